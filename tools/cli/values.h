// Values of options: from text to numbers, with an error (Exit::usage) that names the option, what was given, and the form it should have.
#pragma once
#include "core/math/ray.h"
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace chiaro::cli {

struct Size {
    uint32_t width = 0, height = 0;
};

uint64_t parseWhole(std::string_view option, const std::string& text, uint64_t least, uint64_t most); // 2k, 1M are understood
double parseReal(std::string_view option, const std::string& text, double least, double most);
double parsePercent(std::string_view option, const std::string& text);     // "2%" or "2" as 0.02
double parseDuration(std::string_view option, const std::string& text);    // seconds; "30s", "5m", "2h", "1.5h", "90"
std::size_t parseMemory(std::string_view option, const std::string& text); // bytes; "500M", "32G", "1.5GB", powers of ten
Size parseSize(std::string_view option, const std::string& text);          // "1280x720"
Rect parseCrop(std::string_view option, const std::string& text, Size);    // "WxH+X+Y", inside the picture
Pixel parsePixel(std::string_view option, const std::string& text, Size);  // "X,Y", inside the picture
std::size_t parseChoice(std::string_view option, const std::string& text, std::initializer_list<std::string_view> choices);

} // namespace chiaro::cli
