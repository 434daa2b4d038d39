#include "tools/judge/false_color.h"
#include "core/scene/texture.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::judge {
namespace {

using Lab = std::array<double, 3>;

double decode(double v) { return srgbToLinear(float(v)); }
double encode(double v) { return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

Lab oklab(Rgb8 color) {
    const double r = decode(color[0] / 255.0), g = decode(color[1] / 255.0), b = decode(color[2] / 255.0);
    const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb8 srgb(const Lab& c) {
    const double l = std::pow(c[0] + 0.3963377774 * c[1] + 0.2158037573 * c[2], 3);
    const double m = std::pow(c[0] - 0.1055613458 * c[1] - 0.0638541728 * c[2], 3);
    const double s = std::pow(c[0] - 0.0894841775 * c[1] - 1.2914855480 * c[2], 3);
    const auto byte = [](double v) { return uint8_t(std::lround(255 * encode(std::clamp(v, 0.0, 1.0)))); };
    return {byte(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s), byte(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
            byte(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// The ends are about equally dark, so that a picture in grey shows the size of the difference.
constexpr Rgb8 negativeEnd{25, 60, 200}, zero{238, 238, 238}, positiveEnd{190, 10, 30};

std::string number(double v) { return v == 0 ? "0" : fmt::format("{:+.3g}", v); }

// Bar, ticks, numbers and names; `top` is the first row below the picture.
void drawLegend(Canvas& canvas, uint32_t top, double scale, const FalseColorLegend& legend, uint32_t s) {
    const uint32_t margin = 6 * s, bar = 8 * s, left = margin, length = canvas.width - 2 * margin;
    const uint32_t y = top + 4 * s + glyphHeight * s + 3 * s;
    drawText(canvas, left, top + 4 * s, legend.negative, signedColor(-1), s);
    drawText(canvas, int64_t(left + length) - textWidth(legend.positive, s), top + 4 * s, legend.positive, signedColor(1), s);
    if (!legend.unit.empty()) {
        const int64_t x = int64_t(canvas.width / 2) - textWidth(legend.unit, s) / 2;
        drawText(canvas, x, top + 4 * s, legend.unit, inkColor, s);
    }
    for (uint32_t i = 0; i < length; ++i) canvas.fill(left + i, y, 1, bar, signedColor(2.0 * i / (length - 1) - 1));
    for (const double t : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const int64_t x = left + std::llround((t + 1) / 2 * (length - 1));
        canvas.fill(x, y + bar, 1, 2 * s, inkColor);
        const std::string text = number(t * scale);
        const int64_t w = textWidth(text, s);
        const int64_t start = std::clamp<int64_t>(x - w / 2, 2 * s, int64_t(canvas.width) - w - 2 * s);
        drawText(canvas, start, y + bar + 4 * s, text, inkColor, s);
    }
}

} // namespace

double niceScale(std::span<const float> values, double quantile) {
    std::vector<double> sizes;
    for (const float v : values)
        if (std::isfinite(v) && v != 0) sizes.push_back(std::abs(double(v)));
    if (sizes.empty()) return 1;
    const std::size_t rank = std::size_t(std::ceil(std::clamp(quantile, 0.0, 1.0) * double(sizes.size())));
    const auto at = sizes.begin() + std::ptrdiff_t(std::min(rank > 0 ? rank - 1 : 0, sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    const double power = std::pow(10.0, std::floor(std::log10(*at)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= *at * (1 - 1e-6)) return step * power; // float32 values: 0.1f is 0.1
    return 10 * power;
}

Rgb8 signedColor(double t) noexcept {
    if (!std::isfinite(t)) return notFiniteColor;
    static const Lab low = oklab(negativeEnd), middle = oklab(zero), high = oklab(positiveEnd);
    const Lab& end = t < 0 ? low : high;
    const double share = std::min(std::abs(t), 1.0);
    Lab mixed{};
    for (std::size_t c = 0; c < 3; ++c) mixed[c] = middle[c] + share * (end[c] - middle[c]);
    return srgb(mixed);
}

Canvas falseColor(std::span<const float> values, std::span<const uint8_t> keep, uint32_t width, uint32_t height, double scale,
                  const FalseColorLegend& legend) {
    const uint32_t s = std::max(1u, width / 700); // letters stay readable when a large picture is shown small
    const uint32_t names = textWidth(legend.negative + "  " + legend.unit + "  " + legend.positive, s) + 12 * s;
    const uint32_t numbers = 5 * textWidth("+0.0005x", s) + 12 * s;
    const uint32_t legendHeight = (4 + glyphHeight + 3 + 8 + 4 + glyphHeight + 4) * s;
    Canvas canvas(std::max({width, names, numbers}), height + legendHeight, paperColor);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            canvas.set(x, y, !keep.empty() && keep[i] == 0 ? leftOutColor : signedColor(values[i] / scale));
        }
    drawLegend(canvas, height, scale, legend, s);
    return canvas;
}

} // namespace chiaro::judge
