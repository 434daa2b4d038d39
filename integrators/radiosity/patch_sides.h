// Which backs of surfaces are patches: those that light can reach. Every connected surface casts rays from both of its sides; what it sees,
// sees it. From the sides that shine or see a light or the sky, reach spreads over what reflects diffusely. In a scene without any light
// the backs of double-sided materials count that see anything. What spreads from surface to surface spreads too far: a floor is lit, and
// sees the inside of a block that stands on it. So walks of light go from every back that may be reached, and unless one ends at a light,
// it is not. Nor is a back that lies against another surface, nearer than a two-hundredth of its own extent. Backs are decided for a whole
// connected surface, so that few rays suffice.
#pragma once
#include "core/render/integrator.h"
#include "integrators/radiosity/patch_mesh.h"

namespace chiaro::radiosity {

// For each facet: is its back a patch?
std::vector<uint8_t> reachedBacks(const Work&, const PatchMesh&);

} // namespace chiaro::radiosity
