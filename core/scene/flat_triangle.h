// FlatTriangle: what all points of one triangle share, for loops over the hits of a packet, most of which lie on few triangles. Only of
// triangles in world space without interpolated normals or vertex colours: but for texture coordinates a point there is its position, and
// the positions are those of Scene::point() to the last bit.
#pragma once
#include "core/math/vec.h"
#include "core/scene/surface_math.h"

namespace chiaro {

struct FlatTriangle {
    Vec3 a, e1, e2;   // a corner and the edges from it, in world space
    Vec3 ng;          // geometric and shading normal
    float height = 0; // metres, over the longest edge
    float error = 0;  // of every position on it, metres
    uint32_t material = 0, light = ~0u;

    [[gnu::always_inline]] Vec3 at(float u, float v) const noexcept { return inset(a + e1 * u + e2 * v, e1, e2, height, u, v, error); }
};

} // namespace chiaro
