// Pictures made small without loss, as text that any HTML page can carry. Noise leaves little to save, so the steps are chosen for noise:
// half floats with their last mantissa bits rounded away (the only loss, and a chosen one), red and blue as differences to green (the
// channels of one path are noisy together), prediction from four neighbours that are already known, then all low bytes and all high bytes
// apart, deflated (RFC 1950), and written with 91 printable characters: 13 bits in two of them (16/13 of the size; base64 is 4/3).
//
// Units: a half is kept as its bits. Differences and residuals are taken modulo 2^width, so that every step can be undone exactly.
// picture.js undoes them in the page.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace chiaro::report {

// IEEE 754 binary16, rounded to nearest even; what is too large becomes infinite, NaN stays NaN.
uint16_t toHalf(float) noexcept;
float fromHalf(uint16_t) noexcept;
// The upper 6 + mantissa bits of a half (5 to 10 mantissa bits), rounded to nearest even. Finite stays finite, NaN stays NaN.
uint16_t shortened(uint16_t half, int mantissa) noexcept;
uint16_t lengthened(uint16_t code, int mantissa) noexcept;

enum class Predictor : uint8_t {
    mean,  // of left, above, above left and above right: for noise
    median // of left, above and left + above - above left (Weinberger et al., LOCO-I, 2000): for clean pictures
};

// Numbers of `bits` bits (two's complement), row 0 on top; all planes have the same size.
struct Planes {
    uint32_t width = 0, height = 0;
    int bits = 16;
    std::vector<std::vector<uint16_t>> planes;
};
struct Packed {
    std::string bytes; // deflated
    Predictor predictor = Predictor::mean;
};

// G, R - G, B - G of halves with so many mantissa bits. rgb: interleaved.
Planes planesOf(std::span<const uint16_t> rgbHalves, uint32_t width, uint32_t height, int mantissa);
// Codes -steps..steps for low..high, -128 for NaN.
Planes planesOf(std::span<const float> map, uint32_t width, uint32_t height, double low, double high, int steps);

Packed pack(const Planes&); // with the predictor that gives less
// About how many bytes that will be, from every eighth band of rows.
std::size_t packedSize(const Planes&);

std::string asText(std::string_view bytes);

} // namespace chiaro::report
