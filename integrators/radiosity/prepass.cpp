// Radiosity as the diffuse field of ray-traced views: the two-pass method (Wallace, Cohen, Greenberg 1987; Sillion and Puech 1989), with
// the diffuse exchange from a radiosity solution and everything specular by rays. The field holds what has been scattered at least once
// before it arrives: direct light belongs to whoever traces the view.
#include "core/render/fault.h"
#include "integrators/entries.h"
#include "integrators/radiosity/field.h"
#include "integrators/radiosity/solve_options.h"
#include "integrators/transport.h"
#include <fmt/format.h>

namespace chiaro {
namespace {

using namespace radiosity;

void refuseDirectOnly(const Options& o) {
    if (const int64_t bounces = o.integer("bounces"); bounces >= 0 && bounces < 2)
        throw Error(Exit::usage, fmt::format("--prepass radiosity:bounces={}: nothing is left, for direct light is never in a pre-pass; "
                                             "2 or more, or -1 until converged",
                                             bounces));
}

class RadiosityPrepass final : public Prepass {
public:
    explicit RadiosityPrepass(const Options& o) : cut_(patchSettings(o)), how_(solveSettings(o)) { refuseDirectOnly(o); }
    void solve(const Work&) override;
    void addIndirect(const PathClasses&, const Hit&, const SurfacePoint&, const Bsdf&, PathState eye, const Spectrum& weight,
                     Outputs&) const noexcept override;
    void save(Writer& to) const override { field_.save(to); }
    void load(const Work& work, Reader& from) override {
        patches_ = Patches::of(work, cut_);
        field_.load(work.run, patches_, from);
        kind_ = anyKind(work.scene);
    }

private:
    PatchSettings cut_;
    SolveSettings how_;
    Patches patches_;
    Field field_;
    LightKind kind_ = LightKind::area;
};

void RadiosityPrepass::solve(const Work& work) {
    SolveSettings how = how_;
    how.limits.apart = std::max(termsApart(work.classes, work.scene, arrivalsThroughMirrors(work.classes)), 1u);
    how.limits.bounces =
        std::min(how.limits.bounces, work.classes.maxDepth() >= unlimitedDepth ? Limits::converged : work.classes.maxDepth());
    patches_ = Patches::of(work, cut_);
    if (work.stop.requested()) return;
    const Solution solution = radiosity::solve(work, patches_, how);
    if (!solution.complete) return;
    tell(work, patches_, cut_, how, solution, "--prepass radiosity");
    field_ = Field(work.run, patches_, solution);
    kind_ = anyKind(work.scene);
}

void RadiosityPrepass::addIndirect(const PathClasses& classes, const Hit& hit, const SurfacePoint& at, const Bsdf& bsdf, PathState eye,
                                   const Spectrum& weight, Outputs& out) const noexcept {
    PathState state = classes.eye(eye, Event::DR);
    if (!state || field_.terms() == 0) return;
    const Spectrum albedo = bsdf.diffuseAlbedo();
    if (black(albedo)) return;
    const auto place = patches_.at(hit, dot(at.ng, bsdf.normal()) > 0);
    if (!place) return;
    for (uint32_t k = 0; k < field_.terms() && state; ++k, state = classes.eye(state, Event::DR)) {
        if (k == 0 && !fault(Fault::radiosityDirectTwice)) continue;
        if (const Layer layer = classes.reached(state, kind_))
            addFound(out, layer, weight * albedo * field_.interpolated(patches_, k, *place) * (1 / pi));
    }
}

std::string field(const Options& o) {
    const int64_t bounces = o.integer("bounces");
    return bounces < 2 ? "L D+ D" : fmt::format("L D{{1,{}}} D", bounces - 1);
}

} // namespace

extern const PrepassEntry radiosityPrepass = {
    "radiosity", "diffuse interreflection by radiosity, for every view", solveOptions, field,
    [](const Options& o) -> std::unique_ptr<Prepass> { return std::make_unique<RadiosityPrepass>(o); }};

} // namespace chiaro
