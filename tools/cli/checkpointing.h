// Renders that go on, and parts of renders: what belongs together (every setting that decides a bit, in words), the options that a
// checkpoint remembers, and where checkpoints lie.
#pragma once
#include "core/render/depth.h"
#include "io/checkpoint.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/recipe.h"

namespace chiaro::cli {

// The options of an interrupted render under those that were typed now. Of --spp, --time and --noise the old ones hold unless one of them
// is given again; what was typed about threads, progress and the like belonged to that run.
Arguments continued(const Arguments& typed, const CheckpointHead&);
// The command that made the picture: the first, and the one that went on where it says more than to go on.
std::string commandOf(const Arguments& typed, const CheckpointHead&);
// --time counts what was spent before, unless it is given again.
void chargeTime(RenderSettings&, const Arguments& typed, const CheckpointHead&);

// All that decides a bit of the film, as names and words; "scene" is what the user called it: told, not compared.
FileKey renderKey(const RenderSettings&, const LoadedScene&, const View&, const CameraDesc&);
// How two of them differ: "with --seed 0, not 1"; empty: not at all. `except`: a name that may.
std::string keyDifference(const FileKey& a, const FileKey& b, std::string_view except = {});
// Throws Error(Exit::unsupported): the file belongs to another scene or to other settings.
void refuseOther(const std::filesystem::path& file, const CheckpointHead&, const FileKey& wanted);

// Writes the checkpoint of one render, whenever it is asked to.
class Keeper {
public:
    Keeper(const RenderSettings&, const LoadedScene&, const View&, const DisplayTransform&, const Job&, FileKey);
    // now: the render so far, of all runs; its samples are the film's. Throws Error.
    void write(const Film&, const Integrator&, Rendered now);
    const Centres& centres();

private:
    const RenderSettings& s_;
    const LoadedScene& loaded_;
    const View& view_;
    const DisplayTransform& display_;
    const Job& job_;
    FileKey key_;
    std::optional<Centres> centres_;
};

} // namespace chiaro::cli
