// What the tests of ray casting share: lamps of every kind, plates of several materials, things that throw shadows.
#pragma once
#include "tests/render/measure.h"
#include <numbers>
#include <vector>

namespace chiaro::test {

inline constexpr double degree = std::numbers::pi / 180;

inline PunctualDesc light(PunctualKind kind, double intensity, const Vec3d& at, const Vec3d& target) {
    PunctualDesc l;
    l.kind = kind;
    l.intensity = Spectrum(float(intensity));
    l.toWorld = shapes::lookAt(at, target, std::fabs(normalize(target - at).y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0});
    return l;
}
inline PunctualDesc pointLight(double intensity, const Vec3d& at) {
    return light(PunctualKind::point, intensity, at, at + Vec3d{0, -1, 0});
}

// A camera of the description, for the scene as it was recentred.
inline CameraDesc placed(const Scene& scene, CameraDesc camera) {
    const Vec3d c = scene.centre();
    camera.toWorld.m[0][3] -= c.x;
    camera.toWorld.m[1][3] -= c.y;
    camera.toWorld.m[2][3] -= c.z;
    return camera;
}
inline std::unique_ptr<Film> picture(const Scene& scene, const CameraDesc& camera, const Settings& s, const std::string& integrator) {
    return std::move(rendered(scene, placed(scene, camera), s, integrator).film);
}
// Plates of several materials that no light must pass to reach another, and one lamp of a kind.
inline SceneDesc openScene(const PunctualDesc& lamp) {
    SceneDesc d;
    const int floor = shapes::add(d, shapes::diffuse("floor", Spectrum(0.7f, 0.5f, 0.3f)));
    MaterialDesc plastic = shapes::diffuse("plastic", Spectrum(0.2f, 0.4f, 0.6f));
    plastic.specular = 1;
    plastic.roughness = 0.3f;
    shapes::add(d, "floor", plate({0, 0, 0}, {0, 1, 0}, 1), floor);
    shapes::add(d, "left", plate({-2, 1, 0}, {1, 0.3, 0}, 0.8), shapes::add(d, shapes::metal("gold", {0.9f, 0.7f, 0.3f}, 0.4f)));
    shapes::add(d, "back", plate({0, 1.3, -2}, {0, 0.1, 1}, 0.9), shapes::add(d, plastic));
    d.lights.push_back(lamp);
    return d;
}
// The same with things that throw shadows, on the floor and above it.
inline SceneDesc shadowedScene(const PunctualDesc& lamp) {
    SceneDesc d = openScene(lamp);
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(d, "box", shapes::box({0.15, 0.2, 0.15}), grey, shapes::translation({0.35, 0.2, 0.2}) * rotation({0, 1, 0}, 0.4));
    shapes::add(d, "ball", shapes::sphere(0.25, 3), grey, shapes::translation({-0.3, 0.6, 0.1}));
    return d;
}
inline CameraDesc overview() { return perspective({1.5, 2.5, 4}, {-0.3, 0.6, 0}, 0.8); }

inline std::vector<PunctualDesc> lampKinds() {
    PunctualDesc spot = light(PunctualKind::spot, 20, {0.6, 2.2, 1.4}, {-0.3, 0.4, -0.3});
    spot.innerCone = 0.3;
    spot.outerCone = 0.7;
    return {pointLight(9, {0.4, 1.9, 0.8}), spot, light(PunctualKind::directional, 5, {0.8, 2, 1}, {0, 0, 0})};
}

inline Settings sharp(uint32_t side) {
    Settings s;
    s.width = s.height = side;
    s.spp = 1;
    return s;
}

} // namespace chiaro::test
