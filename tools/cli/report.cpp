#include "tools/cli/report.h"
#include "tools/cli/integrator_list.h"
#include "tools/cli/ledger.h"
#include "tools/cli/version.h"
#include "tools/judge/statistics.h"
#include <algorithm>
#include <cmath>
#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

std::string counted(uint64_t n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

std::string lightsText(const SceneCounts& c, const LoadedScene& loaded) {
    std::string text;
    if (c.emissiveMeshes) text += ", " + counted(c.emissiveMeshes, "emissive mesh", "emissive meshes");
    if (c.punctualLights) text += ", " + counted(c.punctualLights, "punctual light", "punctual lights");
    if (loaded.environment != "none") text += ", environment " + loaded.environment;
    return text;
}

std::string trianglesText(const SceneCounts& c) {
    std::string text = counted(c.triangles, "triangle", "triangles");
    if (c.trianglesDrawn != c.triangles)
        text += fmt::format(" ({} drawn, {})", c.trianglesDrawn, counted(c.instances, "instance", "instances"));
    return text;
}

// The same scene and view by every integrator of the registry that transports light; empty: there is one alone.
std::string compareCommand(const RenderSettings& s) {
    std::vector<std::string> names;
    for (const IntegratorChoice& c : allLightTransport()) names.emplace_back(c.entry->name);
    if (names.size() < 2) return {};
    std::string line = fmt::format("chiaro compare {} -i {}", shellQuoted(s.scene.operand), fmt::join(names, ","));
    const auto all = commands();
    const auto compare = std::find_if(all.begin(), all.end(), [](const Command& c) { return c.name == "compare"; });
    for (const OptionRow& o : s.arguments->command->options)
        if (o.sample && o.name != "integrator" && o.name != "seed" && s.arguments->given(o.name) && findOption(*compare, o.name))
            line += fmt::format(" --{} {}", o.name, shellQuoted(s.arguments->text(o.name)));
    return line + " --time 10s";
}

std::string joined(std::span<const std::filesystem::path> files) {
    std::vector<std::string> names;
    for (const auto& f : files) names.push_back(f.string());
    return fmt::format("{}", fmt::join(names, ", "));
}

// "156/256 spp", "sample 80 of 64:128"
std::string stoppedAt(const RenderSettings& s, const Film& film) {
    if (s.range) return fmt::format("sample {} of {}:{}", film.done(), s.range->begin, s.range->end);
    if (s.budget.spp >= 1u << 31) return fmt::format("{} spp", film.done());
    return fmt::format("{}/{} spp", film.done(), s.budget.spp);
}

std::string resumeCommand(const RenderSettings& s, const std::filesystem::path& checkpoint) {
    return fmt::format("chiaro render {} --resume {}", shellQuoted(s.scene.operand), shellQuoted(checkpoint.string()));
}

} // namespace

double relativeInterval(const Film::Mean& m) {
    return m.value > 0 ? judge::confidenceInterval({.difference = 0, .error = m.error, .dof = m.dof}, 0.05).high / m.value : NAN;
}

nlohmann::ordered_json finiteOrNull(double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr); }

std::string doneText(const Film& film, const Rendered& r, bool biased, double noiseWanted) {
    const std::string quiet = r.result.ended == Ended::noise ? fmt::format(" (below {} with 95 % confidence)", percent(noiseWanted)) : "";
    const std::string before = r.secondsBefore > 0 ? fmt::format(" ({} before)", duration(r.secondsBefore)) : "";
    return fmt::format("{} spp in {}{}   noise {}{}   mean +-{} (95 %{})   {} non-finite", r.result.spp, duration(r.result.seconds), before,
                       percent(r.noise), quiet, percent(relativeInterval(r.mean)), biased ? ", of the noise alone" : "", film.dropped());
}

