#include "tools/judge/tiny_font.h"
#include <algorithm>
#include <cmath>

namespace chiaro::judge {
namespace {

// Rows of five bits from the top, the leftmost pixel in the highest bit, seven above the base line and those of g, j, p, q and y below it;
// in the order of ASCII from the space on.
constexpr uint32_t glyphRows = glyphHeight + glyphDescent;
using Glyph = std::array<uint8_t, glyphRows>;
constexpr auto glyphs = std::to_array<Glyph>({
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000},                   // space
    {0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00000, 0b00100},                   // !
    {0b01010, 0b01010, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000},                   // "
    {0b01010, 0b01010, 0b11111, 0b01010, 0b11111, 0b01010, 0b01010},                   // #
    {0b00100, 0b01111, 0b10100, 0b01110, 0b00101, 0b11110, 0b00100},                   // $
    {0b11000, 0b11001, 0b00010, 0b00100, 0b01000, 0b10011, 0b00011},                   // %
    {0b01100, 0b10010, 0b10100, 0b01000, 0b10101, 0b10010, 0b01101},                   // &
    {0b00100, 0b00100, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000},                   // '
    {0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0b00100, 0b00010},                   // (
    {0b01000, 0b00100, 0b00010, 0b00010, 0b00010, 0b00100, 0b01000},                   // )
    {0b00000, 0b00100, 0b10101, 0b01110, 0b10101, 0b00100, 0b00000},                   // *
    {0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000},                   // +
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b00100, 0b01000},          // ,
    {0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000},                   // -
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b01100},                   // .
    {0b00000, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b00000},                   // /
    {0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110},                   // 0
    {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},                   // 1
    {0b01110, 0b10001, 0b00001, 0b00010, 0b00100, 0b01000, 0b11111},                   // 2
    {0b11111, 0b00010, 0b00100, 0b00010, 0b00001, 0b10001, 0b01110},                   // 3
    {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010},                   // 4
    {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110},                   // 5
    {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110},                   // 6
    {0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000},                   // 7
    {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110},                   // 8
    {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100},                   // 9
    {0b00000, 0b01100, 0b01100, 0b00000, 0b01100, 0b01100, 0b00000},                   // :
    {0b00000, 0b01100, 0b01100, 0b00000, 0b00000, 0b01100, 0b00100, 0b01000},          // ;
    {0b00010, 0b00100, 0b01000, 0b10000, 0b01000, 0b00100, 0b00010},                   // <
    {0b00000, 0b00000, 0b11111, 0b00000, 0b11111, 0b00000, 0b00000},                   // =
    {0b01000, 0b00100, 0b00010, 0b00001, 0b00010, 0b00100, 0b01000},                   // >
    {0b01110, 0b10001, 0b00001, 0b00010, 0b00100, 0b00000, 0b00100},                   // ?
    {0b01110, 0b10001, 0b00001, 0b01101, 0b10101, 0b10101, 0b01110},                   // @
    {0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001},                   // A
    {0b11110, 0b10001, 0b10001, 0b11110, 0b10001, 0b10001, 0b11110},                   // B
    {0b01110, 0b10001, 0b10000, 0b10000, 0b10000, 0b10001, 0b01110},                   // C
    {0b11100, 0b10010, 0b10001, 0b10001, 0b10001, 0b10010, 0b11100},                   // D
    {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b11111},                   // E
    {0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b10000},                   // F
    {0b01110, 0b10001, 0b10000, 0b10111, 0b10001, 0b10001, 0b01111},                   // G
    {0b10001, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001},                   // H
    {0b01110, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},                   // I
    {0b00111, 0b00010, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100},                   // J
    {0b10001, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010, 0b10001},                   // K
    {0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b10000, 0b11111},                   // L
    {0b10001, 0b11011, 0b10101, 0b10101, 0b10001, 0b10001, 0b10001},                   // M
    {0b10001, 0b10001, 0b11001, 0b10101, 0b10011, 0b10001, 0b10001},                   // N
    {0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110},                   // O
    {0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000},                   // P
    {0b01110, 0b10001, 0b10001, 0b10001, 0b10101, 0b10010, 0b01101},                   // Q
    {0b11110, 0b10001, 0b10001, 0b11110, 0b10100, 0b10010, 0b10001},                   // R
    {0b01111, 0b10000, 0b10000, 0b01110, 0b00001, 0b00001, 0b11110},                   // S
    {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100},                   // T
    {0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110},                   // U
    {0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100},                   // V
    {0b10001, 0b10001, 0b10001, 0b10101, 0b10101, 0b10101, 0b01010},                   // W
    {0b10001, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b10001},                   // X
    {0b10001, 0b10001, 0b10001, 0b01010, 0b00100, 0b00100, 0b00100},                   // Y
    {0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b11111},                   // Z
    {0b01110, 0b01000, 0b01000, 0b01000, 0b01000, 0b01000, 0b01110},                   // [
    {0b00000, 0b10000, 0b01000, 0b00100, 0b00010, 0b00001, 0b00000},                   // backslash
    {0b01110, 0b00010, 0b00010, 0b00010, 0b00010, 0b00010, 0b01110},                   // ]
    {0b00100, 0b01010, 0b10001, 0b00000, 0b00000, 0b00000, 0b00000},                   // ^
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b11111},                   // _
    {0b01000, 0b00100, 0b00010, 0b00000, 0b00000, 0b00000, 0b00000},                   // `
    {0b00000, 0b00000, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111},                   // a
    {0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b11110},                   // b
    {0b00000, 0b00000, 0b01110, 0b10000, 0b10000, 0b10001, 0b01110},                   // c
    {0b00001, 0b00001, 0b01101, 0b10011, 0b10001, 0b10001, 0b01111},                   // d
    {0b00000, 0b00000, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110},                   // e
    {0b00110, 0b01001, 0b01000, 0b11100, 0b01000, 0b01000, 0b01000},                   // f
    {0b00000, 0b00000, 0b01101, 0b10011, 0b10001, 0b10011, 0b01101, 0b00001, 0b01110}, // g
    {0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001},                   // h
    {0b00100, 0b00000, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110},                   // i
    {0b00010, 0b00000, 0b00110, 0b00010, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100}, // j
    {0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010},                   // k
    {0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},                   // l
    {0b00000, 0b00000, 0b11010, 0b10101, 0b10101, 0b10001, 0b10001},                   // m
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001},                   // n
    {0b00000, 0b00000, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110},                   // o
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10001, 0b11001, 0b10110, 0b10000, 0b10000}, // p
    {0b00000, 0b00000, 0b01101, 0b10011, 0b10001, 0b10011, 0b01101, 0b00001, 0b00001}, // q
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000},                   // r
    {0b00000, 0b00000, 0b01110, 0b10000, 0b01110, 0b00001, 0b11110},                   // s
    {0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110},                   // t
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101},                   // u
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100},                   // v
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10101, 0b10101, 0b01010},                   // w
    {0b00000, 0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001},                   // x
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101, 0b00001, 0b01110}, // y
    {0b00000, 0b00000, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111},                   // z
    {0b00010, 0b00100, 0b00100, 0b01000, 0b00100, 0b00100, 0b00010},                   // {
    {0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100},                   // |
    {0b01000, 0b00100, 0b00100, 0b00010, 0b00100, 0b00100, 0b01000},                   // }
    {0b00000, 0b00000, 0b01000, 0b10101, 0b00010, 0b00000, 0b00000},                   // ~
});
constexpr Glyph box{0b11111, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b11111};

