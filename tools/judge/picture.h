// What the judge looks at: linear RGB of equal size, with the standard error of every value where it is known. Plain values; reading and
// writing files is the caller's. A picture of several layers is compared layer by layer: chooseChannels says which channels of a file
// make up the RGB and which are left out, so that a report can name them.
#pragma once
#include "core/math/ray.h"
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::judge {

struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<float> rgb;           // interleaved, row 0 on top; linear Rec.709, cd/m2
    std::vector<float> error;         // empty, or the standard error of each value of rgb
    std::string name;                 // for messages
    std::vector<std::string> ignored; // channels of the file that are not compared

    std::size_t pixels() const noexcept { return std::size_t(width) * height; }
};

// The pixels that count. Without either: all.
struct Region {
    std::optional<Rect> crop;
    std::vector<uint8_t> mask; // empty, or one value a pixel of the whole picture; 0 leaves it out
};

struct ChannelChoice {
    std::optional<std::size_t> red, green, blue; // indices; all three the same for a grey picture
    std::vector<std::string> ignored;
};
// R, G, B (any case, or the same names under the one layer prefix given), else Y or a single channel as grey.
ChannelChoice chooseChannels(const std::vector<std::string>& names, const std::string& layer = {});

// Throws Exit::unsupported where the two cannot be compared (sizes, planes of the wrong length, a mask or crop that does not fit).
void requireComparable(const Picture& test, const Picture& reference, const Region&);
// One byte a pixel: 1 inside crop and mask.
std::vector<uint8_t> selected(uint32_t width, uint32_t height, const Region&);

} // namespace chiaro::judge
