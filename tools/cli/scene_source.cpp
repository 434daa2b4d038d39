#include "tools/cli/scene_source.h"
#include "core/scene/camera.h"
#include "io/file_bytes.h"
#include "io/image_read.h"
#include "materials/closure_table.h"
#include "scenes/builtin.h"
#include "tools/cli/command.h"
#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

namespace chiaro::cli {
namespace {

const BuiltinScene& builtinNamed(const std::string& name) {
    if (const BuiltinScene* found = findBuiltin(name)) return *found;
    std::vector<std::string> names;
    for (const BuiltinScene& s : builtinScenes()) names.emplace_back(s.name);
    const std::string near = nearest(name, names);
    throw Error(Exit::usage, fmt::format("no scene \"{}\" in the program; have {}{}", name, fmt::join(names, ", "),
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

bool emits(const SceneDesc& scene) {
    for (const InstanceDesc& instance : scene.instances) {
        if (instance.mesh < 0) continue;
        for (const PrimitiveDesc& p : scene.meshes[std::size_t(instance.mesh)].primitives)
            if (const MaterialDesc* m = p.material >= 0 ? &scene.materials[std::size_t(p.material)] : nullptr;
                m && !black(m->unlit ? m->baseColor : m->emission))
                return true;
    }
    return false;
}

EnvironmentDesc environmentNamed(const std::string& name, Diagnostics& notes) {
    if (name == "studio") return studioEnvironment();
    if (name == "white") return whiteEnvironment();
    return readEnvironment(name, notes);
}

// Of a picture that is named; 0 for the small ones of the program.
uint64_t environmentTexels(const std::string& name) {
    if (name.empty() || name == "none" || name == "studio" || name == "white") return 0;
    const PictureSize size = pictureSize(std::filesystem::path(name));
    return uint64_t(size.width) * uint64_t(size.height);
}

void lightScene(SceneDesc& desc, const SceneRequest& request, LoadedScene& loaded, Diagnostics& notes) {
    loaded.environment = desc.environment ? "of the scene" : "none";
    if (request.env == "none") {
        desc.environment.reset();
        loaded.environment = "none";
        if (desc.lights.empty() && !emits(desc))
            notes.warn(
                "no light and --env none: the picture will be black. Add --env studio, or a KHR_lights_punctual or emissive material.");
    } else if (!request.env.empty()) {
        desc.environment = environmentNamed(request.env, notes);
        loaded.environment = request.env;
    } else if (desc.lights.empty() && !desc.environment && !emits(desc)) {
        desc.environment = studioEnvironment();
        loaded.environment = "studio";
        loaded.added.push_back("no light in the scene: lit by a neutral studio      keep it with: --env studio");
    }
    if (desc.environment) {
        desc.environment->rotate += request.envRotate;
        desc.environment->scale *= request.envScale;
    } else if (request.envRotate != 0 || request.envScale != 1)
        notes.warn("--env-rotate and --env-scale have no effect: there is no environment. Add --env FILE, studio or white.");
}

// "0.02", "1/48"
double parseSeconds(const std::string& part, const std::string& text) {
    const std::size_t slash = part.find('/');
    try {
        const double over = parseReal("shutter", part.substr(0, slash), -1e6, 1e6);
        return slash == std::string::npos ? over : over / parseReal("shutter", part.substr(slash + 1), 1e-6, 1e6);
    } catch (const Error&) {
        throw Error(Exit::usage,
                    fmt::format("--shutter: \"{}\" is not a time in seconds like 0.02 or 1/48, or OPEN:CLOSE like -0.01:0.01", text));
    }
}
Interval parseShutter(const std::string& text) {
    const std::size_t colon = text.find(':');
    const double open = colon == std::string::npos ? 0 : parseSeconds(text.substr(0, colon), text);
    const double close = parseSeconds(colon == std::string::npos ? text : text.substr(colon + 1), text);
    if (close < open) throw Error(Exit::usage, fmt::format("--shutter {}: closes before it opens", text));
    return {float(open), float(close)};
}

bool moves(const SceneDesc& desc) {
    const auto moving = [](const auto& thing) { return thing.motion.size() > 1; };
    for (const MeshDesc& mesh : desc.meshes)
        if (std::any_of(mesh.primitives.begin(), mesh.primitives.end(), [](const PrimitiveDesc& p) { return !p.steps.empty(); }))
            return true;
    return std::any_of(desc.instances.begin(), desc.instances.end(), moving) ||
           std::any_of(desc.lights.begin(), desc.lights.end(), moving) || std::any_of(desc.cameras.begin(), desc.cameras.end(), moving);
}

std::string nameOf(const std::string& name) { return name.empty() ? "" : fmt::format(", \"{}\",", printable(name)); }

void noteTime(const SceneRequest& request, const SceneDesc& desc, LoadedScene& loaded, Diagnostics& notes) {
    const auto& all = loaded.animations;
    if (request.shutter.close > request.shutter.open && !moves(desc))
        notes.warn(fmt::format("--shutter has no effect: nothing moves in {} while it is open", request.operand));
    if (all.empty() && (request.frameTime != 0 || !request.animation.empty()))
        notes.warn(fmt::format("--frame-time and --animation have no effect: {} has no animation", request.operand));
    if (all.size() > 1 && request.animation.empty())
        loaded.added.push_back(
            fmt::format("{} animations in the scene: the first, \"{}\", plays      keep it with: --animation 0", all.size(), all[0].name));
}

} // namespace

std::string SceneRequest::stem() const {
    return operand.starts_with('@') ? operand.substr(1) : std::filesystem::path(operand).stem().string();
}

SceneRequest readSceneRequest(const Arguments& arguments) {
    SceneRequest request;
    request.operand = arguments.operands.at(0);
    if (request.operand.starts_with('@')) builtinNamed(request.operand);
    request.env = arguments.text("env");
    request.envRotate = float(parseReal("env-rotate", arguments.text("env-rotate"), -36000, 36000) * std::numbers::pi / 180);
    request.envScale = float(parseReal("env-scale", arguments.text("env-scale"), 0, 1e12));
    request.greyTextures = parseChoice("missing-texture", arguments.text("missing-texture"), {"error", "grey"}) == 1;
    if (arguments.given("frame-time")) request.frameTime = parseReal("frame-time", arguments.text("frame-time"), -1e9, 1e9);
    if (arguments.given("shutter")) request.shutter = parseShutter(arguments.text("shutter"));
    request.animation = arguments.text("animation");
    request.scene = arguments.text("scene");
    if (!request.scene.empty() && request.operand.starts_with('@'))
        throw Error(Exit::usage,
                    fmt::format("--scene {}: {} is one scene; --scene chooses among those of a glTF file", request.scene, request.operand));
    if (arguments.given("isa")) {
        request.isa = arguments.text("isa");
        parseChoice("isa", request.isa, {"sse2", "sse4.2", "avx", "avx2", "avx512"});
    }
    request.memory = readMemoryBudget(arguments);
    return request;
}

LoadedScene loadScene(const SceneRequest& request, Diagnostics& notes, const Executor& run,
                      const std::function<void(const SceneDesc&)>& look) {
    const auto begin = std::chrono::steady_clock::now();
    LoadedScene loaded;
    SceneDesc desc;
    const uint64_t skyTexels = environmentTexels(request.env);
    const auto admit = [&](SceneSizes ofFile) {
        ofFile.skyTexels = skyTexels;
        admitScene(request.operand, ofFile, request.memory);
    };
    if (request.operand.starts_with('@')) {
        const BuiltinScene& builtin = builtinNamed(request.operand);
        admit({});
        desc = builtin.make();
        loaded.size = Size{builtin.width, builtin.height};
        if (builtin.animate && request.animation != "none") {
            builtin.animate(desc, request.frameTime, request.shutter);
            loaded.animations = {{"flight", 1, {}, true}};
        }
    } else {
        GltfContents found;
        desc = readGltf(request.operand,
                        {request.greyTextures ? MissingTexture::grey : MissingTexture::error, request.frameTime, request.shutter,
                         request.animation, request.scene, &run, admit},
                        notes, &found);
        loaded.animations = std::move(found.animations);
        loaded.origin = std::move(found.origin);
        loaded.inventory = std::move(found.inventory);
        loaded.scenes = std::move(found.scenes);
        loaded.number = found.scene;
        if (loaded.scenes.size() > 1 && request.scene.empty())
            loaded.added.push_back(fmt::format("{} scenes in the file: {}{} is shown      keep it with: --scene {}", loaded.scenes.size(),
                                               loaded.number, nameOf(loaded.scenes[loaded.number]), loaded.number));
    }
    noteTime(request, desc, loaded, notes);
    lightScene(desc, request, loaded, notes);
    if (look) look(desc);
    loaded.scene = Scene::compile(std::move(desc), notes, request.isa, &run, ClosureTable::make);
    loaded.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return loaded;
}

std::string timeText(const SceneRequest& request, const LoadedScene& loaded) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < loaded.animations.size(); ++i)
        if (const AnimationInfo& a = loaded.animations[i]; a.used)
            names.push_back(a.name.empty() ? fmt::format("{}", i) : fmt::format("\"{}\"", a.name));
    if (names.size() > 3) names = {fmt::format("{} animations", names.size())};
    if (names.empty()) return {};
    std::string text = fmt::format("{} at {:g} s", fmt::join(names, ", "), request.frameTime);
    if (request.shutter.close > request.shutter.open)
        text += fmt::format(", shutter {:g} to {:g} s from there", request.shutter.open, request.shutter.close);
    return text;
}

CameraDesc chooseCamera(const Scene& scene, const std::string& wanted, double aspect, bool& automatic) {
    const auto cameras = scene.cameras();
    automatic = wanted == "auto" || (wanted.empty() && cameras.empty());
    if (automatic) return frameScene(scene, aspect);
    if (wanted.empty()) return cameras[0];
    std::vector<std::string> names;
    for (const CameraDesc& c : cameras) {
        if (c.name == wanted) return c;
        names.push_back(c.name);
    }
    std::size_t number = 0;
    const auto [end, failed] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (failed == std::errc() && end == wanted.data() + wanted.size() && number < cameras.size()) return cameras[number];
    if (cameras.empty()) throw Error(Exit::usage, fmt::format("no camera \"{}\": the scene has none; use --camera auto", wanted));
    const std::string near = nearest(wanted, names);
    throw Error(Exit::usage, fmt::format("no camera \"{}\"; have 0 to {} or by name \"{}\", or auto{}", wanted, cameras.size() - 1,
                                         fmt::join(names, "\", \""), near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
}

} // namespace chiaro::cli
