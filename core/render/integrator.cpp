#include "core/render/integrator.h"
#include "core/render/pixel_start.h"
#include "core/render/wide_starts.h"
#include <chrono>

namespace chiaro {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t mostStarts = StartLanes::most;

// Memory of one thread for one batch: kept between tiles, since 256 outputs with layers are 100 KB.
struct Room {
    alignas(64) std::byte starts[mostStarts * sizeof(PathStart)];
    alignas(64) std::byte outputs[mostStarts * sizeof(Outputs)];
    alignas(64) std::byte runs[mostStarts * sizeof(PixelRun)];
    StartLanes lanes;
};

void traceFirst(const Job& job, PathStart& start) noexcept {
    // Through the wide kernels, like the tile loop: the same ray must give the same bits.
    job.scene.intersect(std::span<const Ray>(&start.ray, 1), std::span<Hit>(&start.first, 1), true);
}

// One tile: gather samples, sixteen of a pixel before the next where a pass has so many, since their rays stay together; trace, hand over,
// add.
class TileLoop {
public:
    TileLoop(const Job& job, const Pass& pass, Film& film, Batch batch, const Starts& how)
        : job_(job), pass_(pass), film_(film), batch_(batch), how_(how),
          most_(film.layout().costs ? 1 : std::clamp<std::size_t>(how.width, 1, mostStarts)), // a clock looks at one sample at a time
          plain_(plainStarts(job, how)) {
        thread_local const std::unique_ptr<Room> room = std::make_unique<Room>();
        room_ = room.get();
    }
    void run(Rect tile) {
        for (uint32_t begin = pass_.begin, end; begin < pass_.end; begin = end) {
            end = begin + std::min(pass_.end - begin, uint32_t(RayPacket::size));
            for (uint32_t y = tile.y0; y < tile.y1; ++y)
                for (uint32_t x = tile.x0; x < tile.x1; ++x) take({x, y}, begin, end);
        }
        flush();
    }

private:
    PathStart* starts() noexcept { return reinterpret_cast<PathStart*>(room_->starts); }
    Outputs* outputs() noexcept { return reinterpret_cast<Outputs*>(room_->outputs); }
    PixelRun* runs() noexcept { return reinterpret_cast<PixelRun*>(room_->runs); }
    void take(Pixel pixel, uint32_t begin, uint32_t end) {
        begin = std::max(begin, film_.next(pixel));
        if (begin >= end || (pass_.active && !pass_.active->active(pixel))) return;
        Sampler sampler(job_.seed, job_.sampler, Stream::pixel, pathIndex(pixel), begin);
        const Sampler::PairSeeds seeds = plain_ ? sampler.pairSeeds() : Sampler::PairSeeds{};
        sampler.skip(positionDimensions);
        while (begin < end) {
            const uint32_t n = std::min(end - begin, uint32_t(most_ - count_));
            ::new (runs() + runCount_++) PixelRun{pixel, begin, n, sampler};
            if (plain_) lay(pixel, begin, n, seeds);
            begin += n;
            count_ += n;
            if (count_ == most_) flush();
        }
    }
    void lay(Pixel pixel, uint32_t first, uint32_t n, const Sampler::PairSeeds& seeds) noexcept {
        StartLanes& lanes = room_->lanes;
        const Point2 centre = centreOf(pixel);
        for (std::size_t i = count_; i < count_ + n; ++i) {
            lanes.sample[i] = first++;
            lanes.index[i] = seeds.index;
            lanes.x[i] = seeds.x;
            lanes.y[i] = seeds.y;
            lanes.centreX[i] = centre.x;
            lanes.centreY[i] = centre.y;
        }
    }
    void flush() {
        const std::size_t n = count_;
        if (n == 0) return;
        const auto begin = film_.layout().costs ? Clock::now() : Clock::time_point{};
        plain_ ? makePlain(n) : makeAny(n);
        for (std::size_t i = 0; i < n; ++i) ::new (outputs() + i) Outputs(film_.layout());
        batch_({starts(), n}, {outputs(), n});
        if (film_.layout().costs) outputs()[0].microseconds = std::chrono::duration<float, std::micro>(Clock::now() - begin).count();
        const Outputs* next = outputs();
        for (const PixelRun& run : std::span<const PixelRun>(runs(), runCount_)) {
            film_.add(run.pixel, run.first, {next, run.count});
            next += run.count;
        }
        count_ = runCount_ = 0;
    }
    // The starts as pixelStart() makes them, sixteen rays at a time.
    void makePlain(std::size_t n) noexcept {
        const Camera& camera = job_.view.camera;
        const Ray ray{camera.position(), 0, {}, infinity, 0};
        RayPacket packet;
        for (std::size_t k = 0; k < RayPacket::size; ++k) packet.set(k, ray);
        Hit hits[RayPacket::size];
        const PixelRun* run = runs();
        for (std::size_t first = 0, taken = 0; first < n; first += RayPacket::size) {
            const std::size_t lanes = std::min(RayPacket::size, n - first);
            PathStart* const to = starts() + first;
            plainDirections(room_->lanes, first, job_.view.filter, camera, packet);
            for (std::size_t k = 0; k < lanes; ++k, ++taken) {
                if (taken == run->count) ++run, taken = 0;
                const uint32_t sample = room_->lanes.sample[first + k];
                Sampler sampler = run->sampler.at(sample);
                packet.time[k] = timeOf(job_, how_.time, sampler);
                sampler.skip(lensDimensions);
                ::new (to + k) PathStart{run->pixel, sample, packet.ray(k), camera.footprint(), {}, sampler, {}};
            }
            job_.scene.intersect(packet, {hits, lanes}, true);
            for (std::size_t k = 0; k < lanes; ++k) to[k].first = hits[k];
        }
    }
    void makeAny(std::size_t n) noexcept {
        PathStart* to = starts();
        for (const PixelRun& run : std::span<const PixelRun>(runs(), runCount_))
            for (uint32_t i = 0; i < run.count; ++i) ::new (to++) PathStart(pixelStart(job_, run.pixel, run.first + i, how_));
        for (std::size_t first = 0; first < n; first += RayPacket::size) {
            const std::size_t lanes = std::min(RayPacket::size, n - first);
            RayPacket packet{};
            Hit hits[RayPacket::size];
            for (std::size_t k = 0; k < lanes; ++k) packet.set(k, starts()[first + k].ray);
            job_.scene.intersect(packet, {hits, lanes}, true);
            for (std::size_t k = 0; k < lanes; ++k) starts()[first + k].first = hits[k];
        }
    }

    const Job& job_;
    const Pass& pass_;
    Film& film_;
    Batch batch_;
    const Starts& how_;
    std::size_t most_, count_ = 0, runCount_ = 0;
    bool plain_; // the rays are made sixteen at a time
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
    forEachTile<TileLoop>(job, pass, film, batch, how);
}

void CameraIntegrator::radianceWide(const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) const noexcept {
    for (std::size_t i = 0; i < starts.size(); ++i) radiance(job, starts[i], outputs[i]);
}

void CameraIntegrator::render(const Job& job, const Pass& pass, Film& film) {
    const Starts how = starts(job);
    if (streams(job, film.layout()))
        return forEachStream(
            job, pass, film, [&](StartSource& p, SampleLanes& o) { radianceWide(job, p, o); }, how);
    forEachBatch(
        job, pass, film, [&](std::span<PathStart> p, std::span<Outputs> o) { radianceWide(job, p, o); }, how);
}

} // namespace chiaro