constexpr Glyph ellipsis{0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b10101};
constexpr Glyph times{0b00000, 0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001};
constexpr Glyph plusMinus{0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b11111};
constexpr Glyph middleDot{0b00000, 0b00000, 0b00000, 0b01100, 0b01100, 0b00000, 0b00000};
// U+00C0 to U+00FF without their accents.
constexpr std::string_view latin = "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYPsaaaaaaaceeeeiiiidnooooo/ouuuuypy";

const Glyph& glyphOf(char32_t c) noexcept {
    if (c >= 32 && c < 32 + glyphs.size()) return glyphs[c - 32];
    if (c == U'\u00d7') return times;
    if (c >= 0xc0 && c <= 0xff) return glyphs[std::size_t(latin[c - 0xc0]) - 32];
    switch (c) {
    case U'\u00a0': return glyphs[0];
    case U'\u00b1': return plusMinus;
    case U'\u00b7': return middleDot;
    case U'\u2010':
    case U'\u2011':
    case U'\u2013':
    case U'\u2014':
    case U'\u2212': return glyphs[std::size_t('-') - 32];
    case U'\u2018':
    case U'\u2019': return glyphs[std::size_t('\'') - 32];
    case U'\u201c':
    case U'\u201d': return glyphs[std::size_t('"') - 32];
    case U'\u2026': return ellipsis;
    default: return box;
    }
}

// Takes one character off the front; a byte that begins none is taken alone.
char32_t takeCharacter(std::string_view& text) noexcept {
    const auto byte = [&text](std::size_t i) { return char32_t(static_cast<unsigned char>(text[i])); };
    const char32_t first = byte(0);
    const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    bool whole = length > 0 && length <= text.size();
    char32_t c = length < 2 ? first : first & (0x7f >> length);
    for (std::size_t i = 1; whole && i < length; ++i) {
        whole = byte(i) >> 6 == 2;
        c = c << 6 | (byte(i) & 0x3f);
    }
    text.remove_prefix(whole ? length : 1);
    return whole ? c : char32_t(0xfffd);
}

