// Distributed ray tracing (Cook, Porter, Carpenter 1984): Whitted's tree of rays, every ray of it spread over what it stands for. Eye rays
// over pixel, lens and shutter (the start has them), shadow rays over the area or solid angle of the lights, reflected and transmitted
// rays over the rough lobe. No diffuse interreflection: after D the light is found directly, or comes from a constant or a pre-pass.
//
// Light paths: L D? (G|S)* E. At each vertex diffuse light is sampled at the lights alone; light by the glossy lobe is sampled both ways
// and weighed (Veach and Guibas 1995), so that a lamp in a brushed plate is neither missed nor counted twice. Of n samples at the first
// hit, n, n/d, n/d^2, ... 1 are left at deeper levels: what is deep in the tree is a small part of the pixel (Arvo and Kirk 1990 on
// splitting). Branches that carry little survive by roulette, so the tree ends without bias.
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/render/prepass.h"
#include "core/scene/ray_cone.h"
#include "integrators/distributed_light.h"
#include "integrators/entries.h"
#include "integrators/fixed_vector.h"
#include "integrators/transport.h"
#include "materials/possible_events.h"

namespace chiaro {
namespace {

constexpr OptionSpec specs[] = {
    {"light-samples", OptionType::integer, "4", 1, 4096, "", "shadow rays from the first hit, to all lights together"},
    {"glossy-samples", OptionType::integer, "4", 1, 4096, "", "rays over the rough lobe of the first hit"},
    {"split-decay", OptionType::real, "4", 1, 4096, "", "both numbers are divided by it at each further level, down to 1"},
    {"min-weight", OptionType::real, "0.02", 1e-4, 1, "", "share of the picture below which a branch survives by roulette"},
    {"shadows", OptionType::boolean, "on", 0, 0, "", "off: every light is seen from everywhere"},
    {"gloss", OptionType::boolean, "on", 0, 0, "", "rays over rough reflection lobes; off: these show lights only"},
    {"translucency", OptionType::boolean, "on", 0, 0, "", "rays over rough transmission lobes; off: these show lights only"},
    {"ambient", OptionType::real, "0", 0, 1e9, "",
     "radiance that reaches every diffuse surface from all around, cd/m2; a pre-pass replaces it"},
    {"show", OptionType::choice, "light", 0, 0, "light|shadow",
     "shadow: share of the first hit's shadow rays that arrive: umbra 0, penumbra between, lit 1"},
};

constexpr uint32_t levels = 16;        // with their own number of samples; 1 beyond
constexpr uint32_t mostNested = 24;    // splittings inside each other; what goes on beyond is one path
constexpr uint32_t rouletteDepth = 16; // from here on even branches of full weight may end

struct Plan {
    uint32_t light[levels], glossy[levels];
    float minWeight = 0, ambient = 0;
    bool shadows = true, reflected = true, transmitted = true, showShadow = false;

