// From what the user calls a scene (a file, or a built-in like @cornell) to the compiled scene: environment options applied, and what the
// scene lacks added and announced.
#pragma once
#include "core/render/error.h"
#include "core/scene/scene.h"
#include "io/gltf.h"
#include "tools/cli/console.h"
#include "tools/cli/memory.h"
#include "tools/cli/values.h"
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace chiaro::cli {

class Arguments;

struct SceneRequest {
    std::string operand; // as typed
    std::string env;     // as typed; empty: the scene's own
    float envRotate = 0; // radians
    float envScale = 1;
    bool greyTextures = false;
    double frameTime = 0;  // seconds of the animation
    Interval shutter;      // relative to it
    std::string animation; // as typed; empty: the first
    std::string scene;     // of the file, as typed; empty: its default
    std::string isa;
    MemoryBudget memory;
    std::string stem() const; // for file names: "cornell", "room"
};
// Of the options that render and info share. Throws Error: a bad value, a built-in that does not exist.
SceneRequest readSceneRequest(const Arguments&);

struct LoadedScene {
    std::unique_ptr<const Scene> scene;
    std::optional<Size> size;               // what a built-in scene proposes
    double seconds = 0;                     // reading and compiling
    std::string environment;                // "of the scene", "studio", a path, "none"
    std::vector<AnimationInfo> animations;  // of the file
    std::vector<std::string> scenes;        // of the file, by name
    std::size_t number = 0;                 // of the scene that is shown
    std::optional<GltfInventory> inventory; // of the file; a built-in scene has none
    GltfOrigin origin;                      // what of the file the description shows
    std::vector<std::string> added;         // "no light ...: ..."; with the option that fixes it
};
// look: sees the description before it is compiled (and gone). Throws Error(Exit::resources) before anything is read that would not fit.
LoadedScene loadScene(const SceneRequest&, Diagnostics&, const Executor&, const std::function<void(const SceneDesc&)>& look = {});

// A neutral photo studio as light: grey room of about 1 cd/m2, a bright soft box above the viewer's left shoulder, a weaker one to the
// right, a darker floor. Latitude-longitude, 256 x 128.
EnvironmentDesc studioEnvironment();
// The same radiance from everywhere.
EnvironmentDesc whiteEnvironment();

// What the time of the picture is, for people: "\"Walk\" at 0.5 s, shutter 0 to 0.02 s"; empty: nothing is animated.
std::string timeText(const SceneRequest&, const LoadedScene&);

// A camera by name, number or "auto" (also where the scene has none); `automatic` says that the scene was framed.
CameraDesc chooseCamera(const Scene&, const std::string& wanted, double aspect, bool& automatic);

} // namespace chiaro::cli
