// Memory of a command: how much it may take, how much it took. What would not fit is refused before it is begun, with a line that says what
// needs how much and what to do.
#pragma once
#include "core/scene/scene_bytes.h"
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace chiaro {
class Scene;
}

namespace chiaro::cli {

class Arguments;

std::size_t machineBytes(); // what this process can have: of the machine, or of the control group (cgroup 1 or 2) it runs in; 0: unknown
std::size_t peakBytes();    // the most that this process had; 0 where unknown

struct MemoryBudget {
    std::size_t bytes = ~std::size_t(0); // for scenes, pictures and all that is solved; the program and its libraries come on top
    bool given = false;                  // by --max-memory; else a share of the machine's
    std::string text() const;            // "this machine has 16 GB", "--max-memory is 2 GB"
    // What the scene leaves to pictures and solutions.
    std::size_t beside(const Scene&) const noexcept;
};
// --max-memory where the command has it, or 80 % of the machine's: the rest is for the program and the system.
MemoryBudget readMemoryBudget(const Arguments&);

// Throws Error(Exit::resources) where a scene of these sizes would not fit.
void admitScene(const std::string& name, const SceneSizes&, const MemoryBudget&);
// " beside the 1.2 GB of the scene", or nothing where the scene is small against what is needed.
std::string besideText(const Scene&, double needed);

// {"geometry": 28000000, ..., "total": 96000000}, in bytes; as text "geometry 28 MB, hierarchy 68 MB, ...".
nlohmann::ordered_json sceneBytesJson(const SceneBytes&);
std::string sceneBytesText(const SceneBytes&);

// Failing allocations leave as std::bad_alloc; where no exception can leave, this ends the program with the same line and exit code.
void exitOnOutOfMemory();
// For both ways out.
inline constexpr const char* outOfMemory = "not enough memory. A smaller --size or --crop, fewer layers or a smaller scene needs less.";

} // namespace chiaro::cli
