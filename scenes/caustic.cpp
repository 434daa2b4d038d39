// A glass ball that images a lamp on the floor: the ball lens of every optics text (n = 1.5, paraxial focal length 1.5 radii from the
// centre, Hecht, Optics, chapter 6). Figures and derivation: scenes/caustic.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <numbers>

namespace chiaro {

SceneDesc makeCaustic() {
    using namespace shapes;
    const double radius = 0.1;               // of the ball
    const double lampDistance = 15 * radius; // lamp to centre; 1/15 + 1/(5/3) = 1/1.5, so the floor lies in the paraxial image
    const double floorDistance = radius * 5 / 3;
    const double lampRadius = 0.15 * radius; // 0.01 of its distance: illuminance pi 10000 0.01^2 = pi lux at the centre
    SceneDesc s;
    s.name = "@caustic";
    const int grey = add(s, diffuse("floor", Spectrum{0.5f}));
    const int clear = add(s, glass("glass", 1.5f));
    const int light = add(s, lamp("lamp", Spectrum{10000}));
    add(s, "floor", quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}), grey);
    add(s, "ball", sphere(radius, 6), clear, translation({0, floorDistance, 0}));
    add(s, "lamp", insideOut(disc(lampRadius, 64)), light, translation({0, floorDistance + lampDistance, 0}));

    addCamera(s, "main", 32 * std::numbers::pi / 180, lookAt({0, 0.36, 0.85}, {0, 0.1, 0}));
    // Between ball and floor, straight down on the focus: one picture unit is 0.2 radii of the ball.
    CameraDesc focus;
    focus.name = "focus";
    focus.projection = Projection::orthographic;
    focus.xmag = focus.ymag = 0.1 * radius;
    focus.toWorld = lookAt({0, floorDistance / 5, 0}, {0, 0, 0}, {0, 0, -1});
    s.cameras.push_back(focus);
    return s;
}

} // namespace chiaro
