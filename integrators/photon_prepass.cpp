// The pre-pass photon: photon maps made once, without a view, whose density at a diffuse surface is the indirect light there. Direct light
// is not in it: photons are kept only after a scattering.
#include "core/render/prepass.h"
#include "integrators/entries.h"
#include "integrators/photon_field.h"

namespace chiaro {
namespace {

using Field = PhotonFieldOptions;
constexpr OptionSpec specs[] = {
    Field::count,  Field::causticCount, Field::estimate,      Field::k, Field::radius, Field::causticRadius,
    Field::kernel, Field::shrink,       Field::rouletteDepth,
};

class PhotonPrepass final : public Prepass, public PhotonSource {
public:
    explicit PhotonPrepass(const Options& o) : field_(Field::plan(o)) {}
    void solve(const Work& work) override {
        field_.prepare(work, {});
        if (!field_.trace(work, 0, {})) return;
        work.notes.tell("photons", field_.summary() + "      keep it with: --prepass photon:" + field_.recipe());
        work.notes.tell("light", field_.balance());
    }
    void addIndirect(const PathClasses& classes, const Hit&, const SurfacePoint& at, const Bsdf& bsdf, PathState eye,
                     const Spectrum& weight, Outputs& out) const noexcept override {
        const GatherPoint point{at, bsdf, eye, weight, GatheredLobes::diffuse};
        const GatherResult global = field_.global().add(classes, point, out);
        Spectrum added = global.added;
        if (field_.caustic()) added += field_.caustic()->add(classes, point, out).added;
        if (out.gathered.radius == 0) out.gathered = global.found;
        if (out.log && out.log->here != PathLog::none) (*out.log)[out.log->here].contribution += added;
    }
    void save(Writer& to) const override { field_.save(to); }
    void load(const Work& work, Reader& from) override { field_.load(work, from); }
    std::vector<PhotonMapView> photonMaps() const override { return field_.views(); }
    std::size_t photonBytes() const override { return field_.bytes(); }

private:
    PhotonField field_;
};

} // namespace

extern const PrepassEntry photonPrepass = {"photon", "photon maps: indirect light and caustics by photon density", specs,
                                           [](const Options&) -> std::string { return "L (D|G|S)+ D"; },
                                           [](const Options& o) -> std::unique_ptr<Prepass> { return std::make_unique<PhotonPrepass>(o); }};

} // namespace chiaro
