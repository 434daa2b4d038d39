#include "core/scene/lights.h"
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/scene.h"

namespace chiaro {

uint32_t Lights::count() const noexcept { return uint32_t(triangles_.size() + punctual_.size()) + (environment_ ? 1 : 0); }

float Lights::pmf(uint32_t light) const noexcept {
    if (light >= triangles_.size() + punctual_.size()) return pickEnvironment_;
    return finite_.empty() ? 0 : (1 - pickEnvironment_) * finite_.pmf(light);
}

std::optional<LightSample> Lights::sampleTowards(const SurfacePoint& from, double uPick, Point2 u) const noexcept {
    const double edge = double(pickEnvironment_);
    std::optional<LightSample> s;
    float pmf = 0;
    if (uPick < edge) {
        pmf = pickEnvironment_;
        s = sampleEnvironment(from, uPick / edge, u);
    } else {
        const Choice c = choose(from, (uPick - edge) / (1 - edge), u.x);
        if (c.pmf == 0) return {};
        pmf = (1 - pickEnvironment_) * c.pmf;
        s = sampleOne(c.index, from, 0, {c.u, u.y});
    }
    if (s && !fault(Fault::lightChoiceForgotten)) s->pdfW *= pmf;
    return s;
}

std::optional<LightSample> Lights::sampleOne(uint32_t light, const SurfacePoint& from, double uPick, Point2 u) const noexcept {
    std::optional<LightSample> s;
    if (light < triangles_.size()) {
        const Triangle& t = triangles_[light];
        s = t.motion == none ? sampleTriangle(t, from, u) : sampleTriangle(placed(t, from.time), from, u);
    } else if (light - triangles_.size() < punctual_.size()) {
        s = samplePunctual(punctual_[light - triangles_.size()], from);
    } else {
        s = sampleEnvironment(from, uPick, u);
    }
    if (s) s->light = light;
    return s;
}

Lights::Triangle Lights::placed(const Triangle& t, float time) const noexcept {
    if (t.motion == none) return t;
    const Motion& motion = scene_->motion(t.motion);
    const AffineT<float> m = motion.at(time);
    const auto [p, q, r] = scene_->localCorners(t.geometry, t.triangle, time);
    Triangle w = t;
    w.p = m.point(p);
    w.e1 = m.vector(q - p);
    w.e2 = m.vector(r - p);
    const Vec3 n = m.normal(cross(q - p, r - p));
    const float twice = length(n);
    w.area = twice / 2;
    w.ng = twice > 0 ? n * ((m.determinant() < 0 ? -1.f : 1.f) / twice) : Vec3{0, 0, 1};
    const Vec3 b = w.p + w.e1, c = w.p + w.e2;
    const float reach = max(maxAbs(w.p), max(maxAbs(b), maxAbs(c)));
    w.error = 8 * 0x1p-23f * reach + motion.slack() * (reach + max(std::fabs(m.m[0][3]), max(std::fabs(m.m[1][3]), std::fabs(m.m[2][3]))));
    w.motion = none;
    return w;
}

Lights::Place Lights::placeOf(const Punctual& l, float time) const noexcept {
    if (l.motion == none) return {l.p, l.axis};
    const AffineT<float> m = scene_->motion(l.motion).at(time);
    return {m.point(Vec3{}), normalize(m.vector(Vec3{0, 0, -1}))};
}

std::optional<LightSample> Lights::sampleTriangle(const Triangle& t, const SurfacePoint& from, Point2 u) const noexcept {
    const Point2 b = uniformTriangle(u);
    SurfacePoint at;
    at.p = t.p + t.e1 * b.x + t.e2 * b.y;
    at.ng = t.ng;
    at.error = t.error;
    const Vec3 way = at.p - from.p;
    const float distanceSquared = lengthSquared(way);
    if (!(distanceSquared > 0)) return {};
    LightSample s;
    s.wi = way * (1 / std::sqrt(distanceSquared));
    const float cosine = -dot(s.wi, t.ng);
    if (cosine == 0 || (cosine < 0 && !t.doubleSided)) return {};
    const MaterialDesc& m = scene_->material(t.material);
    float opacity = 1;
    if (!m.unlit && m.emissionTexture.texture < 0 && m.alphaMode == AlphaMode::opaque) { // the same everywhere
        s.radiance = m.emission;
    } else {
        const SurfacePoint look = scene_->attributes({t.geometry, t.triangle, t.instance, b.x, b.y, 0});
        s.radiance = emission(look);
        opacity = scene_->opacity(look);
    }
    s.radiance *= opacity * (fault(Fault::lightPowerBias) ? 1.01f : 1.f);
    if (black(s.radiance)) return {};
    s.pdfW = areaToSolidAngle(1 / t.area, distanceSquared, cosine);
    s.shadow = from.to(at);
    return s;
}

std::optional<LightSample> Lights::samplePunctual(const Punctual& l, const SurfacePoint& from) const noexcept {
    LightSample s;
    s.delta = true;
    s.kind = LightKind::delta;
    s.pdfW = 1;
    const Place place = placeOf(l, from.time);
    if (l.kind == PunctualKind::directional) {
        s.wi = -place.axis;
        s.radiance = l.intensity;
        s.shadow = from.towards(s.wi);
        return s;
    }
    const Vec3 way = place.p - from.p;
    const float distanceSquared = lengthSquared(way);
    if (!(distanceSquared > 0)) return {};
    s.wi = way * (1 / std::sqrt(distanceSquared));
    float attenuation = 1 / distanceSquared;
    if (l.range > 0) attenuation *= clamp01(1 - sqr(distanceSquared / sqr(l.range))); // KHR_lights_punctual: 1 - (d / range)^4
    if (l.kind == PunctualKind::spot) attenuation *= sqr(clamp01(-dot(s.wi, place.axis) * l.scale + l.offset));
    s.radiance = l.intensity * attenuation;
    if (black(s.radiance)) return {};
    const Vec3 origin = from.offset(s.wi), d = place.p - origin;
    const float distance = length(d);
    s.shadow = {origin, 0, d * (1 / distance), distance, from.time};
    return s;
}

std::optional<LightSample> Lights::sampleEnvironment(const SurfacePoint& from, double uCell, Point2 u) const noexcept {
    const auto sky = environment_->sample(uCell, u);
    if (!sky) return {};
    return LightSample{sky->radiance, sky->wi, from.towards(sky->wi), sky->pdfW, false, LightKind::environment, count() - 1};
}

Spectrum Lights::emission(const SurfacePoint& at) const noexcept {
    const MaterialDesc& m = scene_->material(at.material);
    if (!m.unlit) {
        const Vec4 t = scene_->sample(m.emissionTexture, at, Transfer::srgb);
        return m.emission * Spectrum(t.x, t.y, t.z);
    }
    const Vec4 t = scene_->sample(m.baseColorTexture, at, Transfer::srgb);
    return m.baseColor * Spectrum(t.x * at.color.x, t.y * at.color.y, t.z * at.color.z);
}

LightHit Lights::hit(const SurfacePoint& at, const Vec3& wo, const SurfacePoint* from) const noexcept {
    if (at.light == none) return {};
    const Triangle& t = triangles_[at.light];
    if (t.motion != none) {
        const Triangle moved = placed(t, at.time);
        return found(at, wo, from, moved.ng, moved.area);
    }
    return found(at, wo, from, t.ng, t.area);
}

LightHit Lights::found(const SurfacePoint& at, const Vec3& wo, const SurfacePoint* from, const Vec3& ng, float area) const noexcept {
    const Triangle& t = triangles_[at.light];
    const float cosine = dot(wo, ng);
    if (cosine == 0 || (cosine < 0 && !t.doubleSided)) return {};
    LightHit h;
    h.radiance = emission(at);
    if (from && area > 0) h.pdfW = pmf(at.light, *from) * areaToSolidAngle(1 / area, lengthSquared(at.p - from->p), cosine);
    if (fault(Fault::misOtherMeasure)) h.pdfW = from ? pmf(at.light, *from) / area : 0;
    return h;
}

LightHit Lights::miss(const Ray& ray, const SurfacePoint* from) const noexcept {
    if (!environment_) return {};
    const Vec4 sky = environment_->at(ray.d);
    return {{sky.x, sky.y, sky.z}, from ? pickEnvironment_ * sky.w : 0, LightKind::environment};
}

} // namespace chiaro
