// Photons: how many paths a second leave the lights, how fast what they left is sorted, and how fast it is found again.
#include "core/scene/accel.h"
#include "core/scene/ray_record.h"
#include "integrators/photon_trace.h"
#include "tools/bench/rays.h"
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr uint64_t pathsABatch = 1 << 17;
constexpr uint32_t nearest = 64; // photons of a gather
constexpr uint64_t gathersABatch = 1 << 14;

// A radius that holds about as many photons as are wanted, did they lie evenly on surfaces of 12 radius^2.
float gatherRadius(const Scene& scene, std::size_t photons) {
    return 2 * scene.radius() * std::sqrt(float(nearest) / float(std::max<std::size_t>(photons, nearest)));
}

// Finds the nearest photons around photons. Returns how many gathers there were.
double gatherAll(const Executor& run, const PhotonStore& store, float radius, const StopToken& stop) {
    constexpr uint64_t chunks = 64;
    const uint64_t step = std::max<uint64_t>(1, store.size() / gathersABatch);
    const uint64_t points = store.size() / step;
    std::atomic<uint64_t> found{0};
    run.chunks(
        chunks,
        [&](uint64_t c) {
            std::array<PhotonStore::Near, nearest> near;
            uint64_t sum = 0;
            for (uint64_t i = points * c / chunks; i < points * (c + 1) / chunks; ++i)
                sum += store.nearest(store.photons()[i * step].p, nearest, radius, near, [](const Photon&) { return true; });
            found += sum;
        },
        &stop);
    return double(points);
}

// Embree alone on the rays of a trace: by the calls that the trace made, and one by one.
struct Alone {
    double calls = 0, single = 0; // seconds
};
Alone replay(const Work& work, const RayRecord& record) {
    std::vector<const RayBlock*> blocks;
    for (int c = 0; c < rayCalls; ++c) blocks.insert(blocks.end(), record.blocks(RayCall(c)).begin(), record.blocks(RayCall(c)).end());
    std::atomic<uint64_t> hits{0};
    Alone seconds;
    auto begin = Clock::now();
    work.run.chunks(
        blocks.size(), [&](uint64_t b) { hits += Accel::replay(*blocks[b]).hits; }, nullptr);
    seconds.calls = secondsSince(begin);
    begin = Clock::now();
    const auto one = [&](uint64_t b) {
        uint64_t found = 0;
        for (const WideRays& w : blocks[b]->wide)
            for (std::size_t k = 0; k < WideRays::size; ++k)
                if (w.valid[k])
                    found += bool(work.scene.intersect(
                        Ray{{w.ox[k], w.oy[k], w.oz[k]}, w.tnear[k], {w.dx[k], w.dy[k], w.dz[k]}, w.tfar[k], work.shutter.open}));
        hits += found;
    };
    work.run.chunks(blocks.size(), one, nullptr);
    seconds.single = secondsSince(begin);
    return seconds;
}

struct Cells {
    double paths = NAN, stored = NAN, rays = NAN, sorted = NAN, gathers = NAN, bytes = NAN, balance = NAN, spread = 0;
    double wide = NAN, single = NAN;           // seconds of Embree alone over those of the trace
    double manyTraced = NAN, manySorted = NAN; // seconds
};

// Traces and replays in turns: whatever else the machine does hits both.
void compareWithRays(const Work& work, const PhotonRequest& request, double seconds, Cells& cells) {
    RayRecord record(1 << 24);
    record.start();
    (void)tracePhotons(work, request);
    record.stop();
    if (!record.whole() || record.rays() == 0) return;
    std::vector<double> wide, single;
    const auto begin = Clock::now();
    do {
        const auto start = Clock::now();
        (void)tracePhotons(work, request);
        const double traced = secondsSince(start);
        const Alone alone = replay(work, record);
        wide.push_back(alone.calls / traced);
        single.push_back(alone.single / traced);
    } while (secondsSince(begin) < seconds && !work.stop.requested());
    cells.wide = median(wide);
    cells.single = median(single);
}

// Ten million photons from nothing to a store that can be asked. False: neither time nor memory is there.
bool makeMany(const Work& work, double pathsAPhoton, double secondsAPhoton, double left, Cells& cells) {
    constexpr double many = 1e7, whileSorting = 80; // bytes a photon
    if (many * secondsAPhoton > left || many * whileSorting > double(work.memoryLimit)) return false;
    PhotonRequest request;
    request.paths = uint64_t(std::ceil(many * pathsAPhoton));
    auto begin = Clock::now();
    TracedPhotons traced = tracePhotons(work, request);
    cells.manyTraced = secondsSince(begin);
    const float radius = gatherRadius(work.scene, traced.photons.size());
    begin = Clock::now();
    const PhotonStore store(work.run, std::move(traced.photons), radius);
    cells.manySorted = secondsSince(begin);
    return true;
}

