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

// --sample-range A:B: the samples A to B - 1 of every pixel.
struct SampleRange {
    uint32_t begin = 0, end = 0;
};
struct CheckpointSettings {
    std::filesystem::path file;   // where it is written
    std::filesystem::path resume; // empty: from the beginning
    double every = infinity;      // seconds
    bool atEnd = false;           // also when nothing interrupted the render
};

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
    unsigned threads = 0; // 0: all
    SamplerKind sampler = SamplerKind::sobol;
    FilterKind filter = FilterKind::blackmanHarris;
    std::string camera;
    LensRequest lens;
    std::optional<double> exposure; // none: auto
    std::string view, ocio;
    std::vector<std::string> outputs; // patterns of pictures
    std::optional<SampleRange> range; // none: all of the budget's
    CheckpointSettings checkpoint;
    LayerChoice aov;
    std::filesystem::path photonMap; // empty: none is written
    bool strict = false, json = false, quiet = false, verbose = false;
    ProgressMode progress = ProgressMode::automatic;
};
RenderSettings readSettings(const Arguments&);
// What every command that renders reads alike: depth, paths, size, threads, sampler, filter, camera, lens.
void readFrame(const Arguments&, RenderSettings&);

// -o: the pictures; a .chk among them goes to `checkpoint`. standard: where there is no -o.
std::vector<std::string> readOutputs(const Arguments&, std::vector<std::string> standard, std::string& checkpoint);
std::string expandedName(std::string pattern, const std::string& scene, const std::string& integrator, uint32_t spp);

// The film that holds what was asked for.
FilmLayout filmLayout(const RenderSettings&, const View&);

// The pictures that the patterns name for so many samples.
std::vector<std::filesystem::path> outputFiles(const RenderSettings&, uint32_t spp);
bool isExr(const std::filesystem::path&);

// The view: camera, size, crop. `automatic`: the camera was framed by chiaro.
View makeView(const RenderSettings&, const LoadedScene&, CameraDesc& camera, bool& automatic);

std::string samplerName(SamplerKind);
std::string filterName(FilterKind);
std::string integratorRecipe(const IntegratorChoice&); // "path:rr-depth=3"

} // namespace chiaro::cli
