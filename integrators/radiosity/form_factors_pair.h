// The exchange area of two patches as if nothing stood between them, by the cheapest rule that is exact enough: far away the mean of the
// kernel over points of both (2 x 2 Gauss points, then 3 x 3, or their like on triangles), near the double contour integral
// (form_factors_polygon.h). Relative error below 1e-6 everywhere; rows of a closed room sum to 1 within that.
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

// Of their polygons (holes of alpha masks count), square metres. The same bits in either order.
double polygonExchange(const Patch&, const Patch&) noexcept;

} // namespace chiaro::radiosity
