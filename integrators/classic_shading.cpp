#include "integrators/classic_shading.h"
#include "materials/fresnel.h"

namespace chiaro {

ClassicSurface::Answer ClassicSurface::answer(const Vec3& n, const Vec3& wo, const Vec3& wi) const noexcept {
    const float cosine = dot(n, wi);
    if (!(cosine > 0)) return {};
    const bool phong = lobe == ClassicLobe::phong;
    const float along = phong ? dot(reflect(wo, n), wi) : dot(n, normalize(wo + wi));
    Answer a{diffuse * (cosine / pi), Spectrum(0)};
    if (!(along > 0) || black(specular)) return a;
    const float factor = normalised ? cosine * (phong ? phongFactor(exponent) : blinnFactor(exponent)) : 1 / pi;
    a.specular = specular * (factor * std::pow(along, exponent));
    return a;
}

ClassicSurface classicSurface(const BsdfParameters& p, ClassicLobe lobe, bool normalised, float exponent) noexcept {
    ClassicSurface s{lobe, normalised, Spectrum(0), Spectrum(0), exponent};
    const float metallic = clamp01(p.metallic), opaque = (1 - metallic) * (1 - clamp01(p.transmission));
    const float normal = p.ior == 0 ? 1 : fresnelNormal(max(p.ior, 1.f));
    s.diffuse = p.baseColor * opaque;
    for (std::size_t c = 0; c < 3; ++c) {
        const float dielectric = min(normal * max(p.specularColor[c], 0.f), 1.f) * clamp01(p.specular);
        s.specular[c] = dielectric * (1 - metallic) + p.baseColor[c] * metallic;
    }
    if (exponent > 0) return s;
    const float alpha = sqr(clamp01(p.roughness)), blinn = 2 / max(sqr(alpha), 1e-8f) - 2;
    s.exponent = min(lobe == ClassicLobe::blinn ? blinn : blinn / 4, mostExponent);
    return s;
}

} // namespace chiaro
