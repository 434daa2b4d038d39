// Shadow maps against shadow rays (rows B12 and J10 of the verification table).
#include "tests/render/raycast_scenes.h"
#include <algorithm>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// A unit square above a floor of 10 x 10 m, turned so that its shadow's edges cross the texels of a map; seen from between the two.
SceneDesc blocker(const PunctualDesc& lamp, double turn) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(d, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), grey);
    shapes::add(d, "blocker", plate({0, 1, 0}, {0, 1, 0}, 0.5), grey, rotation({0, 1, 0}, turn));
    d.lights.push_back(lamp);
    return d;
}
// half: extent of the floor that is seen, metres from its middle.
CameraDesc fromBelowTheBlocker(double half = 5) {
    CameraDesc c;
    c.projection = Projection::orthographic;
    c.xmag = c.ymag = half;
    c.toWorld = shapes::lookAt({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1});
    return c;
}
// Pixels that two pictures light differently.
struct Wrong {
    std::size_t count = 0;
    uint32_t farthest = 0; // pixels from the nearest edge of a shadow in the first picture
};
Wrong wrongPixels(const Film& truth, const Film& other, uint32_t reach) {
    const uint32_t w = truth.layout().width, h = truth.layout().height;
    const auto value = [](const Film& f, uint32_t x, uint32_t y) { return luminance(f.mean({x, y})); };
    const auto dark = [&](uint32_t x, uint32_t y) { return value(truth, x, y) == 0; };
    Wrong wrong;
    for (uint32_t y = 0; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            if (value(truth, x, y) == value(other, x, y)) continue;
            ++wrong.count;
            uint32_t nearest = reach + 1;
            for (uint32_t j = y > reach ? y - reach : 0; j <= std::min(h - 1, y + reach); ++j)
                for (uint32_t i = x > reach ? x - reach : 0; i <= std::min(w - 1, x + reach); ++i)
                    if (dark(i, j) != dark(x, y)) nearest = std::min(nearest, std::max(i > x ? i - x : x - i, j > y ? j - y : y - j));
            wrong.farthest = std::max(wrong.farthest, nearest);
        }
    return wrong;
}

} // namespace

