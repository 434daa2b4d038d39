// Radiosity seen by a camera: emission as it is, and the light that diffuse surfaces send according to a solution that knows no view
// (integrators/radiosity/solve.h). Three ways to look at it:
//   patch         every patch in its one radiosity
//   interpolated  irradiance between the points of the mesh, times the surface's own reflectance there
//   gather        irradiance from rays over the hemisphere that read the radiosity of what they meet, direct light by shadow rays and those
//                 rays together (final gather: Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, 1992)
// and four that show how it came about: the mesh, the sums of form factors, what is unshot, and by default none of them.
#include "core/math/warp.h"
#include "integrators/entries.h"
#include "integrators/radiosity/field.h"
#include "integrators/radiosity/solve_options.h"
#include "integrators/transport.h"
#include <array>
#include <fmt/format.h>

namespace chiaro {
namespace {

using namespace radiosity;

constexpr OptionSpec views[] = {
    {"show", OptionType::choice, "interpolated", 0, 0, "interpolated|patch|gather|mesh|rowsum|unshot",
     "the light: interpolated, flat patches, final gather; or the mesh, the sum of each row of form factors (closed: 1), what is unshot"},
    {"gather", OptionType::integer, "8", 1, 4096, "", "rays of an eye ray, of show=gather: to surfaces, and as many to lights"},
};
constexpr auto specs = [] {
    std::array<OptionSpec, std::size(views) + std::size(solveOptions)> all{};
    std::size_t n = 0;
    for (const OptionSpec& s : views) all[n++] = s;
    for (const OptionSpec& s : solveOptions) all[n++] = s;
    return all;
}();

enum class Show : uint8_t { interpolated, patch, gather, mesh, rowSum, unshot };
Show showOf(const Options& o) {
    const std::string& s = o.text("show");
    return s == "patch"    ? Show::patch
           : s == "gather" ? Show::gather
           : s == "mesh"   ? Show::mesh
           : s == "rowsum" ? Show::rowSum
           : s == "unshot" ? Show::unshot
                           : Show::interpolated;
}
bool ofLight(Show s) noexcept { return s == Show::interpolated || s == Show::patch || s == Show::gather; }

class RadiosityView final : public CameraIntegrator {
public:
    explicit RadiosityView(const Options& o)
        : cut_(patchSettings(o)), how_(solveSettings(o)), show_(showOf(o)), gather_(uint32_t(o.integer("gather"))) {
        how_.rowSums = show_ == Show::rowSum;
    }
    void prepare(const Job&) override;
    void radiance(const Job&, PathStart&, Outputs&) const noexcept override;

private:
    static constexpr std::size_t width = 16;
    void gather(const Job&, const SurfacePoint&, const Bsdf&, PathStart&, Outputs&) const noexcept;
    void fromSurfaces(const Job&, const SurfacePoint&, const Bsdf&, const Sampler&, uint32_t begin, uint32_t n, Outputs&) const noexcept;
    void fromLights(const Job&, const SurfacePoint&, const Bsdf&, const Sampler&, uint32_t begin, uint32_t n, Outputs&) const noexcept;
    Spectrum inside(const Patches::Place&) const noexcept;
    // Adds what light of every term leaves towards the eye, for an eye path that arrives like this.
    template <class Irradiance>
    void addTerms(const PathClasses& classes, PathState arrival, const Spectrum& weight, Irradiance&& of, Outputs& out) const {
        PathState state = classes.eye(arrival, Event::DR);
        for (uint32_t k = 0; k < field_.terms() && state; ++k, state = classes.eye(state, Event::DR))
            if (const Layer layer = classes.reached(state, kind_)) addFound(out, layer, weight * of(k) * (1 / pi));
    }

