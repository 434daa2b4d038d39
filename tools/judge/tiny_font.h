// Letters for the legends of pictures, drawn by the program itself, so that a difference picture carries its numbers on machines without
// any font. Printable ASCII in cells of 5 x 7 pixels, one pixel of space between; what is not ASCII is drawn as a box.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace chiaro::judge {

using Rgb8 = std::array<uint8_t, 3>;

struct Canvas {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgb; // interleaved, row 0 on top

    Canvas(uint32_t w, uint32_t h, Rgb8 background);
    void set(int64_t x, int64_t y, Rgb8 color) noexcept; // outside: nothing
    void fill(int64_t x, int64_t y, int64_t w, int64_t h, Rgb8 color) noexcept;
};

constexpr uint32_t glyphWidth = 5, glyphHeight = 7;
// In pixels; scale enlarges every pixel of a letter.
uint32_t textWidth(std::string_view text, uint32_t scale = 1) noexcept;
void drawText(Canvas&, int64_t x, int64_t y, std::string_view text, Rgb8 color, uint32_t scale = 1) noexcept;

} // namespace chiaro::judge
