#include "integrators/transport.h"
#include "core/render/fault.h"

namespace chiaro {

Turn turn(const PathClasses& classes, PathState state, const Bsdf& bsdf, const BsdfSample& sample, Sampler& sampler) noexcept {
    if (sample.delta || !classes.sorts(state)) {
        sampler.skip(1);
        return {classes.eye(state, sample.event), sample.weight};
    }
    const float uClass = sampler.get1D();
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
    return {next[i], value.terms[i].f * (cosine * sum / (share[i] * sample.pdfW))};
}

void addDirect(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, PathState state, const Spectrum& throughput,
               const std::optional<LightSample>& light, Mis mis, Outputs& out) noexcept {
    if (!light || !(light->pdfW > 0)) return;
    const BsdfValue value = bsdf.evaluate(light->wi, terms(job.classes, state));
    if (value.n == 0 || black(value.f()) || job.scene.occluded(light->shadow)) return;
    const float weight = mis == Mis::on && !light->delta ? powerHeuristic(light->pdfW, value.pdfW) : 1.f;
    const float cosine = fault(Fault::receiverCosineMissing) ? 1.f : absDot(bsdf.normal(), light->wi);
    const Spectrum arriving =
        light->radiance * segmentTransmittance(job.scene, &at, light->wi, nullptr, light->shadow.tfar) * (cosine * weight / light->pdfW);
    for (const BsdfTerm& term : value)
        out.add(job.classes.reached(job.classes.eye(state, term.event), light->kind), throughput * term.f * arriving);
}

} // namespace chiaro
