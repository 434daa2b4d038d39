// Ray casting with local illumination (Appel, Some Techniques for Shading Machine Renderings of Solids, 1968; Phong 1975): at the nearest
// hit every lamp answers on its own, as if nothing else were in the scene, and what other surfaces send is one constant. No mirror, no
// shadow: the baseline that every later algorithm is compared with. With shadows=ray the light of point, spot and directional lights is
// exact; shadows=map shows what two-pass shadow maps make of it.
//
//   L = Le + k_a I_a + sum over lamps of E f cos           ambient, then diffuse and specular
//
// An area light is one light at its centre (integrators/local_light.h). The environment is the background, and lights nothing: its share
// belongs to the ambient term.
#include "core/math/pixel_pattern.h"
#include "integrators/classic_shading.h"
#include "integrators/entries.h"
#include "integrators/fixed_vector.h"
#include "integrators/local_light.h"
#include "integrators/shadow_map.h"
#include "integrators/transport.h"
#include "materials/slot_reader.h"
#include "materials/surface_parameters.h"
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr OptionSpec specs[] = {
    {"shading", OptionType::choice, "material", 0, 0, "material|phong|blinn",
     "the material's own closure, or Lambert with Phong's or Blinn's highlight"},
    {"highlight", OptionType::choice, "normalised", 0, 0, "normalised|legacy",
     "of phong and blinn: with the factor that keeps energy, or k_s cos^n as first published"},
    {"exponent", OptionType::real, "0", 0, 1e6, "", "of phong and blinn; 0: from the roughness"},
    {"ambient", OptionType::real, "0", 0, 1e9, "", "radiance of a constant ambient light, times the diffuse albedo (layer \"other\")"},
    {"shadows", OptionType::choice, "none", 0, 0, "none|ray|map", "none, by a ray to every lamp, or by two-pass shadow maps"},
    {"map-size", OptionType::integer, "512", 1, 16384, "", "texels along the edge of a shadow map; a lamp with a place has six"},
    {"map-bias", OptionType::real, "1", 0, 1e6, "", "depth that a shadow map forgives, in texels: 0 shows acne, many detach shadows"},
    attenuationOption,
    c1Option,
    c2Option,
    c3Option,
    {"aa", OptionType::choice, "filter", 0, 0, "filter|centre", "samples from the pixel filter, or all at the pixel's centre"},
};

constexpr std::size_t width = 16; // of the widest packet

// A point to be lit, and the sample that sees it.
struct Lit {
    SurfacePoint at;
    Bsdf bsdf;
    ClassicSurface classic;
    Vec3 wo;
    Spectrum throughput;
    Outputs* out;
};
// What one lamp brings to it: the terms of the diffuse and the glossy event.
struct Delivery {
    const Lit* to = nullptr;
    BsdfTerm terms[2]; // f |cos| times the light that arrives
    int n = 0;
    Spectrum weight{0}; // f |cos| of both together, for the log
};

// What a lamp sent, or would have sent, for the log.
[[gnu::cold, gnu::noinline]] void logLamp(const Scene& scene, uint32_t light, const Delivery& d, const Ray& way, bool blocked,
                                          const Spectrum& added, PathLog& log) {
    const bool far = !std::isfinite(way.tfar);
    PathLog::Vertex v;
    v.parent = log.here;
    v.kind = PathLog::Kind::light;
    v.p = way.o + way.d * (far ? scene.radius() : way.tfar);
    v.t = far ? infinity : length(v.p - d.to->at.p);
    v.event = d.terms[0].event;
    v.weight = d.weight;
    v.pdfW = 1;
    v.delta = true;
    v.blocked = blocked;
    v.light = light;
    v.throughput = d.to->throughput * d.weight;
    v.contribution = added;
    if (blocked)
        if (const Hit hit = scene.intersect(way)) v.material = scene.attributes(hit).material;
    log.add(v);
}

class Raycast final : public CameraIntegrator {
public:
    explicit Raycast(const Options& o)
        : material_(o.text("shading") == "material"), normalised_(o.text("highlight") == "normalised"),
          lobe_(o.text("shading") == "blinn" ? ClassicLobe::blinn : ClassicLobe::phong), exponent_(float(o.real("exponent"))),
          ambient_(float(o.real("ambient"))), rays_(o.text("shadows") == "ray"), mapped_(o.text("shadows") == "map"),
          mapSize_(uint32_t(o.integer("map-size"))), mapBias_(float(o.real("map-bias"))), attenuation_(Attenuation::from(o)),
          centre_(o.text("aa") == "centre" ? gridPattern(1) : std::vector<Point2>()) {}

