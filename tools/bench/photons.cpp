// Photons: how many paths a second leave the lights, how fast what they left is sorted, and how fast it is found again.
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

struct Cells {
    double paths = NAN, stored = NAN, rays = NAN, sorted = NAN, gathers = NAN, bytes = NAN, balance = NAN, spread = 0;
};
std::optional<Cells> measure(const Work& work, Stopwatch& watch) {
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
    const PhotonStatistics& s = traced.statistics;
    cells.paths = paths->perSecond;
    cells.spread = paths->spread;
    cells.stored = paths->perSecond * double(s.stored) / double(s.paths);
    cells.rays = paths->perSecond * double(s.rays) / double(s.paths);
    cells.balance = s.emitted > 0 ? (s.absorbed + s.escaped + s.ended) / s.emitted : NAN;
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
                            {"growth", "of 1 thread"}},
                .rows = {},
                .notes = {"sorted: with the copy of the list that is sorted"}};
    Stopwatch watch(request.seconds, request.scenes.size() * request.threads.size() * 3, request.runs, request.stop);
    const PathClasses classes;
    for (const BenchScene& s : request.scenes) {
        double first = NAN;
        for (const unsigned threads : request.threads) {
            request.progress.phase(fmt::format("photons {} {} thread{}", s.name, threads, threads == 1 ? "" : "s"));
            const Executor run(threads);
            const Work work{*s.scene, classes,      s.view.shutter,   request.seed,  SamplerKind::sobol,
                            run,      request.stop, request.progress, request.notes, request.memoryLimit};
            const auto c = measure(work, watch);
            if (!c) {
                table.stopped = true;
                return table;
            }
            if (threads == request.threads.front()) first = c->paths;
            table.rows.push_back({s.name,
                                  "all photons",
                                  threads,
                                  c->spread,
                                  {c->paths * 1e-6, c->stored * 1e-6, c->rays * 1e-6, c->sorted * 1e-6, c->gathers * 1e-6, c->bytes,
                                   c->balance, c->paths / first}});
        }
    }
    return table;
}

} // namespace chiaro::bench
