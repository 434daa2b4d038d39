// Stochastic progressive photon mapping (Hachisuka and Jensen 2009): every iteration shoots new photons and looks at them with one new eye
// path a pixel (photon_eye.h without gather rays), in discs that shrink from iteration to iteration (sppm_radius.h). The picture is the
// mean of the iterations (Knaus and Zwicker 2011): each is a photon map of its own, right but for the bias of its radius. One time an
// iteration, so that photons and eye see the same scene. Memory is that of one iteration.
#include "core/render/archive.h"
#include "integrators/entries.h"
#include "integrators/iterations.h"
#include "integrators/photon_eye.h"
#include "integrators/photon_field.h"
#include "integrators/sppm_radius.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro {
namespace {

using Field = PhotonFieldOptions;
constexpr OptionSpec specs[] = {
    {"count", OptionType::integer, "0", 0, 1e10, "", "light paths an iteration; 0: as many as the picture has pixels"},
    {"caustic-count", OptionType::integer, "0", 0, 1e10, "", "more of them, aimed at mirrors and glass; 0: as many"},
    {"radius", OptionType::real, "0", 0, 1e9, "", "metres, of the first iteration's discs; 0: twice the width of a typical pixel"},
    {"schedule", OptionType::choice, "global", 0, 0, "global|pixel",
     "radii shrink by the number of the iteration alone, or by what each pixel has found"},
    {"alpha", OptionType::real, "0.6666666666666666", 0.01, 0.99, "", "how much of the variance is spent on less bias: 1 none, 0 all"},
    {"sharp", OptionType::real, "0.25", 0, 1, "",
     "rough lobes below this roughness are followed like mirrors; photons do not show in them"},
    {"kernel", OptionType::choice, "constant", 0, 0, "constant|cone|epanechnikov", Field::kernel.help},
    {"shrink", OptionType::real, "1", 1e-3, 1e3, "", "multiplies the radii: the bias of a finite number of iterations vanishes with it"},
    Field::rouletteDepth,
};

constexpr float firstRadius = 2;    // widths of a pixel
constexpr float mostOfScene = 0.1f; // of its radius
constexpr double leastPaths = 4096, mostPaths = 1 << 22;

class Sppm final : public Integrator, public PhotonSource {
public:
    explicit Sppm(const Options& o)
        : ownRadii_(o.text("schedule") == "pixel"), alpha_(o.real("alpha")), radius_(float(o.real("radius"))),
          shrink_(float(o.real("shrink"))) {
        field_.paths = uint64_t(o.integer("count"));
        field_.causticPaths = uint64_t(o.integer("caustic-count"));
        field_.density.kernel = photonKernel(o);
        field_.rouletteDepth = eye_.rouletteDepth = uint32_t(o.integer("rr-depth"));
        eye_.sharp = float(o.real("sharp"));
        eye_.gather = 0;
    }
    void prepare(const Job&) override;
    void render(const Job&, const Pass&, Film&) override;
    void save(Writer&) const override;
    void load(const Job&, Reader&) override;
    std::vector<PhotonMapView> photonMaps() const override { return photons_.views(); }
    std::size_t photonBytes() const override { return photons_.bytes() + pixels_.capacity() * sizeof(PixelStatistics); }

private:
    bool iterate(const Job&, uint32_t iteration, const SampleMask*, Film&);
    float radiusOf(uint32_t iteration) const noexcept { return first_ * float(std::sqrt(progressiveArea(iteration, alpha_))); }

