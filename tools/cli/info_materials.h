// What info tells of materials: which lobes of light they have, and which textures each of them reads.
#pragma once
#include "core/scene/desc.h"
#include <nlohmann/json.hpp>

namespace chiaro::cli {

// [{"name", "kind", "lobes": [...], "textures": {"baseColor": 3, ...}}]: numbers of images.
nlohmann::ordered_json materialsOf(const SceneDesc&);

} // namespace chiaro::cli
