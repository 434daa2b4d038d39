// Ambient occlusion against closed forms: walls, streets, spheres, boxes; limits, weights, and the pictures that are made of it.
#include "tests/render/measure.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;

SceneDesc floorScene(int& matt) {
    SceneDesc s;
    matt = shapes::add(s, shapes::diffuse("matt", Spectrum(rho)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 0.05), matt);
    return s;
}
// Walls through x = -d, facing +x, and their like.
PrimitiveDesc wall(double d, double height = huge) {
    return shapes::quad({-d, 0, -huge}, {-d, height, -huge}, {-d, height, huge}, {-d, 0, huge});
}
PrimitiveDesc opposite(double d, double height) { return shapes::quad({d, 0, huge}, {d, height, huge}, {d, height, -huge}, {d, 0, -huge}); }
PrimitiveDesc across(double d) { return shapes::quad({-huge, 0, -d}, {huge, 0, -d}, {huge, huge, -d}, {-huge, huge, -d}); }

Measured downAt(SceneDesc s, const std::string& how, const Vec3d& at = {0, 0, 0}, uint32_t spp = 64) {
    return measure(*compiled(std::move(s)), probe(at, {0, -1, 0}), {16, 16, spp, {}, 2}, how);
}
SceneDesc beside(double d) {
    int matt;
    SceneDesc s = floorScene(matt);
    shapes::add(s, "wall", wall(d), matt);
    return s;
}
// Edge 1, without its lid, floor at y = 0 about the origin.
SceneDesc openBox() {
    int matt;
    SceneDesc s;
    matt = shapes::add(s, shapes::diffuse("matt", Spectrum(rho)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, .5), matt);
    for (const Vec3d n : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}})
        shapes::add(s, "side", plate(n * -.5 + Vec3d{0, .5, 0}, n, .5), matt);
    return s;
}

} // namespace

