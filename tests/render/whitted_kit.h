// What the tests of `whitted` share: one number per view, and single trees as their log tells them.
#pragma once
#include "core/render/path_log.h"
#include "core/render/prepass.h"
#include "tests/render/measure.h"

namespace chiaro::test {

// A camera of the description, for the compiled scene.
inline CameraDesc moved(const Scene& scene, CameraDesc camera) {
    const Vec3d c = scene.centre();
    for (int i = 0; i < 3; ++i) camera.toWorld.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
    return camera;
}
// The mean of a small picture that is the same in every pixel.
inline Spectrum seen(const Scene& scene, const CameraDesc& camera, const std::string& integrator, uint32_t depth = unlimitedDepth) {
    Settings s{2, 2, 1};
    s.maxDepth = depth;
    return rendered(scene, moved(scene, camera), s, integrator).mean;
}
struct Tree {
    PathLog log;
    uint32_t rays = 0;
    Spectrum total{0};
};
// The ray tree of the middle of the view.
inline Tree tree(const Scene& scene, const CameraDesc& camera, const std::string& integrator, uint32_t depth = unlimitedDepth) {
    Settings s{1, 1, 1};
    s.maxDepth = depth;
    Bench bench(scene, moved(scene, camera), s);
    const IntegratorChoice choice = chooseIntegrator(integrator);
    const auto made = choice.entry->make(choice.options);
    made->prepare(bench.job);
    const auto& whitted = dynamic_cast<const CameraIntegrator&>(*made);
    PathStart start = startPixel(bench.job, {0, 0}, 0, whitted.starts(bench.job));
    Tree t;
    Outputs out(bench.layout());
    out.log = &t.log;
    whitted.radiance(bench.job, start, out);
    t.rays = out.rays;
    t.total = out.total();
    return t;
}

inline PunctualDesc pointLight(const Vec3d& at, const Spectrum& candela) {
    PunctualDesc l;
    l.intensity = candela;
    l.toWorld = shapes::translation(at);
    return l;
}
inline constexpr float piFloat = 3.14159265358979f;
// A floor of reflectance .5 at y = 0 and a lamp of pi candela above its middle (J1).
inline SceneDesc litFloor(double height = 1, float reflectance = 0.5f) {
    SceneDesc s;
    const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(reflectance)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), floor);
    s.lights.push_back(pointLight({0, height, 0}, Spectrum(piFloat)));
    return s;
}
inline CameraDesc slantedOnOrigin() { return probe({0, 0, 0}, {.6, -.8, 0}, 0.1); }

inline void checkRgb(const Spectrum& v, double r, double g, double b, double relative = 1e-4) {
    CHECK(double(v[0]) == doctest::Approx(r).epsilon(relative));
    CHECK(double(v[1]) == doctest::Approx(g).epsilon(relative));
    CHECK(double(v[2]) == doctest::Approx(b).epsilon(relative));
}
inline void checkGrey(const Spectrum& v, double expected, double relative = 1e-4) { checkRgb(v, expected, expected, expected, relative); }

} // namespace chiaro::test
