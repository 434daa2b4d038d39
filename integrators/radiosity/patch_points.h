// Numbers of the points of the mesh of patches, as interpolation wants them: facet corners at one place share a number where smooth edges
// link them, and so do the points on a smooth edge; across a crease, or between materials, each has its own.
#pragma once
#include "integrators/radiosity/patch_cut.h"

namespace chiaro::radiosity {

class PointNumbers {
public:
    // segments: of every strand.
    PointNumbers(const PatchMesh&, const std::vector<uint32_t>& segments);
    // Room for the points inside a facet of so many cells; facets in their order.
    void addInside(uint32_t facet, uint64_t cells);
    uint32_t of(uint32_t facet, const Cut&, uint32_t point) const;
    uint32_t count() const noexcept { return numbers_; } // some may be used by no patch

private:
    void numberCorners();
    void numberEdges(const std::vector<uint32_t>& segments);
    const PatchMesh& mesh_;
    std::vector<uint32_t> firstCorner_; // of each facet, in cornerNumber_ and firstOfEdge_
    std::vector<uint32_t> cornerNumber_;
    std::vector<uint32_t> firstOfEdge_;
    std::vector<uint32_t> firstInside_; // of each facet
    uint32_t numbers_ = 0;
};

} // namespace chiaro::radiosity
