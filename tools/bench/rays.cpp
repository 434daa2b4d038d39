#include "tools/bench/rays.h"
#include "core/math/warp.h"
#include "core/scene/scene.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr uint32_t perPoint = 16;
constexpr uint32_t standardPixels = 1 << 16;

std::vector<RayPacket> packed(std::span<const Ray> rays) {
    std::vector<RayPacket> all(rays.size() / RayPacket::size);
    for (std::size_t i = 0; i < all.size() * RayPacket::size; ++i) all[i / RayPacket::size].set(i % RayPacket::size, rays[i]);
    return all;
}

// Whole packets alone.
void trim(std::vector<Ray>& rays) { rays.resize(rays.size() / RayPacket::size * RayPacket::size); }

// A pixel's share of what follows its camera ray.
void follow(const Job& job, const PathStart& start, RecordedRays& r) {
    if (!start.first) return;
    Sampler sampler = start.sampler;
    const SurfacePoint at = job.scene.point(start.first, start.ray);
    const Vec3 side = dot(at.ng, start.ray.d) < 0 ? at.ng : -at.ng;
    r.bounce.push_back(at.towards(Frame::about(side).toWorld(cosineHemisphere(sampler.get2D()))));
    if (start.pixel.x % 4 || start.pixel.y % 4) return; // sixteen a point: as many as of the other kinds
    std::array<Ray, perPoint> shadows;
    std::size_t n = 0;
    for (uint32_t i = 0; i < perPoint; ++i) {
        const double pick = sampler.getPick();
        const Point2 u = sampler.get2D();
        const auto light = job.scene.lights().sampleTowards(at, pick, u);
        if (light && dot(side, light->wi) > 0) shadows[n++] = light->shadow;
    }
    if (n == perPoint) r.shadow.insert(r.shadow.end(), shadows.begin(), shadows.end());
}

// About so many pixels as whole tiles, spread over the picture.
std::vector<Pixel> tiledPixels(const Rect& r, uint32_t wanted) {
    constexpr uint32_t side = 8;
    std::vector<Pixel> tiles;
    for (uint32_t y = r.y0; y + side <= r.y1; y += side)
        for (uint32_t x = r.x0; x + side <= r.x1; x += side) tiles.push_back({x, y});
    const std::size_t step = std::max<std::size_t>(1, tiles.size() * side * side / std::max(1u, wanted));
    std::vector<Pixel> all;
    for (std::size_t t = 0; t < tiles.size(); t += step)
        for (uint32_t i = 0; i < side * side; ++i) all.push_back({tiles[t].x + i % side, tiles[t].y + i / side});
    return all;
}

template <class F> Traced inChunks(const Executor& run, std::size_t units, const StopToken& stop, F&& each) {
    constexpr std::size_t unitsAChunk = 256;
    std::atomic<uint64_t> rays{0}, hits{0};
    run.chunks((units + unitsAChunk - 1) / unitsAChunk,
               [&](uint64_t chunk) {
                   Traced local;
                   for (std::size_t i = chunk * unitsAChunk; i < std::min<std::size_t>((chunk + 1) * unitsAChunk, units); ++i)
                       each(i, local);
                   rays += local.rays;
                   hits += local.hits;
               },
               &stop);
    return {rays, hits};
}

Traced closest(const Scene& scene, const Executor& run, std::span<const Ray> rays, const StopToken& stop) {
    return inChunks(run, rays.size(), stop, [&](std::size_t i, Traced& t) {
        t.hits += bool(scene.intersect(rays[i]));
        ++t.rays;
    });
}
Traced closest(const Scene& scene, const Executor& run, std::span<const RayPacket> packets, bool coherent, const StopToken& stop) {
    return inChunks(run, packets.size(), stop, [&](std::size_t i, Traced& t) {
        std::array<Hit, RayPacket::size> hits;
        scene.intersect(packets[i], hits, coherent);
        for (const Hit& h : hits) t.hits += bool(h);
        t.rays += RayPacket::size;
    });
}
Traced blocked(const Scene& scene, const Executor& run, std::span<const Ray> rays, const StopToken& stop) {
    return inChunks(run, rays.size(), stop, [&](std::size_t i, Traced& t) {
        t.hits += scene.occluded(rays[i]);
        ++t.rays;
    });
}
Traced blocked(const Scene& scene, const Executor& run, std::span<const RayPacket> packets, const StopToken& stop) {
    return inChunks(run, packets.size(), stop, [&](std::size_t i, Traced& t) {
        std::array<uint8_t, RayPacket::size> answers;
        scene.occluded(packets[i], answers);
        for (const uint8_t a : answers) t.hits += a != 0;
        t.rays += RayPacket::size;
    });
}

} // namespace

