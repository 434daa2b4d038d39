// The directions of camera rays, sixteen at a time. The tile loop makes most of its starts for a plain camera, a filter and Sobol' points:
// then a start is a few hashes, a table and a little arithmetic, the same for every sample. It is written as loops over lanes about the
// very functions that make a single start, so that both give the same bits.
#pragma once
#include "core/render/integrator.h"
#include "core/scene/ray_packet.h"

namespace chiaro {

// Samples that wait for their rays, as arrays.
struct StartLanes {
    static constexpr std::size_t most = 256;
    alignas(64) uint32_t sample[most];
    alignas(64) uint32_t index[most], x[most], y[most]; // Sampler::PairSeeds of the position in the pixel
    alignas(64) float centreX[most], centreY[most];     // of the pixel
};

// Of the sixteen lanes from `first` on, used or not. The origin, the time and the rest of the packet are the caller's.
void plainDirections(const StartLanes&, std::size_t first, const Filter&, const Camera&, RayPacket&) noexcept;

} // namespace chiaro
