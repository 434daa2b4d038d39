#include "integrators/shadow_map.h"
#include "core/render/integrator.h"
#include <algorithm>
#include <array>

namespace chiaro {
namespace {

constexpr uint32_t cubeFaces = 6;

// The direction towards a directional light; empty: the lamp has a place.
std::optional<Vec3> parallelDirection(const LocalLights& lights, uint32_t lamp) noexcept {
    if (lights.lamp(lamp).kind != LightKind::delta) return {};
    const auto sample = lights.towards(lamp, SurfacePoint{});
    if (!sample || std::isfinite(sample->shadow.tfar)) return {};
    return sample->wi;
}

// Of the cube's faces 0 to 5: the axis that it stands on, x, y or z, first its positive side.
std::array<float, 3> components(const Vec3& v) noexcept { return {v.x, v.y, v.z}; }
Vec3 vector(const std::array<float, 3>& c) noexcept { return {c[0], c[1], c[2]}; }

// The texel of a position in [-1, 1].
uint32_t cellOf(float x, uint32_t size) noexcept {
    return uint32_t(std::clamp(int64_t((x + 1) / 2 * float(size)), int64_t(0), int64_t(size) - 1));
}
float middleOf(uint32_t cell, uint32_t size) noexcept { return (2 * float(cell) + 1) / float(size) - 1; }

// The first hit that is not the lamp's own: a point in the middle of a bulb sees through its glass.
float firstOther(const Scene& scene, const LocalLights& lights, uint32_t lamp, Ray ray, Hit hit) noexcept {
    constexpr int most = 64;
    float travelled = 0;
    for (int step = 0; hit && step < most; ++step) {
        travelled += hit.t;
        if (!lights.own(lamp, hit)) return travelled;
        ray = scene.point(hit, ray).towards(ray.d);
        scene.intersect({&ray, 1}, {&hit, 1}, false);
    }
    return infinity;
}

} // namespace

uint64_t ShadowMap::bytes(const LocalLights& lights, uint32_t lamp, uint32_t size) noexcept {
    return uint64_t(size) * size * sizeof(float) * (parallelDirection(lights, lamp) ? 1 : cubeFaces);
}

ShadowMap::ShadowMap(const Job& job, const LocalLights& lights, uint32_t lamp, uint32_t size)
    : size_(size), centre_(lights.lamp(lamp).centre), normal_(lights.lamp(lamp).normal), doubleSided_(lights.lamp(lamp).doubleSided),
      radius_(job.scene.radius()), time_((job.shutter.open + job.shutter.close) / 2), margin_(64 * 0x1p-23f * radius_) {
    if (const auto direction = parallelDirection(lights, lamp)) {
        parallel_ = true;
        frame_ = Frame::about(*direction);
        normal_ = {};
    }
    const uint32_t faces = parallel_ ? 1 : cubeFaces;
    depths_.assign(std::size_t(size) * size * faces, infinity);
    job.run.chunks(
        uint64_t(faces) * size, [&](uint64_t i) { traceRow(job.scene, lights, lamp, uint32_t(i / size), uint32_t(i % size)); }, &job.stop);
}

Ray ShadowMap::rayThrough(uint32_t face, uint32_t row, uint32_t column) const noexcept {
    const float x = middleOf(column, size_), y = middleOf(row, size_);
    if (parallel_) return {frame_.toWorld(Vec3{x, y, 1} * radius_), 0, -frame_.z, infinity, time_};
    const uint32_t axis = face / 2;
    std::array<float, 3> c;
    c[axis] = face % 2 == 0 ? 1.f : -1.f;
    c[(axis + 1) % 3] = x;
    c[(axis + 2) % 3] = y;
    const Vec3 d = normalize(vector(c)), off = normal_ * (dot(d, normal_) < 0 ? -margin_ : margin_);
    return {centre_ + off, 0, d, infinity, time_};
}

void ShadowMap::traceRow(const Scene& scene, const LocalLights& lights, uint32_t lamp, uint32_t face, uint32_t row) noexcept {
    constexpr uint32_t width = 64;
    std::array<Ray, width> rays;
    std::array<Hit, width> hits;
    float* depths = depths_.data() + (std::size_t(face) * size_ + row) * size_;
    for (uint32_t begin = 0; begin < size_; begin += width) {
        const uint32_t n = std::min(width, size_ - begin);
        bool wanted = false;
        for (uint32_t i = 0; i < n; ++i) {
            rays[i] = rayThrough(face, row, begin + i);
            wanted |= doubleSided_ || dot(rays[i].d, normal_) >= -4 / float(size_); // nobody asks behind a lamp that shines to one side
        }
        if (!wanted) continue;
        scene.intersect({rays.data(), n}, {hits.data(), n}, true);
        for (uint32_t i = 0; i < n; ++i) depths[begin + i] = firstOther(scene, lights, lamp, rays[i], hits[i]);
    }
}

ShadowMap::Texel ShadowMap::texelAt(const Vec3& p) const noexcept {
    if (parallel_) {
        const Vec3 q = frame_.toLocal(p) * (1 / radius_);
        return {std::size_t(cellOf(q.y, size_)) * size_ + cellOf(q.x, size_), (1 - q.z) * radius_, 2 * radius_ / float(size_), frame_.z};
    }
    const Vec3 way = p - centre_;
    const auto c = components(way);
    const float x = std::fabs(way.x), y = std::fabs(way.y), z = std::fabs(way.z);
    const std::size_t axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const float far = std::fabs(c[axis]), depth = length(way);
    if (!(far > 0)) return {0, 0, 0, {0, 0, 1}};
    const std::size_t face = 2 * axis + (c[axis] < 0 ? 1 : 0);
    const std::size_t row = cellOf(c[(axis + 2) % 3] / far, size_), column = cellOf(c[(axis + 1) % 3] / far, size_);
    return {(face * size_ + row) * size_ + column, depth, 2 * far / float(size_), way * (-1 / depth)};
}

// Over a texel the depth of a plane changes by half its diagonal times the tangent of the slope, and by less than its width for the rest.
bool ShadowMap::shadowed(const SurfacePoint& at, float bias) const noexcept {
    const Texel t = texelAt(at.p);
    const float cosine = absDot(at.ng, t.towardsLamp), slope = safeSqrt(1 - sqr(cosine)) / max(cosine, 1e-4f);
    return t.depth - bias * t.width * (1 + slope) > depths_[t.index];
}

} // namespace chiaro
