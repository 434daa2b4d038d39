// The GGX distribution of microfacets with Smith's height-correlated masking and shadowing, in the frame whose z is the macro normal.
// Torrance-Sparrow: f = F D G2 / (4 cos_o cos_i). Anisotropic in its formulas; today's materials pass alphaX = alphaY. Directions are on
// the side z > 0 (a transmitted one is mirrored by the caller). Every quotient is written so that grazing directions divide by nothing
// small: with s(w) = sqrt(ax^2 x^2 + ay^2 y^2 + z^2), 1 + Lambda(w) = (z + s) / (2z) and G2 = 2 z_o z_i / (z_i s_o + z_o s_i).
// Sources: Walter et al., Microfacet Models for Refraction, 2007; Heitz, Understanding the Masking-Shadowing Function, JCGT 2014 (eq. 99);
// Dupuy and Benyoub, Sampling Visible GGX Normals with Spherical Caps, 2023.
#pragma once
#include "core/math/warp.h"

namespace chiaro {

template <class T> struct Ggx {
    T alphaX, alphaY;

    // Density of normals, 1/sr: the integral of D cos over the hemisphere is 1.
    T d(const Vec3T<T>& h) const noexcept {
        const T x = h.x / alphaX, y = h.y / alphaY, e = x * x + y * y + h.z * h.z;
        return T(Real<T>(1)) / (T(piOf<T>) * alphaX * alphaY * e * e);
    }
    T stretch(const Vec3T<T>& w) const noexcept { return sqrt(sqr(alphaX * w.x) + sqr(alphaY * w.y) + w.z * w.z); }
    T g1(const Vec3T<T>& w) const noexcept { return (w.z + w.z) / (w.z + stretch(w)); }
    T g2(const Vec3T<T>& o, const Vec3T<T>& i) const noexcept {
        const T p = o.z * i.z;
        return (p + p) / (i.z * stretch(o) + o.z * stretch(i));
    }
    // G2 / (4 cos_o cos_i): what multiplies F D in a reflection, and, times four, in a transmission.
    T visibility(const Vec3T<T>& o, const Vec3T<T>& i) const noexcept {
        return T(Real<T>(0.5)) / max(i.z * stretch(o) + o.z * stretch(i), T(std::numeric_limits<Real<T>>::min()));
    }
    // Density of the normals seen from o over max(0, o.h): D_o(h) = G1 D max(0, o.h) / cos_o = visible(o) D max(0, o.h).
    T visible(const Vec3T<T>& o) const noexcept { return T(Real<T>(2)) / (o.z + stretch(o)); }

    // A normal with that density.
    Vec3T<T> sampleVisible(const Vec3T<T>& o, const Vec2T<T>& u) const noexcept {
        using R = Real<T>;
        const T one = R(1);
        const Vec3T<T> std = normalize(Vec3T<T>{alphaX * o.x, alphaY * o.y, o.z});
        const T phi = T(2 * piOf<T>) * u.x, z = (one - u.y) * (one + std.z) - std.z, s = safeSqrt(one - z * z);
        const Vec3T<T> h{s * cos(phi) + std.x, s * sin(phi) + std.y, z + std.z};
        return normalize(Vec3T<T>{h.x * alphaX, h.y * alphaY, max(h.z, T(R(1e-12)))});
    }
};

// Direction density of reflecting at a visible normal: D_o(h) / (4 o.h).
template <class T> T reflectionPdfW(const Ggx<T>& g, const Vec3T<T>& o, T d) noexcept { return g.visible(o) * d * T(Real<T>(0.25)); }

} // namespace chiaro
