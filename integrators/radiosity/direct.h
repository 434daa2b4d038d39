// Direct light on patches: the mean irradiance from lights, by rays between points spread over the patch and points of the lights, weighed
// against rays over the hemisphere where a light can be hit as well as sampled (Veach and Guibas 1995). Everything else of the light is
// left to form factors.
#pragma once
#include "integrators/radiosity/patches.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

enum class FromLights : uint8_t {
    all,        // emissive surfaces too: a small lamp is then as smooth as shadow rays make it
    notPatches, // point, spot and directional lights and the environment: emissive surfaces send their light by form factors
};
// Lux, one a patch. rays: of each patch, to the lights. Empty where the stop token ended it.
Lights3 directIrradiance(const Work&, const Patches&, FromLights, uint32_t rays);

} // namespace chiaro::radiosity
