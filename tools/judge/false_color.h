// Signed values as colours: blue where they are negative, red where they are positive, light grey at zero, so that the eye reads sign and
// size at once. Between the ends the colours run straight through Oklab (Ottosson, A Perceptual Color Space for Image Processing, 2020), so
// that equal steps of the value look equally large, and both signs equally strong. Under the picture lies a bar with its numbers.
#pragma once
#include "tools/judge/tiny_font.h"
#include <span>
#include <string>

namespace chiaro::judge {

// 1, 2 or 5 times a power of ten that is no smaller than the `quantile` of |value| among those that are finite and not 0; 1 without any.
double niceScale(std::span<const float> values, double quantile = 0.99);

// t = value/scale, cut to -1..1; sRGB. Not a number: the green of `notFiniteColor`.
Rgb8 signedColor(double t) noexcept;
inline constexpr Rgb8 notFiniteColor{0, 170, 60}, leftOutColor{70, 70, 70}, paperColor{255, 255, 255}, inkColor{20, 20, 20};

struct FalseColorLegend {
    std::string negative, positive; // what the two ends mean: "B brighter", "A brighter"
    std::string unit;               // after the numbers; may be empty
};
// values: one a pixel, row 0 on top; keep: one byte a pixel or empty; what is left out is dark grey. The canvas is wider than the picture
// where the legend needs more room; the picture lies at its upper left corner, one pixel for a pixel.
Canvas falseColor(std::span<const float> values, std::span<const uint8_t> keep, uint32_t width, uint32_t height, double scale,
                  const FalseColorLegend& legend);

} // namespace chiaro::judge