std::string_view rayKindName(RayKind kind) noexcept {
    static constexpr std::array<std::string_view, rayKinds> names = {"camera, 16 coherent",    "camera, single",
                                                                     "diffuse bounce, single", "diffuse bounce, 16 wide",
                                                                     "shadow, single",         "shadow, 16 from one point"};
    return names[std::size_t(kind)];
}

RecordedRays recordRays(const Job& job, uint32_t pixels) {
    RecordedRays r;
    for (const Pixel p : tiledPixels(job.view.crop, pixels)) {
        const PathStart start = startPixel(job, p, 0);
        r.camera.push_back(start.ray);
        follow(job, start, r);
    }
    for (std::vector<Ray>* rays : {&r.camera, &r.bounce, &r.shadow}) trim(*rays);
    r.cameraPackets = packed(r.camera);
    r.bouncePackets = packed(r.bounce);
    r.shadowPackets = packed(r.shadow);
    return r;
}

Traced traceAll(const Scene& scene, const Executor& run, const RecordedRays& r, RayKind kind, const StopToken& stop) {
    switch (kind) {
    case RayKind::cameraWide: return closest(scene, run, r.cameraPackets, true, stop);
    case RayKind::cameraSingle: return closest(scene, run, r.camera, stop);
    case RayKind::bounceSingle: return closest(scene, run, r.bounce, stop);
    case RayKind::bounceWide: return closest(scene, run, r.bouncePackets, false, stop);
    case RayKind::shadowSingle: return blocked(scene, run, r.shadow, stop);
    case RayKind::shadowWide: return blocked(scene, run, r.shadowPackets, stop);
    }
    return {};
}

Table raysSuite(const Request& request) {
    Table table{.suite = "rays",
                .title = "Embree alone, on rays recorded from the view",
                .columns = {{"rate", "M rays/s"}, {"growth", "of 1 thread"}, {"hits", "%"}},
                .rows = {},
                .notes = {}};
    Stopwatch watch(request.seconds, request.scenes.size() * request.threads.size() * rayKinds, request.runs, request.stop);
    const PathClasses classes;
    for (const BenchScene& s : request.scenes) {
        std::array<double, rayKinds> first{};
        for (const unsigned threads : request.threads) {
            request.progress.phase(fmt::format("rays {} {} thread{}", s.name, threads, threads == 1 ? "" : "s"));
            const Executor run(threads);
            const Job job{{*s.scene, classes, s.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                           request.notes, request.memoryLimit},
                          s.view};
            const RecordedRays rays = recordRays(job, standardPixels);
            for (int k = 0; k < rayKinds; ++k) {
                Traced traced;
                const auto rate = watch.rate([&] {
                    traced = traceAll(*s.scene, run, rays, RayKind(k), request.stop);
                    return double(traced.rays);
                });
                if (!rate) {
                    table.stopped = true;
                    return table;
                }
                if (traced.rays == 0) continue; // nothing of this kind in the picture
                if (threads == request.threads.front()) first[std::size_t(k)] = rate->perSecond;
                table.rows.push_back(
                    {s.name,
                     std::string(rayKindName(RayKind(k))),
                     threads,
                     rate->spread,
                     {rate->perSecond * 1e-6, rate->perSecond / first[std::size_t(k)], 100 * double(traced.hits) / double(traced.rays)}});
            }
        }
    }
    return table;
}

} // namespace chiaro::bench
