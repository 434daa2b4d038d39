#include "tools/cli/photon_output.h"
#include "io/glb_write.h"
#include "tools/cli/values.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

constexpr std::size_t mostPoints = 2'000'000; // 48 MB: what viewers still turn smoothly

template <class Made> bool photonsIn(const Made& made) { return dynamic_cast<const PhotonSource*>(made.get()) != nullptr; }

// Of the registry, with their default options.
std::string sources() {
    std::vector<std::string_view> names;
    for (const IntegratorEntry& e : integrators())
        if (photonsIn(e.make(Options(e.options)))) names.push_back(e.name);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

// The flux that all but one photon in a hundred stay below: the brightest colour.
float bright(std::span<const Photon> photons) {
    std::vector<float> sample;
    const std::size_t step = std::max<std::size_t>(1, photons.size() / 10'000);
    for (std::size_t i = 0; i < photons.size(); i += step) sample.push_back(maxComponent(photons[i].flux));
    const auto at = sample.begin() + std::ptrdiff_t(sample.size() * 99 / 100);
    std::nth_element(sample.begin(), at, sample.end());
    return *at > 0 ? *at : 1.f;
}

GlbShape pointsOf(std::span<const Photon> photons, std::size_t step) {
    GlbShape shape;
    shape.mode = GlbMode::points;
    const float scale = 1 / bright(photons);
    for (std::size_t i = 0; i < photons.size(); i += step) {
        const Spectrum c = photons[i].flux * scale;
        shape.positions.push_back(photons[i].p);
        shape.colors.push_back({clamp01(c[0]), clamp01(c[1]), clamp01(c[2])});
    }
    return shape;
}

} // namespace

bool hasPhotons(const IntegratorChoice& integrator, const PrepassChoice* prepass) {
    return photonsIn(integrator.entry->make(integrator.options)) || (prepass && photonsIn(prepass->entry->make(prepass->options)));
}
bool hasPhotons(const RenderSettings& s) { return hasPhotons(s.integrator, prepassFor(s.integrator, s.prepass.get())); }

void checkPhotons(const RenderSettings& s) {
    const bool map = !s.photonMap.empty();
    if ((!map && !s.aov.photons) || hasPhotons(s)) return;
    throw Error(Exit::unsupported, fmt::format("{}: {} has no photons; those that have: {}", map ? "--photon-map" : "--aov photons",
                                               s.integrator.entry->name, sources()));
}

void writePhotonMap(const RenderSettings& s, const Scene& scene, const Integrator& integrator, const Prepass* prepass, Diagnostics& notes) {
    const auto* source = dynamic_cast<const PhotonSource*>(&integrator);
    if (!source && prepass) source = dynamic_cast<const PhotonSource*>(prepass);
    if (!source) throw Error(Exit::unsupported, fmt::format("--photon-map: {} has no photons", s.integrator.entry->name));
    const std::vector<PhotonMapView> maps = source->photonMaps();
    std::size_t all = 0;
    for (const PhotonMapView& m : maps) all += m.photons.size();
    const std::size_t step = (all + mostPoints - 1) / mostPoints;
    GlbScene glb{.name = s.scene.stem() + " photons", .generator = "chiaro", .nodes = {}};
    std::size_t points = 0;
    for (const PhotonMapView& m : maps) {
        if (m.photons.empty()) continue;
        GlbNode node;
        node.name = std::string(m.name);
        node.translation = scene.centre();
        node.shapes.push_back(pointsOf(m.photons, step));
        points += node.shapes.back().positions.size();
        node.notes = {{"photons", std::to_string(m.photons.size())},
                      {"light paths", fmt::format("{:.0f}", m.paths)},
                      {"white is", fmt::format("{:.6g} lumen", double(bright(m.photons)) / m.paths)}};
        glb.nodes.push_back(std::move(node));
    }
    writeGlb(s.photonMap, glb);
    notes.tell("photon-map", step > 1 ? fmt::format("{} of {} photons (every {}th) in {}", points, all, step, s.photonMap.string())
                                      : fmt::format("{} photons in {}", points, s.photonMap.string()));
}

} // namespace chiaro::cli
