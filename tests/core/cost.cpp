// What a sample costs, counted by hand: rays and scatterings; and that counting changes no picture.
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// A wide floor seen from above, lit by a point light above it; or a mirror in its place.
SceneDesc floorAndLight(bool mirror) {
    SceneDesc s;
    const int material = shapes::add(s, mirror ? shapes::metal("floor", Spectrum(0.9f), 0) : shapes::diffuse("floor", Spectrum(0.5f)));
    shapes::add(s, "floor", square(100), material);
    shapes::addCamera(s, "eye", 0.1, shapes::translation({0, 0, 5}));
    PunctualDesc light;
    light.intensity = Spectrum(100);
    light.toWorld = shapes::translation({1, 0, 3});
    s.lights.push_back(light);
    return s;
}

std::unique_ptr<Film> counted(const Scene& scene, const std::string& integrator, Settings s) {
    Bench bench(scene, scene.cameras()[0], s);
    FilmLayout layout = bench.layout();
    layout.costs = true;
    auto film = std::make_unique<Film>(layout);
    bench.render(*film, integrator);
    return film;
}

struct Row {
    bool mirror;
    const char* integrator;
    uint32_t maxDepth;
    float rays, depth;
};

} // namespace

TEST_SUITE("cost") {

    TEST_CASE("rays and depth of scenes that can be counted by hand") {
        const Row rows[] = {
            {false, "path", unlimitedDepth, 3, 1},         // camera, shadow, one that leaves the floor and meets nothing
            {false, "path:nee=off", unlimitedDepth, 2, 1}, // camera, and the one that leaves
            {false, "path", 0, 1, 0},                      // emission alone: the camera's ray
            {true, "path", unlimitedDepth, 2, 1},          // camera, mirrored; a mirror asks no light
            {false, "normals", unlimitedDepth, 1, 0},
        };
        for (const Row& row : rows) {
            CAPTURE(row.integrator);
            CAPTURE(row.mirror);
            CAPTURE(row.maxDepth);
            const auto scene = compiled(floorAndLight(row.mirror));
            Settings s;
            s.width = s.height = 4;
            s.spp = 8;
            s.maxDepth = row.maxDepth;
            const auto film = counted(*scene, row.integrator, s);
            for (uint32_t y = 0; y < 4; ++y)
                for (uint32_t x = 0; x < 4; ++x) {
                    const Cost cost = film->cost({x, y});
                    CHECK(cost.rays == row.rays);
                    CHECK(cost.depth == row.depth);
                    CHECK(cost.microseconds > 0);
                    CHECK(std::isfinite(cost.microseconds));
                }
        }
    }

    TEST_CASE("a deeper limit, a deeper path: one more ray and one more scattering in a closed white room") {
        const auto scene = compiled(findBuiltin("@furnace")->make());
        for (const uint32_t depth : {0u, 1u, 2u, 4u}) {
            Settings s;
            s.width = s.height = 4;
            s.spp = 4;
            s.maxDepth = depth;
            const auto film = counted(*scene, "path:nee=off", s);
            CHECK(film->cost({1, 2}).depth == float(depth));
            CHECK(film->cost({1, 2}).rays == float(depth + 1));
        }
    }

    TEST_CASE("counting changes no bit of the picture, and threads no count") {
        const auto scene = compiled(findBuiltin("@cornell-spheres")->make());
        Settings s;
        s.spp = 4;
        const Rendering plain = rendered(*scene, scene->cameras()[0], s, "path:wide=off"); // a clock looks at one path at a time
        const auto one = counted(*scene, "path", s);
        s.threads = 3;
        const auto three = counted(*scene, "path", s);
        CHECK(samePicture(*plain.film, *one));
        CHECK(samePicture(*one, *three));
        CHECK(plain.film->cost({3, 3}).rays == 0); // not kept
        for (uint32_t y = 0; y < s.height; ++y)
            for (uint32_t x = 0; x < s.width; ++x) {
                CHECK(one->cost({x, y}).rays == three->cost({x, y}).rays);
                CHECK(one->cost({x, y}).depth == three->cost({x, y}).depth);
            }
    }
}
