// The directions of camera rays, sixteen at a time. The tile loop makes most of its starts for a plain camera, a filter and Sobol' points:
// then a start is a few hashes, a table and a little arithmetic, the same for every sample. It is written as loops over lanes about the
// very functions that make a single start, so that both give the same bits.
#pragma once
#include "core/render/integrator.h"
#include "core/scene/ray_packet.h"
#include <memory>

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

// The numbers that a start draws of its sampler: position in the pixel, time, lens. All paths go on behind them.
inline constexpr uint32_t startDimensions = 5;

// Sixteen starts, or the last few, with their first hits.
struct StartPacket {
    TracePacket traced;                                                                              // rays and hits
    alignas(64) uint32_t keyLow[RayPacket::size], keyHigh[RayPacket::size], sample[RayPacket::size]; // of the samplers: key(), index()
    uint32_t first = 0, count = 0; // the slots first, first + 1, ... of the SampleLanes are theirs
};

// What the paths of a stream give: plain sums in one slot a sample, for each layer of the film. Light that a path finds and light that a
// shadow ray brings come in two sums: shadow rays wait for company, and so the order of all additions would depend on how many paths are
// under way.
struct SampleLanes {
    static constexpr std::size_t most = 4096;
    uint32_t layers = 1;
    float (*found)[4] = nullptr, (*direct)[4] = nullptr;
    // RGB; a sum is one register; that of a slot and a layer, 1 the first, at slot x layers + layer - 1
    alignas(64) float albedo[3][most], normal[3][most];

    void fit(std::size_t layers);                              // makes room
    void clear(std::size_t first, std::size_t count) noexcept; // the sums; the rest is written by whoever takes the starts

private:
    std::unique_ptr<float[][4]> room_;
    std::size_t fits_ = 0;
};

} // namespace chiaro
