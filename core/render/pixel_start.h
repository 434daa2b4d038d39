// How the samples of a pixel begin: what the tile loops (core/render/integrator.cpp, core/render/stream_loop.cpp) share.
#pragma once
#include "core/render/integrator.h"

namespace chiaro {

// Consecutive samples of one pixel.
struct PixelRun {
    Pixel pixel;
    uint32_t first = 0, count = 0;
    Sampler sampler; // of the first; of the same dimension for all
};

// The dimensions of a start. Numbers that nobody asks for are skipped, not drawn: the others keep their dimensions.
inline constexpr uint32_t positionDimensions = 2, timeDimensions = 1, lensDimensions = 2;

uint64_t pathIndex(Pixel) noexcept;
Point2 centreOf(Pixel) noexcept;
float timeOf(const Job&, std::optional<float> at, Sampler&) noexcept;
// A start without its first hit.
PathStart makeStart(const Job&, Pixel, uint32_t sample, Point2 raster, Sampler, std::optional<float> time) noexcept;
PathStart pixelStart(const Job&, Pixel, uint32_t sample, const Starts&) noexcept;
// Rays of one origin and a direction each, in lanes (core/render/wide_starts.h).
inline bool plainStarts(const Job& job, const Starts& how) noexcept {
    return how.pattern.empty() && job.sampler == SamplerKind::sobol && job.view.camera.plain();
}

// Every tile of the film by a loop of its own, what is done told as it goes.
template <class Loop, class Batches>
void forEachTile(const Job& job, const Pass& pass, Film& film, const Batches& batch, const Starts& how) {
    const Rect crop = film.layout().crop;
    const double area = double(crop.area());
    const auto tile = [&](Rect t) {
        Loop(job, pass, film, batch, how).run(t);
        job.progress.advance(double(t.area()) / area);
    };
    job.run.tiles(crop, tile, how.whole ? nullptr : &job.stop);
}

} // namespace chiaro