    bool follows(Event e) const noexcept { return e == Event::GR ? reflected : e == Event::GT && transmitted; }
    // Can rays over a rough lobe of this material be wanted?
    bool spreads(const MaterialDesc& m) const noexcept {
        const LetterSet events = possibleEvents(m);
        return (reflected && (events & letter(Event::GR))) || (transmitted && (events & letter(Event::GT)));
    }
};

// A ray of the tree on its way.
struct Branch {
    explicit Branch(const Sampler& s) noexcept : sampler(s) {}
    Ray ray;
    Footprint footprint; // where the ray begins; once it has arrived, there
    Spectrum throughput{1};
    Sampler sampler;
    Wavelengths lambda;
    PathState state = 0;
    float density = 0; // number of lobe samples x their pdfW; 0: from the camera or a delta lobe, nothing else finds what lies there
    Event event = Event::SR;
    Spectrum weight; // of the event, for the log
    float pdfW = 0;
    Hit hit;
};
// Where it comes from.
struct Origin {
    const SurfacePoint* at = nullptr; // null: the camera
    uint32_t lightSamples = 0;        // taken there
    uint32_t depth = 0, nested = 0;   // of the ray: scatterings, and splittings around it
};

class Tree {
public:
    Tree(const Job& job, const Plan& plan, Outputs& out) noexcept : job_(job), plan_(plan), out_(out) {}
    void follow(Branch, Origin) noexcept;

private:
    using Siblings = FixedVector<Branch, 16>;
    struct Vertex { // a hit and what a path knows there
        const SurfacePoint& at;
        const Bsdf& bsdf;
        const Branch& arrived;
        Origin next; // of the branches that leave it
    };
    bool arrive(Branch&, const Origin&, SurfacePoint& at) noexcept;
    void light(const Vertex&, uint32_t lobeSamples, Sampler&) noexcept;
    void split(const Vertex&, uint32_t lobeSamples, const Sampler&) noexcept;
    void grow(const Vertex&, Siblings&) noexcept;
    bool overLobe(const Vertex&, uint32_t samples, bool orDelta, Branch&) noexcept;
    bool leave(const Vertex&, const Vec3& wi, const Spectrum& weight, Event, Branch&) noexcept;
    void scattered(const Branch& b) noexcept {
        if (out_.log) [[unlikely]]
            out_.log->scatter(b.event, b.weight, b.pdfW, b.density == 0);
    }

