#include "core/scene/wide_surfaces.h"
#include "core/render/in_parallel.h"
#include "core/scene/accel.h"
#include "core/scene/scene.h"
#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

// Interpolation of unit vectors is that of the vectors themselves only where all have one length.
bool alike(const std::vector<Vec3>& normals) noexcept {
    if (normals.empty()) return true;
    const float first = length(normals[0]);
    if (!(first > 0)) return false;
    for (const Vec3& n : normals)
        if (!(std::fabs(length(n) - first) <= 1e-5f * first)) return false;
    return true;
}

// Are the normals at the corners that of the triangle, or its opposite?
bool asFlat(const Geometry& g, std::span<const uint32_t, 3> corner) noexcept {
    const Vec3d a = cast<double>(g.positions[corner[0]]),
                n = cross(cast<double>(g.positions[corner[1]]) - a, cast<double>(g.positions[corner[2]]) - a);
    const double l = length(n);
    if (!(l > 0)) return false;
    double sides = 0;
    for (const uint32_t c : corner) {
        const Vec3d m = normalize(cast<double>(g.normals[c]));
        const double side = dot(m, n) < 0 ? -1 : 1;
        if (!(lengthSquared(m - n * (side / l)) < 1e-13)) return false;
        sides += side;
    }
    return std::fabs(sides) == 3;
}

struct Code {
    uint32_t x, y;
};
Code octahedral(const Vec3& normal) noexcept {
    const Vec3d n = cast<double>(normal);
    const double s = 1 / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
    double x = n.x * s, y = n.y * s;
    if (n.z < 0) {
        const double fx = std::copysign(1 - std::fabs(y), x), fy = std::copysign(1 - std::fabs(x), y);
        x = fx, y = fy;
    }
    const auto step = [](double v) { return uint32_t(std::lround((v + 1) / 2 * double(WideSurfaces::normalSteps))); };
    return {step(x), step(y)};
}
void encode(const Vec3& n0, const Vec3& n1, const Vec3& n2, uint32_t (&to)[5]) noexcept {
    const Code a = octahedral(n0), b = octahedral(n1), c = octahedral(n2);
    to[0] = a.x | c.x << 24;
    to[1] = a.y | (c.x >> 8) << 24;
    to[2] = b.x | (c.x >> 16) << 24;
    to[3] = b.y;
    to[4] = c.y;
}

} // namespace

const Accel& WideSurfaces::hierarchy(const Scene& scene) noexcept { return *scene.accel_; }

WideSurfaces::WideSurfaces(const Scene& scene, const Executor* run) : moves_(!scene.motions_.empty()) {
    std::vector<uint8_t> shines(scene.geometries_.size(), 0); // under an instance
    for (const Instance& in : scene.instances_) {
        WideInstance w{};
        for (int i = 0; i < 12; ++i) w.toWorld[i] = in.toWorld.m[i / 4][i % 4];
        w.side = in.flipped ? -1.f : 1.f;
        w.moves = in.motion == Hit::none ? 0.f : 1.f;
        instances_.push_back(w);
        for (uint32_t k = 0; k < in.geometryCount; ++k)
            if (in.firstLights[k] != Lights::none) shines[in.firstGeometry + k] = 1;
    }
    std::size_t total = 0;
    for (const Geometry& g : scene.geometries_) {
        moves_ |= g.deforms();
        const bool known = g.colors.empty() && !g.deforms() && alike(g.normals);
        firsts_.push_back(known ? uint32_t(total) : none);
        if (known) total += g.triangles();
    }
    triangles_.resize(std::max<std::size_t>(total, 1)); // lanes without a hit read the first one
    const std::vector<Block> all = blocks(scene);
    inParallel(run, all.size(), [&](uint64_t b) {
        const std::size_t k = all[b].geometry;
        const Geometry& g = scene.geometries_[k];
        for (uint32_t i = all[b].begin; i < all[b].end; ++i) {
            WideTriangle& t = triangles_[firsts_[k] + i];
            const auto corner = g.triangle(i);
            const auto put = [](float(&to)[3], const Vec3& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; };
            put(t.a, g.positions[corner[0]]);
            put(t.b, g.positions[corner[1]]);
            put(t.c, g.positions[corner[2]]);
            const bool smooth = !g.normals.empty() && !asFlat(g, corner);
            t.material = g.material | (smooth ? smoothBit : 0u);
            t.light = shines[k] ? askLight : g.firstLight == Lights::none ? none : g.firstLight + i;
            if (smooth) encode(g.normals[corner[0]], g.normals[corner[1]], g.normals[corner[2]], t.normals);
        }
    });
}

std::vector<WideSurfaces::Block> WideSurfaces::blocks(const Scene& scene) const {
    constexpr uint32_t most = 16384;
    std::vector<Block> all;
    for (std::size_t k = 0; k < scene.geometries_.size(); ++k) {
        const uint32_t count = firsts_[k] == none ? 0 : scene.geometries_[k].triangles();
        for (uint32_t begin = 0; begin < count; begin += std::min(most, count - begin))
            all.push_back({k, begin, begin + std::min(most, count - begin)});
    }
    return all;
}

} // namespace chiaro
