// Recursive ray tracing with the extended illumination model (Whitted, An Improved Illumination Model for Shaded Display, 1980): direct
// light of every lamp, mirror reflection and refraction, ambient light or the diffuse field of a pre-pass. No indirect light else.
#include "core/math/pixel_pattern.h"
#include "integrators/entries.h"
#include "integrators/whitted_adaptive.h"
#include "integrators/whitted_tree.h"
#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

using AntiAliasing = WhittedSettings::AntiAliasing;

std::vector<Point2> patternOf(const WhittedSettings& s) {
    switch (s.antiAliasing) {
    case AntiAliasing::filter: return {};
    case AntiAliasing::centre: return gridPattern(1);
    case AntiAliasing::grid:
    case AntiAliasing::jitter: return gridPattern(uint32_t(std::lround(std::sqrt(double(s.samples)))));
    case AntiAliasing::poisson:
    case AntiAliasing::adaptive: return poissonPattern(s.samples, 0);
    }
    return {};
}

bool absorbs(const MaterialDesc& m) noexcept { return m.volume && m.transmission > 0 && std::isfinite(m.attenuationDistance); }

class Whitted final : public CameraIntegrator {
public:
    explicit Whitted(const Options& o) : settings_(o), pattern_(patternOf(settings_)) {}

    void prepare(const Job& job) override {
        const auto materials = job.scene.materials();
        shared_.settings = &settings_;
        shared_.lamps = LocalLights(job.scene, settings_.attenuation);
        const bool filters = settings_.shadows == WhittedSettings::Shadows::filtered;
        shared_.blends = filters && anyBlended(job.scene);
        shared_.filters = shared_.blends || (filters && anyTransparent(job.scene));
        shared_.absorbs = std::any_of(materials.begin(), materials.end(), absorbs);
        shared_.plain =
            shared_.filters || shared_.absorbs || job.prepass ? std::vector<PlainMaterial>() : plainMaterials(job.scene, settings_);
        adaptive_ = {};
    }
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override { radianceWide(job, {&start, 1}, {&out, 1}); }
    void radianceWide(const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) const noexcept override {
        if (const uint32_t cut = WhittedTrees(shared_, job, starts, outputs).run()) cut_.fetch_add(cut, std::memory_order_relaxed);
    }
    // The default is the view's filter, as in every integrator: pictures that are to be compared must be blurred alike.
    Starts starts(const Job&) const override {
        Starts s;
        s.pattern = pattern_;
        if (settings_.antiAliasing == AntiAliasing::jitter) s.jitter = 1 / std::sqrt(float(settings_.samples));
        s.shifted = settings_.antiAliasing == AntiAliasing::poisson;
        return s;
    }
    void render(const Job& job, const Pass& pass, Film& film) override {
        if (settings_.antiAliasing == AntiAliasing::adaptive)
            adaptive_.render(pass, film, settings_.samples, settings_.contrast,
                             [&](const Pass& part) { CameraIntegrator::render(job, part, film); });
        else
            CameraIntegrator::render(job, pass, film);
        // A few rays are caught for ever behind the smooth normals of a glass ball's facets: not worth a word.
        constexpr double tolerable = 1e-3; // of the samples
        if (double(cut_.exchange(0)) > tolerable * double(film.layout().crop.area()) * (pass.end - pass.begin))
            job.notes.warn(
                "whitted: some ray trees are larger than max-nodes or wait with more than 48 rays, and the rest of them is black; try "
                "a smaller --max-depth, a larger min-weight or max-nodes");
    }

    void save(Writer& to) const override { adaptive_.save(to); }
    void load(const Job& job, Reader& from) override { adaptive_.load(job.view.crop, from); }

private:
    WhittedSettings settings_;
    std::vector<Point2> pattern_;
    WhittedScene shared_;
    AdaptivePasses adaptive_;
    mutable std::atomic<uint64_t> cut_{0};
};

Traits traits(const Options& o) { return WhittedSettings(o).traits(); }

} // namespace

extern const IntegratorEntry whittedEntry = {"whitted", "recursive ray tracing: direct light, mirrors, refraction, ambient light",
                                             WhittedSettings::specs(), traits,
                                             [](const Options& o) -> std::unique_ptr<Integrator> { return std::make_unique<Whitted>(o); }};

} // namespace chiaro
