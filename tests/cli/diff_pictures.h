// Small pictures for the tests of `chiaro diff`, written as files, and its JSON read back.
#pragma once
#include "io/picture.h"
#include "program.h"
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace program {

using Json = nlohmann::json;
using Planes = std::vector<std::pair<std::string, std::vector<float>>>;

inline void writePlanes(const fs::path& file, uint32_t width, uint32_t height, const Planes& planes) {
    chiaro::Picture p{.width = width, .height = height, .window = {0, 0, width, height}, .names = {}, .planes = {}, .metadata = {}};
    for (const auto& [name, values] : planes) p.add(name) = values;
    chiaro::writeExr(file, p);
}
// A row of grey pixels as R G B.
inline void writeRow(const fs::path& file, const std::vector<float>& values) {
    writePlanes(file, uint32_t(values.size()), 1, {{"R", values}, {"G", values}, {"B", values}});
}
inline void writeConstant(const fs::path& file, uint32_t width, uint32_t height, float r, float g, float b) {
    const std::size_t n = std::size_t(width) * height;
    writePlanes(file, width, height, {{"R", std::vector(n, r)}, {"G", std::vector(n, g)}, {"B", std::vector(n, b)}});
}
inline void writeBytes(const fs::path& file, uint32_t width, uint32_t height, const std::vector<uint8_t>& rgb) {
    chiaro::writePng(file, width, height, rgb, {}, true);
}

inline Json json(const Outcome& o) {
    const Json parsed = Json::parse(o.out, nullptr, false);
    CAPTURE(o.out);
    CAPTURE(o.err);
    REQUIRE(parsed.is_object());
    return parsed;
}
inline std::vector<std::string> diffWords(const std::vector<std::string>& more = {}, const std::string& output = "json") {
    std::vector<std::string> words{"diff", "a.exr", "b.exr"};
    if (!output.empty()) words.insert(words.end(), {"--" + output, "-"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
}
inline double metric(const Json& j, const std::string& name, const std::string& channel = "rgb") {
    return j["metrics"][name][channel]["value"].get<double>();
}
inline bool near(double value, double expected, double relative = 1e-6) {
    return std::abs(value - expected) <= relative * std::abs(expected);
}
inline constexpr float notANumber = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

} // namespace program
