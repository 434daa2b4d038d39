// What a mixture of lobes (materials/lobes.h) takes from its parameters whatever the directions: weights, colours, Fresnel ends, and which
// lobes there are. Made once a hit by the closure, once a material by whoever keeps tables of them.
#pragma once
#include "materials/parameters.h"

namespace chiaro {

struct LobeWeights {
    enum class Passes : uint8_t { none, straight, refracted, rough }; // transmission: two delta kinds, and rough (pane or solid)
    float alpha = 0, ior = 1.5f;
    float metallic = 0, coat = 0, glass = 0; // of the three materials
    Spectrum f0{0};                          // of the dielectric
    float f90 = 0;
    bool rough = false, dielectric = false; // dielectric: its Fresnel curve is not zero
    Passes passes = Passes::none;
    bool reflects = false, diffuse = false, coated = false, through = false; // through: diffuse light leaves on the other side too
};

// The colours of the lobes are baseColor times the weights.
LobeWeights lobeWeights(const BsdfParameters&) noexcept;

// Below this alpha single scattering loses less than 1 %, and that at grazing alone: nothing is made up for.
inline constexpr float leastCompensated = 0.004f;
// A mean loss below this is within the error of the tables.
inline constexpr float leastLoss = 2e-4f;
// Light that leaves a rough metal after two and more facets, over (1 - E(wo)) (1 - E(wi)): F^2 E / (1 - F (1 - E)) / (pi (1 - E)) with the
// mean Fresnel term F and the mean albedo E of a white facet (Kulla and Conty, Revisiting Physically Based Shading at Imageworks, 2017).
template <class T> T laterFacets(T meanFresnel, T meanAlbedo) noexcept {
    const T one = Real<T>(1), loss = max(one - meanAlbedo, T(Real<T>(leastLoss)));
    return meanFresnel * meanFresnel * meanAlbedo / ((one - meanFresnel * loss) * loss * T(Real<T>(pi)));
}

} // namespace chiaro
