// The local reflection models of the classics, beside the materials' own closure: Lambert plus Phong's lobe about the mirror direction, or
// Blinn's about the half vector. Each comes in two variants:
//   normalised  an energy-normalised BRDF, times the cosine at the receiver: k_s is the albedo (Phong: exactly at normal incidence; Blinn:
//   of
//               light from there), a sharper highlight is a brighter one
//   legacy      as first published: k_s cos^n without that factor and without the receiver's cosine, scaled so that a lamp of illuminance
//   pi
//               shows k_d and k_s themselves
// Directions leave the surface, unit length. Answers are f |cos|, per steradian, for an illuminance at normal incidence in lux.
// Sources: Phong, Illumination for Computer Generated Pictures, 1975; Blinn, Models of Light Reflection for Computer Synthesized Pictures,
// 1977; Lafortune and Willems, Using the Modified Phong Reflectance Model for Physically Based Rendering, 1994; Sloan and Hoffman's factor
// in Akenine-Moller, Haines, Hoffman, Real-Time Rendering, 3rd edition, 2008, section 7.6; exponents from roughness after Walter et al.,
// Microfacet Models for Refraction through Rough Surfaces, 2007, section 5.2.
#pragma once
#include "core/math/vec.h"
#include "materials/parameters.h"

namespace chiaro {

enum class ClassicLobe : uint8_t { phong, blinn };

// By which cos^n becomes a BRDF of albedo 1.
template <std::floating_point T> T phongFactor(T n) noexcept { return (n + 2) / (2 * std::numbers::pi_v<T>); }
template <std::floating_point T> T blinnFactor(T n) noexcept {
    return (n + 2) * (n + 4) / (8 * std::numbers::pi_v<T> * (std::exp2(-n / 2) + n));
}

struct ClassicSurface {
    ClassicLobe lobe = ClassicLobe::phong;
    bool normalised = true;
    Spectrum diffuse{0}, specular{0}; // k_d and k_s
    float exponent = 1;

    struct Answer {
        Spectrum diffuse{0}, specular{0};
    };
    // n: unit normal on the side of wo. Nothing where wi is not on that side.
    Answer answer(const Vec3& n, const Vec3& wo, const Vec3& wi) const noexcept;
};
// k_d: base colour of what is neither metal nor glass; k_s: reflectance at normal incidence. exponent 0: from the roughness, alpha being
// its square: 2/alpha^2 - 2 for Blinn's lobe, a quarter of it for Phong's, which is twice as wide; at most mostExponent.
inline constexpr float mostExponent = 10000; // a narrower highlight would fall between the pixels
ClassicSurface classicSurface(const BsdfParameters&, ClassicLobe, bool normalised, float exponent) noexcept;

} // namespace chiaro
