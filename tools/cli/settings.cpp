#include "tools/cli/settings.h"
#include "scenes/builtin.h"
#include "tools/cli/photon_output.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

bool hasOption(const IntegratorChoice& choice, std::string_view name) {
    const auto specs = choice.entry->options;
    return std::any_of(specs.begin(), specs.end(), [&](const OptionSpec& s) { return s.name == name; });
}

// --aa MODE[:N] is the integrator's aa=MODE and aa-samples=N.
void readAntiAliasing(const std::string& text, IntegratorChoice& choice) {
    if (!hasOption(choice, "aa"))
        throw Error(Exit::usage,
                    fmt::format("--aa: {} has no patterns of its own, its samples follow --filter; try -i whitted", choice.entry->name));
    const std::size_t colon = text.find(':');
    choice.options.set("aa", text.substr(0, colon), "--aa");
    if (colon != text.npos) choice.options.set("aa-samples", text.substr(colon + 1), "--aa");
}

// A pattern has so many positions: more samples would repeat them. 0: no pattern.
uint32_t patternSamples(const IntegratorChoice& choice) {
    if (!hasOption(choice, "aa") || choice.options.text("aa") == "filter") return 0;
    return choice.options.text("aa") == "centre" ? 1 : uint32_t(choice.options.integer("aa-samples"));
}

// --rr-depth speaks to the integrator, unless its own option of that name was given there.
IntegratorChoice readIntegrator(const Arguments& arguments) {
    std::string text = arguments.text("integrator");
    IntegratorChoice choice = chooseIntegrator(text);
    if (arguments.given("aa")) readAntiAliasing(arguments.text("aa"), choice);
    if (!arguments.given("rr-depth")) return choice;
    const uint64_t depth = parseWhole("rr-depth", arguments.text("rr-depth"), 0, 1'000'000);
    const auto specs = choice.entry->options;
    if (std::none_of(specs.begin(), specs.end(), [](const OptionSpec& s) { return s.name == "rr-depth"; }))
        throw Error(Exit::usage,
                    fmt::format("--rr-depth: {} has no Russian roulette (chiaro integrators {})", choice.entry->name, choice.entry->name));
    if (text.find("rr-depth=") == std::string::npos) choice.options.set("rr-depth", std::to_string(depth), "--rr-depth");
    return choice;
}

SampleRange readRange(const std::string& text) {
    const std::size_t colon = text.find(':');
    if (colon == text.npos)
        throw Error(Exit::usage, fmt::format("--sample-range {}: give first and end, like 64:128 for the samples 64 to 127", text));
    const auto number = [&](const std::string& part) { return uint32_t(parseWhole("sample-range", part, 0, 1u << 31)); };
    const SampleRange r{number(text.substr(0, colon)), number(text.substr(colon + 1))};
    if (r.begin >= r.end) throw Error(Exit::usage, fmt::format("--sample-range {}: no sample is in it; the end is not included", text));
    return r;
}

void checkRange(const Arguments& a, const RenderSettings& s) {
    const std::string text = a.text("sample-range");
    if (a.given("noise"))
        throw Error(Exit::usage, fmt::format("--noise ends a render where its noise says so, --sample-range {} at a fixed sample; "
                                             "leave one of them out",
                                             text));
    if (a.given("spp") && s.budget.spp < s.range->end)
        throw Error(Exit::usage, fmt::format("--sample-range {} goes beyond --spp {}", text, s.budget.spp));
    if (!s.integrator.entry->traits(s.integrator.options).mergeable)
        throw Error(Exit::unsupported,
                    fmt::format("--sample-range: {} remembers what earlier samples found, so that ranges of them cannot be "
                                "rendered apart (chiaro integrators {})",
                                integratorRecipe(s.integrator), s.integrator.entry->name));
}