TEST_SUITE("raycast-shadow-maps") {
    TEST_CASE("B12: the shadow of a unit square half way up to a lamp is 2 x 2 m") {
        const auto scene = compiled(blocker(pointLight(10, {0, 2, 0}), 0));
        const auto film = picture(*scene, fromBelowTheBlocker(), sharp(500), "raycast:shadows=ray,aa=centre");
        std::size_t dark = 0;
        for (uint32_t y = 0; y < 500; ++y)
            for (uint32_t x = 0; x < 500; ++x) dark += luminance(film->mean({x, y})) == 0;
        CHECK(dark == 100 * 100); // pixels of 2 cm
    }

    TEST_CASE("J10: a map is wrong only within a texel of a shadow's edge, and half as much with twice the resolution") {
        constexpr uint32_t side = 512;
        constexpr double half = 1.6, tilt = 0.5;
        const PunctualDesc lamps[] = {pointLight(10, {0, 2, 0}),
                                      light(PunctualKind::directional, 5, {std::sin(tilt), std::cos(tilt), 0}, {0, 0, 0})};
        for (const PunctualDesc& lamp : lamps) {
            CAPTURE(int(lamp.kind));
            const auto scene = compiled(blocker(lamp, 0.35));
            const auto truth = picture(*scene, fromBelowTheBlocker(half), sharp(side), "raycast:shadows=ray,aa=centre");
            std::size_t last = 0;
            for (const uint32_t size : {64u, 128u, 256u, 512u}) {
                CAPTURE(size);
                const auto map = picture(*scene, fromBelowTheBlocker(half), sharp(side),
                                         "raycast:shadows=map,aa=centre,map-size=" + std::to_string(size));
                // Metres of the floor that a texel covers: of the cube's face, or of the parallel view on a slope.
                const double texel = lamp.kind == PunctualKind::point ? 4.0 / size : 2 * scene->radius() / size / std::cos(tilt);
                const auto reach = uint32_t(std::ceil(texel / (2 * half) * side)) + 1;
                const Wrong wrong = wrongPixels(*truth, *map, reach);
                CAPTURE(wrong.count);
                CHECK(wrong.count > 0);
                CHECK(wrong.farthest <= reach);
                if (last > 0) {
                    const double ratio = double(last) / double(wrong.count);
                    CHECK(ratio > 1.6);
                    CHECK(ratio < 2.5);
                }
                last = wrong.count;
            }
        }
    }

    TEST_CASE("J10: among curved and standing things the wrong share shrinks with the texels, for lamps of every kind") {
        std::vector<SceneDesc> scenes;
        for (const PunctualDesc& lamp : lampKinds()) scenes.push_back(shadowedScene(lamp));
        for (const bool ball : {false, true}) { // area lights: a panel and a ball, which must not shadow themselves
            SceneDesc d = shadowedScene(lampKinds()[0]);
            d.lights.clear();
            const int glow = shapes::add(d, shapes::lamp("glow", Spectrum(100)));
            shapes::add(d, "lamp", ball ? shapes::sphere(0.1, 2) : plate({0, 0, 0}, {0, -1, 0}, 0.2), glow,
                        shapes::translation({0.4, 2.2, 0.8}));
            scenes.push_back(std::move(d));
        }
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            CAPTURE(i);
            const auto scene = compiled(scenes[i]);
            const auto truth = picture(*scene, overview(), sharp(256), "raycast:shadows=ray,aa=centre");
            const auto share = [&](const char* size) {
                const auto map = picture(*scene, overview(), sharp(256), std::string("raycast:shadows=map,aa=centre,map-size=") + size);
                return double(wrongPixels(*truth, *map, 0).count) / (256 * 256);
            };
            const double coarse = share("128"), fine = share("1024");
            CAPTURE(coarse);
            CAPTURE(fine);
            CHECK(coarse < 0.002);
            CHECK(fine < 0.0005);
            CHECK(coarse > 4 * fine); // 8 if all were edges
        }
    }

    TEST_CASE("the artefacts are there for those who ask: acne without a bias, detached shadows with too much") {
        const auto scene = compiled(shadowedScene(lampKinds()[0]));
        const auto truth = picture(*scene, overview(), sharp(256), "raycast:shadows=ray,aa=centre");
        const auto wrong = [&](const char* bias) {
            return wrongPixels(*truth,
                               *picture(*scene, overview(), sharp(256), std::string("raycast:shadows=map,aa=centre,map-bias=") + bias), 0)
                .count;
        };
        const std::size_t good = wrong("1");
        CAPTURE(good);
        CHECK(wrong("0") > 5 * good);
        CHECK(wrong("60") > 3 * good);
    }

    TEST_CASE("maps that do not fit into the memory are refused with a size that would") {
        const auto scene = compiled(openScene(lampKinds()[0]));
        Bench bench(*scene, placed(*scene, overview()), sharp(8));
        bench.job.memoryLimit = 1'000'000;
        Film film(bench.layout());
        try {
            bench.render(film, "raycast:shadows=map");
            FAIL("no error");
        } catch (const Error& e) {
            CHECK(e.code == Exit::resources);
            CHECK(std::string(e.what()).find("map-size=204") != std::string::npos); // 6 x 204^2 x 4 bytes
        }
        bench.render(film, "raycast:shadows=map,map-size=204");
        CHECK(film.done() == 1);
    }

    TEST_CASE("a scene without lamps is black, a map of one texel does no harm") {
        SceneDesc d = openScene(lampKinds()[0]);
        d.lights.clear();
        const auto dark = compiled(std::move(d));
        CHECK(meanOf(*picture(*dark, overview(), sharp(16), "raycast:shadows=map")) == Spectrum(0));
        const auto scene = compiled(shadowedScene(lampKinds()[0]));
        CHECK(picture(*scene, overview(), sharp(16), "raycast:shadows=map,map-size=1")->dropped() == 0);
    }
} // TEST_SUITE
