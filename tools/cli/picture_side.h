// Pictures of anybody, as one side of a comparison: which channels are the colour, which its error, decoded to linear, cut to an area.
#pragma once
#include "io/picture.h"
#include "tools/judge/picture.h"
#include <array>
#include <string>
#include <vector>

namespace chiaro::cli {

struct ChosenChannels {
    std::array<std::size_t, 3> channels{};
    bool color = true; // else numbers: normals, depths
};
// R G B of the layer, else its X Y Z, else its one channel; without a layer R G B, else Y, else the only channel. Throws
// Error(Exit::unsupported) with the layers that there are.
ChosenChannels chooseColor(const Picture&, const std::string& file, const std::string& layer);

// Those channels within the area, interleaved.
std::vector<float> cutChannels(const Picture&, const std::array<std::size_t, 3>& channels, const Rect& area, bool decode);

struct PictureSide {
    judge::Picture picture; // the area alone; linear
    std::string file;
    uint32_t width = 0, height = 0;             // of the whole picture
    std::vector<std::string> channels, ignored; // names in the file; ignored ones by layer
    bool encoded = false;                       // whole numbers, decoded by the sRGB curve
};
// errors: take error.R, error.G, error.B where they are.
PictureSide makeSide(const Picture&, const std::string& file, const ChosenChannels&, const Rect& area, bool errors);

} // namespace chiaro::cli
