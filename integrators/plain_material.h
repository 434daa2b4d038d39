// Plain materials: of one colour, ideally diffuse and nothing else. Their closure answers the same in all directions, so that hits on them
// are loops over lanes without a closure each.
#pragma once
#include "core/scene/scene.h"
#include <vector>

namespace chiaro {

// What the closure of a plain material answers, whatever the directions; smooth false: black.
struct PlainMaterial {
    bool plain = false, smooth = false;
    Spectrum f{0}, albedo{0}, diffuseAlbedo{0}; // f: 1/sr
};
std::vector<PlainMaterial> plainMaterials(const Scene&); // by material

} // namespace chiaro
