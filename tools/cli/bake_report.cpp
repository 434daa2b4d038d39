// What chiaro bake says: the lines of a run, the JSON summary, and the recipe that the files carry.
#include "tools/cli/bake_settings.h"
#include "tools/cli/report.h"
#include "tools/cli/version.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

std::string counted(uint64_t n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }
double usedShare(const Baked& b) { return double(b.sites) / std::max(1.0, double(b.layout.size) * b.layout.size); }
const char* estimateName(const BakeSettings& s) { return s.gather.estimate == bake::Estimate::gather ? "gather" : "look"; }
const char* lightName(const BakeSettings& s) { return !s.gather.indirect ? "direct" : !s.gather.direct ? "indirect" : "all"; }

std::string coordinatesText(const bake::Layout& l) {
    if (l.literal) return fmt::format("TEXCOORD_{} of the file as it is", l.parts.front().kept);
    std::string text = counted(l.charts, "chart", "charts");
    if (l.keptParts > 0) text += fmt::format(", {} of them as the file lays them out", l.keptParts);
    return text;
}

} // namespace

void tellBakePlan(const BakeSettings& s, const LoadedScene& loaded, const Baked& b, const Console& console) {
    const SceneCounts& c = loaded.scene->counts();
    const std::string text =
        fmt::format("{}   {} drawn, {} of {} surfaces baked", s.render.scene.operand, counted(c.trianglesDrawn, "triangle", "triangles"),
                    b.chosen.parts.size(), loaded.scene->parts().size());
    console.phase("scene", fmt::format("{:<62} {}", text, duration(loaded.seconds)));
    if (const std::string time = timeText(s.render.scene, loaded); !time.empty()) console.phase("time", time);
    for (const std::string& line : loaded.added) console.phase("added", line);
    if (s.toVertex)
        console.phase("bake",
                      fmt::format("{} of {}", counted(b.vertices, "vertex", "vertices"), counted(b.triangles, "triangle", "triangles")));
    else
        console.phase("bake", fmt::format("light map {0}x{0}, {1:.3g} texels a metre, {2} used, {3}", b.layout.size, b.layout.density,
                                          percent(usedShare(b)), coordinatesText(b.layout)));
}

void warnOfBake(const BakeSettings& s, const LoadedScene& loaded, const Baked& b, Diagnostics& notes) {
    const std::string& scene = s.render.scene.operand;
    if (b.layout.overlapping > 0)
        notes.warn(fmt::format("{}: {} share their place in the light map with another surface; their light is mixed", scene,
                               counted(b.layout.overlapping, "texel", "texels")));
    if (b.result.leaks > 0)
        notes.warn(fmt::format("{}: {} of {} {} lie inside something or behind a one-sided surface (most rays from them meet backs); {}",
                               scene, b.result.leaks, b.sites, s.toVertex ? "vertices" : "texels",
                               s.toVertex ? "their light is that of the others of their surface" : "filled from their neighbours"));
    const auto left = [&](uint64_t n, const char* why) {
        if (n > 0) notes.warn(fmt::format("{}: {} {}; not baked, the material stays", scene, counted(n, "surface", "surfaces"), why));
    };
    left(b.chosen.transparent, b.chosen.transparent == 1 ? "lets light through" : "let light through");
    left(b.chosen.skinned, b.chosen.skinned == 1 ? "hangs on a skin" : "hang on skins");
    left(b.chosen.morphed, b.chosen.morphed == 1 ? "has morph targets" : "have morph targets");
    if (b.chosen.animated > 0)
        notes.warn(fmt::format("{}: {} in animations; baked as {} at {:g} s, and the light stays so", scene,
                               counted(b.chosen.animated, "surface moves", "surfaces move"),
                               b.chosen.animated == 1 ? "it stands" : "they stand", s.render.scene.frameTime));
    uint64_t glossy = 0;
    for (const uint32_t p : b.chosen.parts) glossy += loaded.scene->material(loaded.scene->parts()[p].material).metallic > 0.5f;
    if (glossy > 0 && s.lit)
        notes.warn(fmt::format("{}: {} metal; what it mirrors depends on the eye and is baked as if spread evenly", scene,
                               counted(glossy, "surface is", "surfaces are")));
    if (b.result.dropped > 0) notes.warn(fmt::format("{}: {} non-finite samples dropped", scene, b.result.dropped));
}

