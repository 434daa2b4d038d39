// Particles of one bounce side by side, for loops over lanes: what a walk keeps from surface to surface (light_walk.h) as arrays, and its
// step at hits on plain surfaces, sixteen at a time. Every operation is that of scatterParticle(), so that the bits are too.
#pragma once
#include "core/math/sampler.h"
#include "core/render/path_classes.h"
#include "core/scene/ray_packet.h"
#include <array>

namespace chiaro {

inline constexpr std::size_t laneWidth = RayPacket::size;

// The particles of a stream that are on their way, in the order of their paths.
struct ParticleLanes {
    static constexpr std::size_t most = 1024;
    static constexpr std::size_t room = most + laneWidth; // not a power of two: the arrays would fight for the same lines of the cache
    alignas(64) float ox[room], oy[room], oz[room], dx[room], dy[room], dz[room], tfar[room], time[room]; // rays; tnear is 0
    alignas(64) float fr[room], fg[room], fb[room];                                                       // flux
    alignas(64) float tr[room], tg[room], tb[room];                                                       // throughput
    alignas(64) uint32_t path[room];                                                                      // sample index of the sampler
    PathState state[room];
    uint16_t slot[room], deltas[room]; // slot: number of the path in the stream
    LightKind kind[room];
    float hero[room]; // wavelength that a dispersive event picked, nanometres; 0: none
    // The surface that was left, as far as a segment asks for it; a plain one holds no volume behind it and is none.
    struct Left {
        static constexpr uint32_t none = ~0u;
        Vec3 ng;
        uint32_t material = none;
    } left[room];
    std::size_t count = 0;
};

enum class PlainStep : int32_t { none = -1, stop, delta, any }; // none: not a plain hit; else as Onward

// Hits on plain surfaces and what becomes of them. Some packets of them: lanes that were written one by one a moment ago are slow to load
// as one.
struct PlainHits {
    static constexpr std::size_t most = 4 * laneWidth;
    alignas(64) float px[most], py[most], pz[most], nx[most], ny[most], nz[most], reach[most]; // position, geometric normal, offset
    alignas(64) float r[most], g[most], b[most];                                               // f of the closure, 1/sr
    alignas(64) PlainStep step[most];
    alignas(64) int32_t goesOn[most];                     // in: -1 where paths go on after this event, else 0; out: those that do
    alignas(64) float ux[most], uy[most], roulette[most]; // numbers
    alignas(64) float ox[most], oy[most], oz[most], dx[most], dy[most], dz[most]; // the ray that goes on
    alignas(64) float fr[most], fg[most], fb[most], tr[most], tg[most], tb[most]; // flux and throughput along it
    alignas(64) uint32_t wi[most], normal[most];                                  // of the photon, packed
};

// Flux that went, lumen, luminance: one sum a lane.
struct FluxLanes {
    alignas(64) double absorbed[laneWidth] = {}, ended[laneWidth] = {};
};

// The numbers that particles begin with (light_walk.h), of sixteen paths that follow each other.
struct StartLanes {
    struct Numbers {
        alignas(64) uint32_t pick[laneWidth];
        alignas(64) float x[laneWidth], y[laneWidth];
    } from, towards;
    alignas(64) float time[laneWidth];
};
// first: the sampler of the first path, at its beginning. times: are those asked for?
void drawStarts(const Sampler& first, bool times, StartLanes&) noexcept;

// The numbers of a scattering; of all lanes, they differ by the sample index alone. at: the sampler of any of them at its third dimension.
void drawNumbers(const Sampler& at, const ParticleLanes&, std::size_t first, bool roulette, PlainHits&, std::size_t begin) noexcept;
// Of sixteen lanes from `first` on, whose hits begin at `begin`.
void scatterPlain(const ParticleLanes&, std::size_t first, bool roulette, PlainHits&, std::size_t begin, FluxLanes&) noexcept;

} // namespace chiaro
