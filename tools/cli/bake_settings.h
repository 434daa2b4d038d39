// What `chiaro bake` was asked for, as values, and what it made of it.
#pragma once
#include "tools/bake/bake.h"
#include "tools/bake/layout.h"
#include "tools/bake/mesh.h"
#include "tools/cli/settings.h"

namespace chiaro::cli {

struct BakeSettings {
    Arguments arguments; // as `chiaro render` would have got them
    RenderSettings render;
    bake::LayoutSettings layout;
    bake::GatherSettings gather;
    bool toVertex = false, lit = true;
    std::filesystem::path output, bin, exr; // bin, exr: empty for none
};
// In place: render points to arguments.
void readBakeSettings(const Arguments&, BakeSettings&);

// A surface in the scene that is baked, or why not.
struct Chosen {
    std::vector<uint32_t> parts; // of Scene::parts()
    uint64_t transparent = 0, skinned = 0, morphed = 0, animated = 0;
};

struct Baked {
    Chosen chosen;
    bake::Layout layout; // of a light map
    uint64_t vertices = 0, triangles = 0;
    uint64_t sites = 0, filled = 0;
    bake::BakeResult result;
    double exposure = 0;
    bool automaticExposure = false;
    double prepassSeconds = 0;
    std::vector<std::filesystem::path> files;
};
void tellBakePlan(const BakeSettings&, const LoadedScene&, const Baked&, const Console&);
// Leaks, overlaps and what is left out, as warnings.
void warnOfBake(const BakeSettings&, const LoadedScene&, const Baked&, Diagnostics&);
void tellBaked(const BakeSettings&, const Baked&, const Console&);
void printBakeSummary(const BakeSettings&, const Baked&, const Diagnostics&, int code);
Metadata bakeRecipe(const BakeSettings&, const LoadedScene&, const Baked&);

} // namespace chiaro::cli
