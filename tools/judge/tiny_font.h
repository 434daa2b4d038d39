// Letters for the legends of pictures, drawn by the program itself, so that a difference picture carries its numbers on machines without
// any font. Glyphs of 5 x 7 pixels, one pixel of space between. Text is UTF-8: printable ASCII, the signs that reports use, and Latin
// letters with accents, which are drawn without them; every other character, and every byte that is no UTF-8, is one box.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
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
    void blend(int64_t x, int64_t y, Rgb8 color, float opacity) noexcept; // over what is there; outside: nothing
};

constexpr uint32_t glyphWidth = 5, glyphHeight = 7, glyphDescent = 2; // g, j, p, q and y reach below the line
std::size_t characters(std::string_view text) noexcept;               // as drawText counts them
// The text itself, or as much of its beginning as leaves room for an ellipsis within so many characters.
std::string shortened(std::string_view text, std::size_t most);
// In pixels; scale enlarges a letter. From 2 on the pixels of a glyph are joined to round strokes with smooth edges.
uint32_t textWidth(std::string_view text, uint32_t scale = 1) noexcept;
void drawText(Canvas&, int64_t x, int64_t y, std::string_view text, Rgb8 color, uint32_t scale = 1) noexcept;

} // namespace chiaro::judge
