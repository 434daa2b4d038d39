// What each pixel cost, or what its photons were, for the eye: beside FILE.png one picture a quantity, in colours from dark (cheap) to
// bright (dear) over a bar with its numbers. The brightest twentieth may lie beyond the bar: a thread that the system stopped for a while
// is no dear pixel.
#pragma once
#include "io/picture.h"
#include <array>

namespace chiaro::cli {

// FILE.cost.time.png, FILE.cost.rays.png, FILE.cost.depth.png
std::array<std::filesystem::path, 3> costFiles(const std::filesystem::path& png);
// Of a picture that has the layers "cost.time", "cost.rays", "cost.depth".
void writeCostPictures(const std::filesystem::path& png, const Picture&);
// The same of "photons.density", "photons.radius", "photons.count".
std::array<std::filesystem::path, 3> photonFiles(const std::filesystem::path& png);
void writePhotonPictures(const std::filesystem::path& png, const Picture&);

} // namespace chiaro::cli