TEST_SUITE("ao") {

    TEST_CASE("beside an infinite wall half is closed, at any distance; in a corner three quarters (H13)") {
        for (const double d : {.01, .1, 1.}) {
            CAPTURE(d);
            checkEqual(downAt(beside(d), "ao"), .5, 0.005, 1e-3 * d); // the wall ends somewhere
        }
        SceneDesc s = beside(.1);
        shapes::add(s, "second", across(.1), 0);
        checkEqual(downAt(std::move(s), "ao"), .25, 0.008, 3e-4);
    }

    TEST_CASE("a distance limit opens the wall again, by either weight (H13)") {
        for (const auto& [a, cosine] : {std::pair{.25, .6574812}, {.5, .8044989}, {.75, .9278532}}) {
            CAPTURE(a);
            checkEqual(downAt(beside(a), "ao:distance=1"), cosine, 0.004);
            checkEqual(downAt(beside(a), "ao:distance=1,weight=uniform"), (1 + a) / 2, 0.004);
            checkEqual(downAt(beside(a), "ao:distance=1,samples=1", {0, 0, 0}, 1024), cosine, 0.004);
            checkEqual(downAt(beside(a), "ao:distance=1,samples=37", {0, 0, 0}, 32), cosine, 0.004);
        }
        CHECK(downAt(beside(1), "ao:distance=0.999").value == 1);
    }

    TEST_CASE("a wall of finite height, and the middle of a street (H14)") {
        for (const auto& [height, open] : {std::pair{1., .8535534}, {2., .7236068}}) {
            CAPTURE(height);
            int matt;
            SceneDesc s = floorScene(matt);
            shapes::add(s, "wall", wall(1, height), matt);
            checkEqual(downAt(std::move(s), "ao"), open, 0.004);
        }
        int matt;
        SceneDesc s = floorScene(matt);
        shapes::add(s, "left", wall(.5, 1), matt);
        shapes::add(s, "right", opposite(.5, 1), matt);
        checkEqual(downAt(std::move(s), "ao"), .4472136, 0.006, 1e-4);
    }

    TEST_CASE("below a sphere, and on the floor of an open box (H15)") {
        for (const auto& [height, open] : {std::pair{1.5, .5555556}, {2., .75}}) {
            CAPTURE(height);
            int matt;
            SceneDesc s = floorScene(matt);
            shapes::add(s, "ball", shapes::sphere(1, 6), matt, shapes::translation({0, height, 0}));
            checkEqual(downAt(std::move(s), "ao"), open, 0.005, 3e-4);
        }
        checkEqual(downAt(openBox(), "ao", {0, 0, 0}, 128), .2394565, 0.008);
        checkEqual(downAt(openBox(), "ao:weight=uniform", {0, 0, 0}, 128), .1281884, 0.012);
        const double corner = .5 - 1e-4; // the probe is 1e-4 wide
        checkEqual(measure(*compiled(openBox()), probe({corner, 0, corner}, {0, -1, 0}, 1e-2, 2e-5), {16, 16, 64, {}, 2}, "ao"), .1385316,
                   0.02, 2e-3);
    }

    TEST_CASE("open is 1, closed is 0, from either side; what lies behind a surface does not matter; the sky is black") {
        int matt;
        const SceneDesc alone = floorScene(matt);
        CHECK(downAt(alone, "ao").value == 1);
        CHECK(measure(*compiled(alone), probe({0, 0, 0}, {0, 1, 0}), {8, 8, 16}, "ao").value == 1);
        CHECK(measure(*compiled(alone), probe({0, 0, 0}, {.9, -.1, 0}), {8, 8, 16}, "ao").value == 1);
        CHECK(measure(*compiled(alone), probe({0, 1, 0}, {0, 1, 0}), {8, 8, 16}, "ao").value == 0);
        SceneDesc below = floorScene(matt);
        shapes::add(below, "cellar", plate({0, -1e-3, 0}, {0, 1, 0}, huge), matt);
        CHECK(downAt(std::move(below), "ao").value == 1);
        for (const bool inwards : {false, true}) {
            SceneDesc room;
            const int wallpaper = shapes::add(room, shapes::diffuse("room", Spectrum(rho)));
            PrimitiveDesc box = shapes::box({1, 1, 1});
            shapes::add(room, "room", inwards ? shapes::insideOut(box) : box, wallpaper);
            CHECK(measure(*compiled(std::move(room)), perspective({.3, .2, .1}, {1, 1, 1}, 1.5), {16, 16, 16}, "ao").value == 0);
        }
        SceneDesc ball; // convex: open everywhere, but for what the facets under its smooth normals hide
        const int skin = shapes::add(ball, shapes::diffuse("ball", Spectrum(rho)));
        shapes::add(ball, "ball", shapes::sphere(1, 5), skin);
        CHECK(measure(*compiled(std::move(ball)), perspective({0, 0, 4}, {0, 0, 0}, .3), {16, 16, 32}, "ao").value > .998);
    }

    TEST_CASE("diffuse and combined: under the ambient light, and under the lamps") {
        checkEqual(downAt(beside(.5), "ao:mode=diffuse"), rho, 1e-3);
        checkEqual(downAt(beside(.5), "ao:mode=combined,distance=1"), rho * .8044989, 0.004);
        int matt;
        SceneDesc s = floorScene(matt);
        const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
        shapes::add(s, "lamp", shapes::quad({-.5, 1, -.5}, {.5, 1, -.5}, {.5, 1, .5}, {-.5, 1, .5}), lamp);
        const double irradiance = .7522746885, light = rho * irradiance / pi64; // B1; the lamp closes what it lights
        checkEqual(downAt(s, "ao:mode=diffuse,light=direct"), light, 0.004);
        checkEqual(downAt(s, "ao:mode=combined,light=direct"), light * (1 - irradiance / pi64), 0.006);
    }

    TEST_CASE("combined is the path tracer's direct light under a white sky") {
        SceneDesc s;
        const int red = shapes::add(s, shapes::diffuse("red", {.8f, .3f, .2f})),
                  grey = shapes::add(s, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 20), grey);
        shapes::add(s, "box", shapes::box({.5, .5, .5}), red, shapes::translation({0, .5, 0}));
        shapes::add(s, "ball", shapes::sphere(.5, 4), red, shapes::translation({1.2, .5, .2}));
        s.environment = uniformSky(1);
        const auto scene = compiled(std::move(s));
        const CameraDesc camera = perspective({2, 2, 4}, {.5, 0, 0}, .4); // no sky in view
        Settings how{24, 24, 256, {}, 2};
        const Measured ao = measure(*scene, camera, how, "ao:mode=combined");
        how.maxDepth = 1;
        const Measured path = measure(*scene, camera, how, "path");
        CHECK(std::fabs(ao.value - path.value) <= criticalT * std::hypot(ao.error, path.error) + 1e-5);
        CHECK(criticalT * std::hypot(ao.error, path.error) <= 0.01 * path.value);
    }

    TEST_CASE("the same bits for any number of threads") {
        const auto scene = compiled(openBox());
        const auto picture = [&](unsigned threads) {
            Settings s{40, 40, 4};
            s.threads = threads;
            return rendered(*scene, perspective({.2, 2, .3}, {0, 0, 0}, .8), s, "ao");
        };
        CHECK(samePicture(*picture(1).film, *picture(3).film));
    }

} // TEST_SUITE