    PatchSettings cut_;
    SolveSettings how_;
    Show show_;
    uint32_t gather_;
    Patches patches_;
    Field field_;
    Lights3 unshot_;
    std::vector<float> rowSums_;
    LightKind kind_ = LightKind::area;
    bool scatters_ = true; // light is asked for that has been scattered at all
};

void RadiosityView::prepare(const Job& job) {
    SolveSettings how = how_;
    const PathState first[] = {job.classes.eye()};
    how.limits.apart = std::max(termsApart(job.classes, job.scene, first), 1u);
    how.limits.bounces =
        std::min(how.limits.bounces, job.classes.maxDepth() >= unlimitedDepth ? Limits::converged : job.classes.maxDepth());
    scatters_ = how.limits.bounces > 0;
    if (show_ == Show::gather && scatters_ && how.limits.bounces != Limits::converged) --how.limits.bounces; // the last is the gathering
    job.progress.phase("radiosity");
    patches_ = Patches::of(job, cut_);
    if (job.stop.requested()) return;
    Solution solution = solve(job, patches_, how);
    if (!solution.complete) return;
    tell(job, patches_, cut_, how, solution, "-i radiosity");
    field_ = Field(job.run, patches_, solution);
    unshot_ = std::move(solution.unshot);
    rowSums_ = std::move(solution.rowSums);
    kind_ = anyKind(job.scene);
}

void RadiosityView::radiance(const Job& job, PathStart& start, Outputs& out) const noexcept {
    const Scene& scene = job.scene;
    const PathClasses& classes = job.classes;
    const PathState eye = classes.eye();
    if (!start.first) {
        const LightHit sky = scene.lights().miss(start.ray, nullptr);
        if (out.log) logSky(*out.log, scene, start.ray, Spectrum(1));
        if (sky && ofLight(show_)) addFound(out, classes.reached(eye, sky.kind), sky.radiance);
        out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
        return;
    }
    const SurfacePoint at = scene.point(start.first, start.ray);
    const Vec3 wo = -start.ray.d;
    if (out.log) logSurface(*out.log, at, at.ns, start.first.t, Spectrum(1));
    if (const LightHit light = scene.lights().hit(at, wo, nullptr); light && ofLight(show_))
        addFound(out, classes.reached(eye, light.kind), light.radiance);
    const Bsdf bsdf = shade(scene, at, wo, start.footprint.at(start.first.t), start.lambda);
    const Vec3 n = bsdf.normal();
    out.aov(Aov::albedo, bsdf.albedo());
    out.aov(Aov::normal, {n.x, n.y, n.z});
    const auto place = patches_.at(start.first, dot(at.ng, wo) > 0);
    if (!place) {
        if (out.log) out.log->end("no patch");
        return;
    }
    if (!ofLight(show_)) return out.add(otherLayer, inside(*place));
    const Patch& patch = patches_[place->patch];
    if (show_ == Show::patch)
        addTerms(
            classes, eye, patch.reflectance, [&](uint32_t k) { return field_.onPatch(k, place->patch); }, out);
    else if (show_ == Show::interpolated)
        addTerms(
            classes, eye, bsdf.diffuseAlbedo(), [&](uint32_t k) { return field_.interpolated(patches_, k, *place); }, out);
    else if (scatters_)
        gather(job, at, bsdf, start, out);
}

// The diffuse part of a closure.
Spectrum diffuse(const Bsdf& bsdf, const Vec3& wi) noexcept {
    Spectrum f(0);
    for (const BsdfTerm& term : bsdf.evaluate(wi, Terms::apart))
        if (term.event == Event::DR) f += term.f;
    return f;
}

void RadiosityView::gather(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, PathStart& start, Outputs& out) const noexcept {
    if (!job.classes.eye(job.classes.eye(), Event::DR) || black(bsdf.diffuseAlbedo())) return;
    for (uint32_t begin = 0; begin < gather_; begin += width) {
        const uint32_t n = std::min<uint32_t>(width, gather_ - begin);
        fromSurfaces(job, at, bsdf, start.sampler, begin, n, out);
        fromLights(job, at, bsdf, start.sampler, begin, n, out);
    }
    out.traced(2 * gather_, 2);
}

void RadiosityView::fromSurfaces(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, const Sampler& sampler, uint32_t begin,
                                 uint32_t n, Outputs& out) const noexcept {
    const Scene& scene = job.scene;
    const PathClasses& classes = job.classes;
    const PathState state = classes.eye(classes.eye(), Event::DR);
    const Frame frame = Frame::about(bsdf.normal());
    Ray rays[width];
    Hit hits[width];
    Spectrum weights[width]; // f cos / pdf, the share of this ray
    float pdfs[width];
    std::size_t count = 0;
    for (uint32_t j = begin; j < begin + n; ++j) {
        const Vec3 local = cosineHemisphere(sampler.split(j, gather_).get2D()), wi = frame.toWorld(local);
        const Spectrum f = diffuse(bsdf, wi);
        if (black(f)) continue;
        weights[count] = f * (pi / float(gather_));
        pdfs[count] = cosineHemispherePdfW(local.z);
        rays[count++] = at.towards(wi);
    }
    if (count == 0) return;
    scene.intersect({rays, count}, {hits, count}, false);
    for (std::size_t k = 0; k < count; ++k) {
        LightHit light;
        if (hits[k])
            light = scene.lights().hit(scene.point(hits[k], rays[k]), -rays[k].d, &at);
        else
            light = scene.lights().miss(rays[k], &at);
        if (light) addFound(out, classes.reached(state, light.kind), weights[k] * light.radiance * powerHeuristic(pdfs[k], light.pdfW));
        if (!hits[k]) continue;
        const uint32_t patch = patches_.seen(hits[k], rays[k].d);
        if (patch == ~0u) continue;
        addTerms(
            classes, state, weights[k] * patches_[patch].reflectance, [&](uint32_t term) { return field_.onPatch(term, patch); }, out);
    }
}

void RadiosityView::fromLights(const Job& job, const SurfacePoint& at, const Bsdf& bsdf, const Sampler& sampler, uint32_t begin, uint32_t n,
                               Outputs& out) const noexcept {
    const PathState state = job.classes.eye(job.classes.eye(), Event::DR);
    Ray rays[width];
    uint8_t blocked[width];
    Spectrum values[width];
    LightKind kinds[width];
    std::size_t count = 0;
    for (uint32_t j = begin; j < begin + n; ++j) {
        Sampler u = sampler.split(j, gather_);
        u.skip(2);
        const PickAndPoint to = u.get3D();
        const auto light = job.scene.lights().sampleTowards(at, to.pick, to.u);
        if (!light || !(light->pdfW > 0)) continue;
        const Spectrum f = diffuse(bsdf, light->wi);
        if (black(f)) continue;
        const float cosine = absDot(bsdf.normal(), light->wi);
        const float weight = light->delta ? 1.f : powerHeuristic(light->pdfW, cosineHemispherePdfW(cosine));
        values[count] = light->radiance * f * (cosine * weight / (light->pdfW * float(gather_)));
        kinds[count] = light->kind;
        rays[count++] = light->shadow;
    }
    if (count == 0) return;
    job.scene.occluded({rays, count}, {blocked, count});
    for (std::size_t k = 0; k < count; ++k)
        if (!blocked[k]) addFound(out, job.classes.reached(state, kinds[k]), values[k]);
}

// How the solution came about, as a picture.
Spectrum RadiosityView::inside(const Patches::Place& at) const noexcept {
    const uint32_t i = at.patch;
    if (show_ == Show::rowSum) return Spectrum(rowSums_.empty() ? 0.f : rowSums_[i]);
    if (show_ == Show::unshot) {
        if (unshot_.empty()) return Spectrum(0);
        const Light& u = unshot_[i];
        return Spectrum(float(u[0]), float(u[1]), float(u[2])) * (1 / pi);
    }
    // A grey of its own for each patch, dark along its edges.
    const float s = at.s, t = at.t, edge = patches_[i].corners == 3 ? min(min(s, t), 1 - s - t) : min(min(s, t), min(1 - s, 1 - t));
    const float grey = 0.4f + 0.5f * float(hashMix(i) >> 40) * 0x1p-24f;
    return Spectrum(edge < 0.04f ? 0.05f : grey);
}

Traits traits(const Options& o) {
    Traits t;
    t.unbiased = false;
    if (!ofLight(showOf(o))) {
        t.lightTransport = false;
        t.covers = "";
        return t;
    }
    const int64_t bounces = o.integer("bounces");
    t.covers = bounces < 0 ? "L D* E" : fmt::format("L D{{0,{}}} E", bounces);
    // Constant elements: the error of the mean falls with the edge to the power 1.9 or so (Galerkin over points of the patches). Edges of
    // shadows that interpolation rounds off fall with the edge itself, but start below 0.1 %, so that this law serves.
    const bool sized = o.real("size") > 0;
    t.convergesOver = sized ? "size" : "patches";
    t.convergencePowers = {sized ? 1.9 : -0.95};
    t.convergenceStep = sized ? 0.7071067811865476 : 2;
    return t;
}

} // namespace

extern const IntegratorEntry radiosityEntry = {
    "radiosity", "radiosity: diffuse light between patches of all surfaces, solved once for every view", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<RadiosityView>(o); }};

} // namespace chiaro
