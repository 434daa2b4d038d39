// The measured room of @cornell with a mirror ball and a solid glass ball in place of its blocks. Page: scenes/cornell-spheres.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace chiaro {

SceneDesc makeCornellSpheres() {
    using namespace shapes;
    int white = -1;
    SceneDesc s = cornellRoom(white);
    s.name = "@cornell-spheres";
    const int mirror = add(s, metal("mirror", Spectrum{0.95f}, 0));
    const int clear = add(s, glass("glass", 1.5f));
    // The balls stop a millimetre above the floor: no surface touches another.
    const double radius = 1.0, centre = radius + 1e-3;
    add(s, "mirror ball", sphere(radius, 6), mirror, translation({1.75, centre, 1.9}));
    add(s, "glass ball", sphere(radius, 6), clear, translation({3.85, centre, 3.5}));
    return s;
}

} // namespace chiaro
