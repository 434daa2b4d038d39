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

// Walks the particle. flux: what it carries at first, of the emission's ray. The visitor answers
//   void flight(const Flight&)                                   if it has it: for every ray, before its end is known
//   Onward arrive(const Arrival&, const Bsdf&, Sampler own)      at every surface where a wanted path can be scattered
// own: for two dimensions, which are the visitor's.
template <class Visitor>
Fate walkParticle(const Work& work, const LightEmission& emission, Spectrum flux, Sampler& sampler, const WalkRules& rules,
                  Visitor& visitor) {
    const Scene& scene = work.scene;
    const PathClasses& classes = work.classes;
    Fate fate;
    double carried = double(luminance(flux));
    const auto leave = [&](double& where, const char* why) {
        where += carried;
        if (rules.log) rules.log->end(why);
        return fate;
    };
    // The flux is `to` from here on; what it was more goes to `where`.
    const auto change = [&](double& where, const Spectrum& to) {
        const double now = double(luminance(to));
        where += carried - now;
        carried = now;
    };
    PathState state = classes.light(emission.kind);
    Spectrum throughput(1); // of the events so far, for the roulette
    Ray ray = emission.ray;
    Wavelengths lambda;
    SurfacePoint at, previous;
    bool visible = emission.kind != LightKind::delta;
    uint32_t deltas = 0;
    if (rules.log) rules.log->arrive(PathLog::Kind::emission, ray.o, 0, flux).light = emission.light;
    for (uint32_t depth = 0; state != 0; ++depth) {
        const SurfacePoint* from = depth > 0 ? &previous : nullptr;
        const Hit hit = scene.intersect(ray);
        ++fate.rays;
        if constexpr (requires(const Flight& f) { visitor.flight(f); })
            visitor.flight(Flight{ray, from, hit ? hit.t : ray.tfar, state, flux, visible});
        if (!hit) {
            if (rules.log) logSky(*rules.log, scene, ray, flux);
            fate.escaped += carried;
            return fate;
        }
        at = scene.point(hit, ray);
        flux *= segmentTransmittance(scene, from, ray.d, &at, hit.t);
        change(fate.absorbed, flux);
        if (rules.log) logSurface(*rules.log, at, at.ns, hit.t, flux);
        if (!classes.continues(state)) return leave(fate.ended, depth >= classes.maxDepth() ? "depth limit" : "no longer path is wanted");
        const Bsdf bsdf = shade(scene, at, -ray.d, {}, lambda, Transport::importance);
        const Onward onward =
            visitor.arrive(Arrival{at, from, ray, hit.t, state, flux, depth, deltas, emission.kind}, bsdf, Sampler(sampler));
        sampler.skip(2);
        if (onward == Onward::stop) return leave(fate.ended, "not followed");
        const PickAndPoint u = sampler.get3D();
        const auto sample = bsdf.sample(min(float(u.pick), oneMinusEpsilon), u.u);
        if (!sample) return leave(fate.absorbed, "absorbed");
        change(fate.absorbed, flux * sample->weight);
        if (onward == Onward::delta && !sample->delta) return leave(fate.ended, "not followed");
        const Turn next = turn(classes, state, bsdf, *sample, sampler);
        if (!next.state || black(next.weight)) return leave(fate.ended, next.state ? "absorbed" : "no such path is wanted");
        throughput *= next.weight;
        float boost = 1;
        if (depth >= rules.rouletteDepth) {
            const float survive = min(maxComponent(throughput), 0.95f);
            if (!(sampler.get1D() < survive)) return leave(fate.ended, "roulette");
            boost = 1 / survive;
        } else {
            sampler.skip(1);
        }
        throughput *= boost;
        flux *= next.weight * boost;
        change(fate.ended, flux);
        state = next.state;
        visible = visible || !sample->delta;
        deltas = sample->delta ? deltas + 1 : 0;
        previous = at;
        ray = at.towards(sample->wi);
        if (rules.log) rules.log->scatter(next.event, next.weight * boost, sample->pdfW, sample->delta);
    }
    return leave(fate.ended, "no such path is wanted");
}

} // namespace chiaro
