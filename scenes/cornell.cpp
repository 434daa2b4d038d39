// The Cornell box. Geometry, camera and lamp: Cornell University Program of Computer Graphics, "Cornell Box Data" (measured 1998), in
// millimetres, the front opening at z = 0 and z growing into the room. Reflectances and emission: the customary linear-RGB reductions
// of the measured spectra. Page: scenes/cornell.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <cmath>

namespace chiaro {
namespace {

using namespace shapes;

// From the data's axes to ours: half a turn about +Y, so that the camera looks along -Z, and a hundredth of the number as the length:
// the room stands 5.5 m high. Radiance does not depend on the scale of a scene.
Vec3d measured(double x, double y, double z) { return {(556.0 - x) / 100, y / 100, (559.2 - z) / 100}; }

// The four corners of a block's top in the data's order, and its height; a block has no bottom, as in the data.
PrimitiveDesc block(const std::array<std::array<double, 2>, 4>& top, double height) {
    const auto corner = [&](int i, double y) { return measured(top[std::size_t(i) % 4][0], y, top[std::size_t(i) % 4][1]); };
    PrimitiveDesc p = quad(corner(0, height), corner(1, height), corner(2, height), corner(3, height));
    for (int i = 0; i < 4; ++i) p = joined(std::move(p), quad(corner(i, 0), corner(i + 1, 0), corner(i + 1, height), corner(i, height)));
    return p;
}

} // namespace

SceneDesc cornellRoom(int& white) {
    SceneDesc s;
    white = add(s, diffuse("white", {0.725f, 0.71f, 0.68f}));
    const int green = add(s, diffuse("green", {0.14f, 0.45f, 0.091f}));
    const int red = add(s, diffuse("red", {0.63f, 0.065f, 0.05f}));
    const int light = add(s, lamp("lamp", {18.4f, 15.6f, 8.0f}, Spectrum{0.78f}));
    // Floor and walls are not quite rectangles: as measured.
    add(s, "floor", quad(measured(0, 0, 0), measured(0, 0, 559.2), measured(549.6, 0, 559.2), measured(552.8, 0, 0)), white);
    add(s, "ceiling", quad(measured(0, 548.8, 0), measured(556, 548.8, 0), measured(556, 548.8, 559.2), measured(0, 548.8, 559.2)), white);
    add(s, "back wall", quad(measured(549.6, 0, 559.2), measured(0, 0, 559.2), measured(0, 548.8, 559.2), measured(556, 548.8, 559.2)),
        white);
    add(s, "right wall", quad(measured(0, 0, 559.2), measured(0, 0, 0), measured(0, 548.8, 0), measured(0, 548.8, 559.2)), green);
    add(s, "left wall", quad(measured(552.8, 0, 0), measured(549.6, 0, 559.2), measured(556, 548.8, 559.2), measured(556, 548.8, 0)), red);
    // The lamp hangs 0.1 mm of the data, 1 mm here, below the ceiling, which has no opening.
    add(s, "lamp", quad(measured(343, 548.7, 227), measured(343, 548.7, 332), measured(213, 548.7, 332), measured(213, 548.7, 227)), light);
    // Focal length 35 mm, picture 25 mm wide and high.
    addCamera(s, "main", 2 * std::atan(0.025 / 2 / 0.035), translation(measured(278, 273, -800)));
    return s;
}

SceneDesc makeCornell() {
    int white = -1;
    SceneDesc s = cornellRoom(white);
    s.name = "@cornell";
    add(s, "short block", block({{{130, 65}, {82, 225}, {240, 272}, {290, 114}}}, 165), white);
    add(s, "tall block", block({{{423, 247}, {265, 296}, {314, 456}, {472, 406}}}, 330), white);
    return s;
}

} // namespace chiaro
