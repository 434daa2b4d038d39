#include "tools/cli/values.h"
#include "core/render/options.h"
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdexcept>
#include <vector>

namespace chiaro::cli {
namespace {

[[noreturn]] void bad(std::string_view option, const std::string& text, const std::string& wanted) {
    throw Error(Exit::usage, fmt::format("--{}: \"{}\" is not {}", option, text, wanted));
}

// Digits alone; the rest of the text moves on behind them.
std::optional<uint32_t> takeNumber(std::string_view& text) {
    uint32_t value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end == text.data()) return std::nullopt;
    text.remove_prefix(std::size_t(end - text.data()));
    return value;
}
bool take(std::string_view& text, char c) {
    if (text.empty() || text[0] != c) return false;
    text.remove_prefix(1);
    return true;
}
// The whole text as one number, by the rules of the C locale.
std::optional<double> wholeReal(std::string_view text) {
    double value = 0;
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

constexpr uint32_t maxEdge = 65536;

} // namespace

uint64_t parseWhole(std::string_view option, const std::string& text, uint64_t least, uint64_t most) {
    const std::string wanted = fmt::format("a whole number from {} to {}", least, most);
    uint64_t exact = 0; // beyond 2^53 a double would lose digits
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), exact);
    if (failed == std::errc() && end == text.data() + text.size()) {
        if (exact < least || exact > most) bad(option, text, wanted);
        return exact;
    }
    double value = 0;
    try {
        value = parseCount(text);
    } catch (const std::invalid_argument&) { bad(option, text, wanted); }
    if (!(value >= double(least) && value <= double(most)) || value != std::floor(value) || value >= 0x1p64) bad(option, text, wanted);
    return uint64_t(value);
}

double parseReal(std::string_view option, const std::string& text, double least, double most) {
    const auto value = wholeReal(text);
    if (!value || *value < least || *value > most) bad(option, text, fmt::format("a number from {} to {}", least, most));
    return *value;
}

double parsePercent(std::string_view option, const std::string& text) {
    std::string_view number = text;
    while (number.ends_with('%') || number.ends_with(' ')) number.remove_suffix(1);
    const auto value = wholeReal(number);
    if (!value || *value < 1e-3 || *value > 100) bad(option, text, "a percentage from 0.001 to 100, like 2%");
    return *value / 100;
}

double parseDuration(std::string_view option, const std::string& text) {
    std::string_view number = text;
    double unit = 1;
    if (number.ends_with("ms")) {
        unit = 1e-3;
        number.remove_suffix(2);
    } else if (!number.empty() && std::string_view("smh").find(number.back()) != std::string_view::npos) {
        unit = number.back() == 's' ? 1 : number.back() == 'm' ? 60 : 3600;
        number.remove_suffix(1);
    }
    const auto value = wholeReal(number);
    if (!value || *value <= 0 || *value * unit > 1e9) bad(option, text, "a duration like 30s, 5m or 2h");
    return *value * unit;
}

std::size_t parseMemory(std::string_view option, const std::string& text) {
    std::string_view number = text;
    if (number.ends_with('B') || number.ends_with('b')) number.remove_suffix(1);
    double unit = 1;
    constexpr std::string_view units = "kMGT";
    if (!number.empty())
        if (const std::size_t at = units.find(number.back() == 'K' ? 'k' : number.back()); at != units.npos) {
            unit = std::pow(1000.0, double(at + 1));
            number.remove_suffix(1);
        }
    const auto value = wholeReal(number);
    if (!value || !(*value * unit >= 1e6) || *value * unit > 1e15)
        bad(option, text, "an amount of memory from 1M to 1000T, like 500M or 32G");
    return std::size_t(*value * unit);
}

Size parseSize(std::string_view option, const std::string& text) {
    std::string_view rest = text;
    const auto width = takeNumber(rest);
    const bool by = take(rest, 'x');
    const auto height = takeNumber(rest);
    if (!width || !by || !height || !rest.empty()) bad(option, text, "a size like 1280x720");
    if (*width < 1 || *height < 1 || *width > maxEdge || *height > maxEdge)
        bad(option, text, fmt::format("a size from 1x1 to {}x{}", maxEdge, maxEdge));
    return {*width, *height};
}

Rect parseCrop(std::string_view option, const std::string& text, Size picture) {
    std::string_view rest = text;
    const auto width = takeNumber(rest);
    bool form = take(rest, 'x');
    const auto height = takeNumber(rest);
    form &= take(rest, '+');
    const auto x = takeNumber(rest);
    form &= take(rest, '+');
    const auto y = takeNumber(rest);
    if (!form || !width || !height || !x || !y || !rest.empty() || *width == 0 || *height == 0)
        bad(option, text, "a window like 320x240+100+50");
    if (uint64_t(*x) + *width > picture.width || uint64_t(*y) + *height > picture.height)
        bad(option, text, fmt::format("inside the picture of {}x{}", picture.width, picture.height));
    return {*x, *y, *x + *width, *y + *height};
}

Pixel parsePixel(std::string_view option, const std::string& text, Size picture) {
    std::string_view rest = text;
    const auto x = takeNumber(rest);
    const bool comma = take(rest, ',');
    const auto y = takeNumber(rest);
    if (!x || !comma || !y || !rest.empty()) bad(option, text, "a pixel like 119,518 (x from the left, y from the top)");
    if (*x >= picture.width || *y >= picture.height)
        bad(option, text, fmt::format("inside the picture of {}x{}", picture.width, picture.height));
    return {*x, *y};
}

std::size_t parseChoice(std::string_view option, const std::string& text, std::initializer_list<std::string_view> choices) {
    std::size_t at = 0;
    std::vector<std::string> names;
    for (std::string_view c : choices) {
        if (c == text) return at;
        ++at;
        names.emplace_back(c);
    }
    const std::string near = nearest(text, names);
    throw Error(Exit::usage, fmt::format("--{}: \"{}\" is unknown; have {}{}", option, text, fmt::join(names, ", "),
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

} // namespace chiaro::cli