void replaceAll(std::string& text, std::string_view from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

double aspectOf(const CameraDesc& camera) {
    if (camera.projection == Projection::orthographic) return camera.xmag / camera.ymag;
    return camera.aspect > 0 ? camera.aspect : 16.0 / 9.0;
}

Size sizeOf(const RenderSettings& settings, const LoadedScene& loaded, const CameraDesc* camera) {
    if (!settings.size.empty()) return parseSize("size", settings.size);
    if (loaded.size) return *loaded.size;
    const double aspect = camera ? aspectOf(*camera) : 16.0 / 9.0;
    return {1280, uint32_t(std::clamp(std::round(1280 / (aspect > 0 && std::isfinite(aspect) ? aspect : 16.0 / 9.0)), 1.0, 65536.0))};
}

std::string expanded(const std::string& name, const RenderSettings& s, uint32_t spp) {
    return expandedName(name, s.scene.stem(), std::string(s.integrator.entry->name), spp);
}

// How long, and what is kept of it.
void readBudget(const Arguments& a, RenderSettings& s) {
    constexpr uint32_t unlimitedSpp = 1u << 31, quietSpp = 1u << 16; // no noise that can be reached needs more
    s.budget.spp = uint32_t(parseWhole("spp", a.text("spp"), 1, unlimitedSpp));
    if (a.given("time")) s.budget.seconds = parseDuration("time", a.text("time"));
    if (a.given("noise")) s.budget.noise = parsePercent("noise", a.text("noise"));
    if (a.given("sample-range")) {
        s.range = readRange(a.text("sample-range"));
        checkRange(a, s);
        s.budget.spp = s.range->end;
    }
    if (a.given("spp") || s.range) return;
    if (const BuiltinScene* builtin = findBuiltin(s.scene.operand)) s.budget.spp = builtin->spp;
    if (const uint32_t pattern = patternSamples(s.integrator); pattern > 0) s.budget.spp = pattern;
    // A time or a noise alone is the budget; the default number of samples would end it early.
    if (a.given("noise")) s.budget.spp = quietSpp;
    if (a.given("time")) s.budget.spp = unlimitedSpp;
}

void readKeeping(const Arguments& a, RenderSettings& s, std::string named) {
    CheckpointSettings& c = s.checkpoint;
    c.resume = a.text("resume");
    if (a.given("checkpoint-every")) c.every = parseDuration("checkpoint-every", a.text("checkpoint-every"));
    c.atEnd = !named.empty() || a.given("resume") || a.given("checkpoint-every") || s.range;
    if (named.empty()) named = c.resume.string();
    if (named.empty() && s.outputs.empty()) named = fmt::format("{{scene}}.{}-{}.chk", s.range->begin, s.range->end);
    if (named.empty()) named = std::filesystem::path(s.outputs.front()).replace_extension(".chk").string();
    c.file = expanded(named, s, s.budget.spp);
}

} // namespace

std::vector<std::string> readOutputs(const Arguments& arguments, std::vector<std::string> standard, std::string& checkpoint) {
    const std::vector<std::string> outputs = arguments.all("output");
    if (outputs.empty()) return standard;
    std::vector<std::string> pictures;
    for (const std::string& o : outputs) {
        if (o == "-") throw Error(Exit::usage, "-o -: a picture does not go to stdout; give a file name ending in .exr or .png");
        const std::string ending = std::filesystem::path(o).extension().string();
        if (ending != ".exr" && ending != ".png" && ending != ".chk")
            throw Error(Exit::usage,
                        fmt::format("-o {}: chiaro writes .exr and .png, and checkpoints as .chk; give one of these endings", o));
        if (ending != ".chk") {
            pictures.push_back(o);
            continue;
        }
        if (!checkpoint.empty())
            throw Error(Exit::usage, fmt::format("-o {}: there is one checkpoint a render, and {} is it", o, checkpoint));
        checkpoint = o;
    }
    return pictures;
}

std::string expandedName(std::string pattern, const std::string& scene, const std::string& integrator, uint32_t spp) {
    replaceAll(pattern, "{scene}", scene);
    replaceAll(pattern, "{integrator}", integrator);
    replaceAll(pattern, "{spp}", std::to_string(spp));
    return pattern;
}

void readFrame(const Arguments& a, RenderSettings& s) {
    if (a.given("max-depth")) s.paths.maxDepth = uint32_t(parseWhole("max-depth", a.text("max-depth"), 0, unlimitedDepth - 1));
    s.paths.paths = a.text("paths");
    if (findOption(*a.command, "split")) s.paths.split = a.text("split");
    s.classes = PathClasses::make(s.paths);
    s.size = a.text("size");
    if (!s.size.empty()) parseSize("size", s.size);
    if (a.given("threads")) s.threads = unsigned(parseWhole("threads", a.text("threads"), 1, 4096));
    s.sampler = SamplerKind(parseChoice("sampler", a.text("sampler"), {"sobol", "independent"}));
    s.filter = FilterKind(parseChoice("filter", a.text("filter"), {"box", "gauss", "blackman-harris"}));
    s.camera = a.text("camera");
    s.lens = readLens(a);
    s.prepass = readPrepass(a);
}