    const Job& job_;
    const Plan& plan_;
    Outputs& out_;
};

// Light found by the ray itself; true where it may be scattered.
bool Tree::arrive(Branch& b, const Origin& from, SurfacePoint& at) noexcept {
    return arriveByEye(job_, {b.ray, b.hit, from.at, b.state, from.depth}, b.throughput, at, out_, [&](const LightHit& light) {
        const float rival = float(from.lightSamples) * light.pdfW;
        const float weight = b.density == 0 ? 1.f : powerHeuristic(b.density, rival);
        addFound(out_, job_.classes.reached(b.state, light.kind), b.throughput * light.radiance * weight);
    });
}

// Direct light at a vertex, and what stands for the light that other surfaces send to its diffuse part.
void Tree::light(const Vertex& v, uint32_t lobeSamples, Sampler& sampler) noexcept {
    const Branch& b = v.arrived;
    const DirectPlan how{v.next.lightSamples, lobeSamples, plan_.reflected, plan_.transmitted, plan_.shadows};
    const ShadowCount rays = addDirectSplit(job_, v.at, v.bsdf, b.state, b.throughput, how, sampler, out_);
    if (rays.cast > 0) out_.traced(0, v.next.depth);
    if (job_.prepass)
        job_.prepass->addIndirect(job_.classes, b.hit, v.at, v.bsdf, b.state, b.throughput, out_);
    else if (plan_.ambient > 0)
        addFound(out_, otherLayer, b.throughput * v.bsdf.diffuseAlbedo() * plan_.ambient);
}

// A branch leaves the vertex, if its light is wanted and the roulette lets it: one that carries less than minWeight is raised to it.
bool Tree::leave(const Vertex& v, const Vec3& wi, const Spectrum& weight, Event event, Branch& b) noexcept {
    b.state = job_.classes.eye(v.arrived.state, event);
    b.throughput = v.arrived.throughput * weight;
    const float carried = maxComponent(b.throughput);
    if (!b.state || !(carried > 0)) return false;
    const float survive = min(carried / plan_.minWeight, v.next.depth > rouletteDepth ? 0.95f : 1.f);
    if (survive < 1) {
        if (!(b.sampler.get1D() < survive)) return false;
        b.throughput *= 1 / survive;
    } else {
        b.sampler.skip(1);
    }
    b.ray = v.at.towards(wi);
    b.footprint = chiaro::scattered(job_.scene, v.at, v.arrived.footprint, -v.arrived.ray.d, wi, b.density == 0, b.pdfW);
    b.lambda = v.arrived.lambda;
    b.event = event;
    b.weight = weight * (survive < 1 ? 1 / survive : 1.f);
    return true;
}

// One of several rays over the rough lobes; the diffuse part of the mixture is not followed. orDelta: the delta lobes too.
bool Tree::overLobe(const Vertex& v, uint32_t samples, bool orDelta, Branch& b) noexcept {
    const PickAndPoint u = b.sampler.get3D();
    const auto sample = v.bsdf.sample(min(float(u.pick), oneMinusEpsilon), u.u);
    if (!sample) return false;
    b.pdfW = sample->pdfW;
    if (sample->delta) {
        if (!orDelta || !leave(v, sample->wi, sample->weight, sample->event, b)) return false;
        b.lambda = sample->after(b.lambda);
        return true;
    }
    const float part = fault(Fault::splitUnweighted) ? 1.f : 1.f / float(samples);
    for (const BsdfTerm& term : v.bsdf.evaluate(sample->wi, Terms::apart)) {
        if (!plan_.follows(term.event)) continue;
        b.density = float(samples) * sample->pdfW;
        return leave(v, sample->wi, term.f * (absDot(v.bsdf.normal(), sample->wi) * part / sample->pdfW), term.event, b);
    }
    return false;
}

// All the branches of a vertex: mirror and refraction without dice, the rough lobe by its samples.
void Tree::split(const Vertex& v, uint32_t lobeSamples, const Sampler& sampler) noexcept {
    Siblings siblings;
    uint32_t k = 0;
    for (const DeltaBranch& d : v.bsdf.deltaSplit()) {
        Branch& b = siblings.add(sampler);
        // Far away among the dimensions, not Sampler::split: branches of different kinds are no samples of one integral.
        b.sampler.skip(++k << 16);
        b.pdfW = 1;
        if (!leave(v, d.wi, d.weight, d.event, b)) siblings.drop();
    }
    for (uint32_t j = 0; j < lobeSamples; ++j) {
        if (siblings.full()) grow(v, siblings);
        if (!overLobe(v, lobeSamples, false, siblings.add(sampler.split(j, lobeSamples)))) siblings.drop();
    }
    grow(v, siblings);
}

// Siblings share their origin: traced together.
void Tree::grow(const Vertex& v, Siblings& siblings) noexcept {
    const std::size_t n = siblings.size();
    if (n == 0) return;
    FixedVector<Ray, 16> rays;
    Hit hits[16];
    for (const Branch& b : siblings) rays.add(b.ray);
    if (n == 1) hits[0] = job_.scene.intersect(rays[0]);
    if (n > 1) job_.scene.intersect({rays.data(), n}, {hits, n}, false);
    out_.traced(uint32_t(n), v.next.depth);
    const uint32_t here = out_.log ? out_.log->here : 0;
    for (std::size_t i = 0; i < n; ++i) {
        siblings[i].hit = hits[i];
        if (out_.log) out_.log->here = here;
        scattered(siblings[i]);
        follow(siblings[i], v.next);
    }
    if (out_.log) out_.log->here = here;
    siblings.clear();
}

void Tree::follow(Branch b, Origin from) noexcept {
    SurfacePoint at, before;
    while (arrive(b, from, at)) {
        b.footprint = b.footprint.at(b.hit.t);
        const Bsdf bsdf = shade(job_.scene, at, -b.ray.d, b.footprint, b.lambda, Transport::radiance, Densities::forward);
        if (!from.at) {
            out_.aov(Aov::albedo, bsdf.albedo());
            out_.aov(Aov::normal, Spectrum(bsdf.normal().x, bsdf.normal().y, bsdf.normal().z));
            if (!job_.classes.continues(b.state)) return;
        }
        if (out_.log) (*out_.log)[out_.log->here].normal = bsdf.normal();
        const bool splits = from.nested < mostNested, rough = bsdf.smooth() && plan_.spreads(job_.scene.material(at.material));
        const uint32_t level = std::min(from.depth, levels - 1);
        const uint32_t lobeSamples = !rough ? 0 : splits ? plan_.glossy[level] : 1;
        const Vertex v{at, bsdf, b, {&at, bsdf.smooth() ? plan_.light[level] : 0, from.depth + 1, from.nested + 1}};
        Sampler sampler = b.sampler;
        if (v.next.lightSamples > 0) light(v, lobeSamples, sampler);
        if (splits) return split(v, lobeSamples, sampler);
        Branch next(sampler);
        if (!overLobe(v, 1, true, next)) return;
        next.hit = job_.scene.intersect(next.ray);
        out_.traced(1, v.next.depth);
        scattered(next);
        from = v.next;
        before = at;
        from.at = &before;
        b = next;
    }
}

class Distributed final : public CameraIntegrator {
public:
    explicit Distributed(const Options& o) {
        for (uint32_t level = 0; level < levels; ++level) {
            const double divisor = std::pow(o.real("split-decay"), level);
            plan_.light[level] = uint32_t(std::max(1.0, double(o.integer("light-samples")) / divisor));
            plan_.glossy[level] = uint32_t(std::max(1.0, double(o.integer("glossy-samples")) / divisor));
        }
        plan_.minWeight = float(o.real("min-weight"));
        plan_.ambient = float(o.real("ambient"));
        plan_.shadows = o.boolean("shadows");
        plan_.reflected = o.boolean("gloss");
        plan_.transmitted = o.boolean("translucency");
        plan_.showShadow = o.text("show") == "shadow";
    }
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override {
        if (plan_.showShadow) return shadowView(job, start, out);
        Branch eye(start.sampler);
        eye.ray = start.ray;
        eye.lambda = start.lambda;
        eye.state = job.classes.eye();
        eye.hit = start.first;
        eye.footprint = cone(job.scene, start.footprint);
        Tree(job, plan_, out).follow(eye, {});
    }

private:
    void shadowView(const Job& job, PathStart& start, Outputs& out) const noexcept {
        if (!start.first) return;
        const SurfacePoint at = job.scene.point(start.first, start.ray);
        const Bsdf bsdf =
            shade(job.scene, at, -start.ray.d, start.footprint.at(start.first.t), start.lambda, Transport::radiance, Densities::forward);
        if (out.log) logSurface(*out.log, at, bsdf.normal(), start.first.t, Spectrum(1));
        Outputs unseen = out; // the light itself is not shown
        unseen.log = nullptr;
        const ShadowCount rays =
            addDirectSplit(job, at, bsdf, job.classes.eye(), Spectrum(1), {.lightSamples = plan_.light[0]}, start.sampler, unseen);
        out.traced(rays.cast, rays.cast > 0 ? 1 : 0);
        if (rays.cast > 0) addFound(out, otherLayer, Spectrum(float(rays.arrived) / float(rays.cast)));
    }
    Plan plan_;
};

Traits traits(const Options& o) {
    const bool gloss = o.boolean("gloss"), translucency = o.boolean("translucency");
    Traits t;
    t.covers = gloss && translucency ? "L D? (G|S)* E"
               : gloss               ? "L (D|G)? (GR|S)* E"
               : translucency        ? "L (D|G)? (GT|S)* E"
                                     : "L (D|G)? S* E";
    t.misses = "Ld S+ G .* E"; // a delta light is found by sampling it or not at all
    t.unbiased = o.boolean("shadows") && o.real("ambient") == 0;
    t.field = gloss && translucency ? "(G|S)* E" : gloss ? "(GR|S)* E" : translucency ? "(GT|S)* E" : "S* E";
    if (o.text("show") == "shadow") {
        t.lightTransport = false;
        t.covers = t.misses = t.field = "";
    }
    return t;
}

} // namespace

extern const IntegratorEntry distributedEntry = {
    "distributed", "distributed ray tracing: soft shadows, gloss, translucency, depth of field, motion blur", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Distributed>(o); }};

} // namespace chiaro
