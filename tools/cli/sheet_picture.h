// A picture in the size in which a sheet shows it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro::cli {

struct SheetSize {
    uint32_t width = 0, height = 0;
};
// The largest size within the frame that is a whole multiple of the picture, no side beyond `enough`; a picture that is larger than the
// frame is fitted into it, its sides in proportion and at least one pixel long.
SheetSize sheetSize(SheetSize picture, SheetSize frame, uint32_t enough);

struct SheetPixels {
    std::vector<float> rgb;        // linear; 0 where it is not finite
    std::vector<uint8_t> unusable; // one flag a pixel: something in it is not finite
};
// rgb: linear triples, row 0 on top. `to` is what sheetSize answered for this picture.
SheetPixels sheetPixels(std::span<const float> rgb, SheetSize from, SheetSize to);

} // namespace chiaro::cli
