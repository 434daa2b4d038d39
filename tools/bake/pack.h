// Places rectangles in a square without overlap: bottom-left by the skyline (Jylanki, A Thousand Ways to Pack the Bin, 2010), the tallest
// first. Deterministic.
#pragma once
#include "core/math/ray.h"
#include <optional>
#include <span>
#include <vector>

namespace chiaro::bake {

struct Extent {
    uint32_t w = 0, h = 0;
};
// The lower left corner of each, in their order; none where they do not fit.
std::optional<std::vector<Pixel>> pack(std::span<const Extent>, uint32_t side);

} // namespace chiaro::bake
