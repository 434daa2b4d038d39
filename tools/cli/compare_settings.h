// What `chiaro compare` was asked for, as values.
#pragma once
#include "tools/cli/integrator_list.h"
#include "tools/cli/settings.h"
#include <optional>
#include <string>
#include <vector>

namespace chiaro::cli {

enum class Equal { time, spp, noise };
enum class ReferenceKind { automatic, none, file };

struct CompareSettings {
    RenderSettings base; // of the scene: its integrator, budget and outputs are not used
    bool hasScene = false;
    std::vector<IntegratorChoice> integrators;
    std::vector<std::string> images; // operands that are pictures, in order, without the reference
    Equal equal = Equal::time;
    double seconds = 10; // of an integrator; with Equal::noise at most
    uint32_t spp = 64;   // the same in samples a pixel
    double noise = 0.02;
    std::optional<uint32_t> seeds; // none: standardSeeds, or fewer where the budget is small
    ReferenceKind reference = ReferenceKind::automatic;
    std::string referenceFile;
    std::optional<double> referenceSeconds;
    std::optional<std::filesystem::path> cache; // none: references are not kept
    std::string layer;                          // of files
    bool fit = false;
    std::filesystem::path folder;
    std::string csv, json; // besides the folder's: a file, "-", or empty
};
inline constexpr uint32_t standardSeeds = 16;
inline constexpr double noiseSeconds = 600; // of an integrator with --equal noise and without --time

// Throws Error(Exit::usage).
CompareSettings readCompareSettings(const Arguments&);

} // namespace chiaro::cli
