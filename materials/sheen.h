// Sheen: the glow of fibres that stand on a surface (KHR_materials_sheen). Charlie, a distribution of normals that prefers those along the
// surface, with the shadowing that was fitted for it; no Fresnel term. alpha is the roughness squared.
// Source: Estevez and Kulla, Production Friendly Microfacet Sheen BRDF, 2017; the constants are theirs.
#pragma once
#include "core/math/vec.h"
#include <cmath>

namespace chiaro {

struct Charlie {
    static constexpr float smallestAlpha = 0.005f; // the distribution goes with sin to the power 1/alpha
    float alpha = 1;

    float d(float cosH) const noexcept {
        const float inverse = 1 / alpha, sine = std::max(1 - cosH * cosH, 0.f);
        return (2 + inverse) * std::pow(sine, inverse / 2) / (2 * pi);
    }
    float lambda(float mu) const noexcept {
        return mu < 0.5f ? std::exp(curve(mu)) : std::exp(2 * curve(0.5f) - curve(std::max(1 - mu, 0.f)));
    }
    // D G / (4 cos_o cos_i).
    float value(const Vec3& wo, const Vec3& wi) const noexcept {
        const Vec3 h = normalize(wo + wi);
        return d(h.z) / ((1 + lambda(wo.z) + lambda(wi.z)) * 4 * std::max(wo.z * wi.z, 1e-9f));
    }

private:
    float curve(float x) const noexcept {
        const float t = sqr(1 - alpha);
        const auto mix = [t](float rough, float smooth) { return rough + (smooth - rough) * t; };
        const float a = mix(21.5473f, 25.3245f), b = mix(3.82987f, 3.32435f), c = mix(0.19823f, 0.16801f), d = mix(-1.97760f, -1.27393f),
                    e = mix(-4.32054f, -4.85967f);
        return a / (1 + b * std::pow(x, c)) + d * x + e;
    }
};

// Directional albedo of a white sheen, from a table that is filled by quadrature on first use. Towards grazing it goes beyond 1, as 1 / mu:
// whoever uses the lobe must scale it there.
class SheenSlice {
public:
    SheenSlice() = default;
    explicit SheenSlice(float alpha) noexcept;
    float at(float mu) const noexcept;

private:
    int row_ = 0;
    float fraction_ = 0;
};

} // namespace chiaro
