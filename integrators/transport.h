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

} // namespace chiaro
