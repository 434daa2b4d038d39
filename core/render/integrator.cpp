#include "core/render/integrator.h"
#include "core/render/fault.h"
#include <array>
#include <chrono>
#include <cmath>

namespace chiaro {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t mostStarts = 256;

// Memory of one thread for one batch: kept between tiles, since 256 outputs with layers are 100 KB.
struct Room {
    alignas(64) std::byte starts[mostStarts * sizeof(PathStart)];
    alignas(64) std::byte outputs[mostStarts * sizeof(Outputs)];
    std::array<Ray, mostStarts> rays;
    std::array<Hit, mostStarts> hits;
};

uint64_t pathIndex(Pixel p) noexcept { return fault(Fault::seedsShared) ? 0 : uint64_t(p.y) << 32 | p.x; }

// One shift for all the samples of a pixel keeps their distances (Cranley and Patterson 1976).
Point2 shiftedAround(Point2 p, uint64_t bits) noexcept {
    const float x = p.x + float(bits >> 40) * 0x1p-24f, y = p.y + float(bits & 0xffffff) * 0x1p-24f;
    return {x - std::floor(x), y - std::floor(y)};
}

// Numbers that nobody asks for are skipped, not drawn: the others keep their dimensions.
PathStart makeStart(const Job& job, Pixel pixel, uint32_t sample, Point2 raster, Sampler sampler, std::optional<float> at) noexcept {
    const float open = job.shutter.open, length = job.shutter.close - open;
    float time = at ? *at : open;
    if (at || length == 0)
        sampler.skip(1);
    else
        time = open + sampler.get1D() * length;
    Point2 lens;
    if (job.view.camera.hasLens())
        lens = sampler.get2D();
    else
        sampler.skip(2);
    return {pixel, sample, job.view.camera.ray(raster, lens, time), job.view.camera.footprint(), {}, sampler, {}};
}

Point2 filteredPosition(const Filter& filter, Pixel pixel, Point2 u) noexcept {
    const Point2 filtered = filter.sample(u);
    const float centre = fault(Fault::pixelCorner) ? 0.f : 0.5f;
    return {float(pixel.x) + centre + filtered.x, float(pixel.y) + centre + filtered.y};
}

PathStart pixelStart(const Job& job, Pixel pixel, uint32_t sample, const Starts& how) noexcept {
    Sampler sampler(job.seed, job.sampler, Stream::pixel, pathIndex(pixel), sample);
    if (how.pattern.empty()) {
        const Point2 raster = filteredPosition(job.view.filter, pixel, sampler.get2D());
        return makeStart(job, pixel, sample, raster, sampler, how.time);
    }
    Point2 p = how.pattern[sample % how.pattern.size()];
    if (how.jitter == 0) {
        sampler.skip(2);
    } else {
        const Point2 u = sampler.get2D();
        p = {p.x + (u.x - 0.5f) * how.jitter, p.y + (u.y - 0.5f) * how.jitter};
    }
    if (how.shifted) p = shiftedAround(p, hashCombine(job.seed, pathIndex(pixel)));
    return makeStart(job, pixel, sample, {float(pixel.x) + p.x, float(pixel.y) + p.y}, sampler, how.time);
}

void traceFirst(const Job& job, PathStart& start) noexcept {
    // Through the wide kernels, like the tile loop: the same ray must give the same bits.
    job.scene.intersect(std::span<const Ray>(&start.ray, 1), std::span<Hit>(&start.first, 1), true);
}

// One tile, one sample index after the other: gather the pixels that want it, trace, hand over, add.
class TileLoop {
public:
    TileLoop(const Job& job, const Pass& pass, Film& film, Batch batch, const Starts& how)
        : job_(job), pass_(pass), film_(film), batch_(batch), how_(how),
          most_(film.layout().costs ? 1 : std::clamp<std::size_t>(how.width, 1, mostStarts)) { // a clock looks at one sample at a time
        thread_local const std::unique_ptr<Room> room = std::make_unique<Room>();
        room_ = room.get();
    }
    void run(Rect tile) {
        for (uint32_t sample = pass_.begin; sample < pass_.end; ++sample) {
            for (uint32_t y = tile.y0; y < tile.y1; ++y)
                for (uint32_t x = tile.x0; x < tile.x1; ++x) take({x, y}, sample);
            flush();
        }
    }

private:
    PathStart* starts() noexcept { return reinterpret_cast<PathStart*>(room_->starts); }
    Outputs* outputs() noexcept { return reinterpret_cast<Outputs*>(room_->outputs); }
    void take(Pixel pixel, uint32_t sample) {
        if (film_.next(pixel) > sample || (pass_.active && !pass_.active->active(pixel))) return;
        ::new (starts() + count_) PathStart(pixelStart(job_, pixel, sample, how_));
        ::new (outputs() + count_) Outputs(film_.layout());
        if (++count_ == most_) flush();
    }
    void flush() {
        const std::size_t n = std::exchange(count_, 0);
        if (n == 0) return;
        const auto begin = film_.layout().costs ? Clock::now() : Clock::time_point{};
        for (std::size_t i = 0; i < n; ++i) room_->rays[i] = starts()[i].ray;
        job_.scene.intersect({room_->rays.data(), n}, {room_->hits.data(), n}, true);
        for (std::size_t i = 0; i < n; ++i) starts()[i].first = room_->hits[i];
        batch_({starts(), n}, {outputs(), n});
        if (film_.layout().costs) outputs()[0].microseconds = std::chrono::duration<float, std::micro>(Clock::now() - begin).count();
        for (std::size_t i = 0; i < n; ++i) film_.add(starts()[i].pixel, starts()[i].sample, outputs()[i]);
    }

    const Job& job_;
    const Pass& pass_;
    Film& film_;
    Batch batch_;
    const Starts& how_;
    std::size_t most_, count_ = 0;
    Room* room_;
};

} // namespace

PathStart startPath(const Job& job, Point2 raster, Sampler sampler) noexcept {
    PathStart start = makeStart(job, {uint32_t(raster.x), uint32_t(raster.y)}, 0, raster, sampler, {});
    traceFirst(job, start);
    return start;
}

PathStart startPixel(const Job& job, Pixel pixel, uint32_t sample, const Starts& how) noexcept {
    PathStart start = pixelStart(job, pixel, sample, how);
    traceFirst(job, start);
    return start;
}

void forEachBatch(const Job& job, const Pass& pass, Film& film, Batch batch, const Starts& how) {
    const Rect crop = film.layout().crop;
    const double area = double(crop.area());
    const auto tile = [&](Rect t) {
        TileLoop(job, pass, film, batch, how).run(t);
        job.progress.advance(double(t.area()) / area);
    };
    job.run.tiles(crop, tile, how.whole ? nullptr : &job.stop);
}

void CameraIntegrator::radianceWide(const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) const noexcept {
    for (std::size_t i = 0; i < starts.size(); ++i) radiance(job, starts[i], outputs[i]);
}

void CameraIntegrator::render(const Job& job, const Pass& pass, Film& film) {
    const Starts how = starts(job);
    forEachBatch(
        job, pass, film, [&](std::span<PathStart> p, std::span<Outputs> o) { radianceWide(job, p, o); }, how);
}

} // namespace chiaro
