// From hits to patches: part, facet, cell, without a search.
#pragma once
#include "integrators/radiosity/patch_cross.h"
#include "integrators/radiosity/patch_cut.h"
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

struct Patches::Table {
    struct Cells { // of one facet
        Vec3 normal;
        uint32_t front = ~0u, back = ~0u;   // patches of cell 0; ~0: that side is none
        std::array<uint32_t, 2> segments{}; // along edges 0 and 1
        float twistS = 0, twistT = 0;
        uint32_t nodes = 0; // the first of its bisections
        CutKind kind = CutKind::uniform;
        std::array<std::array<uint8_t, 3>, 2> cornerOf{};
    };
    std::vector<Cells> facets;
    std::vector<CutNode> nodes;
    Crossings crossings;
    std::vector<uint32_t> facetOf;         // facet * 2 + which of its triangles; ~0: none
    std::vector<uint64_t> firstOfGeometry; // triangles before the part that draws a geometry of the top level
    struct OfInstance {
        uint32_t firstGeometry = 0, firstPart = 0;
    };
    std::vector<OfInstance> instances;
    std::vector<uint64_t> firstOfPart;

    uint32_t facet(const Hit& h) const noexcept {
        if (h.instance == Hit::none) return facetOf[firstOfGeometry[h.geometry] + h.triangle];
        const OfInstance& in = instances[h.instance];
        return facetOf[firstOfPart[in.firstPart + h.geometry - in.firstGeometry] + h.triangle];
    }
    CellPlace place(const Cells&, uint32_t half, float u, float v) const noexcept;
};

} // namespace chiaro::radiosity
