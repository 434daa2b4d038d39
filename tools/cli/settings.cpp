#include "tools/cli/settings.h"
#include "scenes/builtin.h"
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

std::vector<std::string> readOutputs(const Arguments& arguments) {
    const std::vector<std::string> outputs = arguments.all("output");
    if (outputs.empty()) return {"{scene}.exr", "{scene}.png"};
    for (const std::string& o : outputs) {
        if (o == "-") throw Error(Exit::usage, "-o -: a picture does not go to stdout; give a file name ending in .exr or .png");
        const std::string extension = std::filesystem::path(o).extension().string();
        if (extension != ".exr" && extension != ".png")
            throw Error(Exit::usage, fmt::format("-o {}: chiaro writes .exr and .png; give one of these endings", o));
    }
    return outputs;
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

} // namespace

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
    if (a.given("max-memory")) s.maxMemory = parseMemory("max-memory", a.text("max-memory"));
}

RenderSettings readSettings(const Arguments& a) {
    RenderSettings s;
    s.arguments = &a;
    s.scene = readSceneRequest(a);
    s.integrator = readIntegrator(a);
    s.budget.spp = uint32_t(parseWhole("spp", a.text("spp"), 1, 1u << 31));
    if (a.given("time")) s.budget.seconds = parseDuration("time", a.text("time"));
    if (const BuiltinScene* builtin = findBuiltin(s.scene.operand); builtin && !a.given("spp")) s.budget.spp = builtin->spp;
    if (const uint32_t pattern = patternSamples(s.integrator); pattern > 0 && !a.given("spp")) s.budget.spp = pattern;
    // A time alone is the budget; the default number of samples would end it early.
    if (a.given("time") && !a.given("spp")) s.budget.spp = 1u << 31;
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
    s.outputs = readOutputs(a);
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

std::vector<std::filesystem::path> outputFiles(const RenderSettings& settings, uint32_t spp) {
    std::vector<std::filesystem::path> files;
    for (std::string name : settings.outputs) {
        replaceAll(name, "{scene}", settings.scene.stem());
        replaceAll(name, "{integrator}", std::string(settings.integrator.entry->name));
        replaceAll(name, "{spp}", std::to_string(spp));
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

std::size_t memoryLimit(const RenderSettings& s) {
    constexpr double share = 0.8;
    if (s.maxMemory) return *s.maxMemory;
    const std::size_t physical = physicalBytes();
    return physical == 0 ? ~std::size_t(0) : std::size_t(share * double(physical));
}

std::string memoryLimitText(const RenderSettings& s) {
    return s.maxMemory ? fmt::format("--max-memory is {}", memorySize(double(*s.maxMemory)))
                       : fmt::format("this machine has {}", memorySize(double(physicalBytes())));
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
