#include "core/render/pixel_start.h"
#include "core/render/fault.h"
#include <cmath>

namespace chiaro {
namespace {

// One shift for all the samples of a pixel keeps their distances (Cranley and Patterson 1976).
Point2 shiftedAround(Point2 p, uint64_t bits) noexcept {
    const float x = p.x + float(bits >> 40) * 0x1p-24f, y = p.y + float(bits & 0xffffff) * 0x1p-24f;
    return {x - std::floor(x), y - std::floor(y)};
}

Point2 filteredPosition(const Filter& filter, Pixel pixel, Point2 u) noexcept {
    const Point2 filtered = filter.sample(u), centre = centreOf(pixel);
    return {centre.x + filtered.x, centre.y + filtered.y};
}

} // namespace

uint64_t pathIndex(Pixel p) noexcept { return fault(Fault::seedsShared) ? 0 : uint64_t(p.y) << 32 | p.x; }

float timeOf(const Job& job, std::optional<float> at, Sampler& sampler) noexcept {
    const float open = job.shutter.open, length = job.shutter.close - open;
    if (!at && length != 0) return open + sampler.get1D() * length;
    sampler.skip(timeDimensions);
    return at ? *at : open;
}
PathStart makeStart(const Job& job, Pixel pixel, uint32_t sample, Point2 raster, Sampler sampler, std::optional<float> at) noexcept {
    const float time = timeOf(job, at, sampler);
    Point2 lens;
    if (job.view.camera.hasLens())
        lens = sampler.get2D();
    else
        sampler.skip(lensDimensions);
    return {pixel, sample, job.view.camera.ray(raster, lens, time), job.view.camera.footprint(), {}, sampler, {}};
}

Point2 centreOf(Pixel p) noexcept {
    const float half = fault(Fault::pixelCorner) ? 0.f : 0.5f;
    return {float(p.x) + half, float(p.y) + half};
}
PathStart pixelStart(const Job& job, Pixel pixel, uint32_t sample, const Starts& how) noexcept {
    Sampler sampler(job.seed, job.sampler, Stream::pixel, pathIndex(pixel), sample);
    if (how.pattern.empty()) {
        const Point2 raster = filteredPosition(job.view.filter, pixel, sampler.get2D());
        return makeStart(job, pixel, sample, raster, sampler, how.time);
    }
    Point2 p = how.pattern[sample % how.pattern.size()];
    if (how.jitter == 0) {
        sampler.skip(positionDimensions);
    } else {
        const Point2 u = sampler.get2D();
        p = {p.x + (u.x - 0.5f) * how.jitter, p.y + (u.y - 0.5f) * how.jitter};
    }
    if (how.shifted) p = shiftedAround(p, hashCombine(job.seed, pathIndex(pixel)));
    return makeStart(job, pixel, sample, {float(pixel.x) + p.x, float(pixel.y) + p.y}, sampler, how.time);
}

} // namespace chiaro
