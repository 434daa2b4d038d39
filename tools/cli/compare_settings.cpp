#include "tools/cli/compare_settings.h"
#include "tools/cli/agree_settings.h"
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

bool namesScene(const std::string& operand) {
    std::string end = std::filesystem::path(operand).extension().string();
    std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return operand.starts_with('@') || end == ".gltf" || end == ".glb";
}

// The scene is the one operand of a scene's form, wherever it stands.
void sortOperands(const Arguments& a, CompareSettings& s, std::string& scene) {
    for (const std::string& operand : a.operands) {
        if (!namesScene(operand)) {
            s.images.push_back(operand);
            continue;
        }
        if (s.hasScene)
            throw Error(Exit::usage,
                        fmt::format("{} and {} are two scenes; compare looks at one, render the other and give its EXR", scene, operand));
        scene = operand;
        s.hasScene = true;
    }
}

void refuseSceneOptions(const Arguments& a) {
    for (const OptionRow& o : a.command->options)
        if (o.sample && a.given(o.name))
            throw Error(Exit::usage, fmt::format("--{} is about rendering, but there are pictures alone; leave it out, or name a SCENE "
                                                 "(a glTF file or @cornell) too",
                                                 o.name));
}

void readEqual(const Arguments& a, CompareSettings& s) {
    std::vector<std::string> given;
    for (const char* name : {"time", "spp", "noise"})
        if (a.given(name)) given.emplace_back(name);
    if (!a.given("equal") && given.size() > 1)
        throw Error(Exit::usage, fmt::format("--{} and --{}: say with --equal which of them is held equal", given[0], given[1]));
    const std::string equal = a.given("equal") ? a.text("equal") : given.empty() ? "time" : given[0];
    s.equal = Equal(parseChoice("equal", equal, {"time", "spp", "noise"}));
    for (const std::string& name : given)
        if (name != equal && (s.equal != Equal::noise))
            throw Error(Exit::usage, fmt::format("--{} says nothing with --equal {}; leave it out", name, equal));
    s.seconds = s.equal == Equal::noise && !a.given("time") ? noiseSeconds : parseDuration("time", a.text("time"));
    s.spp = s.equal == Equal::noise && !a.given("spp") ? 1u << 30 : uint32_t(parseWhole("spp", a.text("spp"), 1, 1u << 30));
    s.noise = parsePercent("noise", a.text("noise"));
    if (a.given("seeds")) s.seeds = uint32_t(parseWhole("seeds", a.text("seeds"), 1, 4096));
    if (s.equal == Equal::spp && s.seeds && *s.seeds > s.spp)
        throw Error(Exit::usage,
                    fmt::format("--seeds {} share --spp {}: each needs a sample; raise --spp or lower --seeds", *s.seeds, s.spp));
}

void readScene(const Arguments& a, const std::string& scene, CompareSettings& s) {
    s.base.scene = readSceneRequest(a);
    s.base.scene.operand = scene;
    s.integrators = a.given("integrator") ? chooseIntegrators(a.text("integrator")) : allLightTransport();
    readFrame(a, s.base);
    requireTaker(s.base.prepass, s.integrators);
    s.base.seed = parseWhole("seed", a.text("seed"), 0, 0x7fffffff); // bits above it part the pictures of one run
    readEqual(a, s);
}

std::optional<std::filesystem::path> cacheFolder(const Arguments& a) {
    if (a.text("cache") == "none") return {};
    if (a.given("cache")) return a.text("cache");
    // As the XDG base directory specification has it; a relative path there is to be ignored.
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && std::filesystem::path(xdg).is_absolute())
        return std::filesystem::path(xdg) / "chiaro";
    if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "chiaro";
    return {};
}

void readReference(const Arguments& a, CompareSettings& s) {
    const std::string text = a.text("ref");
    s.reference = text == "auto" ? ReferenceKind::automatic : text == "none" ? ReferenceKind::none : ReferenceKind::file;
    if (s.reference == ReferenceKind::file) s.referenceFile = text;
    if (a.given("ref-time")) {
        s.referenceSeconds = parseDuration("ref-time", a.text("ref-time"));
        if (s.reference != ReferenceKind::automatic)
            throw Error(Exit::usage, fmt::format("--ref-time is about --ref auto, not --ref {}; leave it out", text));
    }
    s.cache = cacheFolder(a);
    if (s.hasScene) return;
    if (s.images.size() + (s.referenceFile.empty() ? 0 : 1) < 2)
        throw Error(Exit::usage, fmt::format("{} alone: there is nothing to compare it with. Add another picture, --ref FILE, or a SCENE "
                                             "(chiaro info {} looks at one)",
                                             s.images.empty() ? s.referenceFile : s.images[0],
                                             shellQuoted(s.images.empty() ? s.referenceFile : s.images[0])));
    if (s.reference != ReferenceKind::automatic) return;
    s.reference = ReferenceKind::file; // the last operand, as B of `chiaro diff A B`
    s.referenceFile = s.images.back();
    s.images.pop_back();
}

std::filesystem::path outputFolder(const Arguments& a, const CompareSettings& s) {
    const std::string stem =
        s.hasScene ? s.base.scene.stem() : std::filesystem::path(s.images.empty() ? s.referenceFile : s.images[0]).stem().string();
    std::string name = a.text("output");
    for (std::size_t at = name.find("{scene}"); at != std::string::npos; at = name.find("{scene}", at + stem.size()))
        name.replace(at, std::string_view("{scene}").size(), stem);
    if (name == "-" || name.empty()) throw Error(Exit::usage, "-o: give a folder; --json - and --csv - write to stdout");
    return name;
}

} // namespace

CompareSettings readCompareSettings(const Arguments& a) {
    CompareSettings s;
    s.base.arguments = &a;
    s.base.crop = a.text("crop");
    s.base.view = a.text("view");
    s.base.ocio = a.text("ocio");
    if (a.text("exposure") != "auto") s.base.exposure = parseReal("exposure", a.text("exposure"), -100, 100);
    s.base.strict = a.on("strict");
    s.base.quiet = a.on("quiet");
    s.base.verbose = a.on("verbose");
    s.base.progress = ProgressMode(parseChoice("progress", a.text("progress"), {"auto", "bar", "lines", "json", "none"}));
    s.json = a.text("json");
    s.csv = a.text("csv");
    if (s.json == "-" && s.csv == "-") throw Error(Exit::usage, "--json and --csv cannot both go to stdout; give one a file");
    s.layer = a.text("layer");
    s.fit = a.on("fit");
    std::string scene;
    sortOperands(a, s, scene);
    if (s.hasScene)
        readScene(a, scene, s);
    else
        refuseSceneOptions(a);
    readReference(a, s);
    s.folder = outputFolder(a, s);
    return s;
}

} // namespace chiaro::cli
