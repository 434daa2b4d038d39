// Particles leave their lights: position and direction of every kind, drawn so that as little as possible is left in the flux.
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/lights.h"
#include "core/scene/scene.h"

namespace chiaro {
namespace {

// Parallel light crosses the sphere of the scene through a disc: pdfA = 1 / (pi R^2).
float discPdfA(float radius) noexcept { return concentricDiskPdfA<float>() / sqr(radius); }
Ray acrossScene(const Vec3& direction, float radius, Point2 u, float time) noexcept {
    const Frame frame = Frame::about(direction);
    const Point2 d = concentricDisk(u);
    // A little before the sphere: its surface may be that of the scene.
    return {frame.x * (d.x * radius) + frame.y * (d.y * radius) - direction * (radius * 1.01f), 0, direction, infinity, time};
}

// Directions of a spot in proportion to its intensity, s^2 with s = clamp(cos scale + offset) (KHR_lights_punctual). Over the cosine the
// plateau weighs 1 - c1, the ramp 1 / (3 scale) times the cube of its highest s: both are inverted in closed form.
struct SpotDirection {
    float cosine = 1, s = 1;
    float pdfW = 0; // s^2 / (2 pi total)
    float total = 0;
};
SpotDirection sampleSpot(double scale, double offset, double u) noexcept {
    const double plateauFrom = (1 - offset) / scale, top = std::min(1.0, scale + offset);
    const double ramp = top * top * top / (3 * scale), plateau = std::max(0.0, 1 - plateauFrom), total = ramp + plateau, at = u * total;
    const double s = at < ramp ? std::cbrt(3 * scale * at) : 1;
    const double cosine = at < ramp ? (s - offset) / scale : plateauFrom + (at - ramp);
    return {float(std::clamp(cosine, -1.0, 1.0)), float(s), float(s * s / (2 * std::numbers::pi * total)), float(total)};
}

} // namespace

std::optional<LightEmission> Lights::emit(const PickAndPoint& uFrom, const PickAndPoint& uTowards, float time) const noexcept {
    const double edge = double(pickEnvironment_);
    std::optional<LightEmission> e;
    if (uFrom.pick < edge) {
        e = emitEnvironment(uFrom.u, uTowards, time);
        if (e) e->pmf = pickEnvironment_;
    } else {
        if (finite_.empty()) return {};
        const Choice c = finite_.choose((uFrom.pick - edge) / (1 - edge), uFrom.u.x);
        const Point2 point{c.u, uFrom.u.y};
        if (c.index < triangles_.size())
            e = emitTriangle(placed(triangles_[c.index], time), point, uTowards, time);
        else
            e = emitPunctual(punctual_[c.index - triangles_.size()], point, uTowards, time);
        if (!e) return {};
        e->pmf = (1 - pickEnvironment_) * c.pmf;
        e->light = c.index;
    }
    if (!e || black(e->flux)) return {};
    e->flux *= (fault(Fault::emittedFluxBias) ? 1.01f : 1.f) / e->pmf;
    return e;
}

// A uniform point and a direction by the cosine: Le cos / (pdfA pdfW) = Le pi area. A cut-out shines as much as it covers.
std::optional<LightEmission> Lights::emitTriangle(const Triangle& t, Point2 point, const PickAndPoint& uTowards,
                                                  float time) const noexcept {
    const Point2 b = uniformTriangle(point);
    const bool back = t.doubleSided && uTowards.pick >= 0.5;
    const SurfacePoint look = scene_->attributes({t.geometry, t.triangle, t.instance, b.x, b.y, 0});
    SurfacePoint at;
    at.p = t.p + t.e1 * b.x + t.e2 * b.y;
    at.ng = t.ng;
    at.error = t.error;
    at.time = time;
    const Vec3 w = cosineHemisphere(uTowards.u);
    if (!(w.z > 0) || !(t.area > 0)) return {};
    LightEmission e;
    e.ray = at.towards(Frame::about(back ? -t.ng : t.ng).toWorld(w));
    e.cosine = w.z;
    e.pdfA = 1 / t.area;
    e.pdfW = cosineHemispherePdfW(w.z) * (t.doubleSided ? 0.5f : 1.f);
    e.flux = emission(look) * (scene_->opacity(look) * pi * t.area * (t.doubleSided ? 2.f : 1.f));
    return e;
}

// A range lets light fade as 1 - (d / range)^4: so many of the particles end there.
LightEmission Lights::emitPunctual(const Punctual& l, Point2 point, const PickAndPoint& uTowards, float time) const noexcept {
    const Place place = placeOf(l, time);
    LightEmission e;
    e.kind = LightKind::delta;
    e.pdfA = e.pdfW = 1;
    if (l.kind == PunctualKind::directional) {
        e.ray = acrossScene(place.axis, scene_->radius(), point, time);
        e.pdfA = discPdfA(scene_->radius());
        e.flux = l.intensity * (1 / e.pdfA);
        return e;
    }
    const float reach = l.range > 0 ? l.range * std::sqrt(std::sqrt(float(uTowards.pick))) : infinity;
    if (l.kind == PunctualKind::point) {
        e.ray = {place.p, 0, uniformSphere(uTowards.u), reach, time};
        e.pdfW = uniformSpherePdfW<float>();
        e.flux = l.intensity * (4 * pi);
        return e;
    }
    const SpotDirection d = sampleSpot(double(l.scale), double(l.offset), double(uTowards.u.x));
    const float sine = safeSqrt((1 - d.cosine) * (1 + d.cosine)), phi = 2 * pi * uTowards.u.y;
    e.ray = {place.p, 0, Frame::about(place.axis).toWorld({sine * std::cos(phi), sine * std::sin(phi), d.cosine}), reach, time};
    e.pdfW = d.pdfW;
    e.flux = l.intensity * (2 * pi * d.total);
    return e;
}

std::optional<LightEmission> Lights::emitEnvironment(Point2 point, const PickAndPoint& uTowards, float time) const noexcept {
    SurfacePoint middle; // the sky is equally far from everywhere
    middle.time = time;
    const std::optional<LightSample> sky = sampleEnvironment(middle, uTowards.pick, uTowards.u);
    if (!sky) return {};
    LightEmission e;
    e.kind = LightKind::environment;
    e.light = sky->light;
    e.ray = acrossScene(-sky->wi, scene_->radius(), point, time);
    e.pdfA = discPdfA(scene_->radius());
    e.pdfW = sky->pdfW;
    e.flux = sky->radiance * (1 / (e.pdfA * e.pdfW));
    return e;
}

EmissionPdf Lights::emissionPdf(const SurfacePoint& emitter, const Vec3& wo, const SurfacePoint* to) const noexcept {
    if (emitter.light == none) return {};
    const Triangle t = placed(triangles_[emitter.light], emitter.time);
    const float cosine = dot(wo, t.ng);
    if (!(t.area > 0) || cosine == 0 || (cosine < 0 && !t.doubleSided)) return {};
    EmissionPdf d;
    d.pmf = pmf(emitter.light);
    d.pdfA = 1 / t.area;
    d.pdfW = cosineHemispherePdfW(std::fabs(cosine)) * (t.doubleSided ? 0.5f : 1.f);
    if (to) d.pdfDirectW = pmf(emitter.light, *to) * areaToSolidAngle(d.pdfA, lengthSquared(emitter.p - to->p), cosine);
    return d;
}

EmissionPdf Lights::emissionPdf(const Ray& ray, const SurfacePoint* from) const noexcept {
    if (!environment_) return {};
    EmissionPdf d;
    d.pmf = pickEnvironment_;
    d.pdfA = discPdfA(scene_->radius());
    d.pdfW = environment_->at(ray.d).w;
    if (from) d.pdfDirectW = d.pmf * d.pdfW;
    return d;
}

} // namespace chiaro