void tellBaked(const BakeSettings& s, const Baked& b, const Console& console) {
    const bake::BakeResult& r = b.result;
    console.phase("done", fmt::format("{} spp in {}   noise {}   mean irradiance {:.4g} lx{}", r.spp, duration(r.seconds), percent(r.noise),
                                      luminance(r.mean), r.ended == Ended::time ? "   (time was up)" : ""));
    if (b.filled > 0) console.phase("filled", fmt::format("{} beside charts from their rims", counted(b.filled, "texel", "texels")));
    const std::string exposure = fmt::format(
        "exposure {:g}{}", b.exposure, b.automaticExposure ? fmt::format(" (auto)      keep it with: --exposure {:g}", b.exposure) : "");
    for (const std::filesystem::path& file : b.files) {
        const std::string what = file == s.exr   ? "irradiance in lux, linear Rec.709 float32, and what leaves"
                                 : file == s.bin ? "its data"
                                 : s.lit         ? "any glTF viewer shows it lit; " + exposure
                                 : s.toVertex    ? "_IRRADIANCE in lux at the vertices"
                                                 : "the light map beside the materials (MOZ_lightmap); " + exposure;
        console.phase("wrote", fmt::format("{}  {}", file.string(), what));
    }
    if (r.ended == Ended::stopped) console.line(fmt::format("stopped at {} spp; what is there was written", r.spp));
}

Metadata bakeRecipe(const BakeSettings& s, const LoadedScene& loaded, const Baked& b) {
    Metadata m;
    m.emplace_back("program", fmt::format("chiaro {}", version));
    m.emplace_back("scene", s.render.scene.operand);
    m.emplace_back("sceneHash", fmt::format("{:016x}", loaded.scene->hash()));
    m.emplace_back("integrator", integratorRecipe(s.render.integrator));
    if (s.render.prepass.get()) m.emplace_back("prepass", prepassRecipe(*s.render.prepass.get()));
    m.emplace_back("estimate", estimateName(s));
    m.emplace_back("light", lightName(s));
    if (s.render.paths.maxDepth != unlimitedDepth) m.emplace_back("maxDepth", int(s.render.paths.maxDepth));
    m.emplace_back("spp", int(b.result.spp));
    m.emplace_back("seed", fmt::format("{}", s.render.seed));
    m.emplace_back("to", s.toVertex ? "vertex" : "lightmap");
    m.emplace_back("mode", s.lit ? "lit" : "keep");
    m.emplace_back("exposure", b.exposure);
    m.emplace_back("meaning", s.lit        ? "shown value = radiance x 2^exposure, cd/m2"
                              : s.toVertex ? "_IRRADIANCE: lux"
                                           : "light map texel = irradiance / pi x 2^exposure; irradiance in lux");
    if (!s.toVertex) {
        m.emplace_back("lightMapSize", int(b.layout.size));
        m.emplace_back("texelsPerMetre", b.layout.density);
    }
    return m;
}

void printBakeSummary(const BakeSettings& s, const Baked& b, const Diagnostics& notes, int code) {
    using Json = nlohmann::ordered_json;
    const bake::BakeResult& r = b.result;
    const Json noise = std::isfinite(r.noise) ? Json(r.noise) : Json(nullptr);
    Json j{{"scene", s.render.scene.operand},
           {"integrator", integratorRecipe(s.render.integrator)},
           {"estimate", estimateName(s)},
           {"light", lightName(s)},
           {"to", s.toVertex ? "vertex" : "lightmap"},
           {"mode", s.lit ? "lit" : "keep"},
           {"spp", r.spp},
           {"seconds", r.seconds},
           {"prepassSeconds", b.prepassSeconds},
           {"noise", noise},
           {"meanIrradiance", {r.mean[0], r.mean[1], r.mean[2]}},
           {"exposure", b.exposure},
           {"surfaces",
            {{"baked", b.chosen.parts.size()},
             {"transparent", b.chosen.transparent},
             {"skinned", b.chosen.skinned},
             {"morphed", b.chosen.morphed},
             {"animated", b.chosen.animated}}},
           {"sites", b.sites},
           {"leaks", r.leaks},
           {"dropped", r.dropped}};
    if (s.toVertex)
        j["triangles"] = b.triangles;
    else
        j["lightMap"] = {{"size", b.layout.size},
                         {"texelsPerMetre", b.layout.density},
                         {"charts", b.layout.charts},
                         {"keptParts", b.layout.keptParts},
                         {"literal", b.layout.literal},
                         {"used", usedShare(b)},
                         {"overlaps", b.layout.overlapping},
                         {"filled", b.filled}};
    for (const auto& f : b.files) j["files"].push_back(f.string());
    j["warnings"] = notes.warnings();
    j["exitCode"] = code;
    fmt::print("{}\n", j.dump(2));
}

} // namespace chiaro::cli
