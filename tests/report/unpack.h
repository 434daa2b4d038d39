// A page read back: its data, and its pictures decoded as the page decodes them, written a second time from the format's description
// (tools/report/pack.h) so that the two can be held against each other.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace chiaro::test {

std::string fromText(std::string_view text, std::size_t bytes);
std::string inflated(const std::string& bytes);
// Planes of two's complement numbers. predictor: 0 mean, 1 median.
std::vector<std::vector<int32_t>> planesFrom(const std::string& raw, uint32_t width, uint32_t height, int bits, int count, int predictor);

struct Page {
    std::string text;
    nlohmann::json data;
    std::string block(int number) const; // its text
    std::string withoutBlocks() const;
    // Interleaved RGB of an "picture" or "layers" object.
    std::vector<float> picture(const nlohmann::json& image) const;
    std::vector<double> map(const nlohmann::json& map) const;
};
Page pageFrom(std::string text);

} // namespace chiaro::test
