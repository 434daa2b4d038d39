// Photons are made here: particles walk from the lights (light_walk.h) and leave a photon at every smooth surface that they reach and that
// somebody wants. Which they are is a function of (seed, map, number of the path) alone; the list is sorted by path and vertex, so that it
// is the same for any number of threads. The flux of a photon is that of its path as if it were the only one: whoever estimates divides by
// the number of paths.
#pragma once
#include "integrators/photon_store.h"
#include <memory>

namespace chiaro {

// What a photon must be to be kept, by the path that brought it: direct L, caustic L S+, or anything else that scattered.
struct PhotonKinds {
    bool direct = true, caustic = true, indirect = true;
};
// Emission is aimed (emission_guide.h): a pilot learns which parts of the emission space send light through specular surfaces onto smooth
// ones, and more particles start there, their flux divided by how many more (Jensen 2001, section 5.3.1, projection maps). Unbiased.
class EmissionGuide;

struct PhotonRequest {
    uint64_t paths = 0;
    uint64_t iteration = 0;    // of a progressive method; 0 of a map made once. Its paths are number iteration x paths and following
    uint32_t map = 0;          // maps of different numbers have nothing in common
    std::optional<float> time; // seconds; empty: each path has its own in the shutter
    PhotonKinds kinds;
    uint32_t rouletteDepth = 5; // scatterings before Russian roulette may end a path
    const EmissionGuide* guide = nullptr;
};

// Where the flux went, lumen, luminance, mean of a path: emitted = absorbed + escaped + ended to the rounding of doubles (what roulette
// takes and gives, depth limits, and paths that nobody wants to go on are all in ended). The same for any number of threads.
struct PhotonStatistics {
    uint64_t paths = 0, stored = 0, rays = 0;
    double emitted = 0, absorbed = 0, escaped = 0, ended = 0;
    double storedFlux = 0;               // of all photons: light counts again at every surface that it comes to
    double seconds = 0, sortSeconds = 0; // of tracing; of sorting into a store, which the caller adds
};

struct TracedPhotons {
    PhotonList photons;
    PhotonStatistics statistics;
};
// Throws Error(Exit::resources) early where the photons, while they are sorted, would need more than the work's memory limit. A stop of the
// work's token ends it early: then the list is of no use.
TracedPhotons tracePhotons(const Work&, const PhotonRequest&);

// One path of such a map, vertex by vertex, for chiaro trace.
void tellPhotonPath(const Work&, const PhotonRequest&, uint64_t number, PathLog&);

// For maps of caustic photons alone. Null where nothing specular is in the scene or nothing is gained.
std::shared_ptr<const EmissionGuide> learnEmission(const Work&, uint64_t pilotPaths);

} // namespace chiaro
