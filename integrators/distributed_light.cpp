#include "integrators/distributed_light.h"
#include "core/render/fault.h"
#include "integrators/shadow_batch.h"
#include "integrators/transport.h"

namespace chiaro {
namespace {

// What a shadow ray brings: one share a class of the event at the vertex.
struct Delivery {
    Spectrum value[2];
    Layer layer[2] = {};
    uint32_t logged = PathLog::none;
};

// Of the lobe rays against this light sample.
float share(const LightSample& light, const BsdfValue& value, const BsdfTerm& term, const DirectPlan& plan) noexcept {
    const bool rival = (term.event == Event::GR && plan.reflected) || (term.event == Event::GT && plan.transmitted);
    if (!rival || light.delta || plan.lobeSamples == 0) return 1;
    return powerHeuristic(float(plan.lightSamples) * light.pdfW, float(plan.lobeSamples) * value.pdfW);
}

} // namespace

ShadowCount addDirectSplit(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, PathState state, const Spectrum& throughput,
                           const DirectPlan& plan, Sampler& sampler, Outputs& out) noexcept {
    const uint32_t n = plan.lightSamples;
    const float part = fault(Fault::splitUnweighted) ? 1.f : 1.f / float(n);
    ShadowBatch<Delivery> batch(job.scene);
    ShadowCount count;
    const auto deliver = [&](const Delivery& d, bool arrived) {
        ++count.cast;
        count.arrived += arrived;
        if (out.log && d.logged != PathLog::none) [[unlikely]] {
            PathLog::Vertex& v = (*out.log)[d.logged];
            v.blocked = !arrived;
            if (arrived) v.contribution = (d.layer[0] ? d.value[0] : Spectrum(0)) + (d.layer[1] ? d.value[1] : Spectrum(0));
        }
        if (!arrived) return;
        out.add(d.layer[0], d.value[0]);
        out.add(d.layer[1], d.value[1]);
    };
    for (uint32_t j = 0; j < n; ++j) {
        const PickAndPoint u = sampler.split(j, n).get3D();
        const auto light = job.scene.lights().sampleTowards(at, u.pick, u.u);
        if (!light || !(light->pdfW > 0)) continue;
        const BsdfValue value = bsdf.evaluate(light->wi, Terms::apart);
        if (value.n == 0) continue;
        const float factor = absDot(bsdf.normal(), light->wi) * part / light->pdfW;
        const Spectrum arriving = light->radiance * segmentTransmittance(job.scene, &at, light->wi, nullptr, light->shadow.tfar) * factor;
        Delivery d;
        Spectrum weight(0);
        for (int i = 0; i < value.n; ++i) {
            const BsdfTerm& term = value.terms[i];
            const Spectrum through = term.f * share(*light, value, term, plan);
            d.value[i] = throughput * arriving * through;
            if (!black(d.value[i])) d.layer[i] = job.classes.reached(job.classes.eye(state, term.event), light->kind);
            weight += through * factor;
        }
        if (d.layer[0] == 0 && d.layer[1] == 0) continue;
        if (out.log) [[unlikely]]
            d.logged =
                out.log->add(shadowVertex(*out.log, job.scene, at, *light, value.terms[d.layer[0] ? 0 : 1].event, throughput, weight));
        if (plan.shadows) {
            batch.add(light->shadow, d);
            if (batch.full()) batch.trace(deliver);
        } else {
            deliver(d, true);
        }
    }
    batch.trace(deliver);
    sampler.skip(3);
    if (plan.shadows) out.traced(count.cast, 0);
    return count;
}

} // namespace chiaro
