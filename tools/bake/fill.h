// Fill: texels that nothing stands for get the light of those about them, so that neither bilinear look-up nor the mean of a mip level
// brings black into a chart. First ring by ring from the nearest, then what is left from means of ever larger blocks (push-pull: Gortler et
// al., The Lumigraph, 1996).
#pragma once
#include "core/math/vec.h"
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro::bake {

struct MapTexel {
    Spectrum irradiance{0}, outgoing{0};
    float opacity = 1;
    bool known = false;
};
// How many texels were given a value by their neighbours within `rings`.
uint64_t fillUnknown(std::span<MapTexel>, uint32_t size, uint32_t rings);

} // namespace chiaro::bake
