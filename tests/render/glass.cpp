// Refraction and absorption with known answers: slabs with all their orders, panes, invisible glass, basic radiance.
#include "tests/render/measure.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;

// A slab of thickness 1 across x and z, its lower face at y = 0, between a glowing plane far below and one far above.
SceneDesc slab(MaterialDesc glass, bool thin, float below, float above) {
    SceneDesc s;
    const int material = shapes::add(s, std::move(glass));
    if (thin)
        shapes::add(s, "pane", plate({0, 0, 0}, {0, 1, 0}, huge), material);
    else
        shapes::add(s, "slab", shapes::box({huge, 0.5, huge}), material, shapes::translation({0, 0.5, 0}));
    const int lower = shapes::add(s, shapes::lamp("below", Spectrum(below))),
              upper = shapes::add(s, shapes::lamp("above", Spectrum(above)));
    shapes::add(s, "below", plate({0, -5, 0}, {0, 1, 0}, huge), lower);
    shapes::add(s, "above", plate({0, 6, 0}, {0, -1, 0}, huge), upper);
    return s;
}
MaterialDesc pane() {
    MaterialDesc m = shapes::glass("pane", 1.5f);
    m.volume = false;
    return m;
}
MaterialDesc tinted() {
    MaterialDesc m = shapes::glass("tinted", 1.5f);
    m.attenuationDistance = 1;
    m.attenuationColor = Spectrum(std::exp(-0.5f));
    return m;
}
std::unique_ptr<const Scene> ballInFurnace() {
    SceneDesc s;
    const int glass = shapes::add(s, shapes::glass("glass", 1.5f));
    shapes::add(s, "ball", shapes::sphere(1, 4), glass);
    s.environment = uniformSky(1);
    return compiled(std::move(s));
}
// Looks down at the origin under an angle to the vertical.
CameraDesc slanted(double degrees) {
    const double a = degrees * pi64 / 180;
    return probe({0, 1, 0}, {std::sin(a), -std::cos(a), 0}, 2);
}

} // namespace

TEST_SUITE("glass") {

    TEST_CASE("reflectance and transmittance of a slab, all orders (C7, J5)") {
        struct Row {
            const char* name;
            MaterialDesc material;
            bool thin;
            double degrees, R, T;
        };
        const Row rows[] = {{"slab", shapes::glass("glass", 1.5f), false, 0, .0769230769, .9230769231},
                            {"slab, slanted", shapes::glass("glass", 1.5f), false, 60, .163767537, .836232463},
                            {"pane", pane(), true, 0, .0769230769, .9230769231},
                            {"pane, slanted", pane(), true, 60, .163767537, .836232463},
                            {"tinted slab", tinted(), false, 0, .0535694948, .5593078686}};
        for (const Row& row : rows) {
            CAPTURE(row.name);
            const Settings how{32, 32, 1024, {}, 2};
            checkEqual(measure(*compiled(slab(row.material, row.thin, 1, 0)), slanted(row.degrees), how), row.T, 0.004);
            checkEqual(measure(*compiled(slab(row.material, row.thin, 0, 1)), slanted(row.degrees), how), row.R, 0.03);
        }
    }

    TEST_CASE("absorption follows the colour and the distance (C13)") {
        // An index-matched slab absorbs and does nothing else.
        MaterialDesc m = shapes::glass("gel", 1);
        m.attenuationDistance = 2;
        m.attenuationColor = {.5f, .25f, .8f};
        SceneDesc s = slab(m, false, 1, 0);
        s.instances[0].toWorld = shapes::translation({0, 1.5, 0}) * [] {
            Affine thrice;
            thrice.m[1][1] = 3;
            return thrice;
        }();
        const auto scene = compiled(std::move(s));
        Settings how{8, 8, 16};
        CameraDesc camera = probe({0, 3, 0}, {0, -1, 0}, 2);
        const Vec3d c = scene->centre();
        for (int i = 0; i < 3; ++i) camera.toWorld.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
        const Spectrum mean = rendered(*scene, camera, how).mean;
        CHECK(mean[0] == doctest::Approx(.3535533906).epsilon(1e-4));
        CHECK(mean[1] == doctest::Approx(.125).epsilon(1e-4));
        CHECK(mean[2] == doctest::Approx(.7155417528).epsilon(1e-4));
    }

    TEST_CASE("glass in a furnace is invisible, and radiance inside it is n squared (C14)") {
        const auto scene = ballInFurnace();
        checkEqual(measure(*scene, perspective({0, 0, 4}, {0, 0, 0}, 0.6), {32, 32, 64, {}, 2}), 1, 0.002, 1e-3);
        checkEqual(measure(*scene, perspective({0.2, 0.1, 0.3}, {1, 0.3, 0}, 0.8), {32, 32, 256, {}, 2}, "path:rr-depth=64"), 2.25, 0.006,
                   1e-3);
    }

    TEST_CASE("roulette does not take the smaller throughput inside glass for loss") {
        const auto scene = ballInFurnace();
        for (const char* method : {"path:rr-depth=0", "path:rr-depth=0,wide=off"}) {
            CAPTURE(method);
            const Rendering r = rendered(*scene, perspective({0, 0, 4}, {0, 0, 0}, 0.3), {64, 64, 1}, method);
            double sum = 0, squares = 0;
            for (uint32_t y = 0; y < 64; ++y)
                for (uint32_t x = 0; x < 64; ++x) {
                    const double v = double(luminance(r.film->mean({x, y})));
                    sum += v;
                    squares += v * v;
                }
            const double mean = sum / 4096, variance = squares / 4096 - mean * mean;
            // Two chances of .95 for nearly all paths: 1 / .95^2 - 1 = .108. By .444 for what has entered it would be 1.4.
            CHECK(mean == doctest::Approx(1).epsilon(0.03));
            CHECK(variance > 0.09);
            CHECK(variance < 0.15);
        }
    }

    TEST_CASE("a surface without contrast to its surroundings changes nothing") {
        SceneDesc s;
        const int ghost = shapes::add(s, shapes::glass("ghost", 1));
        shapes::add(s, "ball", shapes::sphere(1, 3), ghost);
        s.environment = environment(8, 4, [](int x, int y) { return Spectrum(float(1 + x + 8 * y)); });
        const auto with = compiled(s);
        s.meshes[0].primitives[0].indices.resize(3); // a crumb of the ball: the bounds stay
        const auto without = compiled(std::move(s));
        const CameraDesc camera = perspective({0, 0, 4}, {0, 0, 0}, 1);
        CHECK(measure(*with, camera, {32, 32, 16}).value == doctest::Approx(measure(*without, camera, {32, 32, 16}).value).epsilon(1e-4));
    }

} // TEST_SUITE
