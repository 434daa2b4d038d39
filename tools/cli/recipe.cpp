#include "tools/cli/recipe.h"
#include "tools/cli/ledger.h"
#include "tools/cli/version.h"
#include <fmt/format.h>
#include <map>

namespace chiaro::cli {

namespace {

// The facts of one subject together: attributes of a picture have a name each.
std::map<std::string, std::string> factsByName(const std::vector<Diagnostics::Fact>& facts) {
    std::map<std::string, std::string> all;
    for (const Diagnostics::Fact& f : facts) {
        std::string& text = all[f.subject];
        text += (text.empty() ? "" : "; ") + f.message;
    }
    return all;
}

} // namespace

Metadata recipe(const RenderSettings& s, const LoadedScene& loaded, const View& view, const DisplayTransform& display, const Film& film,
                const Rendered& rendered) {
    const auto text = [](auto number) { return fmt::format("{}", number); };
    Metadata m;
    m.emplace_back("chiaro:command", s.arguments->line);
    m.emplace_back("chiaro:version", std::string(version));
    m.emplace_back("chiaro:commit", std::string(commit));
    m.emplace_back("chiaro:scene", s.scene.operand);
    m.emplace_back("chiaro:sceneHash", fmt::format("{:016x}", loaded.scene->hash()));
    m.emplace_back("chiaro:camera", rendered.camera);
    if (const LensDesc lens = view.camera.lens(); lens.radius > 0) {
        m.emplace_back("chiaro:aperture", text(2 * lens.radius));
        m.emplace_back("chiaro:focus", text(lens.focus));
        if (lens.blades) m.emplace_back("chiaro:blades", fmt::format("{}:{:g}", lens.blades, lens.rotation * 180 / std::numbers::pi));
    }
    m.emplace_back("chiaro:environment", loaded.environment);
    m.emplace_back("chiaro:frameTime", text(s.scene.frameTime));
    m.emplace_back("chiaro:shutter", fmt::format("{}:{}", view.shutter.open, view.shutter.close));
    if (const std::string time = timeText(s.scene, loaded); !time.empty()) m.emplace_back("chiaro:animation", time);
    m.emplace_back("chiaro:integrator", integratorRecipe(s.integrator));
    if (s.prepass.choice) {
        m.emplace_back("chiaro:prepass", prepassRecipe(*s.prepass.choice));
        m.emplace_back("chiaro:prepassSeconds", rendered.prepassSeconds);
    }
    for (const auto& [name, value] : factsByName(rendered.facts)) m.emplace_back("chiaro:fact." + name, value);
    if (!s.paths.paths.empty()) m.emplace_back("chiaro:paths", s.paths.paths);
    if (!s.paths.split.empty()) m.emplace_back("chiaro:split", s.paths.split);
    m.emplace_back("chiaro:maxDepth", s.paths.maxDepth == unlimitedDepth ? std::string("unlimited") : text(s.paths.maxDepth));
    m.emplace_back("chiaro:size", fmt::format("{}x{}", view.width, view.height));
    m.emplace_back("chiaro:seed", text(s.seed));
    m.emplace_back("chiaro:spp", text(rendered.result.spp));
    if (film.begin() > 0) m.emplace_back("chiaro:samples", fmt::format("{}:{}", film.begin(), film.done()));
    m.emplace_back("chiaro:sampler", samplerName(s.sampler));
    m.emplace_back("chiaro:filter", filterName(s.filter));
    m.emplace_back("chiaro:isa", loaded.scene->isa());
    m.emplace_back("chiaro:dropped", text(film.dropped()));
    if (film.dropped() > 0) m.emplace_back("chiaro:ledger", ledgerText(film));
    m.emplace_back("chiaro:unit", std::string("1.0 = 1 cd/m2"));
    m.emplace_back("chiaro:exposure", rendered.exposure);
    m.emplace_back("chiaro:display", display.display());
    m.emplace_back("chiaro:view", display.view());
    m.emplace_back("chiaro:ocio", display.source());
    m.emplace_back("chiaro:seconds", rendered.result.seconds);
    return m;
}

namespace {

std::string commandWithSamples(const char* command, const RenderSettings& s) {
    std::string line = fmt::format("chiaro {} {}", command, shellQuoted(s.scene.operand));
    for (const OptionRow& o : s.arguments->command->options)
        if (o.sample && o.name != "seed" && s.arguments->given(o.name))
            line += fmt::format(" {}{} {}", o.letter ? "-" : "--", o.letter ? std::string(1, o.letter) : std::string(o.name),
                                shellQuoted(s.arguments->text(o.name)));
    return line;
}

} // namespace

std::string sameSamples(const RenderSettings& s) { return commandWithSamples("render", s); }

std::string tracePathCommand(const RenderSettings& s, Pixel p, uint64_t path) {
    return commandWithSamples("trace", s) + fmt::format(" --pixel {},{} --sample {} --seed {}", p.x, p.y, path, s.seed);
}

std::string replayCommand(const RenderSettings& s, const DroppedSample& d) {
    return sameSamples(s) + fmt::format(" --pixel {},{} --sample {} --seed {}", d.pixel.x, d.pixel.y, d.sample, s.seed);
}

} // namespace chiaro::cli
