#include "integrators/photon_eye.h"
#include "core/render/fault.h"
#include "core/scene/ray_cone.h"
#include "integrators/fixed_vector.h"
#include "materials/surface_parameters.h"
#include <algorithm>

namespace chiaro {
namespace {

// An eye path, on its way.
struct Branch {
    explicit Branch(const Sampler& s) noexcept : sampler(s) {}
    Ray ray;
    Footprint footprint; // where the ray begins; once it has arrived, there
    Hit hit;
    Spectrum throughput{1};
    Sampler sampler;
    Wavelengths lambda;
    PathState state = 0;
    uint32_t depth = 0;
    float density = 0;                  // number of rays x pdfW; 0: from the camera or a delta lobe, no shadow ray finds what lies there
    bool gathering = false;             // R has happened
    uint32_t deltas = 0;                // S events since R
    bool sharpened = false;             // G of a sharp lobe since R
    const SurfacePoint* from = nullptr; // null: the camera
    // Light found now came through S+ alone: the caustic map at x has it.
    bool caustic() const noexcept { return gathering && deltas > 0 && !sharpened && !fault(Fault::photonCausticTwice); }
};

class EyeWalk {
public:
    EyeWalk(const Job& job, const EyePlan& plan, Outputs& out) noexcept : job_(job), plan_(plan), out_(out) {}
    void follow(Branch) noexcept;
    float count() const noexcept { return count_; }

private:
    struct Vertex {
        const SurfacePoint& at;
        const Bsdf& bsdf;
        const Branch& arrived;
        bool sharp = false; // its glossy lobes are C, not R
        uint32_t rays = 1;  // that leave it
        bool apart = false; // D and G are told apart
        bool followed(Event e) const noexcept { return sharp && (e == Event::GR || e == Event::GT); }
    };
    using Siblings = FixedVector<Branch, 16>;
    bool arrive(Branch&, SurfacePoint&) noexcept;
    bool sharpAt(const SurfacePoint&) const noexcept;
    void light(const Vertex&, Sampler&) noexcept;
    void photons(const Vertex&) noexcept;
    void ask(const PhotonMap&, const Vertex&, float radius) noexcept;
    bool leave(const Vertex&, Branch&) noexcept;
    bool scatter(const Vertex&, const BsdfSample&, Branch&, Turn&) noexcept;
    void split(const Vertex&, const Sampler&) noexcept;
    void grow(Siblings&) noexcept;
    // Is light that arrives by R at this vertex sought along rays?
    bool gathersFrom(const Vertex& v) const noexcept { return !v.arrived.gathering && plan_.gather > 0; }

