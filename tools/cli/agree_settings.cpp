#include "tools/cli/agree_settings.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

void refuseDebugViews(const std::vector<IntegratorChoice>& chosen) {
    std::vector<std::string> names;
    for (const IntegratorChoice& c : allLightTransport()) names.emplace_back(c.entry->name);
    for (const IntegratorChoice& c : chosen)
        if (!c.entry->traits(c.options).lightTransport)
            throw Error(Exit::usage, fmt::format("-i {}: a debug view, its picture is not light: there is nothing to agree on; have {}",
                                                 c.entry->name, fmt::join(names, ", ")));
}

void refuseSceneOptions(const Arguments& a) {
    for (const OptionRow& o : a.command->options)
        if (o.sample && a.given(o.name))
            throw Error(Exit::usage, fmt::format("--{} is about rendering, but {} and {} are pictures already; leave it out", o.name,
                                                 a.operands[0], a.operands[1]));
}

void readScene(const Arguments& a, AgreeSettings& s) {
    s.base.scene = readSceneRequest(a);
    s.integrators = a.given("integrator") ? chooseIntegrators(a.text("integrator")) : allLightTransport();
    refuseDebugViews(s.integrators);
    readFrame(a, s.base);
    requireTaker(s.base.prepass, s.integrators);
    s.base.seed = parseWhole("seed", a.text("seed"), 0, 0x7fffffff); // bits above it part the pictures of one run
    s.replicates = uint32_t(parseWhole("replicates", a.text("replicates"), 2, 1u << 16));
    if (a.given("spp")) s.spp = uint32_t(parseWhole("spp", a.text("spp"), 1, 1u << 24));
    if (a.given("time")) s.seconds = parseDuration("time", a.text("time"));
    s.confirm = !a.on("no-confirm");
}

std::vector<std::string> readOutputs(const Arguments& a, std::size_t subjects) {
    const std::vector<std::string> outputs = a.all("output");
    for (const std::string& o : outputs) {
        const bool file = o.ends_with(".png") || o.ends_with(".exr");
        if (o == "-") throw Error(Exit::usage, "-o -: a map does not go to stdout; give a folder, FILE.png or FILE.exr");
        if (file && subjects > 1 && o.find("{integrator}") == std::string::npos)
            throw Error(Exit::usage,
                        fmt::format("-o {}: there are {} maps; put {{integrator}} into the name, or give a folder", o, subjects));
    }
    return outputs;
}

} // namespace

bool comparesImages(const Arguments& a) { return a.operands.size() == 2; }

AgreeSettings readAgreeSettings(const Arguments& a) {
    AgreeSettings s;
    s.base.arguments = &a;
    s.base.crop = a.text("crop");
    s.base.strict = a.on("strict");
    s.base.quiet = a.on("quiet");
    s.base.verbose = a.on("verbose");
    s.base.progress = ProgressMode(parseChoice("progress", a.text("progress"), {"auto", "bar", "lines", "json", "none"}));
    s.json = a.text("json");
    s.csv = a.text("csv");
    if (s.json == "-" && s.csv == "-") throw Error(Exit::usage, "--json and --csv cannot both go to stdout; give one a file");
    s.rule.alpha = parseReal("alpha", a.text("alpha"), 1e-12, 0.5);
    std::string margin = a.text("margin");
    if (margin.ends_with('%')) margin.pop_back();
    s.rule.margin = parseReal("margin", margin, 1e-4, 100) / 100;
    if (comparesImages(a))
        refuseSceneOptions(a);
    else
        readScene(a, s);
    s.outputs = readOutputs(a, comparesImages(a) ? 1 : s.integrators.size());
    return s;
}

} // namespace chiaro::cli