// The strokes of a glyph: neighbouring pixels joined through their centres, corner to corner only where no edge joins them.
struct Stroke {
    float x0, y0, x1, y1;
};
struct Strokes {
    std::array<Stroke, glyphWidth * glyphRows * 4> all;
    std::size_t count = 0;
};
Strokes strokesOf(const Glyph& glyph) noexcept {
    Strokes s;
    const auto lit = [&glyph](int x, int y) {
        return x >= 0 && x < int(glyphWidth) && y >= 0 && y < int(glyphRows) && (glyph[std::size_t(y)] >> (int(glyphWidth) - 1 - x) & 1);
    };
    const auto join = [&s](int x0, int y0, int x1, int y1) { s.all[s.count++] = {float(x0), float(y0), float(x1), float(y1)}; };
    for (int y = 0; y < int(glyphRows); ++y)
        for (int x = 0; x < int(glyphWidth); ++x) {
            if (!lit(x, y)) continue;
            join(x, y, x, y);
            if (lit(x + 1, y)) join(x, y, x + 1, y);
            if (lit(x, y + 1)) join(x, y, x, y + 1);
            if (lit(x + 1, y + 1) && !lit(x + 1, y) && !lit(x, y + 1)) join(x, y, x + 1, y + 1);
            if (lit(x - 1, y + 1) && !lit(x - 1, y) && !lit(x, y + 1)) join(x, y, x - 1, y + 1);
        }
    return s;
}

float distanceTo(const Stroke& s, float x, float y) noexcept {
    const float dx = s.x1 - s.x0, dy = s.y1 - s.y0, lengthSquared = dx * dx + dy * dy;
    const float along = lengthSquared > 0 ? std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / lengthSquared, 0.f, 1.f) : 0.f;
    return std::hypot(x - s.x0 - along * dx, y - s.y0 - along * dy);
}

void drawStrokes(Canvas& canvas, int64_t left, int64_t top, const Glyph& glyph, Rgb8 color, uint32_t scale) noexcept {
    constexpr float halfWidth = 0.47f; // of a stroke, in pixels of the glyph
    const Strokes strokes = strokesOf(glyph);
    const float size = float(scale);
    for (uint32_t y = 0; y < glyphRows * scale; ++y)
        for (uint32_t x = 0; x < glyphWidth * scale; ++x) {
            const float px = (float(x) + 0.5f) / size - 0.5f, py = (float(y) + 0.5f) / size - 0.5f;
            float distance = float(glyphWidth + glyphRows);
            for (std::size_t i = 0; i < strokes.count; ++i) distance = std::min(distance, distanceTo(strokes.all[i], px, py));
            canvas.blend(left + x, top + y, color, (halfWidth - distance) * size + 0.5f); // what the edge covers of this pixel
        }
}

} // namespace

Canvas::Canvas(uint32_t w, uint32_t h, Rgb8 background) : width(w), height(h), rgb(std::size_t(w) * h * 3) {
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = background[i % 3];
}

void Canvas::set(int64_t x, int64_t y, Rgb8 color) noexcept { blend(x, y, color, 1); }

void Canvas::fill(int64_t x, int64_t y, int64_t w, int64_t h, Rgb8 color) noexcept {
    for (int64_t row = y; row < y + h; ++row)
        for (int64_t column = x; column < x + w; ++column) set(column, row, color);
}

void Canvas::blend(int64_t x, int64_t y, Rgb8 color, float opacity) noexcept {
    if (x < 0 || y < 0 || x >= int64_t(width) || y >= int64_t(height) || !(opacity > 0)) return;
    uint8_t* pixel = rgb.data() + 3 * (y * int64_t(width) + x);
    for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = opacity >= 1 ? color[c] : uint8_t(float(pixel[c]) + (float(color[c]) - float(pixel[c])) * opacity + 0.5f);
}

std::size_t characters(std::string_view text) noexcept {
    std::size_t n = 0;
    for (; !text.empty(); ++n) takeCharacter(text);
    return n;
}

std::string shortened(std::string_view text, std::size_t most) {
    if (characters(text) <= most) return std::string(text);
    std::string_view rest = text;
    for (std::size_t i = 1; i < most; ++i) takeCharacter(rest);
    return std::string(text.substr(0, text.size() - rest.size())) + (most > 0 ? "\u2026" : "");
}

uint32_t textWidth(std::string_view text, uint32_t scale) noexcept {
    return text.empty() ? 0 : uint32_t(characters(text) * (glyphWidth + 1) - 1) * scale;
}

void drawText(Canvas& canvas, int64_t x, int64_t y, std::string_view text, Rgb8 color, uint32_t scale) noexcept {
    for (; !text.empty(); x += (glyphWidth + 1) * scale) {
        const Glyph& glyph = glyphOf(takeCharacter(text));
        if (scale > 1) {
            drawStrokes(canvas, x, y, glyph, color, scale);
            continue;
        }
        for (uint32_t row = 0; row < glyphRows; ++row)
            for (uint32_t column = 0; column < glyphWidth; ++column)
                if (glyph[row] >> (glyphWidth - 1 - column) & 1) canvas.set(x + column, y + row, color);
    }
}

} // namespace chiaro::judge
