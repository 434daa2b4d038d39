// Ambient occlusion (Zhukov, Iones, Kronin 1998; Landis 2002): how open the hemisphere over the first hit is. Rays over the hemisphere
// about the shading normal, on the viewer's side, as far as a limit: the share of them that meets nothing. With the cosine weight it is
// what a surrounding of radiance 1 sends to the surface, over pi, if nothing scatters twice; so `combined` under light=ambient is the exact
// answer of `path --max-depth 1` for matt surfaces under a sky of radiance 1. Directions below the surface itself count as closed. No light
// path.
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "integrators/entries.h"
#include "integrators/shadow_batch.h"
#include "integrators/transport.h"

namespace chiaro {
namespace {

constexpr OptionSpec specs[] = {
    {"samples", OptionType::integer, "16", 1, 65536, "", "rays over the hemisphere for each eye ray"},
    {"distance", OptionType::real, "0", 0, 1e18, "", "metres beyond which nothing closes; 0: no limit"},
    {"weight", OptionType::choice, "cosine", 0, 0, "cosine|uniform",
     "of a direction: cosine, as light counts on a surface, or all directions alike"},
    {"mode", OptionType::choice, "ao", 0, 0, "ao|diffuse|combined", "openness, diffuse shading, or their product"},
    {"light", OptionType::choice, "ambient", 0, 0, "ambient|direct",
     "of the diffuse shading: radiance 1 from all around (its picture is the albedo), or the scene's lights with their shadows"},
    {"light-samples", OptionType::integer, "16", 1, 4096, "", "shadow rays for each eye ray, of light=direct"},
};

enum class Mode : uint8_t { ao, diffuse, combined };

class AmbientOcclusion final : public CameraIntegrator {
public:
    explicit AmbientOcclusion(const Options& o)
        : samples_(uint32_t(o.integer("samples"))), lightSamples_(uint32_t(o.integer("light-samples"))),
          distance_(o.real("distance") > 0 ? float(o.real("distance")) : infinity), cosine_(o.text("weight") == "cosine"),
          direct_(o.text("light") == "direct"), mode_(o.text("mode") == "ao"        ? Mode::ao
                                                      : o.text("mode") == "diffuse" ? Mode::diffuse
                                                                                    : Mode::combined) {}
    void radiance(const Job&, PathStart&, Outputs&) const noexcept override;

private:
    float openness(const Job&, const SurfacePoint&, const Bsdf&, const Vec3& wo, Sampler&, Outputs&) const noexcept;
    Spectrum directDiffuse(const Job&, const SurfacePoint&, const Bsdf&, Sampler&, Outputs&) const noexcept;
    uint32_t samples_, lightSamples_;
    float distance_;
    bool cosine_, direct_;
    Mode mode_;
};

void logRay(PathLog& log, const Ray& ray, float reach, bool arrived) {
    const float t = min(ray.tfar, reach);
    PathLog::Vertex v;
    v.parent = log.here;
    v.kind = arrived ? PathLog::Kind::sky : PathLog::Kind::light;
    v.p = ray.o + ray.d * t;
    v.t = ray.tfar;
    v.blocked = !arrived;
    v.note = arrived ? "open" : "closed";
    log.add(v);
}

float AmbientOcclusion::openness(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, const Vec3& wo, Sampler& sampler,
                                 Outputs& out) const noexcept {
    const Frame frame = Frame::about(bsdf.normal());
    const float side = dot(at.ng, wo) < 0 ? -1.f : 1.f;
    const bool cosine = cosine_ && !fault(Fault::occlusionUniform);
    uint32_t open = 0, cast = 0;
    ShadowBatch<Ray> batch(job.scene);
    const auto answer = [&](const Ray& ray, bool arrived) {
        ++cast;
        open += arrived;
        if (out.log) [[unlikely]]
            logRay(*out.log, ray, job.scene.radius(), arrived);
    };
    for (uint32_t j = 0; j < samples_; ++j) {
        const Point2 u = sampler.split(j, samples_).get2D();
        const Vec3 w = frame.toWorld(cosine ? cosineHemisphere(u) : uniformHemisphere(u));
        if (!(dot(w, at.ng) * side > 0)) continue;
        Ray ray = at.towards(w);
        ray.tfar = distance_;
        batch.add(ray, ray);
        if (batch.full()) batch.trace(answer);
    }
    batch.trace(answer);
    sampler.skip(2);
    out.traced(cast, 1);
    return float(open) / float(samples_);
}

// Light straight from the lights, scattered by the diffuse part.
Spectrum AmbientOcclusion::directDiffuse(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, Sampler& sampler,
                                         Outputs& out) const noexcept {
    Spectrum sum(0);
    uint32_t cast = 0;
    ShadowBatch<Spectrum> batch(job.scene);
    const auto answer = [&](const Spectrum& value, bool arrived) {
        ++cast;
        if (arrived) sum += value;
    };
    for (uint32_t j = 0; j < lightSamples_; ++j) {
        const PickAndPoint u = sampler.split(j, lightSamples_).get3D();
        const auto light = job.scene.lights().sampleTowards(at, u.pick, u.u);
        if (!light || !(light->pdfW > 0)) continue;
        for (const BsdfTerm& term : bsdf.evaluate(light->wi, Terms::apart)) {
            if (term.event != Event::DR && term.event != Event::DT) continue;
            batch.add(light->shadow, light->radiance * term.f * (absDot(bsdf.normal(), light->wi) / (light->pdfW * float(lightSamples_))));
            if (batch.full()) batch.trace(answer);
        }
    }
    batch.trace(answer);
    sampler.skip(3);
    out.traced(cast, 1);
    return sum;
}

void AmbientOcclusion::radiance(const Job& job, PathStart& start, Outputs& out) const noexcept {
    if (!start.first) {
        if (out.log) logSky(*out.log, job.scene, start.ray, Spectrum(1));
        return;
    }
    const SurfacePoint at = job.scene.point(start.first, start.ray);
    const Bsdf bsdf = shade(job.scene, at, -start.ray.d, start.footprint.at(start.first.t), start.lambda);
    const Vec3 n = bsdf.normal();
    if (out.log) logSurface(*out.log, at, n, start.first.t, Spectrum(1));
    out.aov(Aov::albedo, bsdf.albedo());
    out.aov(Aov::normal, {n.x, n.y, n.z});
    Spectrum value(1);
    if (mode_ != Mode::diffuse) value = Spectrum(openness(job, at, bsdf, -start.ray.d, start.sampler, out));
    if (mode_ != Mode::ao) value *= direct_ ? directDiffuse(job, at, bsdf, start.sampler, out) : bsdf.diffuseAlbedo();
    addFound(out, otherLayer, value);
}

Traits traits(const Options&) {
    Traits t;
    t.lightTransport = false;
    t.covers = "";
    return t;
}

} // namespace

extern const IntegratorEntry aoEntry = {
    "ao", "ambient occlusion: how open the hemisphere over the first hit is; alone or times the diffuse shading", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<AmbientOcclusion>(o); }};

} // namespace chiaro
