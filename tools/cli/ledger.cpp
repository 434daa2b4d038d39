#include "tools/cli/ledger.h"
#include "integrators/light_path_ledger.h"
#include "tools/cli/recipe.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

// What brings a dropped sample back depends on how the integrator makes its picture.
std::string commandFor(const RenderSettings& s, const Integrator& integrator, const DroppedSample& d) {
    if (dynamic_cast<const CameraIntegrator*>(&integrator)) return replayCommand(s, d);
    if (const auto* light = dynamic_cast<const LightPathLedger*>(&integrator))
        if (const std::optional<uint64_t> path = light->brokenPath()) return tracePathCommand(s, d.pixel, *path);
    return fmt::format("{} --crop 1x1+{}+{} --spp {} --seed {}", sameSamples(s), d.pixel.x, d.pixel.y, d.sample + 1, s.seed);
}

std::string materialSeen(const Job& job, const CameraIntegrator& camera, const DroppedSample& d) {
    const PathStart start = startPixel(job, d.pixel, d.sample, camera.starts(job));
    if (!start.first) return {};
    const std::string& name = job.scene.material(job.scene.point(start.first, start.ray).material).name;
    return name.empty() ? "" : fmt::format(" (material \"{}\")", name);
}

} // namespace

std::vector<LedgerLine> ledger(const RenderSettings& s, const Film& film) {
    std::vector<LedgerLine> all;
    if (film.dropped() == 0) return all;
    const auto integrator = s.integrator.entry->make(s.integrator.options);
    const bool splats = dynamic_cast<const LightPathLedger*>(integrator.get()) != nullptr;
    for (const DroppedSample& d : film.droppedSamples()) all.push_back({d, splats ? std::string() : commandFor(s, *integrator, d)});
    return all;
}

nlohmann::ordered_json ledgerJson(const RenderSettings& s, const Film& film) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const LedgerLine& line : ledger(s, film)) {
        nlohmann::ordered_json entry{{"pixel", {line.dropped.pixel.x, line.dropped.pixel.y}}};
        if (!line.command.empty()) entry.update({{"sample", line.dropped.sample}, {"replay", line.command}});
        all.push_back(std::move(entry));
    }
    return all;
}

std::string ledgerText(const Film& film) {
    std::string text;
    for (const DroppedSample& d : film.droppedSamples())
        text += fmt::format("{}{},{} sample {}", text.empty() ? "" : "; ", d.pixel.x, d.pixel.y, d.sample);
    return text;
}

void warnDropped(const RenderSettings& s, const Job& job, const Integrator& integrator, const Film& film) {
    const std::vector<DroppedSample> dropped = film.droppedSamples();
    if (dropped.empty()) return;
    const DroppedSample& first = dropped.front();
    std::string where = fmt::format(", the first at pixel {},{}", first.pixel.x, first.pixel.y);
    if (const auto* camera = dynamic_cast<const CameraIntegrator*>(&integrator)) where = materialSeen(job, *camera, first);
    job.notes.warn(fmt::format("{} non-finite {} dropped{}. Reproduce: {}", film.dropped(), film.dropped() == 1 ? "sample" : "samples",
                               where, commandFor(s, integrator, first)));
}

} // namespace chiaro::cli
