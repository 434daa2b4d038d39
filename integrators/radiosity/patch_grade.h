// Where patches must be smaller than elsewhere: near lamps, in their housings, in the light of the sun. A patch has one radiosity, and what
// that gets wrong is about P (h / l)^2, where P is the direct light that a surface sends on, l the length over which it changes and h the
// edge of its patches. So many patches do best where h^4 is in proportion to l^2 and, inversely, to the exitance P / A (Lagrange's
// multipliers; Cohen and others, An Efficient Radiosity Approach for Realistic Environments, 1986, cut what differed after the fact). Light
// and lengths are found by rays to the lights from points of the larger facets. Units: metres.
#pragma once
#include "core/render/integrator.h"
#include "integrators/radiosity/patch_mesh.h"

namespace chiaro::radiosity {

// Edges of patches on a facet as a share of those elsewhere, along its first and its last edge; 1: as elsewhere.
struct Grade {
    float first = 1, last = 1;
    // The size for this facet, where `size` is that of all. Edges that are shorter than their share of it ask for nothing.
    float size(float size, float firstLength, float lastLength) const noexcept {
        float own = size;
        if (firstLength > first * size) own = min(own, first * size);
        if (lastLength > last * size) own = min(own, last * size);
        return own;
    }
};
// One a facet, the same for every seed. backs: facets with patches on both sides. size: facets that are far smaller stay as they are; at
// most about so many are looked at. Empty in a scene without lights.
std::vector<Grade> grades(const Work&, const PatchMesh&, std::span<const uint8_t> backs, float size, uint64_t most);
void tell(std::span<const Grade>, Diagnostics&);

} // namespace chiaro::radiosity