    const Job& job_;
    const EyePlan& plan_;
    Outputs& out_;
    float count_ = 0;
};

bool EyeWalk::sharpAt(const SurfacePoint& at) const noexcept {
    if (plan_.sharp <= 0) return false;
    const MaterialDesc& m = job_.scene.material(at.material);
    const bool varies = m.metallicRoughnessTexture.texture >= 0 || m.specularGlossiness;
    return (varies ? surfaceParameters(job_.scene, at).roughness : m.roughness) < plan_.sharp;
}

// Light found by the ray itself; true where it may be scattered.
bool EyeWalk::arrive(Branch& b, SurfacePoint& at) noexcept {
    return arriveByEye(job_, {b.ray, b.hit, b.from, b.state, b.depth}, b.throughput, at, out_, [&](const LightHit& light) {
        if (b.caustic()) return;
        const float weight = b.density == 0 ? 1.f : powerHeuristic(b.density, light.pdfW);
        addFound(out_, job_.classes.reached(b.state, light.kind), b.throughput * light.radiance * weight);
    });
}

// One shadow ray. What arrives by R counts at x alone, at z it is among the photons.
void EyeWalk::light(const Vertex& v, Sampler& sampler) noexcept {
    const PickAndPoint u = sampler.get3D();
    const Branch& b = v.arrived;
    if (b.gathering && !v.sharp) return;
    const auto light = job_.scene.lights().sampleTowards(v.at, u.pick, u.u);
    if (!light || !(light->pdfW > 0)) return;
    const BsdfValue value = v.bsdf.evaluate(light->wi, v.apart ? Terms::apart : Terms::together);
    if (value.n == 0 || black(value.f())) return;
    Layer layers[2] = {};
    Spectrum values[2], weight(0);
    const float factor = absDot(v.bsdf.normal(), light->wi) / light->pdfW;
    for (int i = 0; i < value.n; ++i) {
        const BsdfTerm& term = value.terms[i];
        const bool followed = v.followed(term.event);
        if (b.gathering && !followed) continue;
        layers[i] = job_.classes.reached(job_.classes.eye(b.state, term.event), light->kind);
        const bool weighed = !light->delta && (followed || gathersFrom(v));
        values[i] = term.f * (factor * (weighed ? powerHeuristic(light->pdfW, float(v.rays) * value.pdfW) : 1.f));
        weight += values[i];
    }
    if (layers[0] == 0 && layers[1] == 0) return;
    out_.traced(1, b.depth + 1);
    const bool blocked = job_.scene.occluded(light->shadow);
    const Spectrum arriving =
        b.throughput * light->radiance * segmentTransmittance(job_.scene, &v.at, light->wi, nullptr, light->shadow.tfar);
    Spectrum added(0);
    for (int i = 0; i < value.n && !blocked; ++i) {
        if (layers[i] == 0) continue;
        out_.add(layers[i], arriving * values[i]);
        added += arriving * values[i];
    }
    if (!out_.log) return;
    PathLog::Vertex shadow = shadowVertex(*out_.log, job_.scene, v.at, *light, value.terms[0].event, b.throughput, weight);
    shadow.blocked = blocked;
    shadow.contribution = added;
    out_.log->add(shadow);
}

void EyeWalk::ask(const PhotonMap& map, const Vertex& v, float radius) noexcept {
    const Branch& b = v.arrived;
    const GatherPoint point{v.at, v.bsdf, b.state, b.throughput, v.sharp ? GatheredLobes::diffuse : GatheredLobes::all};
    const GatherResult result = radius > 0 ? map.add(job_.classes, point, radius, out_) : map.add(job_.classes, point, out_);
    if (result.found.radius == 0) return;
    out_.traced(0, b.depth + 1);
    if (!b.gathering) count_ += result.found.count;
    Gathered& shown = out_.gathered;
    if (shown.radius == 0)
        shown = result.found;
    else if (!b.gathering && shown.radius == result.found.radius) // the other map at the same point
        shown = {shown.density + result.found.density, shown.radius, shown.count + result.found.count};
    if (out_.log && out_.log->here != PathLog::none) (*out_.log)[out_.log->here].contribution += result.added;
}

void EyeWalk::photons(const Vertex& v) noexcept {
    const bool atX = !v.arrived.gathering;
    const float radius = atX ? plan_.radius : 0;
    if (atX && plan_.caustic) ask(*plan_.caustic, v, radius);
    if (atX ? plan_.gather == 0 : true) ask(*plan_.global, v, radius);
}

// The event of a direction that came from the mixture, and the weight of its part of f: as turn(), among the classes that are followed.
bool EyeWalk::scatter(const Vertex& v, const BsdfSample& sample, Branch& next, Turn& turned) noexcept {
    const PathState state = v.arrived.state;
    if (sample.delta) {
        next.sampler.skip(1);
        turned = {job_.classes.eye(state, sample.event), sample.weight, sample.event};
        return turned.state != 0;
    }
    const float uClass = next.sampler.get1D();
    const BsdfValue value = v.bsdf.evaluate(sample.wi, v.apart ? Terms::apart : Terms::together);
    PathState states[2] = {};
    float share[2] = {};
    for (int i = 0; i < value.n; ++i) {
        if (!v.followed(value.terms[i].event) && !gathersFrom(v)) continue;
        states[i] = job_.classes.eye(state, value.terms[i].event);
        share[i] = states[i] ? luminance(value.terms[i].f) : 0;
    }
    const float sum = share[0] + share[1];
    if (!(sum > 0)) return false;
    const int i = uClass * sum < share[0] ? 0 : 1;
    const float cosine = absDot(v.bsdf.normal(), sample.wi);
    turned = {states[i], value.terms[i].f * (cosine * sum / (share[i] * sample.pdfW)), value.terms[i].event};
    return true;
}

// A ray leaves the vertex: by delta and sharp lobes always, by R where light is gathered. Its hit is not traced yet.
bool EyeWalk::leave(const Vertex& v, Branch& next) noexcept {
    const PickAndPoint u = next.sampler.get3D();
    const auto sample = v.bsdf.sample(min(float(u.pick), oneMinusEpsilon), u.u);
    Turn turned;
    if (!sample || !scatter(v, *sample, next, turned)) return false;
    const bool gathered = !sample->delta && !v.followed(turned.event);
    next.gathering = v.arrived.gathering || gathered;
    next.deltas = gathered ? 0 : v.arrived.deltas + (sample->delta ? 1 : 0);
    next.sharpened = !gathered && (v.arrived.sharpened || !sample->delta);
    next.density = sample->delta ? 0 : float(v.rays) * sample->pdfW;
    Spectrum weight = turned.weight * (1 / float(v.rays));
    const float carried = maxComponent(v.arrived.throughput * weight);
    if (!(carried > 0)) return false;
    if (v.arrived.depth >= plan_.rouletteDepth) {
        const float survive = min(carried * float(v.rays), 0.95f);
        if (!(next.sampler.get1D() < survive)) return false;
        weight *= 1 / survive;
    } else {
        next.sampler.skip(1);
    }
    next.throughput = v.arrived.throughput * weight;
    next.state = turned.state;
    next.depth = v.arrived.depth + 1;
    next.lambda = sample->after(v.arrived.lambda);
    next.from = &v.at;
    next.ray = v.at.towards(sample->wi);
    next.footprint = scattered(job_.scene, v.at, v.arrived.footprint, -v.arrived.ray.d, sample->wi, sample->delta, sample->pdfW);
    if (out_.log) out_.log->scatter(turned.event, weight, sample->pdfW, sample->delta);
    return true;
}

// Several rays from x; siblings share their origin and are traced together.
void EyeWalk::split(const Vertex& v, const Sampler& sampler) noexcept {
    Siblings siblings;
    const uint32_t here = out_.log ? out_.log->here : 0;
    for (uint32_t j = 0; j < v.rays; ++j) {
        if (!leave(v, siblings.add(sampler.split(j, v.rays)))) siblings.drop();
        if (siblings.full() || (out_.log && siblings.size() > 0)) grow(siblings); // a log is told of one after the other
        if (out_.log) out_.log->here = here;
    }
    grow(siblings);
    if (out_.log) out_.log->here = here;
}

void EyeWalk::grow(Siblings& siblings) noexcept {
    const std::size_t n = siblings.size();
    if (n == 0) return;
    FixedVector<Ray, 16> rays;
    Hit hits[16];
    for (const Branch& b : siblings) rays.add(b.ray);
    if (n == 1)
        hits[0] = job_.scene.intersect(rays[0]);
    else
        job_.scene.intersect({rays.data(), n}, {hits, n}, false);
    out_.traced(uint32_t(n), siblings[0].depth);
    for (std::size_t i = 0; i < n; ++i) {
        siblings[i].hit = hits[i];
        follow(siblings[i]);
    }
    siblings.clear();
}

void EyeWalk::follow(Branch b) noexcept {
    SurfacePoint at, before;
    bool maySplit = b.from == nullptr;
    while (arrive(b, at)) {
        b.footprint = b.footprint.at(b.hit.t);
        const Bsdf bsdf = shade(job_.scene, at, -b.ray.d, b.footprint, b.lambda, Transport::radiance, Densities::forward);
        if (!b.from) {
            out_.aov(Aov::albedo, bsdf.albedo());
            out_.aov(Aov::normal, Spectrum(bsdf.normal().x, bsdf.normal().y, bsdf.normal().z));
            if (!job_.classes.continues(b.state)) return;
        }
        if (out_.log) (*out_.log)[out_.log->here].normal = bsdf.normal();
        const bool sharp = sharpAt(at), smooth = bsdf.smooth();
        const uint32_t rays = smooth && maySplit && plan_.gather > 1 ? plan_.gather : 1;
        const Vertex v{at, bsdf, b, sharp, rays, sharp || job_.classes.sorts(b.state)};
        Sampler sampler = b.sampler;
        if (smooth) {
            light(v, sampler);
            photons(v);
        } else {
            sampler.skip(3);
        }
        if (rays > 1) return split(v, sampler);
        Branch next(sampler);
        if (!leave(v, next)) return;
        next.hit = job_.scene.intersect(next.ray);
        out_.traced(1, next.depth);
        before = at;
        next.from = &before;
        b = next;
    }
}

} // namespace

float followEye(const Job& job, const EyePlan& plan, PathStart& start, Outputs& out) noexcept {
    Branch eye(start.sampler);
    eye.ray = start.ray;
    eye.lambda = start.lambda;
    eye.state = job.classes.eye();
    eye.hit = start.first;
    eye.footprint = cone(job.scene, start.footprint);
    EyeWalk walk(job, plan, out);
    walk.follow(eye);
    return walk.count();
}

} // namespace chiaro
