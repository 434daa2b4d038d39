// forEachStream: the tile loop for integrators that follow streams of paths.
#include "core/render/pixel_start.h"
#include "core/render/wide_starts.h"
#include "core/scene/accel.h"
#include "core/scene/wide_surfaces.h"
#include <cstring>

namespace chiaro {

void SampleLanes::fit(std::size_t n) {
    if (n > fits_) {
        room_ = std::make_unique_for_overwrite<float[][4]>(2 * n * most);
        fits_ = n;
    }
    layers = uint32_t(n);
    found = room_.get();
    direct = found + n * most;
}

void SampleLanes::clear(std::size_t first, std::size_t count) noexcept {
    std::memset(found + first * layers, 0, count * layers * sizeof found[0]);
    std::memset(direct + first * layers, 0, count * layers * sizeof direct[0]);
}

namespace {

constexpr std::size_t mostStarts = SampleLanes::most, width = RayPacket::size, together = 32;

// Memory of one thread for one stream, kept between tiles.
struct StreamRoom {
    SampleLanes lanes;
    StartLanes waiting;
    alignas(64) std::byte runs[mostStarts * sizeof(PixelRun)];
    alignas(64) std::byte outputs[together * sizeof(Outputs)];
};
static_assert(positionDimensions + timeDimensions + lensDimensions == startDimensions);

// One tile: samples are gathered sixteen of a pixel before the next where a pass has so many, since their rays stay together.
class StreamLoop final : public StartSource {
public:
    StreamLoop(const Job& job, const Pass& pass, Film& film, StreamBatch batch, const Starts& how)
        : job_(job), pass_(pass), film_(film), batch_(batch), how_(how), hierarchy_(WideSurfaces::hierarchy(job.scene)),
          plain_(plainStarts(job, how)) {
        thread_local const std::unique_ptr<StreamRoom> room(new StreamRoom); // not filled with zeros
        room_ = room.get();
        room_->lanes.fit(std::max<std::size_t>(1, film.layout().layers.size()));
        for (std::size_t k = 0; k < together; ++k) ::new (room_->outputs + k * sizeof(Outputs)) Outputs(film.layout());
    }
    void run(Rect tile) {
        for (uint32_t begin = pass_.begin, end; begin < pass_.end; begin = end) {
            end = begin + std::min(pass_.end - begin, uint32_t(width));
            for (uint32_t y = tile.y0; y < tile.y1; ++y)
                for (uint32_t x = tile.x0; x < tile.x1; ++x) take({x, y}, begin, end);
        }
        flush();
    }
    bool next(StartPacket& to) noexcept override {
        const std::size_t n = std::min(width, count_ - given_);
        if (n == 0) return false;
        to.first = uint32_t(given_);
        to.count = uint32_t(n);
        room_->lanes.clear(given_, n);
        for (std::size_t k = 0; k < n;) {
            const PixelRun& run = runs()[run_];
            const auto piece = std::min(uint32_t(n - k), run.count - inRun_);
            lay(run, inRun_, k, piece, to);
            k += piece;
            inRun_ += piece;
            if (inRun_ == run.count) ++run_, inRun_ = 0;
        }
        if (plain_) plainDirections(room_->waiting, 0, job_.view.filter, job_.view.camera, to.traced.rays);
        hierarchy_.trace(to.traced, to.count, true);
        given_ += n;
        return true;
    }

private:
    PixelRun* runs() noexcept { return reinterpret_cast<PixelRun*>(room_->runs); }
    void take(Pixel pixel, uint32_t begin, uint32_t end) {
        begin = std::max(begin, film_.next(pixel));
        if (begin >= end || (pass_.active && !pass_.active->active(pixel))) return;
        Sampler sampler(job_.seed, job_.sampler, Stream::pixel, pathIndex(pixel), begin);
        while (begin < end) {
            const uint32_t n = std::min(end - begin, uint32_t(mostStarts - count_));
            ::new (runs() + runCount_++) PixelRun{pixel, begin, n, sampler};
            begin += n;
            count_ += n;
            if (count_ == mostStarts) flush();
        }
    }
    // The starts of some samples of a run, as pixelStart() makes them; of a plain camera without their directions.
    void lay(const PixelRun& run, uint32_t from, std::size_t k, uint32_t count, StartPacket& to) noexcept {
        const uint64_t key = run.sampler.key();
        std::fill_n(to.keyLow + k, count, uint32_t(key));
        std::fill_n(to.keyHigh + k, count, uint32_t(key >> 32));
        for (uint32_t i = 0; i < count; ++i) to.sample[k + i] = run.first + from + i;
        if (!plain_) {
            for (uint32_t i = 0; i < count; ++i) to.traced.rays.set(k + i, pixelStart(job_, run.pixel, run.first + from + i, how_).ray);
            return;
        }
        StartLanes& lanes = room_->waiting;
        const Sampler::PairSeeds seeds = run.sampler.pairSeeds();
        const Point2 centre = centreOf(run.pixel);
        const Vec3 o = job_.view.camera.position();
        for (uint32_t i = 0; i < count; ++i) lanes.sample[k + i] = run.first + from + i;
        for (const auto& [at, value] : {std::pair{lanes.index, seeds.index}, std::pair{lanes.x, seeds.x}, std::pair{lanes.y, seeds.y}})
            std::fill_n(at + k, count, value);
        RayPacket& r = to.traced.rays;
        for (const auto& [at, value] : {std::pair{lanes.centreX, centre.x}, std::pair{lanes.centreY, centre.y}, std::pair{r.ox, o.x},
                                        std::pair{r.oy, o.y}, std::pair{r.oz, o.z}, std::pair{r.tnear, 0.f}, std::pair{r.tfar, infinity}})
            std::fill_n(at + k, count, value);
        if (how_.time || job_.shutter.close == job_.shutter.open) {
            std::fill_n(r.time + k, count, how_.time.value_or(job_.shutter.open));
            return;
        }
        for (uint32_t i = 0; i < count; ++i) {
            Sampler sampler = run.sampler.at(run.first + from + i);
            sampler.skip(positionDimensions);
            r.time[k + i] = timeOf(job_, how_.time, sampler);
        }
    }
    void flush() {
        if (count_ == 0) return;
        given_ = run_ = inRun_ = 0;
        batch_(*this, room_->lanes);
        std::size_t slot = 0;
        for (const PixelRun& run : std::span<const PixelRun>(runs(), runCount_)) {
            for (uint32_t i = 0, n; i < run.count; i += n, slot += n) {
                n = std::min(uint32_t(together), run.count - i);
                add(run, i, n, slot);
            }
        }
        count_ = runCount_ = 0;
    }
    void add(const PixelRun& run, uint32_t from, uint32_t n, std::size_t slot) noexcept {
        auto* const outputs = reinterpret_cast<Outputs*>(room_->outputs);
        const SampleLanes& l = room_->lanes;
        for (std::size_t k = 0, i = slot; k < n; ++k, ++i) {
            Outputs& out = outputs[k];
            for (uint32_t layer = 0; layer < l.layers; ++layer) {
                const float *found = l.found[i * l.layers + layer], *direct = l.direct[i * l.layers + layer];
                out.layer[layer] = {found[0] + direct[0], found[1] + direct[1], found[2] + direct[2]};
            }
            out.aov(Aov::albedo, {l.albedo[0][i], l.albedo[1][i], l.albedo[2][i]});
            out.aov(Aov::normal, {l.normal[0][i], l.normal[1][i], l.normal[2][i]});
        }
        film_.add(run.pixel, run.first + from, {outputs, n});
    }

    const Job& job_;
    const Pass& pass_;
    Film& film_;
    StreamBatch batch_;
    const Starts& how_;
    const Accel& hierarchy_;
    std::size_t count_ = 0, runCount_ = 0; // gathered
    std::size_t given_ = 0, run_ = 0;      // of which handed out; the run that the next one belongs to
    uint32_t inRun_ = 0;
    bool plain_;
    StreamRoom* room_;
};

} // namespace

void forEachStream(const Job& job, const Pass& pass, Film& film, StreamBatch batch, const Starts& how) {
    forEachTile<StreamLoop>(job, pass, film, batch, how);
}

} // namespace chiaro
