// What lies under the pixel centres: depths when the shutter opens, lamps wherever they are while it is open.
#include "core/render/depth.h"
#include "tests/scene_kit.h"
#include <algorithm>
#include <doctest/doctest.h>

using namespace chiaro;

TEST_SUITE("depth") {

    TEST_CASE("a lamp that moves is marked along its way, its depth where it begins") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
        shapes::add(s, "lamp", test::square(1), lamp);
        s.instances[0].motion = {Affine{}, shapes::translation({4, 0, 0})};
        shapes::addCamera(s, "eye", 1.2, shapes::translation({2, 0, 6}));
        for (const bool open : {true, false}) {
            s.shutter = {0, open ? 1.f : 0.f};
            const auto scene = test::compiled(s);
            CameraDesc camera = scene->cameras()[0];
            test::Bench bench(*scene, camera, {.width = 48, .height = 16});
            const Centres seen = seenAtCentres(bench.job);
            const auto first = seen.lamp.begin() + 8 * 48, last = first + 48;
            const auto deep = std::count_if(seen.depth.begin() + 8 * 48, seen.depth.begin() + 9 * 48,
                                            [](float d) { return d == doctest::Approx(6).epsilon(1e-4); });
            const auto marked = std::count(first, last, 1);
            CAPTURE(marked);
            CAPTURE(deep);
            CHECK(deep > 0);
            if (open) {
                CHECK(marked >= deep + deep); // from -1 to 5 instead of -1 to 1, as far as the picture shows it
                CHECK(std::find(std::find(std::find(first, last, 1), last, 0), last, 1) == last); // without gaps
            } else
                CHECK(marked == deep);
        }
    }
}
