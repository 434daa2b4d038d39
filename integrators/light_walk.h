// The walk of a particle: from a light, through the scene, scattered as materials scatter importance, until it is absorbed, leaves, or no
// wanted path continues. Light tracing connects it to the camera, photon maps store it; both walk here (Arvo 1986; Jensen 1996; Veach 1997,
// section 5.2 for the adjoint, which lives in Bsdf). A particle carries flux in lumen; Russian roulette keeps its expectation.
#pragma once
#include "core/render/path_log.h"
#include "integrators/transport.h"

namespace chiaro {

// A particle on its arrival at a surface, before it scatters there.
struct Arrival {
    const SurfacePoint& at;
    const SurfacePoint* from = nullptr; // the surface that it left; null: the light
    const Ray& ray;                     // that it came along
    float distance = 0;                 // metres along the ray
    PathState state = 0;                // of the light path so far
    Spectrum flux;                      // lumen, on arrival
    uint32_t depth = 0;                 // scatterings so far
    uint32_t deltas = 0;                // how many of the scatterings, counted from the last one back, were S
    LightKind kind = LightKind::area;
};
// On its way, before what it meets is known to it.
struct Flight {
    const Ray& ray;
    const SurfacePoint* from = nullptr;
    float distance = 0; // to what it meets; infinite: nothing
    PathState state = 0;
    const Spectrum& flux; // where it set out
    bool visible = true;  // false: it comes from a light without extent, which a lens sees neither itself nor in mirrors
};
enum class Onward : uint8_t { any, delta, stop }; // wherever it is scattered; by delta lobes alone; not at all

// Where the flux of one particle went, luminance in lumen: what it set out with is absorbed + escaped + ended, to the rounding of doubles.
// Roulette and the sampling of directions keep the parts on average: a single particle may "absorb" less than nothing.
struct Fate {
    double absorbed = 0; // by surfaces, and by solids on the way
    double escaped = 0;  // left the scene
    double ended = 0;    // by roulette, by the depth limit, because no wanted path goes on, or by the visitor's word
    uint32_t rays = 0;
};

// How a particle begins. The numbers may be bent by whoever aims emission; the sampler goes on to the walk.
struct Departure {
    PickAndPoint from, towards;
    float time = 0;
};
inline Departure departure(const Work& work, Sampler& sampler, const std::optional<float>& time = {}) noexcept {
    Departure d;
    d.from = sampler.get3D();
    d.towards = sampler.get3D();
    const float u = sampler.get1D();
    d.time = time ? *time : work.shutter.open + u * (work.shutter.close - work.shutter.open);
    return d;
}

struct WalkRules {
    uint32_t rouletteDepth = 5; // scatterings before Russian roulette may end a path
    PathLog* log = nullptr;
};

// A particle on its way: what a walk keeps from surface to surface.
struct Particle {
    Ray ray;
    Spectrum flux; // lumen
    Sampler sampler;
    PathState state = 0; // 0: no wanted path goes on
    LightKind kind = LightKind::area;
    bool visible = true;    // as in Flight
    uint32_t depth = 0;     // scatterings so far
    uint32_t deltas = 0;    // as in Arrival
    Spectrum throughput{1}; // of the events so far, for the roulette
    Wavelengths lambda = {};
    static constexpr uint32_t dimensions = 7; // of the sampler, a scattering; as many go into the departure
};
// flux: what it carries at first, of the emission's ray. sampler: behind the departure.
inline Particle departed(const PathClasses& classes, const LightEmission& e, const Spectrum& flux, const Sampler& sampler) noexcept {
    return {.ray = e.ray,
            .flux = flux,
            .sampler = sampler,
            .state = classes.light(e.kind),
            .kind = e.kind,
            .visible = e.kind != LightKind::delta};
}

// The particle has met `hit`. True: it goes on along its ray, from `at`. from: the surface that it left; null: the light. The visitor
// answers
//   Onward arrive(const Arrival&, const Bsdf&, Sampler own)      at every surface where a wanted path can be scattered
// own: for two dimensions, which are the visitor's.
template <class Visitor>
bool scatterParticle(const Work& work, Particle& p, const Hit& hit, const SurfacePoint* from, SurfacePoint& at, const WalkRules& rules,
                     Visitor& visitor, Fate& fate) {
    const Scene& scene = work.scene;
    const PathClasses& classes = work.classes;
    double carried = double(luminance(p.flux));
    const auto leave = [&](double& where, const char* why) {
        where += carried;
        if (rules.log) rules.log->end(why);
        return false;
    };
    // The flux is `to` from here on; what it was more goes to `where`.
    const auto change = [&](double& where, const Spectrum& to) {
        const double now = double(luminance(to));
        where += carried - now;
        carried = now;
    };
    if (!hit) {
        if (rules.log) logSky(*rules.log, scene, p.ray, p.flux);
        fate.escaped += carried;
        return false;
    }
    at = scene.point(hit, p.ray);
    p.flux *= segmentTransmittance(scene, from, p.ray.d, &at, hit.t);
    change(fate.absorbed, p.flux);
    if (rules.log) logSurface(*rules.log, at, at.ns, hit.t, p.flux);
    if (!classes.continues(p.state)) return leave(fate.ended, p.depth >= classes.maxDepth() ? "depth limit" : "no longer path is wanted");
    const Bsdf bsdf = shade(scene, at, -p.ray.d, {}, p.lambda, Transport::importance, Densities::forward);
    const Onward onward =
        visitor.arrive(Arrival{at, from, p.ray, hit.t, p.state, p.flux, p.depth, p.deltas, p.kind}, bsdf, Sampler(p.sampler));
    p.sampler.skip(2);
    if (onward == Onward::stop) return leave(fate.ended, "not followed");
    const PickAndPoint u = p.sampler.get3D();
    const auto sample = bsdf.sample(min(float(u.pick), oneMinusEpsilon), u.u);
    if (!sample) return leave(fate.absorbed, "absorbed");
    change(fate.absorbed, p.flux * sample->weight);
    if (onward == Onward::delta && !sample->delta) return leave(fate.ended, "not followed");
    const Turn next = turn(classes, p.state, bsdf, *sample, p.sampler);
    if (!next.state || black(next.weight)) return leave(fate.ended, next.state ? "absorbed" : "no such path is wanted");
    p.throughput *= next.weight;
    float boost = 1;
    if (p.depth >= rules.rouletteDepth) {
        const float survive = min(maxComponent(p.throughput), 0.95f);
        if (!(p.sampler.get1D() < survive)) return leave(fate.ended, "roulette");
        boost = 1 / survive;
    } else {
        p.sampler.skip(1);
    }
    p.throughput *= boost;
    p.flux *= next.weight * boost;
    change(fate.ended, p.flux);
    p.state = next.state;
    p.visible = p.visible || !sample->delta;
    p.deltas = sample->delta ? p.deltas + 1 : 0;
    p.lambda = sample->after(p.lambda);
    ++p.depth;
    p.ray = at.towards(sample->wi);
    if (rules.log) rules.log->scatter(next.event, next.weight * boost, sample->pdfW, sample->delta);
    return true;
}

// Walks the particle to its end. Beside arrive() the visitor may have
//   void flight(const Flight&)                                   for every ray, before its end is known
template <class Visitor>
Fate walkParticle(const Work& work, const LightEmission& emission, const Spectrum& flux, const Sampler& sampler, const WalkRules& rules,
                  Visitor& visitor) {
    Fate fate;
    Particle p = departed(work.classes, emission, flux, sampler);
    if (rules.log) rules.log->arrive(PathLog::Kind::emission, p.ray.o, 0, flux).light = emission.light;
    if (p.state == 0) {
        fate.ended = double(luminance(flux));
        if (rules.log) rules.log->end("no such path is wanted");
        return fate;
    }
    SurfacePoint points[2]; // in turns: where it is, and the surface that it left
    for (bool onward = true; onward;) {
        const SurfacePoint* const from = p.depth > 0 ? &points[(p.depth - 1) % 2] : nullptr;
        const Hit hit = work.scene.intersect(p.ray);
        ++fate.rays;
        if constexpr (requires(const Flight& f) { visitor.flight(f); })
            visitor.flight(Flight{p.ray, from, hit ? hit.t : p.ray.tfar, p.state, p.flux, p.visible});
        onward = scatterParticle(work, p, hit, from, points[p.depth % 2], rules, visitor, fate);
    }
    return fate;
}

} // namespace chiaro
