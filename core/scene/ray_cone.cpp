#include "core/scene/ray_cone.h"
#include "core/scene/accel.h"
#include "core/scene/scene.h"

namespace chiaro {

// Of one that mirrors or refracts, curvature turns the edges of the cone (paraxial optics: Hecht, Optics, 2002, section 5.2).
Footprint scattered(const Scene& scene, const SurfacePoint& at, const Footprint& here, const Vec3& wo, const Vec3& wi, bool delta,
                    float pdfW) noexcept {
    if (here.width == 0 && here.spread == 0) return here;
    if (!delta) return {here.width, max(here.spread, lobeSpread(pdfW))};
    const bool outside = dot(wo, at.ng) >= 0, through = (dot(wi, at.ng) >= 0) != outside;
    const MaterialDesc& m = scene.material(at.material);
    if (through && !m.volume) return here;
    const float bend = (outside ? 1.f : -1.f) * scene.curvature(at) * here.width;
    return {here.width, through ? refractedSpread(here.spread, bend, outside ? m.ior : 1 / m.ior) : mirroredSpread(here.spread, bend)};
}

Footprint cone(const Scene& scene, const Footprint& start) noexcept { return scene.textures().filtered() ? start : Footprint{}; }

float meanCurvature(const Vec3 (&p)[3], const Vec3 (&n)[3]) noexcept {
    float sum = 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3 way = p[(i + 1) % 3] - p[i];
        const float l = lengthSquared(way), turned = dot(n[(i + 1) % 3] - n[i], way);
        if (l > 0) sum += turned / l;
    }
    const float side = dot(n[0] + n[1] + n[2], cross(p[1] - p[0], p[2] - p[0]));
    return std::isfinite(sum) ? (side < 0 ? -sum : sum) / 3 : 0;
}

ConeSection Scene::section(const SurfacePoint& s, const Vec3& d, float width) const noexcept {
    if (s.geometry == Hit::none || !(width > 0)) return {};
    const auto corner = corners({s.geometry, s.instance}, s.triangle, s.time);
    return {coneSection(corner[1] - corner[0], corner[2] - corner[0], d, width * footprintShare)};
}

Vec4 Scene::sample(const TextureSlot& slot, const SurfacePoint& s, Transfer transfer, const ConeSection& cone) const noexcept {
    if (slot.texture < 0) return {1, 1, 1, 1};
    const Point2 uv = apply(slot.transform, s.uv[slot.uvSet]);
    if (cone.none() || s.geometry == Hit::none || geometries_[s.geometry].uv[slot.uvSet].empty())
        return textures_.lookup(slot.texture, uv, transfer);
    const Geometry& g = geometries_[s.geometry];
    const auto i = g.triangle(s.triangle);
    const std::vector<Point2>& at = g.uv[slot.uvSet];
    const UvEdges<float> edges(at[i[0]], at[i[1]], at[i[2]]);
    return textures_.lookup(slot.texture, uv, transfer, edges.step(cone.major, slot.transform), edges.step(cone.minor, slot.transform));
}

float Scene::curvature(const SurfacePoint& s) const noexcept {
    if (s.geometry == Hit::none) return 0;
    const Geometry& g = geometries_[s.geometry];
    if (g.normals.empty()) return 0;
    const auto i = g.triangle(s.triangle);
    const Vec3 p[3] = {g.positions[i[0]], g.positions[i[1]], g.positions[i[2]]};
    const Vec3 n[3] = {normalize(g.normals[i[0]]), normalize(g.normals[i[1]]), normalize(g.normals[i[2]])};
    const float here = meanCurvature(p, n);
    return s.instance == Hit::none ? here : here / length(instances_[s.instance].toWorld.vector({1, 0, 0}));
}

} // namespace chiaro