void tellPictures(std::span<const std::filesystem::path> files, const DisplayTransform& display, double exposure, bool automatic,
                  const Console& console) {
    const std::string text = fmt::format(fmt::runtime(automatic ? "{:.1f}" : "{:g}"), exposure);
    const std::string keep = automatic ? fmt::format("      keep it with: --exposure {:.1f}", exposure) : "";
    for (const std::filesystem::path& file : files) {
        if (isExr(file))
            console.phase("wrote", fmt::format("{}  linear Rec.709 float32, 1.0 = 1 cd/m2", file.string()));
        else
            console.phase("wrote",
                          fmt::format("{}  {}{}, exposure {}{}{}", file.string(), display.display(),
                                      display.view() == "Standard" ? "" : " " + display.view(), text, automatic ? " (auto)" : "", keep));
    }
}

std::string embreeVersion() { return RTC_VERSION_STRING; }

std::string bestIsa() {
    Diagnostics ignored;
    return Scene::compile({}, ignored)->isa();
}

void tellHeader(const RenderSettings& s, const Executor& run, const Console& console) {
    if (console.quiet()) return;
    console.line(fmt::format("chiaro {}  {}  embree {} {}  {}", version, buildType, embreeVersion(),
                             s.scene.isa.empty() ? bestIsa() : s.scene.isa, counted(run.threads(), "thread", "threads")));
}

void tellScene(const RenderSettings& s, const LoadedScene& loaded, const std::string& camera, const Console& console) {
    const SceneCounts& c = loaded.scene->counts();
    const std::string text = fmt::format("{}   {}{}, camera {}", s.scene.operand, trianglesText(c), lightsText(c, loaded),
                                         camera == "auto" ? "automatic" : fmt::format("\"{}\"", camera));
    console.phase("scene", fmt::format("{:<62} {}", text, duration(loaded.seconds)));
    if (camera == "auto" && s.camera.empty())
        console.phase("added", "no camera in the scene: one that frames it all      keep it with: --camera auto");
    if (const std::string time = timeText(s.scene, loaded); !time.empty()) console.phase("time", time);
    for (const std::string& line : loaded.added) console.phase("added", line);
    if (s.verbose)
        console.phase("", fmt::format("radius {:.4g} m, {}, light {:.4g} lm, hash {:016x}", loaded.scene->radius(), sceneBytesText(c.bytes),
                                      loaded.scene->lights().power(), loaded.scene->hash()));
}

void tellIntegrator(const RenderSettings& s, const View& view, const Console& console) {
    std::string budget = s.range                   ? fmt::format("samples {}:{}", s.range->begin, s.range->end)
                         : s.budget.spp < 1u << 31 ? fmt::format("{} spp", s.budget.spp)
                                                   : "";
    if (s.budget.noise > 0) budget += fmt::format("{}noise {}", budget.empty() ? "" : " or ", percent(s.budget.noise));
    if (std::isfinite(s.budget.seconds)) budget += fmt::format("{}{}", budget.empty() ? "" : " or ", duration(s.budget.seconds));
    std::string depth;
    if (s.integrator.entry->traits(s.integrator.options).lightTransport) {
        depth = s.paths.maxDepth == unlimitedDepth ? ", depth unlimited" : fmt::format(", depth {}", s.paths.maxDepth);
        for (const OptionSpec& o : s.integrator.entry->options)
            if (o.name == "rr-depth") depth += fmt::format(" (roulette from {})", s.integrator.options.text("rr-depth"));
    }
    console.phase(s.integrator.entry->name, fmt::format("{}{}, seed {}", budget, depth, s.seed));
    if (s.verbose)
        console.phase("", fmt::format("{}x{}, crop {}x{}+{}+{}, {} sampler, {} filter, {}", view.width, view.height, view.crop.width(),
                                      view.crop.height(), view.crop.x0, view.crop.y0, samplerName(s.sampler), filterName(s.filter),
                                      integratorRecipe(s.integrator)));
}

