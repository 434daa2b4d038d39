#include "tools/judge/ramp.h"
#include "tools/judge/false_color.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::judge {
namespace {

constexpr std::array<Rgb8, 6> stops = {{{8, 8, 30}, {70, 20, 110}, {160, 40, 110}, {230, 90, 50}, {250, 170, 40}, {252, 250, 190}}};

void drawBar(Canvas& canvas, uint32_t top, double scale, const std::string& title, uint32_t s) {
    const uint32_t left = 6 * s, length = canvas.width - 2 * left, bar = 8 * s, y = top + (4 + glyphHeight + 3) * s;
    drawText(canvas, left, top + 4 * s, title, inkColor, s);
    for (uint32_t i = 0; i < length; ++i) canvas.fill(left + i, y, 1, bar, rampColor(double(i) / (length - 1)));
    for (const double t : {0.0, 0.5, 1.0}) {
        const int64_t x = left + std::llround(t * (length - 1));
        canvas.fill(x, y + bar, 1, 2 * s, inkColor);
        const std::string text = fmt::format("{:.3g}", t * scale);
        const int64_t w = textWidth(text, s);
        drawText(canvas, std::clamp<int64_t>(x - w / 2, 2 * s, int64_t(canvas.width) - w - 2 * s), y + bar + 4 * s, text, inkColor, s);
    }
}

} // namespace

Rgb8 rampColor(double t) noexcept {
    if (!std::isfinite(t)) return notFiniteColor;
    const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
    const std::size_t i = std::min(std::size_t(at), stops.size() - 2);
    Rgb8 color{};
    for (std::size_t c = 0; c < 3; ++c)
        color[c] = uint8_t(std::lround(stops[i][c] + (at - double(i)) * (double(stops[i + 1][c]) - stops[i][c])));
    return color;
}

Canvas ramp(std::span<const float> values, uint32_t width, uint32_t height, double scale, const std::string& title) {
    const uint32_t s = std::max(1u, width / 700); // letters stay readable when a large picture is shown small
    const uint32_t room = std::max(textWidth(title, s), 3 * textWidth("0.0005x", s)) + 12 * s;
    Canvas canvas(std::max(width, room), height + (4 + glyphHeight + 3 + 8 + 4 + glyphHeight + 4) * s, paperColor);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) canvas.set(x, y, rampColor(values[std::size_t(y) * width + x] / scale));
    drawBar(canvas, height, scale, title, s);
    return canvas;
}

} // namespace chiaro::judge