    bool ownRadii_;
    double alpha_;
    float radius_, shrink_;
    PhotonFieldPlan field_;
    EyePlan eye_;
    PhotonField photons_;
    float first_ = 0;                     // radius of the first iteration
    std::vector<PixelStatistics> pixels_; // of the crop, rows from the top; empty: one radius for all
};

void Sppm::prepare(const Job& job) {
    const PhotonScale scale = photonScale(job);
    first_ = radius_ > 0 ? radius_ : std::min(firstRadius * scale.pixel, mostOfScene * job.scene.radius());
    if (!(first_ > 0)) first_ = mostOfScene * job.scene.radius(); // nothing is seen
    first_ *= shrink_;
    PhotonFieldPlan plan = field_;
    if (plan.paths == 0) plan.paths = uint64_t(std::clamp(scale.pixels, leastPaths, mostPaths));
    if (plan.causticPaths == 0) plan.causticPaths = plan.paths;
    photons_ = PhotonField(plan);
    photons_.prepare(job, scale);
    if (ownRadii_) pixels_.assign(job.view.crop.area(), {first_ * first_, 0});
    const std::string caustic = photons_.caustic() ? fmt::format(" and {} aimed at mirrors and glass", plan.causticPaths) : std::string();
    job.notes.tell("photons", fmt::format("{} light paths an iteration{}, first radius {:.3g} m      keep it with: -i "
                                          "sppm:count={},caustic-count={},radius={:.3g}",
                                          plan.paths, caustic, double(first_), plan.paths, plan.causticPaths, double(first_ / shrink_)));
}

void Sppm::render(const Job& job, const Pass& pass, Film& film) {
    const uint32_t begin = nextIteration(film, pass);
    for (uint32_t i = begin; i < pass.end && !(i > begin && job.stop.requested()); ++i) {
        if (!iterate(job, i, pass.active, film)) return;
        job.progress.advance(1.0 / (pass.end - pass.begin));
    }
}

// False: stopped before anything was added.
bool Sppm::iterate(const Job& job, uint32_t iteration, const SampleMask* active, Film& film) {
    Sampler sampler(job.seed, job.sampler, Stream::chain, 0, iteration);
    Starts how;
    how.time = job.shutter.open + sampler.get1D() * (job.shutter.close - job.shutter.open);
    how.whole = true;
    const float radius = radiusOf(iteration);
    photons_.setRadius(radius);
    if (!photons_.trace(job, iteration, how.time)) return false;
    if (iteration == 0) job.notes.tell("light", photons_.balance() + "; of the first iteration");
    EyePlan plan = eye_;
    plan.global = &photons_.global();
    plan.caustic = photons_.caustic();
    const Rect crop = film.layout().crop;
    const auto look = [&](std::span<PathStart> starts, std::span<Outputs> outputs) {
        EyePlan own = plan;
        for (std::size_t i = 0; i < starts.size(); ++i) {
            const Pixel p = starts[i].pixel;
            PixelStatistics* const pixel =
                pixels_.empty() ? nullptr : &pixels_[std::size_t(p.y - crop.y0) * crop.width() + (p.x - crop.x0)];
            own.radius = pixel ? std::sqrt(pixel->radius2) : radius;
            const float found = followEye(job, own, starts[i], outputs[i]);
            if (pixel) pixel->add(found, float(alpha_));
        }
    };
    Progress unheard; // the loop would tell of a whole pass
    const Job quiet{{job.scene, job.classes, job.shutter, job.seed, job.sampler, job.run, job.stop, unheard, job.notes, job.memoryLimit},
                    job.view,
                    job.prepass};
    forEachBatch(quiet, {iteration, iteration + 1, active}, film, look, how);
    return true;
}

void Sppm::save(Writer& to) const {
    to.value(first_);
    to.array(pixels_);
}

void Sppm::load(const Job& job, Reader& from) {
    first_ = from.value<float>();
    pixels_ = from.array<PixelStatistics>();
    bool sound = first_ > 0 && std::isfinite(first_) && pixels_.size() == (ownRadii_ ? job.view.crop.area() : 0);
    for (const PixelStatistics& p : pixels_) sound = sound && p.radius2 > 0 && p.radius2 <= first_ * first_ && p.kept >= 0;
    if (!sound) from.refuse("its radii are not those of this picture; render it from the beginning");
}

Traits traits(const Options& o) {
    Traits t;
    t.unbiased = false;
    t.mergeable = o.text("schedule") != "pixel";
    if (o.real("sharp") > 0) t.misses = "Ld S+ G .* E"; // caustics of a delta light on a lobe that photons do not show in
    t.convergesOver = "shrink";
    t.convergencePowers = {1, 2}; // edges, and the illuminance's curvature
    t.convergenceStep = 0.5;
    return t;
}

} // namespace

extern const IntegratorEntry sppmEntry = {
    "sppm", "stochastic progressive photon mapping: new photons every iteration, in discs that shrink", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Sppm>(o); }};

} // namespace chiaro
