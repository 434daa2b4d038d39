// Direct light at one vertex of a ray tree: many light samples, their shadow rays traced together, weighed against the lobe samples that
// the same vertex sends out.
#pragma once
#include "core/render/integrator.h"
#include "materials/bsdf.h"

namespace chiaro {

struct DirectPlan {
    uint32_t lightSamples = 1;                 // of all lights together
    uint32_t lobeSamples = 0;                  // rays over the glossy lobe, which find emitters too
    bool reflected = true, transmitted = true; // on which sides those rays are followed
    bool shadows = true;                       // off: every light is seen
};
struct ShadowCount {
    uint32_t cast = 0, arrived = 0;
};
// Adds the light that arrives straight from the lights, in the layers of its path classes. Diffuse light is found here alone; glossy light
// has two estimators, weighed by the power heuristic for n_light and n_lobe samples (Veach 1997, section 9.2.2). Takes three dimensions.
ShadowCount addDirectSplit(const Job&, const SurfacePoint&, const Bsdf&, PathState, const Spectrum& throughput, const DirectPlan&, Sampler&,
                           Outputs&) noexcept;

} // namespace chiaro
