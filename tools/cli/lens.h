// The lens that a view is given: --aperture, --focus, --blades. glTF cameras have none of their own.
#pragma once
#include "core/scene/desc.h"
#include "tools/cli/command.h"
#include "tools/cli/values.h"
#include <optional>
#include <string>

namespace chiaro {
class Scene;
}

namespace chiaro::cli {

class Console;

struct LensRequest {
    std::optional<double> diameter, fNumber; // one of them, or none: a pinhole
    std::string focus = "auto";              // "auto", metres, or the pixel "X,Y" whose surface is to be sharp
    int blades = 0;
    double rotation = 0; // radians
    explicit operator bool() const noexcept { return diameter || fNumber; }
};
// Throws Error(Exit::usage).
LensRequest readLens(const Arguments&);

// Needs the scene: a focus may be what a pixel sees in the middle of the shutter. Where the picture's centre sees nothing, the middle of
// the scene.
LensDesc chooseLens(const LensRequest&, const CameraDesc&, const Scene&, Size);
void tellLens(const LensRequest&, const LensDesc&, const Console&);

} // namespace chiaro::cli
