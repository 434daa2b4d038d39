// Photon mapping (Jensen, Global Illumination Using Photon Maps, 1996; Realistic Image Synthesis Using Photon Mapping, 2001): photons are
// traced once and stored; eye paths (photon_eye.h, which says what light each of its estimates carries) gather them. The map is part of
// every pixel, so that its error is the same in all samples of a picture and no number of them removes it: more photons and a smaller
// radius do.
#include "integrators/entries.h"
#include "integrators/photon_eye.h"
#include "integrators/photon_field.h"
#include <algorithm>

namespace chiaro {
namespace {

using Field = PhotonFieldOptions;
constexpr OptionSpec specs[] = {
    Field::count,
    Field::causticCount,
    {"gather", OptionType::integer, "4", 0, 4096, "",
     "rays of the final gathering at the first diffuse surface; 0: the global map is shown as it is"},
    {"sharp", OptionType::real, "0.25", 0, 1, "",
     "rough lobes below this roughness are followed like mirrors; photons do not show in them"},
    Field::estimate,
    Field::k,
    Field::radius,
    Field::causticRadius,
    Field::kernel,
    Field::shrink,
    Field::rouletteDepth,
};

PhotonFieldPlan fieldPlan(const Options& o) {
    PhotonFieldPlan p = Field::plan(o);
    p.direct = p.all = o.integer("gather") > 0; // at the second surface everything that arrives is wanted
    return p;
}

class PhotonMapping final : public CameraIntegrator, public PhotonSource {
public:
    explicit PhotonMapping(const Options& o) : field_(fieldPlan(o)) {
        plan_.gather = uint32_t(o.integer("gather"));
        plan_.sharp = float(o.real("sharp"));
        plan_.rouletteDepth = uint32_t(o.integer("rr-depth"));
    }
    void prepare(const Job& job) override {
        job.progress.phase("photons");
        field_.prepare(job, photonScale(job));
        if (!field_.trace(job, 0, {})) return;
        plan_.global = &field_.global();
        plan_.caustic = field_.caustic();
        job.notes.tell("photons", field_.summary() + "      keep it with: -i photon:" + field_.recipe());
        job.notes.tell("light", field_.balance());
        if (movesInShutter(job))
            job.notes.warn("photon: things move while the shutter is open, and the photon map holds all their places at once: light and "
                           "shadows on and about them are blurred. Use -i sppm, which takes one time after the other.");
    }
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override {
        if (plan_.global) followEye(job, plan_, start, out); // else stopped while preparing
    }
    std::vector<PhotonMapView> photonMaps() const override { return field_.views(); }
    std::size_t photonBytes() const override { return field_.bytes(); }

private:
    static bool movesInShutter(const Job& job) {
        const auto [open, close] = job.shutter;
        if (open == close) return false;
        const auto parts = job.scene.parts();
        return std::any_of(parts.begin(), parts.end(), [&](const DrawnPart& part) { return part.triangles > 0 && job.scene.moves(part); });
    }
    PhotonField field_;
    EyePlan plan_;
};

Traits traits(const Options& o) {
    Traits t;
    t.unbiased = false;
    if (o.real("sharp") > 0) t.misses = "Ld S+ G .* E"; // caustics of a delta light on a lobe that photons do not show in
    t.convergesOver = "shrink";
    const bool nearest = o.text("estimate") == "knn";
    t.convergencePowers = nearest ? std::vector<double>{1} : std::vector<double>{1, 2}; // edges, and the illuminance's curvature
    t.convergenceStep = nearest ? 0.7071067811865476 : 0.5;
    return t;
}

} // namespace

extern const IntegratorEntry photonEntry = {
    "photon", "photon mapping: a global and a caustic map, direct light by shadow rays, final gathering", specs, traits,
    [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<PhotonMapping>(o); }};

} // namespace chiaro
