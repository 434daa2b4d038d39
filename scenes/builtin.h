// The scenes inside the program: `@cornell` and its like, written in code so that a picture, a self-test or an example needs no file.
// Each is a plain SceneDesc in the project's conventions (metres, +Y up, front faces counter-clockwise, emitters shining from the front
// only) and has a page, scenes/<name>.md, that says what it proves, which numbers to expect and where its data come from.
// Making a scene has no errors: the answer depends on nothing but the code.
#pragma once
#include "core/scene/desc.h"
#include <cstdint>
#include <span>
#include <string_view>

namespace chiaro {

struct BuiltinScene {
    std::string_view name;          // as typed on the command line: "@cornell"
    std::string_view summary;       // one line for `chiaro scenes`
    SceneDesc (*make)();            // a fresh description; equal bits at every call
    uint32_t width = 0, height = 0; // the picture the page talks about
    uint32_t spp = 0;               // samples per pixel that give a presentable picture with `path`
    // Moves what moves: places it at the frame time (seconds) and gives it its motion over the shutter. Null: nothing moves.
    void (*animate)(SceneDesc&, double frameTime, Interval shutter) = nullptr;
};

// All of them, in the order in which they are listed to people.
std::span<const BuiltinScene> builtinScenes();
// By name with its "@"; null when there is none.
const BuiltinScene* findBuiltin(std::string_view name);

} // namespace chiaro
