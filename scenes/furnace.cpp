// The closed furnace: a sphere whose wall glows with radiance 1 and reflects half of what it receives. Inside, radiance is
// 1 / (1 - 0.5) = 2 everywhere and in every direction (the geometric series of the rendering equation, Kajiya 1986). Page:
// scenes/furnace.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <numbers>

namespace chiaro {

SceneDesc makeFurnace() {
    using namespace shapes;
    SceneDesc s;
    s.name = "@furnace";
    const int wall = add(s, lamp("wall", Spectrum{1}, Spectrum{0.5f}));
    PrimitiveDesc shell = insideOut(sphere(1, 4));
    // Without vertex normals the wall is shaded as the flat facets that it is made of, and the prediction is exact for any polyhedron.
    shell.normals.clear();
    add(s, "wall", std::move(shell), wall);
    addCamera(s, "main", 60 * std::numbers::pi / 180, lookAt({0.2, 0.15, 0.3}, {-0.5, 0.1, -0.4}));
    return s;
}

} // namespace chiaro
