// The sky in sixteen lanes: Sky::at() and Sky::sample() from the same tables, the look-up to the last bit, the sample but for the rounding
// of sine and cosine. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "core/scene/sky.h"
#include <cstring>

namespace chiaro::CHIARO_ISA {

struct WideSkyTables {
    SkyFrame frame;
    const float *texels, *cells, *rows;
    uint32_t count;
    bool linear;
};
struct WideSkyValue {
    Rgbw radiance;
    Float pdfW;
};

CHIARO_LANE WideSkyValue skyTexel(const WideSkyTables& sky, Int texel) noexcept {
    alignas(64) uint32_t at[laneCount];
    (texel << 2).store(at);
    WideSkyValue v;
    loadFour(sky.texels, at, v.radiance.c[0], v.radiance.c[1], v.radiance.c[2], v.pdfW);
    return v;
}
// Around the horizon, and to the edge at the poles. As signed numbers both may be one too low.
CHIARO_LANE Int skyColumn(const WideSkyTables& sky, Int x) noexcept {
    const Int width(sky.frame.width);
    x = select(x >= Int(0x80000000u), x + width, select(x >= width, x - width, x));
    return select(x >= width, width - Int(1u), x);
}
CHIARO_LANE Int skyLine(const WideSkyTables& sky, Int y) noexcept {
    const Int height(sky.frame.height);
    return select(y >= Int(0x80000000u), Int(0u), select(y >= height, height - Int(1u), y));
}
// m: lanes whose place is one; the others hold nothing of use.
CHIARO_LANE WideSkyValue skyLook(const WideSkyTables& sky, const SkyPlace<Float>& place, Mask m) noexcept {
    const Float px = select(m, place.x, Float(0.5f)), py = select(m, place.y, Float(0.5f)), half(0.5f);
    const Int width(sky.frame.width);
    if (!sky.linear) return skyTexel(sky, skyLine(sky, truncated(py)) * width + skyColumn(sky, truncated(px)));
    const Float x0 = floor(px - half), y0 = floor(py - half), fx = px - half - x0, fy = py - half - y0;
    const Int x = truncated(x0), y = truncated(y0);
    const Int left = skyColumn(sky, x), right = skyColumn(sky, x + Int(1u));
    const Int above = skyLine(sky, y) * width, below = skyLine(sky, y + Int(1u)) * width;
    const WideSkyValue a = skyTexel(sky, above + left), b = skyTexel(sky, above + right), c = skyTexel(sky, below + left),
                       d = skyTexel(sky, below + right);
    const SkyWeights<Float> w = skyWeights(fx, fy);
    WideSkyValue v;
    for (std::size_t i = 0; i < 3; ++i) v.radiance.c[i] = skyBlend(w, a.radiance.c[i], b.radiance.c[i], c.radiance.c[i], d.radiance.c[i]);
    const Mask first = fx < half;
    v.pdfW = select(fy < half, select(first, a.pdfW, b.pdfW), select(first, c.pdfW, d.pdfW));
    return v;
}

CHIARO_LANE WideSkyValue skyAt(const WideSkyTables& sky, const Vec3w& direction, Mask m) noexcept {
    return skyLook(sky, skyPlace(sky.frame, direction), m);
}

// What skySample() will read, on its way into the caches: first the cells, and when these have come the texels that they lead to. The
// tables are larger than the caches near the processor, and each step waits for the one before.
CHIARO_LANE void fetchSkyCells(const WideSkyTables& sky, Int cell, Mask m) noexcept {
    alignas(64) uint32_t at[laneCount];
    (cell << 1).store(at);
    for (uint32_t bits = m.bits(); bits; bits &= bits - 1)
        _mm_prefetch(reinterpret_cast<const char*>(sky.cells + at[__builtin_ctz(bits)]), _MM_HINT_T0);
}
CHIARO_LANE void fetchSkyTexels(const WideSkyTables& sky, Int cell, const Vec2w& u, Mask m) noexcept {
    alignas(64) uint32_t at[laneCount];
    alignas(64) float test[laneCount];
    (cell << 1).store(at);
    u.x.store(test);
    const uint32_t upper = (u.y < Float(0.5f)).bits();
    for (uint32_t bits = m.bits(); bits; bits &= bits - 1) {
        const auto k = uint32_t(__builtin_ctz(bits));
        const float* const c = sky.cells + at[k];
        uint32_t texel;
        std::memcpy(&texel, c + 1, sizeof texel);
        if (test[k] < *c) texel = at[k] >> 1;
        const float* const first = sky.texels + std::size_t(texel) * 4;
        _mm_prefetch(reinterpret_cast<const char*>(first), _MM_HINT_T0);
        if (!sky.linear) continue;
        // Of the row above or below, whichever the place lies nearer to.
        const std::size_t row = std::size_t(sky.frame.width) * 4;
        const bool above = (upper >> k & 1) != 0;
        if (above ? texel >= sky.frame.width : texel + sky.frame.width < sky.count)
            _mm_prefetch(reinterpret_cast<const char*>(above ? first - row : first + row), _MM_HINT_T0);
    }
}

struct WideSkySample {
    Vec3w wi;
    Rgbw radiance;
    Float pdfW;
};
// cell: of the alias table, chosen by another number than u; less than their count in every lane.
CHIARO_LANE WideSkySample skySample(const WideSkyTables& sky, Int cell, const Vec2w& u) noexcept {
    alignas(64) uint32_t at[laneCount];
    (cell << 1).store(at);
    Float keep, alias, unused;
    loadFour(sky.cells, at, keep, alias, unused, unused);
    const Mask stays = u.x < keep;
    const Float over = select(stays, u.x, u.x - keep) / select(stays, keep, Float(1.f) - keep);
    const Float left = min(over, Float(oneMinusEpsilon));
    const Int texel = select(stays, cell, floatAsBits(alias)), width(sky.frame.width);
    // Row and column: the quotient by a multiplication is one too low at most.
    const uint32_t inverse = sky.frame.width > 1 ? uint32_t((uint64_t(1) << 32) / sky.frame.width) : 0xffffffffu;
    Int row = mulHigh(texel, Int(inverse)), column = texel - row * width;
    const Mask low = column >= width;
    row = select(low, row + Int(1u), row);
    column = select(low, column - width, column);
    const Mask all(0xffffu);
    const Float upper = gather(sky.rows, row, all), lower = gather(sky.rows + 1, row, all);
    const SkyDirection<Float> d = skyDirection(sky.frame, toFloat(column) + left, upper + (lower - upper) * u.y);
    const WideSkyValue own = skyTexel(sky, texel);
    if (!sky.linear) return {d.w, own.radiance, own.pdfW};
    return {d.w, skyLook(sky, d.place, all).radiance, own.pdfW};
}

} // namespace chiaro::CHIARO_ISA
