// Values that are never negative as colours: from near black over violet and orange to pale yellow, lightness rising all the way, so that a
// grey print tells the same. Under the picture lies a bar with its numbers.
#pragma once
#include "tools/judge/tiny_font.h"
#include <span>
#include <string>

namespace chiaro::judge {

// t = value / scale, cut to 0..1; sRGB. Not a number: notFiniteColor of tools/judge/false_color.h.
Rgb8 rampColor(double t) noexcept;

// values: one a pixel, row 0 on top. The canvas is wider than the picture where the bar needs more room; the picture lies at its upper left
// corner, one pixel for a pixel. title: what the numbers are.
Canvas ramp(std::span<const float> values, uint32_t width, uint32_t height, double scale, const std::string& title);

} // namespace chiaro::judge
