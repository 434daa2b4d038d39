#include "tools/cli/sheet.h"
#include "io/picture.h"
#include "tools/cli/sheet_picture.h"
#include "tools/judge/false_color.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace chiaro::cli {
namespace {

using judge::Canvas, judge::Rgb8;

constexpr uint32_t widest = 2400, tallestPicture = 1600, smallPicture = 512, narrowestCell = 240, margin = 24, gap = 20;
// A neutral surround, dark so that pictures look as they do in a viewer, and what is read on it.
constexpr Rgb8 surround{30, 30, 30}, ink{235, 235, 235}, faint{165, 165, 165}, hole{55, 55, 55};

struct Word {
    std::string text;
    Rgb8 color;
};
Word wordOf(report::Standing s) {
    using enum report::Standing;
    switch (s) {
    case reference: return {"reference", {150, 190, 235}};
    case agrees: return {"agrees", {110, 205, 120}};
    case cannotTell: return {"cannot tell yet", {225, 200, 100}};
    case missesPaths: return {"leaves paths out", {195, 165, 240}};
    case biased: return {"biased", {240, 165, 90}};
    case differs: return {"differs", {245, 120, 110}};
    case debug: return {"debug view", {170, 170, 170}};
    case unjudged: break;
    }
    return {"", faint};
}

std::string duration(double seconds) {
    if (seconds < 1) return fmt::format("{:.0f} ms", 1000 * seconds);
    if (seconds >= 1000) return fmt::format("{:.1f} min", seconds / 60);
    return seconds < 100 ? fmt::format("{:#.3g} s", seconds) : fmt::format("{:.0f} s", seconds);
}

// What it cost and how far off it is, in pieces that stay whole when the line breaks.
std::vector<Word> figuresOf(const report::Entry& e) {
    std::vector<Word> pieces;
    if (e.seconds > 0) {
        const double prepass = e.prepassSeconds + e.prepareSeconds;
        const std::string before = prepass > 0 ? fmt::format(" ({} pre-pass)", duration(prepass)) : "";
        pieces.push_back({duration(e.seconds) + before, faint});
    }
    if (e.spp > 0) pieces.push_back({fmt::format("{:.{}f} spp", e.spp, e.spp == std::round(e.spp) ? 0 : 1), faint}); // a mean over seeds
    for (const char* name : {"relMSE", "FLIP"})
        for (const report::Metric& m : e.metrics)
            if (m.name == name && std::isfinite(m.value)) pieces.push_back({fmt::format("{} {:.3g}", name, m.value), faint});
    uint64_t holes = 0;
    for (std::size_t i = 0; i + 2 < e.picture.rgb.size(); i += 3)
        holes += !(std::isfinite(e.picture.rgb[i]) && std::isfinite(e.picture.rgb[i + 1]) && std::isfinite(e.picture.rgb[i + 2]));
    if (holes > 0) pieces.push_back({fmt::format("{} px not finite", holes), judge::notFiniteColor});
    return pieces;
}

bool drawable(const report::Image& p) { return p.width > 0 && p.height > 0 && p.rgb.size() == std::size_t(p.width) * p.height * 3; }

struct Layout {
    uint32_t columns = 1, rows = 0;
    SheetSize cell; // the pictures' part of it
    uint32_t letters = 2, titleLines = 1, labelLines = 1;
    uint32_t width = 0, height = 0;
    uint32_t line() const { return (judge::glyphHeight + 5) * letters; }
    uint32_t titleHeight() const { return margin + judge::glyphHeight * (letters + 1) + (titleLines - 1) * line() + margin; }
    uint32_t rowHeight() const { return cell.height + 4 * letters + labelLines * line() + gap; }
};

SheetSize largest(const report::Report& r) {
    SheetSize s{1, 1};
    for (const report::Entry& e : r.entries)
        if (drawable(e.picture)) s = {std::max(s.width, e.picture.width), std::max(s.height, e.picture.height)};
    return s;
}

// The size of a cell with so many beside each other.
SheetSize cellOf(const report::Report& r, uint32_t columns) {
    const uint32_t room = (widest - 2 * margin - (columns - 1) * gap) / columns;
    SheetSize cell{1, 1};
    for (const report::Entry& e : r.entries) {
        if (!drawable(e.picture)) continue;
        const SheetSize s = sheetSize({e.picture.width, e.picture.height}, {room, tallestPicture}, smallPicture);
        cell = {std::max(cell.width, s.width), std::max(cell.height, s.height)};
    }
    cell.width = std::max(cell.width, std::min(room, narrowestCell));
    return cell;
}

// So many beside each other that the whole is wide rather than high and no place stays empty without need.
uint32_t columnsOf(const report::Report& r) {
    const auto n = uint32_t(r.entries.size());
    const SheetSize picture = largest(r);
    const double aspect = double(picture.width) / picture.height;
    uint32_t best = 1;
    double least = 1e30;
    for (uint32_t c = 1; c <= std::min(n, 8u); ++c) {
        const uint32_t rows = (n + c - 1) / c;
        const double cost = std::fabs(std::log(aspect * c / rows / 2.2)) + 3.0 * (rows * c - n) / n;
        if (cost < least) least = cost, best = c;
    }
    return best;
}

using Line = std::vector<Word>;
constexpr uint32_t between = 2; // characters from piece to piece

// Characters of this size that stand side by side in so many pixels.
std::size_t charactersIn(uint32_t width, uint32_t letters) {
    return std::max<std::size_t>(1, (width + letters) / ((judge::glyphWidth + 1) * letters));
}

std::vector<Line> brokenLines(const std::vector<Word>& pieces, uint32_t width, uint32_t letters) {
    std::vector<Line> lines;
    std::size_t used = 0;
    const std::size_t most = charactersIn(width, letters);
    for (const Word& w : pieces) {
        const std::string text = judge::shortened(w.text, most);
        const std::size_t n = judge::characters(text);
        const bool breaks = lines.empty() || used + between + n > most;
        if (breaks) lines.emplace_back();
        used = breaks ? n : used + between + n;
        lines.back().push_back({text, w.color});
    }
    return lines;
}

// A name as pieces that have room in a line: one with many options is broken behind them, so that names which differ look it.
std::vector<Word> nameOf(std::string_view name, std::size_t most) {
    std::vector<Word> pieces(1, {"", ink});
    while (!name.empty()) {
        const std::string option(name.substr(0, std::min(name.find_first_of(":,"), name.size() - 1) + 1));
        std::string& last = pieces.back().text;
        if (last.empty() || judge::characters(last) + judge::characters(option) <= most)
            last += option;
        else
            pieces.push_back({option, ink});
        name.remove_prefix(option.size());
    }
    return pieces;
}

// The name and the verdict, then the figures.
std::vector<Line> labelOf(const report::Entry& e, uint32_t width, uint32_t letters) {
    std::vector<Word> heading = nameOf(e.name, charactersIn(width, letters));
    if (Word verdict = wordOf(e.standing); !verdict.text.empty() && verdict.text != e.name) heading.push_back(std::move(verdict));
    std::vector<Line> lines = brokenLines(heading, width, letters);
    for (Line& line : brokenLines(figuresOf(e), width, letters)) lines.push_back(std::move(line));
    return lines;
}

std::string displayed(const report::Report& r, const DisplayTransform& display) {
    return fmt::format("exposure {:+.4g} EV, view {} ({})", r.exposure, display.view(), display.display());
}

Layout layoutOf(const report::Report& r, const DisplayTransform& display) {
    Layout l;
    const auto n = uint32_t(r.entries.size());
    l.columns = columnsOf(r);
    l.rows = (n + l.columns - 1) / l.columns;
    l.cell = cellOf(r, l.columns);
    l.width = 2 * margin + l.columns * l.cell.width + (l.columns - 1) * gap;
    l.letters = l.width >= 1600 ? 3 : 2; // a wide sheet is shown smaller than it is
    const uint32_t how = judge::textWidth(displayed(r, display), l.letters), title = judge::textWidth(r.title, l.letters + 1);
    l.width = std::max(l.width, std::min(how + 2 * margin, widest));
    l.titleLines = how + title + 2 * margin + gap <= l.width ? 1 : 2;
    for (const report::Entry& e : r.entries) l.labelLines = std::max(l.labelLines, uint32_t(labelOf(e, l.cell.width, l.letters).size()));
    l.height = l.titleHeight() + l.rows * l.rowHeight() + (l.rows > 0 ? margin - gap : 0);
    return l;
}

// What the pictures are of, and how all of them are shown; the two sizes share a base line where they share a line.
void drawTitle(Canvas& canvas, const report::Report& r, const DisplayTransform& display, const Layout& l) {
    const uint32_t room = canvas.width - 2 * margin;
    const std::string how = judge::shortened(displayed(r, display), charactersIn(room, l.letters));
    judge::drawText(canvas, margin, margin, judge::shortened(r.title, charactersIn(room, l.letters + 1)), ink, l.letters + 1);
    if (l.titleLines == 1)
        judge::drawText(canvas, int64_t(canvas.width) - margin - judge::textWidth(how, l.letters), margin + judge::glyphHeight, how, faint,
                        l.letters);
    else
        judge::drawText(canvas, margin, margin + l.line() + judge::glyphHeight, how, faint, l.letters);
}

void drawPicture(Canvas& canvas, const report::Image& p, const DisplayTransform& display, double exposure, int64_t x, int64_t y,
                 SheetSize cell) {
    if (!drawable(p)) {
        canvas.fill(x, y, cell.width, cell.height, hole);
        return;
    }
    const SheetSize size = sheetSize({p.width, p.height}, cell, smallPicture);
    const SheetPixels pixels = sheetPixels(p.rgb, {p.width, p.height}, size);
    const std::vector<uint8_t> bytes = display.bytes(pixels.rgb, exposure);
    for (uint32_t j = 0; j < size.height; ++j)
        for (uint32_t i = 0; i < size.width; ++i) {
            const std::size_t at = std::size_t(j) * size.width + i;
            const Rgb8 color = pixels.unusable[at] ? judge::notFiniteColor : Rgb8{bytes[3 * at], bytes[3 * at + 1], bytes[3 * at + 2]};
            canvas.set(x + i, y + j, color);
        }
}

void drawLabel(Canvas& canvas, const report::Entry& e, const Layout& l, int64_t x, int64_t y) {
    for (const Line& line : labelOf(e, l.cell.width, l.letters)) {
        int64_t left = x;
        for (const Word& w : line) {
            judge::drawText(canvas, left, y, w.text, w.color, l.letters);
            left += int64_t(judge::characters(w.text) + between) * (judge::glyphWidth + 1) * l.letters;
        }
        y += l.line();
    }
}

} // namespace

Canvas drawSheet(const report::Report& r, const DisplayTransform& display) {
    const Layout l = layoutOf(r, display);
    Canvas canvas(l.width, l.height, surround);
    drawTitle(canvas, r, display, l);
    for (std::size_t i = 0; i < r.entries.size(); ++i) {
        const auto x = int64_t(margin + (i % l.columns) * (l.cell.width + gap));
        const auto y = int64_t(l.titleHeight() + (i / l.columns) * l.rowHeight());
        drawPicture(canvas, r.entries[i].picture, display, r.exposure, x, y, l.cell);
        drawLabel(canvas, r.entries[i], l, x, y + l.cell.height + 4 * l.letters);
    }
    return canvas;
}

void writeSheet(const report::Report& r, const std::filesystem::path& file, const DisplayTransform& display) {
    const Canvas canvas = drawSheet(r, display);
    const Metadata metadata{{"chiaro:sheet", r.title}, {"chiaro:command", r.command}, {"chiaro:exposure", r.exposure}};
    writePng(file, canvas.width, canvas.height, canvas.rgb, metadata, display.srgb());
}

} // namespace chiaro::cli