    void prepare(const Job&) override;
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override { shadeBatch(job, {&start, 1}, {&out, 1}); }
    void radianceWide(const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) const noexcept override {
        for (std::size_t i = 0; i < starts.size(); i += width) {
            const std::size_t n = std::min(width, starts.size() - i);
            shadeBatch(job, starts.subspan(i, n), outputs.subspan(i, n));
        }
    }
    Starts starts(const Job&) const override {
        Starts s;
        s.pattern = centre_;
        return s;
    }

private:
    using Points = FixedVector<Lit, width>;
    void shadeBatch(const Job&, std::span<PathStart>, std::span<Outputs>) const noexcept;
    void arrive(const Job&, PathStart&, Outputs&, Points&) const noexcept;
    void illuminate(const Job&, uint32_t lamp, Points&) const noexcept;
    Delivery delivery(const Job&, const Lit&, const LightSample&) const noexcept;

    bool material_, normalised_;
    ClassicLobe lobe_;
    float exponent_, ambient_;
    bool rays_, mapped_;
    uint32_t mapSize_;
    float mapBias_;
    Attenuation attenuation_;
    std::vector<Point2> centre_;
    LocalLights lights_;
    std::vector<ShadowMap> maps_; // one a lamp
};

void Raycast::prepare(const Job& job) {
    lights_ = LocalLights(job.scene, attenuation_);
    maps_.clear();
    if (!mapped_) return;
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < lights_.count(); ++i) bytes += ShadowMap::bytes(lights_, i, mapSize_);
    if (bytes > job.memoryLimit)
        throw Error(Exit::resources, fmt::format("the shadow maps of {} lamps need {:.3g} GB, limit {:.3g} GB. Use -i raycast:map-size={}, "
                                                 "or a larger --max-memory",
                                                 lights_.count(), double(bytes) / 1e9, double(job.memoryLimit) / 1e9,
                                                 std::max(1u, uint32_t(mapSize_ * std::sqrt(double(job.memoryLimit) / double(bytes))))));
    maps_.reserve(lights_.count());
    for (uint32_t i = 0; i < lights_.count(); ++i) maps_.emplace_back(job, lights_, i, mapSize_);
}

// What the eye sees before any lamp answers: background, emission, ambient.
void Raycast::arrive(const Job& job, PathStart& start, Outputs& out, Points& points) const noexcept {
    const Scene& scene = job.scene;
    const PathState eye = job.classes.eye();
    const Ray& ray = start.ray;
    if (!start.first) {
        const LightHit sky = scene.lights().miss(ray, nullptr);
        if (out.log) logSky(*out.log, scene, ray, Spectrum(1));
        if (sky) addFound(out, job.classes.reached(eye, sky.kind), sky.radiance);
        out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
        return;
    }
    const SurfacePoint at = scene.point(start.first, ray);
    const Spectrum throughput = segmentTransmittance(scene, nullptr, ray.d, &at, start.first.t);
    const Footprint here = cone(scene, start.footprint).at(start.first.t);
    const Bsdf bsdf = shade(scene, at, -ray.d, here, start.lambda);
    if (out.log) logSurface(*out.log, at, bsdf.normal(), start.first.t, throughput);
    if (const LightHit light = scene.lights().hit(at, -ray.d, nullptr))
        addFound(out, job.classes.reached(eye, light.kind), throughput * light.radiance);
    out.aov(Aov::albedo, bsdf.albedo());
    out.aov(Aov::normal, {bsdf.normal().x, bsdf.normal().y, bsdf.normal().z});
    if (!job.classes.continues(eye)) {
        if (out.log) out.log->end("no scattered light is wanted");
        return;
    }
    const SlotReader read(scene, at, -ray.d, here);
    const ClassicSurface classic =
        material_ ? ClassicSurface{}
                  : classicSurface(surfaceParameters(read, scene.material(at.material), at), lobe_, normalised_, exponent_);
    if (ambient_ > 0) addFound(out, otherLayer, throughput * (material_ ? bsdf.diffuseAlbedo() : classic.diffuse) * ambient_);
    points.add(at, bsdf, classic, -ray.d, throughput, &out);
}

