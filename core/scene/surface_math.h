// The arithmetic of a position on a triangle, shared by the surface point and by its wide version: the same operations, the same bits.
#pragma once
#include "core/math/vec.h"
#include "core/render/fault.h"

namespace chiaro {

// Of positions made from coordinates of this magnitude: the sums of barycentric interpolation and of Embree's edge tests, with room for the
// affine map of an instance (Higham's gamma_n with n = 8; Pharr, Jakob, Humphreys 2016, section 3.9).
inline constexpr float gamma8 = 8 * 0x1p-24f / (1 - 8 * 0x1p-24f);

inline Vec3 unitOr(const Vec3& v, const Vec3& otherwise) noexcept {
    const float l = lengthSquared(v);
    return l > 0 && std::isfinite(l) ? v * (1 / std::sqrt(l)) : otherwise;
}

// How far from the surface a ray begins whose position has this error in every coordinate.
[[gnu::always_inline]] inline float reachOf(const Vec3& ng, float error) noexcept {
    return fault(Fault::offsetAbsolute) ? 1e-4f : error * (std::fabs(ng.x) + std::fabs(ng.y) + std::fabs(ng.z));
}

// Of a triangle over its longest edge. e1, e2, doubleArea: world.
inline float heightOf(const Vec3& e1, const Vec3& e2, float doubleArea) noexcept {
    return doubleArea / std::sqrt(max(lengthSquared(e1), max(lengthSquared(e2), lengthSquared(e2 - e1))));
}

// A hit on the very edge of its triangle may be rounded to the far side of the wall that it meets there: a ray from it would begin outside.
// It is pulled towards the triangle's centre until it lies at least two bounds within, by four bounds at most.
[[gnu::always_inline]] inline bool atEdge(float height, float u, float v, float error) noexcept {
    return min(u, min(v, 1 - u - v)) * height < 2 * error;
}
inline Vec3 pulled(const Vec3& p, const Vec3& e1, const Vec3& e2, float height, float u, float v, float error) noexcept {
    const Vec3 way = e1 * (1 / 3.f - u) + e2 * (1 / 3.f - v);
    const float far = length(way), share = min(1.f, 6 * error / height);
    return far > 0 ? p + way * min(share, 4 * error / far) : p;
}
inline Vec3 inset(const Vec3& p, const Vec3& e1, const Vec3& e2, float height, float u, float v, float error) noexcept {
    return atEdge(height, u, v, error) ? pulled(p, e1, e2, height, u, v, error) : p;
}

} // namespace chiaro
