// Where two estimates differ: signed standard errors of tiles and pixels, as false colours (PNG, tiles on the left, pixels on the right) or
// as numbers (EXR: z.tile, z.pixel, and of replicates test.Y and reference.Y). NaN: left out.
#pragma once
#include "tools/judge/agreement.h"
#include <filesystem>
#include <string>
#include <vector>

namespace chiaro::cli {

struct AgreeMap {
    std::string name, reference; // of the sides
    uint32_t width = 0, height = 0;
    Rect window; // the part that was judged
    const judge::Agreement* agreement = nullptr;
    const judge::Replicates *test = nullptr, *of = nullptr; // or null
};

inline constexpr double mapScale = 5; // standard errors at full colour

// The files that -o asks for: a folder gives NAME.png and NAME.exr.
std::vector<std::filesystem::path> mapFiles(const std::vector<std::string>& outputs, const std::string& fileName);
// Folders are made; throws Error(Exit::file) for what could not be written later.
void prepareMaps(const std::vector<std::string>& outputs, const std::vector<std::string>& fileNames);
void writeMap(const std::filesystem::path&, const AgreeMap&);

} // namespace chiaro::cli
