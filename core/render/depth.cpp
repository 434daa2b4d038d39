#include "core/render/depth.h"
#include <algorithm>

namespace chiaro {
namespace {

constexpr int movingTimes = 5; // at which lamps are looked for while the shutter is open, both its ends among them

// Steps through cut-outs until something counts as a surface.
struct Seen {
    float depth = infinity;
    bool lamp = false;
};
Seen seenAlong(const Job& job, Ray ray, Hit hit) {
    constexpr int mostCutOuts = 1000; // a ray that meets more is given up as a miss
    for (int i = 0; i < mostCutOuts && hit; ++i) {
        const SurfacePoint point = job.scene.point(hit, ray);
        if (job.scene.opacity(point) >= 0.5f) return {job.view.camera.depth(point.p), point.light != Lights::none};
        const float tfar = ray.tfar, time = ray.time;
        ray = point.towards(ray.d);
        ray.tfar = tfar;
        ray.time = time;
        hit = job.scene.intersect(ray);
    }
    return {};
}

// Depths are those of the opening: the first time.
void seeTile(const Job& job, Rect tile, float time, Centres& out) {
    const Rect& crop = job.view.crop;
    const bool first = time == job.view.shutter.open;
    std::vector<Ray> rays;
    std::vector<Hit> hits(tile.area());
    for (uint32_t y = tile.y0; y < tile.y1; ++y)
        for (uint32_t x = tile.x0; x < tile.x1; ++x)
            rays.push_back(job.view.camera.ray({float(x) + 0.5f, float(y) + 0.5f}, {0.5f, 0.5f}, time));
    job.scene.intersect(rays, hits, true);
    std::size_t i = 0;
    for (uint32_t y = tile.y0; y < tile.y1; ++y)
        for (uint32_t x = tile.x0; x < tile.x1; ++x, ++i) {
            const Seen seen = seenAlong(job, rays[i], hits[i]);
            const std::size_t at = std::size_t(y - crop.y0) * crop.width() + (x - crop.x0);
            if (first) out.depth[at] = seen.depth;
            out.lamp[at] |= uint8_t(seen.lamp);
        }
}

} // namespace

Centres seenAtCentres(const Job& job) {
    Centres centres{std::vector<float>(job.view.crop.area()), std::vector<uint8_t>(job.view.crop.area())};
    const Interval& shutter = job.view.shutter;
    const int times = shutter.close > shutter.open ? movingTimes : 1;
    job.run.tiles(
        job.view.crop,
        [&](Rect tile) {
            for (int i = 0; i < times; ++i)
                seeTile(job, tile, i == 0 ? shutter.open : shutter.open + (shutter.close - shutter.open) * (float(i) / (movingTimes - 1)),
                        centres);
        },
        nullptr);
    return centres;
}

} // namespace chiaro
