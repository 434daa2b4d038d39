#include "tools/report/report.h"
#include "core/render/error.h"
#include "io/replace_file.h"
#include "tools/report/fit.h"
#include "tools/report/json.h"
#include "tools/report/page.h"
#include <fmt/format.h>
#include <map>
#include <span>
#include <string_view>

namespace chiaro::report {
namespace {

// As a content security policy wants it; the build knows the hash in hexadecimal.
std::string base64(std::string_view hexadecimal) {
    static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto digit = [](char c) { return uint32_t(c <= '9' ? c - '0' : c - 'a' + 10); };
    std::string out;
    for (std::size_t i = 0; i < hexadecimal.size(); i += 3) { // three digits are 12 bits are two letters
        uint32_t v = 0;
        for (std::size_t k = i; k < i + 3; ++k) v = v << 4 | (k < hexadecimal.size() ? digit(hexadecimal[k]) : 0);
        out += letters[v >> 6];
        out += letters[v & 63];
    }
    if (hexadecimal.size() % 3 == 1) out.back() = '='; // 4 bits over: the second letter is padding, as are what follows
    while (out.size() % 4 != 0) out += '=';
    return out;
}

// The template with its marks {{name}} filled, in one pass: what is filled in is never looked at again.
std::string filled(std::string_view text, const std::map<std::string_view, std::string_view>& values) {
    std::string out;
    for (std::size_t at = 0;;) {
        const std::size_t open = text.find("{{", at);
        out += text.substr(at, open - at);
        if (open == std::string_view::npos) return out;
        const std::size_t close = text.find("}}", open);
        out += values.at(text.substr(open + 2, close - open - 2));
        at = close + 2;
    }
}

void appendBlock(std::string& out, const Block& block, uint32_t& next) {
    if (block.packed.bytes.empty()) return;
    out += fmt::format("<script type=\"text/plain\" id=\"block{}\">{}</script>\n", next++, asText(block.packed.bytes));
}

std::string blocksOf(const Fitted& fitted) {
    std::string out;
    uint32_t next = 0; // the order of asJson: picture, layers, maps of each entry
    for (const Fitted::Entry& e : fitted.entries) {
        for (const Block& b : e.pictures) appendBlock(out, b, next);
        for (const Block& b : e.maps) appendBlock(out, b, next);
    }
    return out;
}

std::string pageOf(const Report& report, const Fitted& fitted) {
    const std::string data = asJson(report, fitted), blocks = blocksOf(fitted);
    const std::string styleHash = base64(pageStyleHash), scriptHash = base64(pageScriptHash);
    return filled(pageHtml, {{"style", pageStyle},
                             {"style-hash", styleHash},
                             {"script", pageScript},
                             {"script-hash", scriptHash},
                             {"data", data},
                             {"blocks", blocks}});
}

// What the page needs besides its pictures: a report of everything but their pixels, and room for the blocks' tags and numbers.
std::uintmax_t besides(const Report& full) {
    Report bare{full.title,    full.version, full.command,   full.machine, full.settings,   full.notes,
                full.exposure, {},           full.reference, full.curves,  full.timeToError};
    std::uintmax_t blocks = 0;
    for (const Entry& e : full.entries) {
        Entry text;
        text.name = e.name, text.source = e.source, text.covers = e.covers, text.standing = e.standing, text.verdict = e.verdict;
        text.metrics = e.metrics, text.file = e.file, text.command = e.command;
        text.picture.name = e.picture.name;
        for (const Image& layer : e.layers) text.layers.push_back({layer.name, 0, 0, {}});
        for (const Map& m : e.maps) text.maps.push_back({m.name, m.caption, {}, m.low, m.high, m.diverging});
        blocks += 1 + e.layers.size() + e.maps.size();
        bare.entries.push_back(std::move(text));
    }
    return pageOf(bare, fit(bare, 0)).size() + 200 * blocks + 1000;
}

} // namespace

WrittenReport writeReport(const Report& report, const std::filesystem::path& file, std::uintmax_t limit) {
    const std::uintmax_t taken = besides(report);
    Fitted fitted = fit(report, limit > taken ? limit - taken : 0);
    std::string page = pageOf(report, fitted);
    if (page.size() > limit) {
        fitted.reductions.push_back(fmt::format("the page is larger than {} bytes all the same: so much are its texts and numbers", limit));
        page = pageOf(report, fitted);
    }
    replaceFile(file, std::as_bytes(std::span(page)));
    return {page.size(), fitted.reductions};
}

} // namespace chiaro::report
