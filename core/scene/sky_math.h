// Where a direction lies in the picture of the sky and the way back, over the number type of core/math/number.h: one path and sixteen
// lanes find the same place to the last bit.
#pragma once
#include "core/math/angles.h"
#include "core/render/fault.h"
#include <cstdint>

namespace chiaro {

// u = 0.5 + atan2(z, x) / (2 pi), v = acos(y) / pi from the top row, after turning back by the environment's rotation about +Y.
struct SkyFrame {
    uint32_t width = 0, height = 0; // texels
    float cosRotate = 1, sinRotate = 0;
};
template <class T> struct SkyPlace {
    T x, y; // texels from the left upper corner
};

template <class T> [[gnu::always_inline]] inline T skyRow(const SkyFrame& sky, const T& across, const T& up) noexcept {
    return arcTangent(across, up) * T(Real<T>(1 / std::numbers::pi)) * T(Real<T>(sky.height));
}
template <class T> [[gnu::always_inline]] inline SkyPlace<T> skyPlace(const SkyFrame& sky, const Vec3T<T>& w) noexcept {
    using R = Real<T>;
    const T c = R(sky.cosRotate), s = R(sky.sinRotate);
    const T x = w.x * c - w.z * s, z = w.x * s + w.z * c;
    const R turn = fault(Fault::skyHalfTexel) ? R(0.5) / R(sky.width) : fault(Fault::skyQuarterTurn) ? R(0.25) : R(0);
    const T u = T(R(0.5)) + arcTangent(z, x) * T(R(0.5 / std::numbers::pi)) + T(turn);
    return {u * T(R(sky.width)), skyRow(sky, sqrt(x * x + z * z), w.y)};
}

template <class T> struct SkyDirection {
    Vec3T<T> w;
    SkyPlace<T> place;
};
// x: texels from the left edge; cosine: of the angle to +Y.
template <class T> [[gnu::always_inline]] inline SkyDirection<T> skyDirection(const SkyFrame& sky, const T& x, const T& cosine) noexcept {
    using R = Real<T>;
    const T one = R(1), phi = (x / T(R(sky.width)) - T(R(0.5))) * T(R(2 * std::numbers::pi));
    const T radius = safeSqrt((one - cosine) * (one + cosine)), dx = radius * cos(phi), dz = radius * sin(phi);
    const T c = R(sky.cosRotate), s = R(sky.sinRotate);
    return {{dx * c + dz * s, cosine, dz * c - dx * s}, {x, skyRow(sky, radius, cosine)}};
}

// Between four texels, bilinear.
template <class T> struct SkyWeights {
    T own[4]; // left and right above, left and right below
};
template <class T> [[gnu::always_inline]] inline SkyWeights<T> skyWeights(const T& fx, const T& fy) noexcept {
    const T one = Real<T>(1);
    return {{(one - fx) * (one - fy), fx * (one - fy), (one - fx) * fy, fx * fy}};
}
template <class T>
[[gnu::always_inline]] inline T skyBlend(const SkyWeights<T>& w, const T& a, const T& b, const T& c, const T& d) noexcept {
    return a * w.own[0] + b * w.own[1] + c * w.own[2] + d * w.own[3];
}

} // namespace chiaro
