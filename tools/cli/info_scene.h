// What info knows of a scene, as one JSON object (--json prints it as it is), and that object as text for people.
#pragma once
#include "tools/cli/scene_source.h"
#include <nlohmann/json.hpp>

namespace chiaro::cli {

nlohmann::ordered_json describeScene(const SceneRequest&, Diagnostics&);
void printScene(const nlohmann::ordered_json&);

} // namespace chiaro::cli
