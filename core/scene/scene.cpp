#include "core/scene/scene.h"
#include "core/render/fault.h"
#include "core/scene/accel.h"
#include "core/scene/surface_math.h"

namespace chiaro {
namespace {

template <class T> T interpolate(const std::vector<T>& values, std::span<const uint32_t, 3> i, float u, float v) noexcept {
    const T &a = values[i[0]], &b = values[i[1]], &c = values[i[2]];
    const float w = 1 - u - v;
    if constexpr (requires { a.w; })
        return {a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v, a.z * w + b.z * u + c.z * v, a.w * w + b.w * u + c.w * v};
    else if constexpr (requires { a.z; })
        return a * w + b * u + c * v;
    else
        return {a.x * w + b.x * u + c.x * v, a.y * w + b.y * u + c.y * v};
}

// A triangle of a geometry at a time: its corners, what is interpolated on it there, and the largest coordinate that went into it.
struct Shape {
    Vec3 a, b, c, ns;
    Vec4 tangent;
    float reach = 0;
};

template <class T> T blend(const T& a, const T& b, float f) noexcept {
    if constexpr (requires { a.w; })
        return {a.x * (1 - f) + b.x * f, a.y * (1 - f) + b.y * f, a.z * (1 - f) + b.z * f, a.w * (1 - f) + b.w * f};
    else
        return a * (1 - f) + b * f;
}

// Which two shapes a time lies between, and how far along: counted as Embree counts.
struct Moment {
    std::size_t step = 0;
    float share = 0;
};
Moment momentOf(const Geometry& g, float shutterShare) noexcept {
    const float place = shutterShare * float(g.steps.size());
    const std::size_t step = std::min(std::size_t(place), g.steps.size() - 1);
    return {step, place - float(step)};
}

[[gnu::noinline]] Shape deformed(const Geometry& g, std::span<const uint32_t, 3> i, float u, float v, float shutterShare) noexcept {
    const auto [step, f] = momentOf(g, shutterShare);
    const std::vector<Vec3>&p = g.positionsAt(step), &q = g.positionsAt(step + 1);
    Shape s{blend(p[i[0]], q[i[0]], f), blend(p[i[1]], q[i[1]], f), blend(p[i[2]], q[i[2]], f), {}, {}, 0};
    for (int k = 0; k < 3; ++k) s.reach = max(s.reach, max(maxAbs(p[i[k]]), maxAbs(q[i[k]])));
    if (!g.normals.empty()) s.ns = blend(interpolate(g.normalsAt(step), i, u, v), interpolate(g.normalsAt(step + 1), i, u, v), f);
    if (!g.tangents.empty()) s.tangent = blend(interpolate(g.tangentsAt(step), i, u, v), interpolate(g.tangentsAt(step + 1), i, u, v), f);
    return s;
}
// The bound of what blending two shapes adds to a position, as a share of its reach: three roundings here and three in Embree.
constexpr float blendSlack = 8 * 0x1p-24f;

// Partial derivatives of the position by (u, v) from one triangle's corners.
void derivatives(const Vec3& e1, const Vec3& e2, Point2 a, Point2 b, Point2 c, Vec3& dpdu, Vec3& dpdv) noexcept {
    const float du1 = b.x - a.x, dv1 = b.y - a.y, du2 = c.x - a.x, dv2 = c.y - a.y, det = du1 * dv2 - dv1 * du2;
    if (det == 0 || !std::isfinite(1 / det)) return;
    dpdu = (e1 * dv2 - e2 * dv1) * (1 / det);
    dpdv = (e2 * du1 - e1 * du2) * (1 / det);
}

} // namespace

Vec3 SurfacePoint::offset(const Vec3& w) const noexcept {
    const float reach = reachOf(ng, error);
    return p + ng * (dot(w, ng) < 0 ? -reach : reach);
}

Ray SurfacePoint::towards(const Vec3& wi) const noexcept { return {offset(wi), 0, wi, infinity, time}; }

Ray SurfacePoint::to(const SurfacePoint& other) const noexcept {
    const Vec3 way = other.p - p, from = offset(way), d = other.offset(-way) - from;
    const float distance = length(d);
    return {from, 0, distance > 0 ? d * (1 / distance) : ng, distance * (fault(Fault::shadowRayShort) ? 0.9f : 1 - 0x1p-20f), time};
}

Scene::Scene() = default;
Scene::~Scene() = default;

Hit Scene::intersect(const Ray& r) const noexcept { return accel_->intersect(r); }
void Scene::intersect(std::span<const Ray> r, std::span<Hit> h, bool coherent) const noexcept { accel_->intersect(r, h, coherent); }
Hit Scene::firstSurface(const Ray& r) const noexcept { return accel_->firstSurface(r); }
void Scene::intersect(const RayPacket& r, std::span<Hit> h, bool coherent) const noexcept { accel_->intersect(r, h, coherent); }
void Scene::intersect(const RayPacket& r, HitPacket& h, uint32_t n, bool coherent) const noexcept { accel_->intersect(r, h, n, coherent); }
uint32_t Scene::occluded(const RayPacket& r, uint32_t n) const noexcept { return accel_->occluded(r, n); }
bool Scene::occluded(const Ray& r) const noexcept { return accel_->occluded(r); }
void Scene::occluded(std::span<const Ray> r, std::span<uint8_t> a) const noexcept { accel_->occluded(r, a); }
void Scene::occluded(const RayPacket& r, std::span<uint8_t> a) const noexcept { accel_->occluded(r, a); }

SurfacePoint Scene::attributes(const Hit& hit) const noexcept {
    const Geometry& g = geometries_[hit.geometry];
    const auto i = g.triangle(hit.triangle);
    SurfacePoint s;
    s.material = g.material;
    s.geometry = hit.geometry, s.triangle = hit.triangle, s.instance = hit.instance;
    if (g.uvEnd > 0)
        for (int k = 0; k < uvSets; ++k)
            if (!g.uv[k].empty()) s.uv[k] = interpolate(g.uv[k], i, hit.u, hit.v);
    if (!g.colors.empty()) s.color = interpolate(g.colors, i, hit.u, hit.v);
    const uint32_t first = hit.instance == Hit::none
                               ? g.firstLight
                               : instances_[hit.instance].firstLights[hit.geometry - instances_[hit.instance].firstGeometry];
    if (first != Lights::none) s.light = first + hit.triangle;
    return s;
}

SurfacePoint Scene::point(const Hit& hit, const Ray& ray) const noexcept {
    const Geometry& g = geometries_[hit.geometry];
    const auto i = g.triangle(hit.triangle);
    SurfacePoint s = attributes(hit);
    s.time = ray.time;
    const bool smooth = !g.normals.empty(), framed = g.frameSet != Geometry::noFrame;
    Vec3 a, b, c;
    Vec4 tangent;
    float reach;
    if (g.deforms()) [[unlikely]] {
        const Shape t = deformed(g, i, hit.u, hit.v, clock_.share(ray.time));
        a = t.a, b = t.b, c = t.c, s.ns = t.ns, tangent = t.tangent, reach = t.reach;
    } else {
        a = g.positions[i[0]], b = g.positions[i[1]], c = g.positions[i[2]];
        reach = max(maxAbs(a), max(maxAbs(b), maxAbs(c)));
        if (smooth) s.ns = interpolate(g.normals, i, hit.u, hit.v);
        if (framed && !g.tangents.empty()) tangent = interpolate(g.tangents, i, hit.u, hit.v);
    }
    Vec3 e1 = b - a, e2 = c - a;
    s.p = a + e1 * hit.u + e2 * hit.v;
    s.ng = cross(e1, e2);
    if (framed && !g.tangents.empty()) {
        s.tangent = {tangent.x, tangent.y, tangent.z};
        s.tangentSign = tangent.w < 0 ? -1.f : 1.f;
    } else if (framed && !g.uv[g.frameSet].empty()) {
        const auto& uv = g.uv[g.frameSet];
        derivatives(e1, e2, uv[i[0]], uv[i[1]], uv[i[2]], s.dpdu, s.dpdv);
    }
    float interpolated = g.deforms() ? blendSlack * reach : 0;
    if (hit.instance != Hit::none) {
        const Instance& in = instances_[hit.instance];
        const Motion* motion = in.motion == Hit::none ? nullptr : &motions_[in.motion];
        const AffineT<float> toWorld = motion ? motion->at(ray.time) : in.toWorld;
        const float side = in.flipped ? -1.f : 1.f;
        s.p = toWorld.point(s.p);
        s.ng = toWorld.normal(s.ng) * side;
        if (smooth) s.ns = toWorld.normal(s.ns) * side;
        s.tangent = toWorld.vector(s.tangent);
        s.tangentSign *= side;
        s.dpdu = toWorld.vector(s.dpdu);
        s.dpdv = toWorld.vector(s.dpdv);
        e1 = toWorld.vector(e1);
        e2 = toWorld.vector(e2);
        float world = 0, turned = 0;
        for (const auto& row : toWorld.m) {
            const float stretched = (std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2])) * reach;
            world = max(world, stretched + std::fabs(row[3]));
            turned = max(turned, stretched);
        }
        reach = world;
        interpolated = (motion ? motion->slack() * turned + gamma8 * world : 0) + (g.deforms() ? blendSlack * turned : 0);
    }
    s.error = gamma8 * reach + interpolated;
    s.p = inset(s.p, e1, e2, heightOf(e1, e2, length(s.ng)), hit.u, hit.v, s.error);
    s.ng = unitOr(s.ng, Vec3{0, 0, 1});
    s.ns = smooth ? unitOr(s.ns, s.ng) : s.ng;
    if (dot(s.ns, s.ng) < 0) s.ns = -s.ns;
    return s;
}

