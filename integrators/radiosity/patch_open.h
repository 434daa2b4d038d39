// How much of each patch light can reach at all. A block stands on a floor: the floor below it is dark, and the mean over a patch that lies
// half under the block would be half of what the other half has; so light would leak into the block, in proportion to the edge of a patch,
// where everything else falls with its square. So a patch that another body covers in part is as large as its open part. Rays tell: from a
// point that is not open they all meet sides that no light reaches (patch_sides.h).
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

struct Open {
    float share = 1; // of the polygon, above 0
    Vec3 centre;     // of what is open; of all, where nothing is
};
// One a patch. The same for every seed. Everything is open in a scene without lights.
std::vector<Open> openParts(const Work&, const Patches&);

} // namespace chiaro::radiosity
