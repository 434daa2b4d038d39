// Pictures made by formulas, for the tests of the judge.
#pragma once
#include "tools/judge/picture.h"
#include <cmath>
#include <functional>

namespace chiaro::judge::tests {

// 0..1 in steps of 2^-24, a pure function of i (the 32-bit mixer "lowbias32" of Wellons, 2018): any language gives the same number.
inline double uniformAt(uint32_t i) noexcept {
    i ^= i >> 16;
    i *= 0x7feb352du;
    i ^= i >> 15;
    i *= 0x846ca68bu;
    i ^= i >> 16;
    return (i >> 8) / 16777216.0;
}

using Formula = std::function<double(uint32_t x, uint32_t y, uint32_t channel)>;
inline Picture make(uint32_t width, uint32_t height, const Formula& f, std::string name = "picture") {
    Picture p{width, height, {}, {}, std::move(name), {}};
    p.rgb.reserve(p.pixels() * 3);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            for (uint32_t c = 0; c < 3; ++c) p.rgb.push_back(float(f(x, y, c)));
    return p;
}
inline Picture constant(uint32_t width, uint32_t height, double r, double g, double b) {
    return make(width, height, [=](uint32_t, uint32_t, uint32_t c) { return c == 0 ? r : c == 1 ? g : b; });
}

} // namespace chiaro::judge::tests