Delivery Raycast::delivery(const Job& job, const Lit& p, const LightSample& light) const noexcept {
    const PathState eye = job.classes.eye();
    Delivery d;
    d.to = &p;
    const Spectrum arriving = p.throughput * light.radiance * segmentTransmittance(job.scene, &p.at, light.wi, nullptr, light.shadow.tfar);
    if (material_) {
        const BsdfValue value = p.bsdf.evaluate(light.wi, terms(job.classes, eye));
        const float cosine = absDot(p.bsdf.normal(), light.wi);
        for (const BsdfTerm& term : value) d.terms[d.n++] = {term.f * arriving * cosine, term.event};
        d.weight = value.f() * cosine;
        return d;
    }
    const bool hidden = (dot(p.at.ng, light.wi) > 0) != (dot(p.at.ng, p.wo) > 0); // the other side of the surface
    if (hidden) return d;
    const ClassicSurface::Answer a = p.classic.answer(p.bsdf.normal(), p.wo, light.wi);
    d.weight = a.diffuse + a.specular;
    if (!black(a.diffuse)) d.terms[d.n++] = {a.diffuse * arriving, Event::DR};
    if (!black(a.specular)) d.terms[d.n++] = {a.specular * arriving, Event::GR};
    return d;
}

// One lamp at all points: neighbours, whose shadow rays go the same way.
void Raycast::illuminate(const Job& job, uint32_t lamp, Points& points) const noexcept {
    FixedVector<Delivery, width> waiting;
    FixedVector<Ray, width> rays;
    for (const Lit& p : points) {
        const auto light = lights_.towards(lamp, p.at);
        if (!light) continue;
        waiting.add(delivery(job, p, *light));
        if (waiting[waiting.size() - 1].n == 0)
            waiting.drop();
        else
            rays.add(light->shadow);
    }
    uint8_t blocked[width] = {};
    if (rays_ && waiting.size() > 0) lights_.occluded(lamp, {rays.data(), rays.size()}, {blocked, rays.size()});
    for (std::size_t k = 0; k < waiting.size(); ++k) {
        const Delivery& d = waiting[k];
        Outputs& out = *d.to->out;
        if (mapped_) blocked[k] = maps_[lamp].shadowed(d.to->at, mapBias_);
        out.traced(rays_ ? 1 : 0, 1);
        Spectrum added(0);
        for (int i = 0; i < d.n && !blocked[k]; ++i) {
            const Lamp& from = lights_.lamp(lamp);
            const Layer layer = job.classes.reached(job.classes.eye(job.classes.eye(), d.terms[i].event), from.kind);
            out.add(layer, d.terms[i].f);
            if (layer != 0) added += d.terms[i].f;
        }
        if (out.log) [[unlikely]]
            logLamp(job.scene, lights_.lamp(lamp).first, d, rays[k], blocked[k] != 0, added, *out.log);
    }
}

void Raycast::shadeBatch(const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) const noexcept {
    Points points;
    for (std::size_t i = 0; i < starts.size(); ++i) arrive(job, starts[i], outputs[i], points);
    if (points.size() == 0) return;
    for (uint32_t lamp = 0; lamp < lights_.count(); ++lamp) illuminate(job, lamp, points);
}

// Exact are emission and, where rays see what lies between, the materials' own answer to lights that are points by themselves. Light
// without shadows, and that of an area light taken at its centre, is biased by definition: it is in the picture, but not among the paths
// that it covers. On those it is exact; only the ambient term, which is no path at all, comes on top of them.
Traits traits(const Options& o) {
    Traits t;
    const bool exact = o.text("shadows") == "ray" && o.text("shading") == "material" && o.text("attenuation") == "physical";
    t.covers = exact ? "Ld (D|G) E | (La|Le) E" : "(La|Le) E";
    t.approximates = "(La|Ld) (D|G) E";
    t.unbiased = o.real("ambient") == 0;
    t.deterministic = o.text("aa") == "centre";
    return t;
}

} // namespace

extern const IntegratorEntry raycastEntry = {
    "raycast", "ray casting: local illumination by every lamp, ambient light; no reflections, shadows only if asked for", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Raycast>(o); }};

} // namespace chiaro
