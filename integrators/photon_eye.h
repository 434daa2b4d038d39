// The second pass of photon mapping: eye paths through photon maps. An eye path is followed through mirrors, glass and sharp glossy lobes
// to the first event R on a diffuse or rough glossy lobe, at x. Every light path L ... E is carried by exactly one estimate, told apart by
// what lies between its light and x (C: S, or G of a sharp lobe; events are named from the light on):
//   L C* E             no R at all: as in path tracing, light sampling and hits by sharp lobes weighed together
//   L R C* E           direct: a shadow ray at x, weighed against the gather rays that hit a light
//   L S+ R C* E        caustics: the caustic map at x. Gather rays that reach a light through S+ alone do not count
//   L .* R C* R C* E   indirect: gather rays from x; each goes on through C* to the next R, at z, where the global map is asked for
//                      everything that arrives, direct light and caustics too
//   L C* G C* R C* E   by hits and shadow rays of the gather rays' own sharp vertices
// Without gather rays (gather 0) the global map, of photons that have scattered and are no caustics, is asked at x, and there is no z.
// What is drawn but carried by another estimate is not followed; its weight is never given to somebody else.
#pragma once
#include "integrators/photon_map.h"
#include "integrators/transport.h"

namespace chiaro {

struct EyePlan {
    uint32_t gather = 1;        // rays from x; 0: the global map is shown as it is
    float sharp = 0;            // roughness below which a glossy lobe is followed like a mirror
    uint32_t rouletteDepth = 5; // scatterings before Russian roulette may end a path
    const PhotonMap* global = nullptr;
    const PhotonMap* caustic = nullptr; // null: caustic photons are in the global map
    float radius = 0;                   // of the lookups at x; 0: the maps' own
};
// Adds what arrives along the start's ray. Returns how many photons the lookups at x have found.
float followEye(const Job&, const EyePlan&, PathStart&, Outputs&) noexcept;

} // namespace chiaro