void tellDone(const RenderSettings& s, const DisplayTransform& display, const Film& film, const Rendered& r,
              std::span<const std::filesystem::path> files, const Console& console) {
    const bool stopped = r.result.ended == Ended::stopped, kept = !r.checkpoint.empty();
    if (stopped) {
        std::vector<std::filesystem::path> all(files.begin(), files.end());
        if (kept) all.push_back(r.checkpoint);
        console.line(fmt::format("stopped at {}; wrote {}.{}", stoppedAt(s, film), joined(all),
                                 kept ? " Continue: " + resumeCommand(s, r.checkpoint) : std::string()));
    }
    const Traits traits = traitsWith(s.integrator, s.prepass.get());
    console.phase("done", doneText(film, r, traits.lightTransport && !traits.unbiased, s.budget.noise) +
                              fmt::format("   peak {}", memorySize(double(peakBytes()))));
    tellPictures(files, display, r.exposure, r.automaticExposure, console);
    if (kept) console.phase("kept", fmt::format("{}  samples {}:{}", r.checkpoint.string(), film.begin(), film.done()));
    if (s.range) {
        if (!stopped) console.phase("next", "all parts as one picture: chiaro merge PART...");
        return;
    }
    if (kept && !stopped) console.phase("next", fmt::format("more samples: {} --spp {}", resumeCommand(s, r.checkpoint), 2 * r.result.spp));
    if (!stopped && r.noise > 0.01 && r.result.spp < 1u << 20)
        console.phase("next", fmt::format("half the noise: {} --spp {}", sameSamples(s), 4 * std::max(1u, r.result.spp)));
    if (const std::string compare = compareCommand(s); !stopped && !compare.empty()) console.phase("next", compare);
}

nlohmann::ordered_json factsJson(const std::vector<Diagnostics::Fact>& facts) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const Diagnostics::Fact& f : facts) all.push_back({{"subject", f.subject}, {"message", f.message}});
    return all;
}

void printSummary(const RenderSettings& s, const LoadedScene& loaded, const View& view, const DisplayTransform& display, const Film& film,
                  const Rendered& r, std::span<const std::filesystem::path> files, const Diagnostics& notes, int code) {
    const char* ended = r.result.ended == Ended::spp     ? "spp"
                        : r.result.ended == Ended::time  ? "time"
                        : r.result.ended == Ended::noise ? "noise"
                                                         : "stopped";
    std::vector<std::string> names;
    for (const auto& f : files) names.push_back(f.string());
    const nlohmann::ordered_json summary{
        {"version", version},
        {"commit", commit},
        {"scene", s.scene.operand},
        {"sceneHash", fmt::format("{:016x}", loaded.scene->hash())},
        {"camera", r.camera},
        {"environment", loaded.environment},
        {"integrator", integratorRecipe(s.integrator)},
        {"prepass", s.prepass.choice ? nlohmann::ordered_json(prepassRecipe(*s.prepass.choice)) : nlohmann::ordered_json(nullptr)},
        {"prepassSeconds", r.prepassSeconds},
        {"size", {view.width, view.height}},
        {"crop", {view.crop.x0, view.crop.y0, view.crop.width(), view.crop.height()}},
        {"seed", s.seed},
        {"spp", r.result.spp},
        {"seconds", r.result.seconds},
        {"ended", ended},
        {"samples", {film.begin(), film.done()}},
        {"noise", finiteOrNull(r.noise)},
        {"noiseBound", finiteOrNull(r.noiseBound)},
        {"mean", finiteOrNull(r.mean.value)},
        {"meanError", finiteOrNull(r.mean.error)},
        {"meanInterval", finiteOrNull(relativeInterval(r.mean))},
        {"dropped", film.dropped()},
        {"ledger", ledgerJson(s, film)},
        {"memory", {{"peak", peakBytes()}, {"limit", s.scene.memory.bytes}, {"scene", sceneBytesJson(loaded.scene->counts().bytes)}}},
        {"isa", loaded.scene->isa()},
        {"exposure", r.exposure},
        {"display", display.display()},
        {"view", display.view()},
        {"files", names},
        {"checkpoint", r.checkpoint.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(r.checkpoint.string())},
        {"facts", factsJson(r.facts)},
        {"warnings", notes.warnings()},
        {"exit", code},
    };
    fmt::print("{}\n", summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

} // namespace chiaro::cli