std::optional<Cells> measure(const Work& work, Stopwatch& watch, double share) {
    Cells cells;
    PhotonRequest request;
    request.paths = pathsABatch;
    TracedPhotons traced;
    const auto paths = watch.rate([&] {
        traced = tracePhotons(work, request);
        ++request.iteration;
        return double(traced.statistics.paths);
    });
    if (!paths) return {};
    const PhotonStatistics s = traced.statistics;
    cells.paths = paths->perSecond;
    cells.spread = paths->spread;
    cells.stored = paths->perSecond * double(s.stored) / double(s.paths);
    cells.rays = paths->perSecond * double(s.rays) / double(s.paths);
    cells.balance = s.emitted > 0 ? (s.absorbed + s.escaped + s.ended) / s.emitted : NAN;
    compareWithRays(work, request, share / 4, cells);
    if (work.stop.requested()) return {};
    if (traced.photons.empty()) return cells;
    const float radius = gatherRadius(work.scene, traced.photons.size());
    PhotonStore store;
    const auto sorted = watch.rate([&] {
        store = PhotonStore(work.run, traced.photons, radius);
        return double(store.size());
    });
    const auto gathers = watch.rate([&] { return gatherAll(work.run, store, radius, work.stop); });
    if (!sorted || !gathers) return {};
    cells.sorted = sorted->perSecond;
    cells.gathers = gathers->perSecond;
    cells.bytes = double(store.bytes()) / double(store.size());
    return cells;
}

} // namespace

Table photonsSuite(const Request& request) {
    Table table{.suite = "photons",
                .title = fmt::format("{} paths at a time; a gather finds the {} nearest photons", pathsABatch, nearest),
                .columns = {{"paths", "M/s"},
                            {"stored", "M photons/s"},
                            {"rays", "M/s"},
                            {"sorted", "M photons/s"},
                            {"gathers", "M/s"},
                            {"bytes", "a photon"},
                            {"flux", "told / emitted"},
                            {"growth", "of 1 thread"},
                            {"of rays", "16 wide"},
                            {"of rays", "single"},
                            {"10 M", "s traced"},
                            {"10 M", "s sorted"}},
                .rows = {},
                .notes = {"sorted: with the copy of the list that is sorted",
                          "of rays: what Embree alone takes for the very rays of the trace, over the trace, in turns"}};
    Stopwatch watch(request.seconds, request.scenes.size() * request.threads.size() * 3, request.runs, request.stop);
    const PathClasses classes;
    for (const BenchScene& s : request.scenes) {
        double first = NAN;
        for (const unsigned threads : request.threads) {
            request.progress.phase(fmt::format("photons {} {} thread{}", s.name, threads, threads == 1 ? "" : "s"));
            const Executor run(threads);
            const Work work{*s.scene, classes,      s.view.shutter,   request.seed,  SamplerKind::sobol,
                            run,      request.stop, request.progress, request.notes, request.memoryLimit};
            auto c = measure(work, watch, request.seconds / double(request.scenes.size() * request.threads.size()));
            if (c && threads == request.threads.back() && c->stored > 0) {
                request.progress.phase(fmt::format("ten million photons {}", s.name));
                if (!makeMany(work, c->paths / c->stored, 1.5 / c->stored + 1.5 / c->sorted,
                              std::max(0.0, watch.left()) + request.seconds / 4, *c))
                    table.notes.push_back(fmt::format("{}: ten million photons want more time or memory: --time 1m", s.name));
            }
            if (!c || request.stop.requested()) {
                table.stopped = true;
                return table;
            }
            if (threads == request.threads.front()) first = c->paths;
            table.rows.push_back({s.name,
                                  "all photons",
                                  threads,
                                  c->spread,
                                  {c->paths * 1e-6, c->stored * 1e-6, c->rays * 1e-6, c->sorted * 1e-6, c->gathers * 1e-6, c->bytes,
                                   c->balance, c->paths / first, c->wide, c->single, c->manyTraced, c->manySorted}});
        }
    }
    return table;
}

} // namespace chiaro::bench
