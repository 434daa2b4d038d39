// The test of multiple importance sampling, after Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering",
// SIGGRAPH 1995, figure 1: four plates of growing roughness, four ball lamps of growing size and equal power. The figures are this
// project's own. Page: scenes/veach-mis.md.
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include <cmath>
#include <numbers>

namespace chiaro {
namespace {

using namespace shapes;

const Vec3d eye{0, 2, 15};
const double lampHeight = 2.5, lampDepth = -3.5; // the lamps' centres lie on this line parallel to x

struct Plate {
    float alpha; // GGX width; glTF's roughness is its square root
    Vec3d centre;
};
struct Bulb {
    double x, radius;
    Spectrum tint;
};

// A plate leans so that a mirror in its place would show the row of lamps: its normal halves the angle between eye and lamps.
Affine leaning(const Vec3d& centre) {
    const Vec3d lamps{centre.x, lampHeight, lampDepth};
    const Vec3d y = normalize(normalize(eye - centre) + normalize(lamps - centre)), x{1, 0, 0}, z = cross(x, y);
    return {{{x.x, y.x, z.x, centre.x}, {x.y, y.y, z.y, centre.y}, {x.z, y.z, z.z, centre.z}}};
}

// Radiance of a ball that shines with luminous power `power` (lumen): power = pi L area; the tint is scaled to luminance 1.
Spectrum radianceOf(double power, const PrimitiveDesc& shape, const Spectrum& tint) {
    return tint * float(power / (std::numbers::pi * area(shape) * luminance(tint)));
}

} // namespace

SceneDesc makeVeachMis() {
    SceneDesc s;
    s.name = "@veach-mis";
    const int grey = add(s, diffuse("grey", Spectrum{0.4f}));
    add(s, "floor", quad({-14, -4.5, 8}, {14, -4.5, 8}, {14, -4.5, -9}, {-14, -4.5, -9}), grey);
    add(s, "wall", quad({-14, -4.5, -9}, {14, -4.5, -9}, {14, 9, -9}, {-14, 9, -9}), grey);

    const Plate plates[] = {{0.005f, {0, -0.3, -2.6}}, {0.02f, {0, -1.35, -0.6}}, {0.05f, {0, -2.35, 1.4}}, {0.1f, {0, -3.3, 3.4}}};
    for (const Plate& p : plates) {
        const std::string name = "plate " + std::to_string(&p - plates + 1);
        const int material = add(s, metal(name, {0.65f, 0.62f, 0.58f}, std::sqrt(p.alpha)));
        add(s, name, box({4.5, 0.05, 0.85}), material, leaning(p.centre));
    }

    const double power = 100; // lumen, of each
    const Bulb bulbs[] = {
        {-3.75, 0.0333333, {1, 0.75f, 0.5f}}, {-1.25, 0.1, {0.7f, 1, 0.6f}}, {1.25, 0.3, {0.6f, 0.8f, 1}}, {3.75, 0.9, {1, 0.6f, 0.8f}}};
    for (const Bulb& b : bulbs) {
        const std::string name = "lamp " + std::to_string(&b - bulbs + 1);
        PrimitiveDesc ball = sphere(b.radius, 3);
        const int material = add(s, lamp(name, radianceOf(power, ball, b.tint)));
        add(s, name, std::move(ball), material, translation({b.x, lampHeight, lampDepth}));
    }
    addCamera(s, "main", 36 * std::numbers::pi / 180, lookAt(eye, {0, -0.6, 0}));
    return s;
}

} // namespace chiaro