std::array<Vec3, 3> Scene::localCorners(uint32_t geometry, uint32_t triangle, float time) const noexcept {
    const Geometry& g = geometries_[geometry];
    const auto i = g.triangle(triangle);
    if (!g.deforms()) return {g.positions[i[0]], g.positions[i[1]], g.positions[i[2]]};
    const Shape s = deformed(g, i, 0, 0, clock_.share(time));
    return {s.a, s.b, s.c};
}

std::array<Vec3, 3> Scene::corners(const DrawnPart& part, uint32_t triangle, float time) const noexcept {
    std::array<Vec3, 3> at = localCorners(part.geometry, triangle, time);
    if (part.instance == Hit::none) return at;
    const Instance& in = instances_[part.instance];
    const AffineT<float> toWorld = in.motion == Hit::none ? in.toWorld : motions_[in.motion].at(time);
    for (Vec3& p : at) p = toWorld.point(p);
    return at;
}

bool Scene::moves(const DrawnPart& part) const noexcept {
    return geometries_[part.geometry].deforms() || (part.instance != Hit::none && instances_[part.instance].motion != Hit::none);
}

std::array<uint32_t, 3> Scene::vertices(const DrawnPart& part, uint32_t triangle) const noexcept {
    const auto i = geometries_[part.geometry].triangle(triangle);
    return {i[0], i[1], i[2]};
}

Vec4 Scene::sample(const TextureSlot& slot, const SurfacePoint& s, Transfer transfer) const noexcept {
    if (slot.texture < 0) return {1, 1, 1, 1};
    return textures_.lookup(slot.texture, apply(slot.transform, s.uv[slot.uvSet]), transfer);
}

float Scene::opacity(const SurfacePoint& s) const noexcept {
    const MaterialDesc& m = materials_[s.material];
    if (m.alphaMode == AlphaMode::opaque) return 1;
    const float alpha = m.alpha * s.color.w * sample(m.baseColorTexture, s, Transfer::srgb).w;
    if (m.alphaMode == AlphaMode::mask)
        return alpha > m.alphaCutoff || (alpha == m.alphaCutoff && !fault(Fault::alphaCutoffOpen)) ? 1.f : 0.f;
    return clamp01(fault(Fault::blendTwice) ? alpha * alpha : alpha);
}

} // namespace chiaro
