#include "integrators/local_light.h"
#include "core/scene/surface_math.h"
#include <algorithm>

namespace chiaro {
namespace {

constexpr int mostOwnTriangles = 64; // of a bulb, between a point and the centre

bool flat(const Lamp& lamp) noexcept { return lengthSquared(lamp.normal) > 0; }
bool bulb(const Lamp& lamp) noexcept { return lamp.kind == LightKind::area && !flat(lamp); }

} // namespace

Attenuation Attenuation::from(const Options& o) {
    return {o.text("attenuation") == "physical", float(o.real("c1")), float(o.real("c2")), float(o.real("c3"))};
}

LocalLights::LocalLights(const Scene& scene, const Attenuation& attenuation)
    : scene_(&scene), lamps_(scene.lights().lamps()), attenuation_(attenuation), margin_(64 * 0x1p-23f * scene.radius()) {
    moves_ = scene.shutter().close > scene.shutter().open;
    std::erase_if(lamps_, [](const Lamp& l) { return black(l.intensity); });
    for (const Lamp& l : lamps_)
        meshes_.push_back({l.centre, l.normal, flat(l), l.doubleSided, fault(Fault::lampShadowsItself) ? -margin_ : margin_, attenuation_});
}

std::optional<LightSample> LocalLights::towards(uint32_t i, const SurfacePoint& from) const noexcept {
    return lamps_[i].kind == LightKind::area ? fromMesh(i, from) : fromPunctual(lamps_[i], from);
}

std::optional<LightSample> LocalLights::fromMesh(uint32_t i, const SurfacePoint& from) const noexcept {
    const MeshLamp& m = meshes_[i];
    const float reach = reachOf(from.ng, from.error);
    const LampWay w = attenuation_.physical
                          ? m.flat ? m.way<true, true>(from.p, from.ng, reach) : m.way<true, false>(from.p, from.ng, reach)
                      : m.flat ? m.way<false, true>(from.p, from.ng, reach)
                               : m.way<false, false>(from.p, from.ng, reach);
    if (!w.arrives) return {};
    std::optional<LightSample> answer(std::in_place);
    answer->wi = w.wi;
    answer->radiance = lamps_[i].intensity * w.factor;
    answer->pdfW = 1;
    answer->delta = true;
    answer->light = lamps_[i].first;
    answer->shadow = {w.start, 0, w.d, w.left, from.time};
    return answer;
}

std::optional<LightSample> LocalLights::fromPunctual(const Lamp& lamp, const SurfacePoint& from) const noexcept {
    std::optional<LightSample> s = scene_->lights().sampleOne(lamp.first, from, 0, {});
    if (s && !attenuation_.physical && std::isfinite(s->shadow.tfar)) {
        const float distance = s->shadow.tfar;
        s->radiance *= distance * distance * attenuation_.at(distance);
    }
    return s;
}

bool LocalLights::own(uint32_t i, const Hit& hit) const noexcept {
    return scene_->attributes(hit).light - lamps_[i].first < lamps_[i].count;
}

bool LocalLights::onlyAtItsEnd(uint32_t i) const noexcept { return !bulb(lamps_[i]) && !(moves_ && lamps_[i].kind == LightKind::area); }

void LocalLights::occluded(uint32_t i, const RayPacket& rays, std::span<uint8_t> answers) const noexcept {
    if (onlyAtItsEnd(i)) return scene_->occluded(rays, answers);
    for (std::size_t k = 0; k < answers.size(); ++k)
        if (rays.tfar[k] >= 0) answers[k] = hidden(i, rays.ray(k));
}

void LocalLights::occluded(uint32_t i, std::span<const Ray> rays, std::span<uint8_t> answers) const noexcept {
    if (onlyAtItsEnd(i)) return scene_->occluded(rays, answers);
    for (std::size_t k = 0; k < rays.size(); ++k) answers[k] = hidden(i, rays[k]);
}

bool LocalLights::hidden(uint32_t i, Ray ray) const noexcept {
    for (int step = 0; step < mostOwnTriangles; ++step) {
        Hit hit;
        scene_->intersect({&ray, 1}, {&hit, 1}, false);
        if (!hit) return false;
        if (!own(i, hit) || fault(Fault::lampShadowsItself)) return true;
        const SurfacePoint at = scene_->point(hit, ray);
        const float left = ray.tfar - hit.t;
        ray = at.towards(ray.d);
        ray.tfar = std::max(left, 0.f);
    }
    return true;
}

} // namespace chiaro
