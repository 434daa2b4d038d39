// Warps: maps of the unit square onto the domains that are sampled, each beside its density and, where something needs it, its inverse.
// Uniform (u.x, u.y) in [0, 1)^2 comes in, a point distributed by the named density goes out. Directions are unit vectors about +z,
// densities pdfW per steradian or pdfA per unit of area. Branch-free templates over the number type (core/math/number.h).
// Sources: Shirley and Chiu, A Low Distortion Map Between Disk and Square, 1997; Heitz, A Low-Distortion Map Between Triangle and Square,
// 2019; Archimedes for sphere and cone.
#pragma once
#include "core/math/vec.h"
#include "core/render/fault.h"

namespace chiaro {

template <class T> inline constexpr Real<T> piOf = std::numbers::pi_v<Real<T>>;

// The unit disk, uniform: pdfA = 1/pi. Rings of the square become rings of the disk.
template <class T> Vec2T<T> concentricDisk(const Vec2T<T>& u) noexcept {
    using R = Real<T>;
    const T zero = R(0), quarterPi = piOf<T> / 4, x = u.x + u.x - R(1), y = u.y + u.y - R(1);
    const auto wide = abs(x) > abs(y);
    const T r = select(wide, x, y), num = select(wide, y, x), den = select(r == zero, T(R(1)), r);
    const T phi = quarterPi * (num / den), s = r * sin(phi), c = r * cos(phi);
    return {select(wide, c, s), select(wide, s, c)};
}
template <class T> T concentricDiskPdfA() noexcept { return Real<T>(1) / piOf<T>; }
// The point of the square that concentricDisk maps to p.
inline Point2 concentricDiskInverse(const Point2& p) noexcept {
    const float r = std::hypot(p.x, p.y), a = std::fabs(p.x), b = std::fabs(p.y);
    const float along = r, across = r * (4 / pi) * std::atan2(std::min(a, b), std::max(a, b));
    const float x = a > b ? along : across, y = a > b ? across : along;
    return {(std::copysign(x, p.x) + 1) / 2, (std::copysign(y, p.y) + 1) / 2};
}

// The hemisphere about +z with pdfW = cos/pi (Malley's method: the disk lifted).
template <class T> Vec3T<T> cosineHemisphere(const Vec2T<T>& u) noexcept {
    const Vec2T<T> d = concentricDisk(u);
    return {d.x, d.y, safeSqrt(T(Real<T>(1)) - d.x * d.x - d.y * d.y)};
}
template <class T> T cosineHemispherePdfW(T cosTheta) noexcept { return max(cosTheta, T(Real<T>(0))) * T(Real<T>(1) / piOf<T>); }
inline Point2 cosineHemisphereInverse(const Vec3& w) noexcept { return concentricDiskInverse({w.x, w.y}); }

// Directions within an angle of +z, uniform. The cone is given by 1 - cos of that angle: exact for the smallest ones too.
template <class T> Vec3T<T> uniformCone(const Vec2T<T>& u, T oneMinusCos) noexcept {
    using R = Real<T>;
    const T drop = u.x * oneMinusCos, s = safeSqrt(drop * (T(R(2)) - drop)), phi = T(2 * piOf<T>) * u.y;
    return {s * cos(phi), s * sin(phi), T(R(1)) - drop};
}
template <class T> T uniformConePdfW(T oneMinusCos) noexcept { return T(Real<T>(1)) / (T(2 * piOf<T>) * oneMinusCos); }
// The cone in which a sphere appears: 1 - cos of its half angle from sin^2 = (radius / distance)^2, without cancellation.
template <class T> T coneOfSphere(T sinSquared) noexcept { return sinSquared / (T(Real<T>(1)) + safeSqrt(T(Real<T>(1)) - sinSquared)); }

template <class T> Vec3T<T> uniformHemisphere(const Vec2T<T>& u) noexcept { return uniformCone(u, T(Real<T>(1))); }
template <class T> T uniformHemispherePdfW() noexcept { return Real<T>(1) / (2 * piOf<T>); }
template <class T> Vec3T<T> uniformSphere(const Vec2T<T>& u) noexcept { return uniformCone(u, T(Real<T>(2))); }
template <class T> T uniformSpherePdfW() noexcept { return Real<T>(1) / (4 * piOf<T>); }
// The numbers that uniformCone maps to w.
inline Point2 uniformConeInverse(const Vec3& w, float oneMinusCos) noexcept {
    const float r2 = w.x * w.x + w.y * w.y, drop = w.z > 0 ? r2 / (1 + w.z) : 1 - w.z;
    const float turn = std::atan2(w.y, w.x) / (2 * pi);
    return {std::min(drop / oneMinusCos, 1.f), turn < 0 ? turn + 1 : turn};
}

// Weights of the second and third vertex of a triangle, uniform over its area: pdfA = 1/area.
template <class T> Vec2T<T> uniformTriangle(const Vec2T<T>& u) noexcept {
    const T half = Real<T>(0.5), a = u.x * half, b = u.y * half;
    const auto lower = u.x < u.y;
    return {select(lower, a, u.x - b), select(lower, u.y - a, b)};
}

// Densities between measures: per square metre of a surface at a distance, to per steradian, and back.
template <class T> T areaToSolidAngle(T pdfA, T distanceSquared, T cosAtSurface) noexcept {
    if (fault(Fault::lightPdfNotConverted)) return pdfA;
    if (fault(Fault::lampCosineMissing)) return pdfA * distanceSquared;
    return pdfA * distanceSquared / abs(cosAtSurface);
}
template <class T> T solidAngleToArea(T pdfW, T distanceSquared, T cosAtSurface) noexcept {
    return pdfW * abs(cosAtSurface) / distanceSquared;
}

// Weights of multiple importance sampling for one sample of each (Veach 1997, section 9.2): a found it, b could have.
template <class T> T balanceHeuristic(T pdfA, T pdfB) noexcept { return pdfA / (pdfA + pdfB); }
// Power 2, by the ratio: no overflow where a density is squared.
template <class T> T powerHeuristic(T pdfA, T pdfB) noexcept {
    const T ratio = pdfB / pdfA;
    return T(Real<T>(1)) / (T(Real<T>(1)) + ratio * ratio);
}

} // namespace chiaro
