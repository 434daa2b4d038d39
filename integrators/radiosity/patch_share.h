// Who shares a point of the mesh of patches. Interpolation gives a point one value for all patches around it; where a wall stands on a
// floor that runs on below it, along the edge between two patches, that value would be neither that of the room nor that of the bright
// outside, and light would go through the wall. So a point becomes as many as there are sides: patches at it belong together where their
// open parts see each other just above the surface, by themselves or by way of others at the point; a thin leg that stands between two of
// four parts nothing. (Discontinuity meshing, Heckbert 1992, cuts the mesh there; here it is the values that are cut.)
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

// What is less open than this says nothing to its neighbours.
inline constexpr float leastOpen = 1 / 64.f;

// Renumbers the corners of patches; `points` counts the numbers in use. The same for every seed and any number of threads. Returns how many
// points were parted. Nothing happens in a scene without lights.
uint32_t partPoints(const Work&, std::vector<Patch>& patches, uint32_t& points, float time);

} // namespace chiaro::radiosity
