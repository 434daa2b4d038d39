// What lies under the pixel centres. The depth layer: planar distance along the viewing axis, metres, of what lies under each pixel's
// centre, through the middle of the lens, when the shutter opens. Unfiltered, since an average of depths is no depth; +inf where nothing
// is. Alpha counts as a surface where its opacity is at least one half.
#pragma once
#include "core/render/integrator.h"
#include <vector>

namespace chiaro {

// One value a pixel of the crop, rows from the top.
struct Centres {
    std::vector<float> depth;
    std::vector<uint8_t> lamp; // 1 where the surface is a light, with motion at any of several times while the shutter is open
};
Centres seenAtCentres(const Job&);

} // namespace chiaro
