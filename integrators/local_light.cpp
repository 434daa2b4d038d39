#include "integrators/local_light.h"
#include "core/render/fault.h"
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
}

std::optional<LightSample> LocalLights::towards(uint32_t i, const SurfacePoint& from) const noexcept {
    const Lamp& lamp = lamps_[i];
    return lamp.kind == LightKind::area ? fromMesh(lamp, from) : fromPunctual(lamp, from);
}

std::optional<LightSample> LocalLights::fromMesh(const Lamp& lamp, const SurfacePoint& from) const noexcept {
    const Vec3 way = lamp.centre - from.p;
    const float distanceSquared = lengthSquared(way), distance = std::sqrt(distanceSquared);
    if (!(distance > 0)) return {};
    std::optional<LightSample> answer(std::in_place);
    LightSample& s = *answer;
    s.wi = way * (1 / distance);
    float factor = attenuation_.physical ? 1 / distanceSquared : attenuation_.at(distance);
    if (flat(lamp)) {
        const float cosine = -dot(s.wi, lamp.normal);
        factor *= lamp.doubleSided ? std::fabs(cosine) : cosine;
        if (!(factor > 0)) return {};
    }
    s.radiance = lamp.intensity * factor;
    s.pdfW = 1;
    s.delta = true;
    s.light = lamp.first;
    // The end lies a rounding bound before the lamp, the start one before the surface.
    const Vec3 facing = flat(lamp) && dot(s.wi, lamp.normal) > 0 ? -lamp.normal : flat(lamp) ? lamp.normal : -s.wi;
    const Vec3 start = from.offset(way), end = lamp.centre + facing * (fault(Fault::lampShadowsItself) ? -margin_ : margin_);
    const Vec3 d = end - start;
    const float left = length(d);
    s.shadow = {start, 0, left > 0 ? d * (1 / left) : s.wi, left, from.time};
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

void LocalLights::occluded(uint32_t i, std::span<const Ray> rays, std::span<uint8_t> answers) const noexcept {
    const bool onlyAtItsEnd = !bulb(lamps_[i]) && !(moves_ && lamps_[i].kind == LightKind::area);
    if (onlyAtItsEnd) return scene_->occluded(rays, answers);
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
