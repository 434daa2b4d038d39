// Measuring with a camera: radiance at one point from one side, with the error that the film itself estimates.
#pragma once
#include "tests/scene_kit.h"
#include <cmath>
#include <doctest/doctest.h>
#include <string>

namespace chiaro::test {

inline constexpr float huge = 1000; // metres: "infinite" beside scenes of one metre

// Looks at `target` along `direction` from `distance` before it, through a window of half extent `half`: every pixel sees the same.
inline CameraDesc probe(const Vec3d& target, const Vec3d& direction, double distance = 1e-2, double half = 1e-4) {
    CameraDesc c;
    c.name = "probe";
    c.projection = Projection::orthographic;
    c.xmag = c.ymag = half;
    const Vec3d d = normalize(direction), up = std::fabs(d.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    c.toWorld = shapes::lookAt(target - d * distance, target, up);
    return c;
}
inline CameraDesc perspective(const Vec3d& eye, const Vec3d& target, double yfov) {
    CameraDesc c;
    c.yfov = yfov;
    c.toWorld = shapes::lookAt(eye, target, std::fabs(normalize(target - eye).y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
    return c;
}

// A square in the plane through `centre` with the given front normal.
inline PrimitiveDesc plate(const Vec3d& centre, const Vec3d& normal, double half) {
    const auto f = FrameT<double>::about(normalize(normal));
    return shapes::quad(centre - f.x * half - f.y * half, centre + f.x * half - f.y * half, centre + f.x * half + f.y * half,
                        centre - f.x * half + f.y * half);
}
// One of the six faces of the unit cube around the origin, seen from inside.
inline PrimitiveDesc cubeFace(int axis, int side) {
    Vec3d n{};
    (axis == 0 ? n.x : axis == 1 ? n.y : n.z) = side;
    return plate(n * 0.5, -n, 0.5);
}

struct Measured {
    double value = 0, error = 0; // mean of the replicates, and its standard error
};
inline constexpr int replicates = 16;
inline constexpr double criticalT = 6.91; // of 15 degrees of freedom, two-sided p = 5e-6

// value(r): of one replicate.
template <class Value> Measured overReplicates(Value&& value) {
    double sum = 0, squares = 0;
    for (int r = 0; r < replicates; ++r) {
        const double v = value(r);
        sum += v;
        squares += v * v;
    }
    const double mean = sum / replicates, variance = std::max(0.0, squares / replicates - mean * mean) * replicates / (replicates - 1);
    return {mean, std::sqrt(variance / replicates)};
}
// Mean luminance over the picture, from independent replicates (other seeds) that share the samples of s.spp: under a scrambled sequence
// only they tell the error truly.
inline Measured measure(const Scene& scene, const CameraDesc& camera, const Settings& s, const std::string& integrator = "path") {
    CameraDesc local = camera;
    const Vec3d c = scene.centre();
    const auto recentre = [&c](Affine& m) {
        for (int i = 0; i < 3; ++i) m.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
    };
    recentre(local.toWorld);
    for (Affine& m : local.motion) recentre(m);
    Settings one = s;
    one.spp = std::max(1u, s.spp / replicates);
    return overReplicates([&](int r) {
        one.seed = s.seed * 1000 + uint64_t(r);
        const Rendering rendering = rendered(scene, local, one, integrator);
        CHECK(rendering.film->dropped() == 0);
        return rendering.film->meanLuminance().value;
    });
}
// The upper half of a sphere that has an edge on its equator, seen from inside. level: of its subdivision.
inline PrimitiveDesc upperDome(int level) {
    PrimitiveDesc half = shapes::insideOut(shapes::sphere(1, level));
    const std::vector<uint32_t> all = std::move(half.indices);
    half.indices.clear();
    for (std::size_t i = 0; i < all.size(); i += 3)
        if (half.positions[all[i]].y + half.positions[all[i + 1]].y + half.positions[all[i + 2]].y > -0.2f)
            half.indices.insert(half.indices.end(), all.begin() + std::ptrdiff_t(i), all.begin() + std::ptrdiff_t(i) + 3);
    half.normals.clear();
    return half;
}
// A sphere that glows with radiance 1 and reflects .9, but for a black port of 5 % (row F2): its radiance is the same all over the wall.
struct PortedSphere {
    SceneDesc scene;
    double radiance = 0, open = 0; // open: the port's share of the area
};
inline PortedSphere portedSphere(int level) {
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, level)), port = shell;
    const double whole = shapes::area(shell);
    port.indices.clear();
    while (shapes::area(port) < 0.05 * whole) { // facet by facet
        port.indices.insert(port.indices.end(), shell.indices.end() - 3, shell.indices.end());
        shell.indices.resize(shell.indices.size() - 3);
    }
    PortedSphere s;
    s.open = shapes::area(port) / whole;
    s.radiance = 1 / (1 - 0.9 * (1 - s.open));
    shell.normals.clear();
    port.normals.clear();
    shapes::add(s.scene, "wall", std::move(shell), shapes::add(s.scene, shapes::lamp("wall", Spectrum(1), Spectrum(.9f))));
    shapes::add(s.scene, "port", std::move(port), shapes::add(s.scene, shapes::diffuse("port", Spectrum(0))));
    return s;
}
// Equal to an exact number by a one-sample t-test; and the test must be able to see a relative bias of `resolution`.
// floor: of the arithmetic (float radiance, tessellation), relative.
inline void checkEqual(const Measured& m, double expected, double resolution, double floor = 2e-5) {
    INFO("measured " << m.value << " +- " << m.error << ", expected " << expected);
    CHECK(std::fabs(m.value - expected) <= criticalT * m.error + floor * std::fabs(expected));
    CHECK(criticalT * m.error + floor * std::fabs(expected) <= resolution * std::max(std::fabs(expected), 1e-3));
}

} // namespace chiaro::test
