// Reflectance of a base under a film whose thickness is that of a wavelength (KHR_materials_iridescence): Airy's sum over the paths within
// the film, integrated over the colour matching functions in closed form, which are Gaussians in frequency.
// Source: Belcour and Barla, A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence, 2017, equations 7 to 10,
// in the unpolarised form of glTF's appendix; phases there are 0 or pi, so that each term is the one of phase 0 with a sign. Two terms
// beside the mean suffice. The interfaces of a dielectric follow the exact Fresnel curve, a metal's lower one Schlick's: with a film of no
// thickness the plain curves come back.
#pragma once
#include "materials/fresnel.h"

namespace chiaro {

class ThinFilm {
public:
    ThinFilm() = default;
    // thickness: nanometres. The film fades into the air below 30 nm of its index (glTF's smoothstep over 0.03 micrometres).
    ThinFilm(float ior, float thickness) noexcept : thickness_(std::max(thickness, 0.f)) {
        const float t = clamp01(thickness_ / 30), blend = t * t * (3 - 2 * t);
        ior_ = 1 + (std::max(ior, 1.f) - 1) * blend;
    }
    float ior() const noexcept { return ior_; }

    // f0: reflectance of the base at normal incidence, in air. cosTheta: in the air.
    Spectrum overDielectric(const Spectrum& f0, float cosTheta) const noexcept { return reflectance(f0, cosTheta, false); }
    Spectrum overMetal(const Spectrum& f0, float cosTheta) const noexcept { return reflectance(f0, cosTheta, true); }

private:
    // Linear RGB of light with the phase that a difference of paths (nm) makes, over that of none: 1 at 0, 0 far away. The functions
    // are those for light of equal energy, whose RGB is not (1, 1, 1): each channel is divided by its own.
    static Spectrum sensitivity(float path) noexcept {
        constexpr float value[3] = {5.4856e-13f, 4.4201e-13f, 5.2481e-13f}, at[3] = {1.6810e6f, 1.7953e6f, 2.2084e6f},
                        width[3] = {4.3278e9f, 9.3046e9f, 6.6121e9f};
        const float phase = 2 * pi * path * 1e-9f;
        const auto bump = [phase](float v, float middle, float variance) {
            return v * std::sqrt(2 * pi * variance) * std::cos(middle * phase) * std::exp(-phase * phase * variance) / 1.0685e-7f;
        };
        float xyz[3];
        for (std::size_t i = 0; i < 3; ++i) xyz[i] = bump(value[i], at[i], width[i]);
        xyz[0] += bump(9.7470e-14f, 2.2399e6f, 4.5282e9f);
        constexpr float whole[3] = {1.2054f, 0.9481f, 0.9101f};
        return {(3.2404542f * xyz[0] - 1.5371385f * xyz[1] - 0.4985314f * xyz[2]) / whole[0],
                (-0.9692660f * xyz[0] + 1.8760108f * xyz[1] + 0.0415560f * xyz[2]) / whole[1],
                (0.0556434f * xyz[0] - 0.2040259f * xyz[1] + 1.0572252f * xyz[2]) / whole[2]};
    }
    // The lower interface: index of the base in air from f0, then the curve between film and base.
    static float lower(float f0, float filmIor, float cosFilm, bool metal) noexcept {
        const float root = std::sqrt(std::min(f0, 0.9999f)), base = (1 + root) / (1 - root), eta = base / filmIor;
        if (!metal) return fresnelDielectric(cosFilm, eta);
        const float normal = fresnelNormal(eta);
        return normal + (1 - normal) * schlickShape(cosFilm);
    }
    Spectrum reflectance(const Spectrum& f0, float cosTheta, bool metal) const noexcept {
        const float c = clamp01(cosTheta), inside = 1 - (1 - c * c) / (ior_ * ior_);
        const float cosFilm = std::sqrt(std::max(inside, 0.f)), upper = fresnelDielectric(c, ior_), through = 1 - upper;
        const float path = 2 * ior_ * thickness_ * cosFilm;
        const Spectrum first = sensitivity(path), second = sensitivity(2 * path);
        Spectrum r;
        for (std::size_t i = 0; i < 3; ++i) {
            const float base = lower(std::max(f0[i], 0.f), ior_, cosFilm, metal), both = std::min(upper * base, 0.9999f);
            const float sum = through * through * base / (1 - both), amplitude = std::sqrt(both);
            // The phase turns by pi at the upper interface from within, and at the lower one where the base is the thinner medium.
            const float root = std::sqrt(std::min(std::max(f0[i], 0.f), 0.9999f)), baseIor = (1 + root) / (1 - root);
            const float sign = baseIor < ior_ ? 1.f : -1.f, term = (sum - through) * amplitude;
            r[i] = clamp01(upper + sum + 2 * (sign * term * first[i] + term * amplitude * second[i]));
        }
        return r;
    }

    float ior_ = 1, thickness_ = 0;
};

} // namespace chiaro
