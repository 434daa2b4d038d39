#include "integrators/transport.h"
#include "core/render/fault.h"

namespace chiaro {
namespace {

// A shadow ray under the vertex at which the path stands. weight: of the event there, the share of this strategy included. Kept out of
// line: the renderer's own loop has no room for it.
[[gnu::cold, gnu::noinline]] void logShadow(PathLog& log, const Scene& scene, const SurfacePoint& at, const LightSample& light,
                                            const BsdfValue& value, const Spectrum& throughput, const Spectrum& weight, bool blocked,
                                            const Spectrum& contribution) {
    const BsdfTerm& term = value.n > 1 && luminance(value.terms[1].f) > luminance(value.terms[0].f) ? value.terms[1] : value.terms[0];
    PathLog::Vertex v = shadowVertex(log, scene, at, light, term.event, throughput, weight);
    v.blocked = blocked;
    v.contribution = contribution;
    if (blocked)
        if (const Hit hit = scene.intersect(light.shadow)) v.material = scene.attributes(hit).material;
    log.add(v);
}

} // namespace

PathLog::Vertex shadowVertex(const PathLog& log, const Scene& scene, const SurfacePoint& at, const LightSample& light, Event event,
                             const Spectrum& throughput, const Spectrum& weight) {
    const bool far = !std::isfinite(light.shadow.tfar);
    const Vec3 end = light.shadow.o + light.shadow.d * (far ? scene.radius() : light.shadow.tfar);
    return {.parent = log.here,
            .kind = PathLog::Kind::light,
            .p = end,
            .normal = {},
            .t = far ? infinity : length(end - at.p),
            .event = event,
            .weight = weight,
            .pdfW = light.pdfW,
            .delta = light.delta,
            .light = light.light,
            .throughput = throughput * weight};
}

Turn turn(const PathClasses& classes, PathState state, const Bsdf& bsdf, const BsdfSample& sample, Sampler& sampler) noexcept {
    if (drawsClass(classes, state, sample)) return turn(classes, state, bsdf, sample, sampler.get1D());
    sampler.skip(1);
    return {classes.eye(state, sample.event), sample.weight, sample.event};
}

Turn turn(const PathClasses& classes, PathState state, const Bsdf& bsdf, const BsdfSample& sample, float uClass) noexcept {
    if (!drawsClass(classes, state, sample)) return {classes.eye(state, sample.event), sample.weight, sample.event};
    const BsdfValue value = bsdf.evaluate(sample.wi, Terms::apart);
    PathState next[2] = {};
    float share[2] = {};
    for (int i = 0; i < value.n; ++i) {
        next[i] = classes.eye(state, value.terms[i].event);
        share[i] = next[i] ? luminance(value.terms[i].f) : 0;
    }
    const float sum = share[0] + share[1];
    if (!(sum > 0)) return {};
    const int i = uClass * sum < share[0] ? 0 : 1;
    const float cosine = absDot(bsdf.normal(), sample.wi);
    return {next[i], value.terms[i].f * (cosine * sum / (share[i] * sample.pdfW)), value.terms[i].event};
}

void addDirect(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, PathState state, const Spectrum& throughput,
               const std::optional<LightSample>& light, Mis mis, Outputs& out) noexcept {
    if (!light || !(light->pdfW > 0)) return;
    const BsdfValue value = bsdf.evaluate(light->wi, terms(job.classes, state));
    if (value.n == 0 || black(value.f())) return;
    out.traced(1, 0);
    const bool blocked = job.scene.occluded(light->shadow);
    if (blocked && !out.log) [[likely]]
        return;
    const float weight = mis == Mis::on && !light->delta ? powerHeuristic(light->pdfW, value.pdfW) : 1.f;
    const float cosine = fault(Fault::receiverCosineMissing) ? 1.f : absDot(bsdf.normal(), light->wi);
    const float factor = cosine * weight / light->pdfW;
    const Spectrum arriving = light->radiance * segmentTransmittance(job.scene, &at, light->wi, nullptr, light->shadow.tfar) * factor;
    Spectrum added(0);
    for (const BsdfTerm& term : value) {
        const Layer layer = blocked ? Layer(0) : job.classes.reached(job.classes.eye(state, term.event), light->kind);
        const Spectrum contribution = throughput * term.f * arriving;
        out.add(layer, contribution);
        if (layer != 0) added += contribution;
    }
    if (out.log) [[unlikely]]
        logShadow(*out.log, job.scene, at, *light, value, throughput, value.f() * factor, blocked, added);
}

void logSurface(PathLog& log, const SurfacePoint& at, const Vec3& normal, float t, const Spectrum& throughput) {
    PathLog::Vertex& v = log.arrive(PathLog::Kind::surface, at.p, t, throughput);
    v.normal = normal;
    v.material = at.material;
    v.light = at.light;
}

void logFound(PathLog& log, Layer layer, const Spectrum& value) {
    if (layer != 0 && log.here != PathLog::none) log[log.here].contribution += value;
}

void logSky(PathLog& log, const Scene& scene, const Ray& ray, const Spectrum& throughput) {
    PathLog::Vertex& v = log.arrive(PathLog::Kind::sky, ray.o + ray.d * scene.radius(), infinity, throughput);
    if (scene.lights().hasEnvironment()) v.light = scene.lights().count() - 1;
    v.note = "left the scene";
}

} // namespace chiaro
