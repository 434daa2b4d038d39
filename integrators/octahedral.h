// Unit vectors as two small numbers, by way of the octahedron (Cigolle et al., A Survey of Efficient Representations for Independent Unit
// Vectors, JCGT 2014). Branch-free: loops over lanes pack sixteen at a time.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

// Steps of [-1, 1] a coordinate, an even number, so that the axes are exact.
inline constexpr uint32_t fineSteps = 65534, coarseSteps = 254;

template <uint32_t steps> [[gnu::always_inline]] inline uint32_t octahedralStep(float x) noexcept {
    const float at = (x + 1) * (steps / 2.f) + 0.5f, low = at < 0 ? 0 : at, inside = float(steps) < low ? float(steps) : low;
    return uint32_t(int32_t(inside)); // int: lanes convert it
}

// The sphere onto the square [-1, 1]^2, each coordinate in steps; y in the upper `bits`.
template <uint32_t steps, int bits> [[gnu::always_inline]] inline uint32_t octahedralCode(const Vec3& v) noexcept {
    const float s = 1 / (std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z)), x = v.x * s, y = v.y * s;
    const float fx = std::copysign(1 - std::fabs(y), x), fy = std::copysign(1 - std::fabs(x), y);
    const bool upper = v.z >= 0;
    return octahedralStep<steps>(upper ? x : fx) | octahedralStep<steps>(upper ? y : fy) << bits;
}

inline Vec3 fromOctahedron(Point2 e) noexcept {
    Vec3 v{e.x, e.y, 1 - std::fabs(e.x) - std::fabs(e.y)};
    if (v.z < 0) {
        const float x = v.x;
        v.x = std::copysign(1 - std::fabs(v.y), x);
        v.y = std::copysign(1 - std::fabs(x), v.y);
    }
    return normalize(v);
}
template <uint32_t steps> float octahedralPlace(uint32_t c) noexcept { return float(std::min(c, steps)) * (2.f / steps) - 1; }

} // namespace chiaro
