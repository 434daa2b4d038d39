// Which patches stand at which point of their mesh: a list for each point, one after the other.
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

struct Corners {
    std::vector<uint32_t> begin, patch;
    Corners(std::span<const Patch> patches, uint32_t points) : begin(points + 1) {
        for (const Patch& p : patches)
            for (uint32_t c = 0; c < p.corners; ++c) ++begin[p.vertex[c] + 1];
        for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
        patch.resize(begin.back());
        std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
        for (uint32_t i = 0; i < patches.size(); ++i)
            for (uint32_t c = 0; c < patches[i].corners; ++c) patch[next[patches[i].vertex[c]]++] = i;
    }
    std::span<const uint32_t> at(uint32_t point) const noexcept { return {patch.data() + begin[point], begin[point + 1] - begin[point]}; }
};

} // namespace chiaro::radiosity
