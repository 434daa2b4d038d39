// Fresnel reflectance: exact for a dielectric, Schlick's fit for a metal described by its colour, and the directions that go with them.
// Templates over the number type without branches. Cosines are those between a direction and the normal that reflects (in a microfacet
// model the half vector), on the side of the direction. eta is always the index beyond the surface over the index on the cosine's side.
// Sources: Born and Wolf, Principles of Optics, section 1.5.2; Schlick, An Inexpensive BRDF Model, 1994.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

// Unpolarised mean of both polarisations; 1 under total internal reflection. eta 1 reflects nothing, at any angle.
template <class T> T fresnelDielectric(T cosTheta, T eta) noexcept {
    using R = Real<T>;
    const T one = R(1), zero = R(0), tiny = std::numeric_limits<R>::min();
    const T c = clamp01(cosTheta), eta2 = eta * eta, g2 = eta2 - one + c * c;
    const T g = safeSqrt(g2); // eta times the cosine of the refracted direction
    const T rs = (c - g) / max(c + g, tiny), rp = (eta2 * c - g) / max(eta2 * c + g, tiny);
    return select(g2 < zero, one, T(R(0.5)) * (rs * rs + rp * rp));
}

// Reflectance at normal incidence.
template <class T> T fresnelNormal(T eta) noexcept { return sqr((eta - T(Real<T>(1))) / (eta + T(Real<T>(1)))); }

// (1 - cos)^5: Schlick's F = F0 + (F90 - F0) of it.
template <class T> T schlickShape(T cosTheta) noexcept {
    const T m = T(Real<T>(1)) - clamp01(cosTheta), m2 = m * m;
    return m2 * m2 * m;
}

// The exact curve in the place of Schlick's: 0 at normal incidence, 1 at grazing. Above an index of 2 + sqrt(3) the true curve dips
// below its start, and the shape below 0.
template <class T> T dielectricShape(T cosTheta, T eta) noexcept {
    const T f0 = fresnelNormal(eta), one = Real<T>(1);
    return (fresnelDielectric(cosTheta, eta) - f0) / (one - f0);
}

// All orders of reflection between the two faces of a pane: F + T^2 F + T^2 F^3 + ... = 2F / (1 + F).
template <class T> T paneReflectance(T f) noexcept { return (f + f) / (T(Real<T>(1)) + f); }

template <class T> Vec3T<T> reflect(const Vec3T<T>& w, const Vec3T<T>& h) noexcept {
    const T c = dot(w, h);
    return h * (c + c) - w;
}
// Snell in vector form: w on the side of h, the answer beyond it. Under total internal reflection the answer lies in the surface and
// means nothing: the caller has seen a reflectance of 1.
template <class T> Vec3T<T> refract(const Vec3T<T>& w, const Vec3T<T>& h, T eta) noexcept {
    const T one = Real<T>(1), inv = one / eta, c = dot(w, h);
    const T cosT = safeSqrt(one - inv * inv * max(one - c * c, T(Real<T>(0))));
    return h * (inv * c - cosT) - w * inv;
}

} // namespace chiaro
