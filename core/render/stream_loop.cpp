// forEachStream: the tile loop for integrators that follow streams of paths.
#include "core/render/pixel_start.h"
#include "core/render/wide_starts.h"
#include <cstring>

namespace chiaro {

void SampleLanes::clear(std::size_t count) noexcept {
    std::memset(found, 0, count * sizeof found[0]);
    std::memset(direct, 0, count * sizeof direct[0]);
    for (auto* values : {albedo, normal})
        for (int c = 0; c < 3; ++c) std::memset(values[c], 0, count * sizeof(float));
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
        : job_(job), pass_(pass), film_(film), batch_(batch), how_(how), plain_(plainStarts(job, how)) {
        thread_local const std::unique_ptr<StreamRoom> room(new StreamRoom); // not filled with zeros
        room_ = room.get();
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
        for (std::size_t k = 0; k < n; ++k, ++inRun_) {
            if (inRun_ == runs()[run_].count) ++run_, inRun_ = 0;
            lay(runs()[run_], inRun_, k, to);
        }
        if (plain_) plainDirections(room_->waiting, 0, job_.view.filter, job_.view.camera, to.rays);
        job_.scene.intersect(to.rays, to.hits, to.count, true);
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
    // The start of one sample of a run, as pixelStart() makes it; of a plain camera without its direction.
    void lay(const PixelRun& run, uint32_t inRun, std::size_t k, StartPacket& to) noexcept {
        const uint32_t sample = run.first + inRun;
        const uint64_t key = run.sampler.key();
        to.keyLow[k] = uint32_t(key);
        to.keyHigh[k] = uint32_t(key >> 32);
        to.sample[k] = sample;
        if (!plain_) return to.rays.set(k, pixelStart(job_, run.pixel, sample, how_).ray);
        StartLanes& lanes = room_->waiting;
        if (inRun == 0 || k == 0) seeds_ = run.sampler.pairSeeds(), centre_ = centreOf(run.pixel);
        lanes.sample[k] = sample;
        lanes.index[k] = seeds_.index;
        lanes.x[k] = seeds_.x;
        lanes.y[k] = seeds_.y;
        lanes.centreX[k] = centre_.x;
        lanes.centreY[k] = centre_.y;
        Sampler sampler = run.sampler.at(sample);
        sampler.skip(positionDimensions);
        to.rays.set(k, {job_.view.camera.position(), 0, {}, infinity, timeOf(job_, how_.time, sampler)});
    }
    void flush() {
        if (count_ == 0) return;
        given_ = run_ = inRun_ = 0;
        room_->lanes.clear(count_);
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
            Outputs& out = *::new (outputs + k) Outputs(film_.layout());
            out.add(otherLayer, {l.found[i][0] + l.direct[i][0], l.found[i][1] + l.direct[i][1], l.found[i][2] + l.direct[i][2]});
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
    std::size_t count_ = 0, runCount_ = 0; // gathered
    std::size_t given_ = 0, run_ = 0;      // of which handed out; the run that the next one belongs to
    uint32_t inRun_ = 0;
    Sampler::PairSeeds seeds_;
    Point2 centre_;
    bool plain_;
    StreamRoom* room_;
};

} // namespace

void forEachStream(const Job& job, const Pass& pass, Film& film, StreamBatch batch, const Starts& how) {
    const Rect crop = film.layout().crop;
    const double area = double(crop.area());
    const auto tile = [&](Rect t) {
        StreamLoop(job, pass, film, batch, how).run(t);
        job.progress.advance(double(t.area()) / area);
    };
    job.run.tiles(crop, tile, how.whole ? nullptr : &job.stop);
}

} // namespace chiaro
