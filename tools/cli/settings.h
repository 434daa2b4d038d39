// What `chiaro render` was asked for, as values: every option read and checked before anything is loaded.
#pragma once
#include "core/render/render.h"
#include "integrators/registry.h"
#include "tools/cli/command.h"
#include "tools/cli/lens.h"
#include "tools/cli/prepass_settings.h"
#include "tools/cli/progress_bar.h"
#include "tools/cli/scene_source.h"
#include <filesystem>

namespace chiaro::cli {

// Of --aov: what a picture carries beside its beauty.
struct LayerChoice {
    bool albedo = true, normal = true, depth = true, cost = false, photons = false;
    bool all = false; // photons too, where there are any
};
LayerChoice readLayers(const std::string& list);

struct RenderSettings {
    const Arguments* arguments = nullptr;
    SceneRequest scene;
    IntegratorChoice integrator{nullptr, Options({})};
    PrepassSettings prepass;
    Budget budget;
    PathQuery paths;               // --paths, --split, --max-depth
    PathClasses classes;           // made from them
    std::string size, crop, pixel; // as typed; they are read when the camera is known
    uint32_t sample = 0;
    uint64_t seed = 0;
    unsigned threads = 0;                 // 0: all
    std::optional<std::size_t> maxMemory; // bytes; none: a share of the machine's
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::blackmanHarris;
    std::string camera;
    LensRequest lens;
    std::optional<double> exposure; // none: auto
    std::string view, ocio;
    std::vector<std::string> outputs; // patterns
    LayerChoice aov;
    std::filesystem::path photonMap; // empty: none is written
    bool strict = false, json = false, quiet = false, verbose = false;
    ProgressMode progress = ProgressMode::automatic;
};
RenderSettings readSettings(const Arguments&);
// What every command that renders reads alike: depth, paths, size, threads, sampler, filter, camera, lens.
void readFrame(const Arguments&, RenderSettings&);

// The files that the patterns name for so many samples.
std::vector<std::filesystem::path> outputFiles(const RenderSettings&, uint32_t spp);
bool isExr(const std::filesystem::path&);

// The view: camera, size, crop. `automatic`: the camera was framed by chiaro.
View makeView(const RenderSettings&, const LoadedScene&, CameraDesc& camera, bool& automatic);

// --max-memory, or 80 % of the machine's: the rest is for the scene and the system.
std::size_t memoryLimit(const RenderSettings&);
std::string memoryLimitText(const RenderSettings&); // "this machine has 16 GB", "--max-memory is 2 GB"

std::string samplerName(SamplerKind);
std::string filterName(FilterKind);
std::string integratorRecipe(const IntegratorChoice&); // "path:rr-depth=3"

} // namespace chiaro::cli