RenderSettings readSettings(const Arguments& a) {
    RenderSettings s;
    s.arguments = &a;
    s.scene = readSceneRequest(a);
    s.integrator = readIntegrator(a);
    readBudget(a, s);
    readFrame(a, s);
    requireTaker(s.prepass, {s.integrator});
    s.crop = a.text("crop");
    s.pixel = a.text("pixel");
    if (a.given("sample") && s.pixel.empty()) throw Error(Exit::usage, "--sample says which sample --pixel replays; add --pixel X,Y");
    s.sample = uint32_t(parseWhole("sample", a.text("sample"), 0, 0xffffffffu));
    s.seed = parseWhole("seed", a.text("seed"), 0, ~uint64_t(0));
    if (a.text("exposure") != "auto") s.exposure = parseReal("exposure", a.text("exposure"), -100, 100);
    s.view = a.text("view");
    s.ocio = a.text("ocio");
    std::string checkpoint;
    std::vector<std::string> pictures;
    if (!s.range) pictures = {"{scene}.exr", "{scene}.png"}; // a part is no picture
    s.outputs = readOutputs(a, std::move(pictures), checkpoint);
    readKeeping(a, s, std::move(checkpoint));
    s.aov = readLayers(a.text("aov"));
    s.photonMap = a.text("photon-map");
    if (!s.photonMap.empty() && s.photonMap.extension() != ".glb")
        throw Error(Exit::usage, fmt::format("--photon-map {}: a point cloud is a .glb", s.photonMap.string()));
    s.strict = a.on("strict");
    s.json = a.on("json");
    s.quiet = a.on("quiet");
    s.verbose = a.on("verbose");
    s.progress = ProgressMode(parseChoice("progress", a.text("progress"), {"auto", "bar", "lines", "json", "none"}));
    return s;
}

FilmLayout filmLayout(const RenderSettings& s, const View& view) {
    return {.width = view.width,
            .height = view.height,
            .crop = view.crop,
            .layers = s.classes.layerNames(),
            .splats = s.integrator.entry->traits(s.integrator.options).splats,
            .costs = s.aov.cost,
            .photons = s.aov.photons || (s.aov.all && hasPhotons(s))};
}

std::vector<std::filesystem::path> outputFiles(const RenderSettings& settings, uint32_t spp) {
    std::vector<std::filesystem::path> files;
    for (const std::string& pattern : settings.outputs) {
        const std::string name = expanded(pattern, settings, spp);
        if (std::find(files.begin(), files.end(), name) != files.end()) throw Error(Exit::usage, fmt::format("-o {} is named twice", name));
        files.emplace_back(name);
    }
    return files;
}

bool isExr(const std::filesystem::path& file) { return file.extension() == ".exr"; }

View makeView(const RenderSettings& settings, const LoadedScene& loaded, CameraDesc& camera, bool& automatic) {
    // The frame of an automatic camera needs the aspect, the size needs the camera: an automatic camera has no aspect of its own.
    const Size framed = sizeOf(settings, loaded, nullptr);
    camera = chooseCamera(*loaded.scene, settings.camera, double(framed.width) / framed.height, automatic);
    const Size size = automatic ? framed : sizeOf(settings, loaded, &camera);
    View view;
    camera.lens = chooseLens(settings.lens, camera, *loaded.scene, size);
    view.shutter = loaded.scene->shutter();
    view.camera = Camera(camera, size.width, size.height, view.shutter);
    view.width = size.width;
    view.height = size.height;
    view.crop = settings.crop.empty() ? Rect{0, 0, size.width, size.height} : parseCrop("crop", settings.crop, size);
    view.filter = Filter(settings.filter);
    return view;
}

std::string samplerName(SamplerKind kind) { return kind == SamplerKind::sobol ? "sobol" : "independent"; }
std::string filterName(FilterKind kind) {
    return kind == FilterKind::box ? "box" : kind == FilterKind::gauss ? "gauss" : "blackman-harris";
}

std::string integratorRecipe(const IntegratorChoice& choice) {
    const std::string options = choice.options.recipe();
    return fmt::format("{}{}{}", choice.entry->name, options.empty() ? "" : ":", options);
}

} // namespace chiaro::cli
