// Unidirectional path tracing (Kajiya 1986) with next-event estimation, BSDF sampling, both weighted by the power heuristic (Veach and
// Guibas 1995), and Russian roulette (Arvo and Kirk 1990).
#include "core/render/fault.h"
#include "core/scene/ray_cone.h"
#include "integrators/entries.h"
#include "integrators/path_wide.h"
#include "integrators/transport.h"
#include "materials/surface_parameters.h"
#include <new>

namespace chiaro {
namespace {

constexpr OptionSpec specs[] = {
    {"rr-depth", OptionType::integer, "5", 0, 65535, "", "scatterings before Russian roulette may end a path"},
    {"nee", OptionType::boolean, "on", 0, 0, "", "next-event estimation: sample a light at every vertex"},
    {"mis", OptionType::boolean, "on", 0, 0, "",
     "weigh light and BSDF samples together; off: light samples alone, for lights that can be sampled"},
    {"wide", OptionType::boolean, "on", 0, 0, "", "follow sixteen paths at a time in SIMD lanes; off: one by one, the readable reference"},
    {"stream", OptionType::integer, "512", PathStream::least, PathStream::most, "",
     "paths that a thread has under way in lanes; the picture does not depend on it"},
};

class Path final : public CameraIntegrator {
public:
    explicit Path(const Options& o)
        : settings_{uint32_t(o.integer("rr-depth")), o.boolean("nee"), o.boolean("mis")}, lanes_(o.boolean("wide")),
          stream_(uint32_t(o.integer("stream"))) {}
    void prepare(const Job& job) override {
        if (lanes_) wide_ = WidePaths::make(job, settings_, stream_);
    }
    using CameraIntegrator::radianceWide;
    void radiance(const Job&, PathStart&, Outputs&) const noexcept override;
    void radianceWide(const Job& job, StartSource& starts, SampleLanes& samples) const noexcept override {
        wide_->run(job, starts, samples);
    }
    bool streams(const Job& job, const FilmLayout& layout) const noexcept override { return wide_ && WidePaths::able(job, layout); }

private:
    const PathSettings settings_;
    const bool lanes_;
    const uint32_t stream_;
    std::unique_ptr<const WidePaths> wide_; // null: one by one
};

// For the log: why nothing follows.
[[gnu::cold, gnu::noinline]] void logEnd(PathLog& log, const char* why) noexcept { log.end(why); }
void ended(Outputs& out, const char* why) noexcept {
    if (out.log) logEnd(*out.log, why);
}
const char* unwanted(const PathClasses& classes, uint32_t depth) noexcept {
    return depth >= classes.maxDepth() ? "depth limit" : "no longer path is wanted";
}

void Path::radiance(const Job& job, PathStart& start, Outputs& out) const noexcept {
    const Scene& scene = job.scene;
    const PathClasses& classes = job.classes;
    Sampler& sampler = start.sampler;
    Ray ray = start.ray;
    Hit hit = start.first;
    Spectrum throughput(1);
    PathState state = classes.eye();
    SurfacePoint points[2]; // in turns: where the path is, and where it was
    Footprint footprint = cone(scene, start.footprint);
    float pdfW = 0;
    bool delta = true;
    for (uint32_t depth = 0;; ++depth) {
        const SurfacePoint* const from = depth > 0 ? &points[(depth + 1) % 2] : nullptr;
        if (!hit) {
            const LightHit sky = scene.lights().miss(ray, from);
            if (out.log) logSky(*out.log, scene, ray, throughput);
            if (sky)
                addFound(out, classes.reached(state, sky.kind), throughput * sky.radiance * settings_.hitWeight(delta, pdfW, sky.pdfW));
            if (depth == 0) out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
            return;
        }
        const SurfacePoint& at = *::new (&points[depth % 2]) SurfacePoint(scene.point(hit, ray));
        footprint = footprint.at(hit.t);
        throughput *= segmentTransmittance(scene, from, ray.d, &at, hit.t);
        if (out.log) logSurface(*out.log, at, at.ns, hit.t, throughput);
        if (const LightHit light = scene.lights().hit(at, -ray.d, from))
            addFound(out, classes.reached(state, light.kind), throughput * light.radiance * settings_.hitWeight(delta, pdfW, light.pdfW));
        if (!classes.continues(state) && depth > 0) return ended(out, unwanted(classes, depth));
        const Bsdf bsdf = shade(scene, at, -ray.d, footprint, start.lambda, Transport::radiance, Densities::forward);
        if (depth == 0) {
            out.aov(Aov::albedo, bsdf.albedo());
            out.aov(Aov::normal, Spectrum(bsdf.normal().x, bsdf.normal().y, bsdf.normal().z));
        }
        if (!classes.continues(state)) return ended(out, unwanted(classes, depth));
        if (out.log) (*out.log)[out.log->here].normal = bsdf.normal();
        const PickAndPoint uLight = sampler.get3D(), uBsdf = sampler.get3D();
        if (settings_.nee && bsdf.smooth() && !(fault(Fault::bounceDropped) && depth == 1)) {
            const uint32_t rays = out.rays;
            addDirect(job, at, bsdf, state, throughput, scene.lights().sampleTowards(at, uLight.pick, uLight.u),
                      settings_.mis ? Mis::on : Mis::off, out);
            if (out.rays > rays) out.traced(0, depth + 1);
        }
        const auto sample = bsdf.sample(min(float(uBsdf.pick), oneMinusEpsilon), uBsdf.u);
        if (!sample) return ended(out, "absorbed");
        const Turn next = turn(classes, state, bsdf, *sample, sampler);
        if (!next.state || black(next.weight)) return ended(out, next.state ? "absorbed" : "no such path is wanted");
        throughput *= next.weight;
        float boost = 1;
        if (depth >= settings_.rouletteDepth) {
            const float inside = dot(at.ng, sample->wi) < 0 ? squaredIndexInside(scene.material(at.material)) : 1.f;
            const float survive = min(maxComponent(throughput) * inside, 0.95f);
            if (!(sampler.get1D() < survive)) return ended(out, "roulette");
            boost = fault(Fault::rouletteUnweighted) ? 1 : 1 / survive;
            throughput *= boost;
        } else {
            sampler.skip(1);
        }
        state = next.state;
        pdfW = sample->pdfW;
        delta = sample->delta;
        start.lambda = sample->after(start.lambda);
        footprint = scattered(scene, at, footprint, -ray.d, sample->wi, delta, pdfW);
        ray = at.towards(sample->wi);
        hit = scene.intersect(ray);
        out.traced(1, depth + 1);
        if (out.log) out.log->scatter(next.event, next.weight * boost, pdfW, delta);
    }
}

Traits traits(const Options& o) {
    Traits t;
    t.covers = "L (D|G|S)* E";
    t.misses = o.boolean("nee") ? "Ld S+ (D|G) .* E" : "Ld .* E"; // a delta light is found by sampling it or not at all
    return t;
}

} // namespace

extern const IntegratorEntry pathEntry = {"path", "path tracing with next-event estimation and multiple importance sampling", specs, traits,
                                          [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Path>(o); }};

} // namespace chiaro
