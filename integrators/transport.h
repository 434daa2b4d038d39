// Steps that every Monte Carlo integrator shares: which class an event takes, direct light with multiple importance sampling, and what is
// told to the log of a path (core/render/path_log.h) where somebody asked for one.
#pragma once
#include "core/math/warp.h"
#include "core/render/integrator.h"
#include "materials/bsdf.h"

namespace chiaro {

inline Terms terms(const PathClasses& classes, PathState state) noexcept { return classes.sorts(state) ? Terms::apart : Terms::together; }

// Where a path stands after an event, and what the event multiplies its throughput by.
struct Turn {
    PathState state = 0; // 0: stop
    Spectrum weight;
    Event event = Event::DR;
};
// The direction came from the mixture. Where classes still matter, the event's class is drawn from those alive in proportion to the
// luminance of f_class, and the weight divided by that probability: classes sum to the picture, densities stay those of the mixture.
Turn turn(const PathClasses&, PathState, const Bsdf&, const BsdfSample&, Sampler&) noexcept; // takes one dimension
// Does the event's class have to be drawn? Then by a number of the caller's own.
inline bool drawsClass(const PathClasses& classes, PathState state, const BsdfSample& sample) noexcept {
    return !sample.delta && classes.sorts(state);
}
Turn turn(const PathClasses&, PathState, const Bsdf&, const BsdfSample&, float uClass) noexcept;

enum class Mis : bool { off, on };
// Adds the light that arrives at `at` from one light sample, in the layers of its path classes. Counts the shadow ray; the depth of the
// path that it closes is known to the caller.
void addDirect(const Job&, const SurfacePoint& at, const Bsdf&, PathState, const Spectrum& throughput, const std::optional<LightSample>&,
               Mis, Outputs&) noexcept;

// A shadow ray under the vertex at which the path stands, not yet known to arrive. weight: of the event there, the share of its strategy
// included.
[[gnu::cold]] PathLog::Vertex shadowVertex(const PathLog&, const Scene&, const SurfacePoint& at, const LightSample&, Event,
                                           const Spectrum& throughput, const Spectrum& weight);
// The path has arrived: on a surface, or nowhere. throughput: on arrival.
[[gnu::cold]] void logSurface(PathLog&, const SurfacePoint& at, const Vec3& normal, float t, const Spectrum& throughput);
[[gnu::cold]] void logSky(PathLog&, const Scene&, const Ray&, const Spectrum& throughput);
[[gnu::cold]] void logFound(PathLog&, Layer, const Spectrum& value);
// Adds light that the path has found where it stands.
inline void addFound(Outputs& out, Layer layer, const Spectrum& value) noexcept {
    out.add(layer, value);
    if (out.log) logFound(*out.log, layer, value);
}

// An eye ray at the end of its way. from: the surface that it left; null: the camera.
struct EyeArrival {
    const Ray& ray;
    const Hit& hit; // of it
    const SurfacePoint* from = nullptr;
    PathState state = 0;
    uint32_t depth = 0; // scatterings so far
};
// The throughput is dimmed by what lies between, light that the ray has met is told to found(const LightHit&). True where it may be
// scattered: at.
template <class Found>
bool arriveByEye(const Job& job, const EyeArrival& a, Spectrum& throughput, SurfacePoint& at, Outputs& out, Found&& found) {
    const Scene& scene = job.scene;
    if (!a.hit) {
        if (out.log) [[unlikely]]
            logSky(*out.log, scene, a.ray, throughput);
        const LightHit sky = scene.lights().miss(a.ray, a.from);
        if (sky) found(sky);
        if (!a.from) out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
        return false;
    }
    at = scene.point(a.hit, a.ray);
    throughput *= segmentTransmittance(scene, a.from, a.ray.d, &at, a.hit.t);
    if (out.log) [[unlikely]]
        logSurface(*out.log, at, at.ns, a.hit.t, throughput);
    if (const LightHit light = scene.lights().hit(at, -a.ray.d, a.from)) found(light);
    if (job.classes.continues(a.state) || !a.from) return true;
    if (out.log) out.log->end(a.depth >= job.classes.maxDepth() ? "depth limit" : "no longer path is wanted");
    return false;
}

} // namespace chiaro
