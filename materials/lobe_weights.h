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
    bool reflects = false, diffuse = false, coated = false;
};

// The colours of the lobes are baseColor times the weights.
LobeWeights lobeWeights(const BsdfParameters&) noexcept;

} // namespace chiaro
