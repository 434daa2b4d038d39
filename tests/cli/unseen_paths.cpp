// What is said of light paths that an integrator does not show as they are: three ways to be absent, told apart.
#include "tools/cli/unseen_paths.h"
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::cli;

namespace {

std::string said(const Scene& scene, const std::string& integrator, const std::string& paths = {}) {
    return unseenPaths(scene, chooseIntegrator(integrator), {.paths = paths, .split = {}, .within = {}, .without = {}}).value_or("");
}
bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A lamp over a floor; with a point light behind glass too.
SceneDesc lampOverFloor(bool pointBehindGlass) {
    SceneDesc s;
    const int grey = shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(5)));
    shapes::add(s, "floor", test::square(1), grey);
    shapes::add(s, "lamp", test::square(1), lamp, shapes::translation({0, 0, 4}) * test::rotation({0, 1, 0}, 3.14159));
    if (!pointBehindGlass) return s;
    shapes::add(s, "pane", test::square(1), shapes::add(s, shapes::glass("glass", 1.5)), shapes::translation({0, 0, 2}));
    PunctualDesc point;
    point.toWorld = shapes::translation({0, 0, 3});
    s.lights.push_back(point);
    return s;
}

} // namespace

TEST_SUITE("unseen_paths") {

    TEST_CASE("cannot find, left out by definition, shown by approximation") {
        const auto plain = test::compiled(lampOverFloor(false)), glass = test::compiled(lampOverFloor(true));
        CHECK(said(*plain, "path").empty());
        const std::string caustic = said(*glass, "path");
        CHECK(contains(caustic, "point light behind glass: path cannot sample these caustics (Ld S D E). Missing, not noisy."));
        CHECK_FALSE(contains(caustic, "definition"));

        for (const std::string name : {"whitted", "raycast"}) {
            const std::string text = said(*plain, name); // they show the lamp as a point
            CAPTURE(text);
            CHECK(contains(text, name + " leaves out light paths by definition (La D D E and the like). Missing, not noisy."));
            CHECK(contains(text, name + " shows others only by approximation (La D E and the like). Biased, not noisy."));
            CHECK_FALSE(contains(text, "cannot sample"));
            CHECK(contains(text, "Try -i path."));
            CHECK(said(*plain, name, "La E").empty());
            CHECK_FALSE(contains(said(*plain, name, "La D E"), "definition"));
        }
        const std::string sampled = said(*plain, "whitted:area=sample");
        CHECK(contains(sampled, "La D D E"));
        CHECK_FALSE(contains(sampled, "approximation"));
        CHECK(said(*plain, "whitted:area=sample", "La D E").empty());
        CHECK(contains(said(*plain, "whitted:area=sample,shadows=none", "La D E"), "approximation"));
        CHECK_FALSE(contains(said(*plain, "distributed"), "approximation"));
        CHECK(said(*plain, "normals").empty());
        CHECK(said(*glass, "raycast:shadows=ray", "Ld S* E | Ld D E").empty()); // a point is seen by nobody
    }
}
