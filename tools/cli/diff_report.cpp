// What `chiaro diff` prints for people: what was compared, one line a metric, means, the largest difference.
#include "tools/cli/diff.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

using judge::Channel;

std::string number(double v) { return std::isnan(v) ? "-" : fmt::format("{:.6g}", v); }

std::size_t rowOf(const judge::Metric& m) { return std::size_t(&m - judge::metricTable().data()); }

std::string sideLine(const char* label, const PictureSide& s, const Rect& area) {
    std::string text = fmt::format("{}  {}   {}x{}", label, s.file, s.width, s.height);
    if (area.width() != s.width || area.height() != s.height)
        text += fmt::format(", of it {}x{}+{}+{}", area.width(), area.height(), area.x0, area.y0);
    text += fmt::format("   {}", fmt::join(s.channels, " "));
    text += s.encoded ? "   decoded by the sRGB curve" : "   linear";
    if (s.channels.size() == 1) text += ", grey";
    if (!s.picture.error.empty()) text += ", with errors";
    if (!s.ignored.empty()) text += fmt::format("   not compared: {}", fmt::join(s.ignored, " "));
    return text + "\n";
}

std::string pixelLine(const Difference& d) {
    std::string text = fmt::format("pixels    {} compared", d.report.compared);
    if (d.report.compared != d.keep.size()) text += fmt::format(" of {}", d.keep.size());
    if (d.report.selected != d.keep.size()) text += fmt::format(", {} outside crop or mask", d.keep.size() - d.report.selected);
    if (d.notFinite > 0)
        text += fmt::format(", {} not finite (A {}, B {})", d.notFinite, d.report.nonFiniteTest, d.report.nonFiniteReference);
    return text + "\n\n";
}

std::string summaryTable(const DiffInputs& in, const Difference& d) {
    std::string text = fmt::format("{:<12} {:>12} {:>14}   {}\n", "metric", "value", "without 0.1 %", "unit");
    for (const judge::Metric* m : d.metrics) {
        const judge::MetricValue& v = d.of(Channel::all).values[rowOf(*m)];
        text += fmt::format("{:<12} {:>12} {:>14}   {}\n", m->name, number(v.value), number(v.trimmed), in.unit(m->unit));
    }
    return text;
}

std::string channelTable(const DiffInputs& in, const Difference& d) {
    std::string text = fmt::format("{:<12}", "metric");
    for (const Channel c : in.told) text += fmt::format(" {:>12}", in.columns[std::size_t(c)]);
    text += "   unit\n";
    for (const judge::Metric* m : d.metrics) {
        text += fmt::format("{:<12}", m->name);
        for (const Channel c : in.told) text += fmt::format(" {:>12}", number(d.of(c).values[rowOf(*m)].value));
        text += fmt::format("   {}\n", in.unit(m->unit));
    }
    const auto row = [&](const char* name, auto value, bool signs) {
        text += fmt::format("{:<12}", name);
        for (const Channel c : in.told) {
            const double v = value(d.of(c));
            text += fmt::format(" {:>12}", signs && std::isfinite(v) ? fmt::format("{:+.6g}", v) : number(v));
        }
        text += fmt::format("   {}\n", in.unit("cd/m2"));
    };
    row(
        "mean A", [](const judge::ChannelReport& r) { return r.meanTest; }, false);
    row(
        "mean B", [](const judge::ChannelReport& r) { return r.meanReference; }, false);
    row(
        "largest d", [](const judge::ChannelReport& r) { return r.worst.difference; }, true);
    return text;
}

// The numbers inside the formulas, where a metric that is told uses them.
std::string constantsLine(const DiffInputs& in, const Difference& d) {
    const auto told = [&](std::string_view name) {
        return std::any_of(d.metrics.begin(), d.metrics.end(), [&](const judge::Metric* m) { return name == m->name; });
    };
    const judge::ChannelReport& r = d.of(Channel::all);
    std::vector<std::string> parts;
    if (told("relmse") || told("relmse-net")) parts.push_back(fmt::format("relmse e {:.6g}", r.relativeFloor));
    if (told("mape")) parts.push_back(fmt::format("mape e {:.6g}", r.percentFloor));
    if (told("psnr")) parts.push_back(fmt::format("psnr peak {:.6g}", r.peak));
    if (told("flip-ldr") && d.report.flipLdr)
        parts.push_back(in.linear() ? fmt::format("flip-ldr on sRGB at exposure {:+.1f}", d.exposure) : std::string("flip-ldr on sRGB"));
    if (told("flip-hdr") && d.report.flipHdr)
        parts.push_back(fmt::format("flip-hdr over {} exposures {:+.1f} to {:+.1f}", d.report.flipHdr->exposures,
                                    d.report.flipHdr->startExposure, d.report.flipHdr->stopExposure));
    return parts.empty() ? std::string() : fmt::format("with      {}\n", fmt::join(parts, ", "));
}

std::string meanLine(const DiffInputs& in, const Difference& d) {
    const judge::ChannelReport& r = d.of(Channel::all);
    const double difference = r.meanTest - r.meanReference;
    std::string text = fmt::format("mean      A {}, B {}, A - B {}", number(r.meanTest), number(r.meanReference),
                                   std::isnan(difference) ? "-" : fmt::format("{:+.6g}", difference));
    if (r.meanDifferenceError) {
        const bool a = !in.a.picture.error.empty(), b = !in.b.picture.error.empty();
        const double error = *r.meanDifferenceError;
        text += fmt::format(" +- {} (1 standard error, of {})", number(error), a && b ? "both" : a ? "A alone" : "B alone");
        if (error > 0 && std::isfinite(error)) text += fmt::format(", {:.1f} of them", std::abs(difference) / error);
    }
    return text + "\n";
}

std::string largestLine(const DiffInputs& in, const Difference& d) {
    if (d.report.compared == 0) return {};
    const judge::Worst& w = d.of(d.worstChannel).worst;
    if (w.difference == 0) return "largest   no pixel differs\n";
    return fmt::format("largest   |d| {:.6g} at pixel {},{} channel {}: A {:.6g}, B {:.6g}; A max/median {}\n", std::abs(w.difference),
                       w.x + in.area.x0, w.y + in.area.y0, in.columns[std::size_t(d.worstChannel)], w.test, w.reference,
                       number(d.of(Channel::all).maxOverMedian));
}

} // namespace

std::string diffText(const DiffInputs& in, const Difference& d, const DiffSettings& s) {
    std::string text = sideLine("A", in.a, in.area) + sideLine("B", in.b, in.area);
    if (!s.layer.empty()) text += fmt::format("layer     {}\n", s.layer);
    if (!s.crop.empty()) text += fmt::format("crop      {}\n", s.crop);
    if (!s.mask.empty()) text += fmt::format("mask      {}\n", s.mask);
    text += pixelLine(d);
    text += s.perChannel ? channelTable(in, d) : summaryTable(in, d);
    return text + "\n" + constantsLine(in, d) + meanLine(in, d) + largestLine(in, d);
}

} // namespace chiaro::cli
