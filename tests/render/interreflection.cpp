// Interreflection with known answers: integrating spheres, wedges, cubes, plates, concentric spheres.
#include "tests/render/measure.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;

// A closed wall around the origin with emission and reflectance; facets, so that no shading normal differs from the geometry.
SceneDesc closed(PrimitiveDesc shell, float emission, float reflectance) {
    SceneDesc s;
    shell.normals.clear();
    const int wall = shapes::add(s, shapes::lamp("wall", Spectrum(emission), Spectrum(reflectance)));
    shapes::add(s, "wall", std::move(shell), wall);
    return s;
}
PrimitiveDesc ballRoom() { return shapes::insideOut(shapes::sphere(1, 3)); }

} // namespace

TEST_SUITE("interreflection") {

    TEST_CASE("integrating sphere: 1 / (1 - rho), and its partial sums by depth (F1)") {
        for (const float rho : {0.5f, 0.8f, 0.9f}) {
            const auto scene = compiled(closed(ballRoom(), 1, rho));
            const CameraDesc camera = perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2);
            for (const uint32_t depth : {0u, 1u, 2u, 3u, unlimitedDepth}) {
                CAPTURE(rho);
                CAPTURE(depth);
                const double expected =
                    depth == unlimitedDepth ? 1 / (1 - double(rho)) : (1 - std::pow(double(rho), depth + 1.)) / (1 - double(rho));
                checkEqual(measure(*scene, camera, {16, 16, 256, {}, 2, 0, SamplerKind::sobol, FilterKind::box, depth}), expected,
                           depth == unlimitedDepth ? 0.02 : 0.005);
            }
        }
    }

    TEST_CASE("every estimator has the same mean (F7)") {
        const auto scene = compiled(closed(ballRoom(), 1, 0.8f));
        const CameraDesc camera = perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2);
        for (const char* how : {"path", "path:nee=off", "path:mis=off", "path:rr-depth=0", "path:rr-depth=30"})
            for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
                CAPTURE(how);
                CAPTURE(int(sampler));
                checkEqual(measure(*scene, camera, {16, 16, 256, {}, 2, 0, sampler, FilterKind::gauss}, how), 5, 0.03);
            }
    }

    TEST_CASE("sphere with a black port of 5 % (F2)") {
        PortedSphere sphere = portedSphere(5);
        const auto scene = compiled(std::move(sphere.scene));
        // Any wall point away from the port.
        checkEqual(measure(*scene, probe({0.1, -0.97, 0.15}, {0.1, -1, 0.1}), {16, 16, 1024, {}, 2}), sphere.radiance, 0.012, 1e-3);
    }

    TEST_CASE("a point lamp off the centre of a sphere: indirect light is uniform (F3)") {
        SceneDesc s = closed(shapes::insideOut(shapes::sphere(1, 5)), 0, 0.5f);
        PunctualDesc l;
        l.toWorld = shapes::translation({0, 0.5, 0});
        s.lights.push_back(l);
        const auto scene = compiled(std::move(s));
        // Facets have no exact pole: look at the middle of one beside it.
        checkEqual(measure(*scene, probe({0.01, -0.999, 0.012}, {0, -1, 0}), {16, 16, 1024, {}, 2}), .2298905, 0.006, 2e-3);
        checkEqual(measure(*scene, probe({0.01, 0.999, 0.012}, {0, 1, 0}), {16, 16, 1024, {}, 2}), 5 * 0.5 / pi64, 0.007, 5e-3);
    }

    TEST_CASE("a wedge of two half-planes, one lit at grazing to the other (F4)") {
        SceneDesc s;
        const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(0.8f))),
                  wall = shapes::add(s, shapes::diffuse("wall", Spectrum(0.5f)));
        shapes::add(s, "floor", shapes::quad({0, 0, huge}, {huge, 0, huge}, {huge, 0, -huge}, {0, 0, -huge}), floor);
        shapes::add(s, "wall", shapes::quad({0, 0, -huge}, {0, huge, -huge}, {0, huge, huge}, {0, 0, huge}), wall);
        PunctualDesc sun;
        sun.kind = PunctualKind::directional;
        sun.intensity = Spectrum(float(pi64));
        sun.toWorld = shapes::lookAt({0, 1, 0}, {0, 0, 0}, {0, 0, 1});
        s.lights.push_back(sun);
        const auto scene = compiled(std::move(s));
        checkEqual(measure(*scene, probe({0.05, 0, 0}, {0, -1, 0}), {16, 16, 1024, {}, 2}), .8888888889, 0.004, 1e-3);
        checkEqual(measure(*scene, probe({0, 0.05, 0}, {-1, 0, 0}), {16, 16, 4096, {}, 2}), .2222222222, 0.01, 1e-3);
    }

    TEST_CASE("a closed cube with one emitting face, pixel by pixel (A16)") {
        for (const float rho : {0.5f, 0.8f}) {
            SceneDesc s;
            const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1), Spectrum(rho))),
                      wall = shapes::add(s, shapes::diffuse("wall", Spectrum(rho)));
            for (int axis = 0; axis < 3; ++axis)
                for (const int side : {-1, 1}) shapes::add(s, "face", cubeFace(axis, side), axis == 1 && side == 1 ? lamp : wall);
            const auto scene = compiled(std::move(s));
            CAPTURE(rho);
            const Settings how{16, 16, 4096, {}, 2};
            checkEqual(measure(*scene, probe({0, -.5, 0}, {0, -1, 0}), how), rho == 0.5f ? .1976 : .7131, 0.01, 1e-3);
            checkEqual(measure(*scene, probe({.5, 0, 0}, {1, 0, 0}), how), rho == 0.5f ? .17765 : .6837, 0.01, 1e-3);
        }
    }

    TEST_CASE("the same cube bounce by bounce (A17)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1), Spectrum(0.5f))),
                  wall = shapes::add(s, shapes::diffuse("wall", Spectrum(0.5f)));
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) shapes::add(s, "face", cubeFace(axis, side), axis == 1 && side == 1 ? lamp : wall);
        const auto scene = compiled(std::move(s));
        const double terms[] = {0, .119728, .03469, .02253, .01017};
        double expected = 0;
        for (uint32_t depth = 0; depth < 5; ++depth) {
            CAPTURE(depth);
            expected += terms[depth];
            checkEqual(
                measure(*scene, probe({0, -.5, 0}, {0, -1, 0}), {16, 16, 2048, {}, 2, 0, SamplerKind::sobol, FilterKind::box, depth}),
                expected, 0.012, 1e-3);
        }
    }

    TEST_CASE("infinite parallel plates, built of diffuse plates between mirrors (A18)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("plate 1", Spectrum(1), Spectrum(0.5f))),
                  other = shapes::add(s, shapes::diffuse("plate 2", Spectrum(0.8f)));
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(1), 0));
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) shapes::add(s, "face", cubeFace(axis, side), axis != 1 ? mirror : side == 1 ? lamp : other);
        const auto scene = compiled(std::move(s));
        checkEqual(measure(*scene, probe({.1, .5, .2}, {0, 1, 0}), {16, 16, 1024, {}, 2}), 5. / 3, 0.01);
        checkEqual(measure(*scene, probe({.1, -.5, .2}, {0, -1, 0}), {16, 16, 1024, {}, 2}), 4. / 3, 0.015);
    }

    TEST_CASE("concentric spheres (A19)") {
        for (const auto& [inner, outer] : {std::pair{1.0, .2}, {10. / 9, 2. / 9}}) {
            const bool black = inner == 1.0;
            SceneDesc s;
            const int lamp = shapes::add(s, shapes::lamp("inner", Spectrum(1), Spectrum(black ? 0.f : 0.5f)));
            const int wall = shapes::add(s, shapes::diffuse("outer", Spectrum(0.5f)));
            shapes::add(s, "inner", shapes::sphere(0.5, 5), lamp);
            shapes::add(s, "outer", shapes::insideOut(shapes::sphere(1, 5)), wall);
            const auto scene = compiled(std::move(s));
            CAPTURE(black);
            checkEqual(measure(*scene, probe({0, -.999, 0}, {0, -1, 0}), {16, 16, 2048, {}, 2}), outer, 0.012, 3e-3);
            checkEqual(measure(*scene, probe({0, -.5, 0}, {0, 1, 0}), {16, 16, 512, {}, 2}), inner, 0.006, 2e-3);
        }
    }

    TEST_CASE("a hemisphere closed by an emissive lid (A20)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("lid", Spectrum(1), Spectrum(0.5f))),
                  wall = shapes::add(s, shapes::diffuse("dome", Spectrum(0.5f)));
        shapes::add(s, "dome", upperDome(6), wall);
        shapes::add(s, "lid", plate({0, 0, 0}, {0, 1, 0}, 1.1), lamp);
        const auto scene = compiled(std::move(s));
        checkEqual(measure(*scene, probe({.2, 0, .1}, {0, -1, 0}), {16, 16, 512, {}, 2}), 1.2, 0.006, 2e-3);
        checkEqual(measure(*scene, probe({.05, .998, .04}, {0, 1, 0}), {16, 16, 1024, {}, 2}), .4, 0.008, 2e-3);
    }

} // TEST_SUITE
