// Recursive ray tracing against hand arithmetic: rows J1, J2, J5 to J8 and C7 to C9 of the verification table.
#include "tests/render/whitted_kit.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

// Two mirrors of reflectance .5 that glow with radiance 1, facing each other (J6).
SceneDesc facingMirrors() {
    SceneDesc s;
    MaterialDesc m = shapes::metal("mirror", Spectrum(0.5f), 0);
    m.emission = Spectrum(1);
    const int mirror = shapes::add(s, m);
    shapes::add(s, "below", plate({0, 0, 0}, {0, 1, 0}, 5), mirror);
    shapes::add(s, "above", plate({0, 1, 0}, {0, -1, 0}, 5), mirror);
    return s;
}
CameraDesc straightDown() { return probe({0, 0, 0}, {0, -1, 0}, 0.5); }

// A slab of glass of thickness 1 with its lower face at y = 0, a glowing plane below or above.
SceneDesc slab(float below, float above, bool pane = false, double half = huge) {
    SceneDesc s;
    MaterialDesc glass = shapes::glass("glass", 1.5f);
    glass.volume = !pane;
    const int material = shapes::add(s, glass), lower = shapes::add(s, shapes::lamp("below", Spectrum(below))),
              upper = shapes::add(s, shapes::lamp("above", Spectrum(above)));
    if (pane)
        shapes::add(s, "pane", plate({0, 0, 0}, {0, 1, 0}, half), material);
    else
        shapes::add(s, "slab", shapes::box({half, 0.5, half}), material, shapes::translation({0, 0.5, 0}));
    shapes::add(s, "below", plate({0, -5, 0}, {0, 1, 0}, half), lower);
    shapes::add(s, "above", plate({0, 6, 0}, {0, -1, 0}, half), upper);
    return s;
}
CameraDesc slanted(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return probe({0, 1, 0}, {std::sin(a), -std::cos(a), 0}, 2);
}

} // namespace

TEST_SUITE("whitted") {

    TEST_CASE("a lamp over a floor, ambient light, and a mirror that shows it (J1)") {
        const auto scene = compiled(litFloor());
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted"), .5);
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted:ambient=.2"), .6);
        checkRgb(seen(*scene, slantedOnOrigin(), "whitted:ambient=.2,ambient-g=2,ambient-b=0"), .6, .7, .5);
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted:ambient=.2", 0), 0); // depth 0 is emission
        SceneDesc s = litFloor();
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(.8f), 0));
        shapes::add(s, "mirror", plate({0, 2, 0}, {0, -1, 0}, 1), mirror);
        const auto room = compiled(std::move(s));
        const CameraDesc up = probe({0, 2, 0}, {0, 1, 0}, 0.5);
        checkGrey(seen(*room, up, "whitted"), .4);
        checkGrey(seen(*room, up, "whitted:ambient=.2"), .48);
        checkGrey(seen(*room, up, "whitted", 1), 0); // the mirror is the second scattering
    }

    TEST_CASE("classic attenuation: min(1, 1 / (c1 + c2 d + c3 d^2)) (J2)") {
        const auto scene = compiled(litFloor(2));
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted:attenuation=classic"), .1);
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted:attenuation=classic,c1=0,c2=1,c3=0"), .25);
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted:attenuation=classic,c1=.1,c3=0"), .5); // never above 1
        checkGrey(seen(*scene, slantedOnOrigin(), "whitted"), .125);
    }

    TEST_CASE("a pane before a wall of radiance .5: all orders, or two transmissions of a slab (J5)") {
        checkGrey(seen(*compiled(slab(.5f, 0, true)), slanted(0), "whitted"), .4615385);
        checkGrey(seen(*compiled(slab(.5f, 0)), slanted(0), "whitted", 2), .4608);
    }

    TEST_CASE("a slab, order by order to all orders (C7)") {
        for (const double degrees : {0., 60.}) {
            const double f = degrees == 0 ? .04 : .163767537 / (2 - .163767537); // R = 2F / (1 + F)
            CAPTURE(degrees);
            const auto through = compiled(slab(1, 0)), back = compiled(slab(0, 1));
            double T = 0, R = f;
            for (uint32_t order = 0; order < 4; ++order) {
                T += (1 - f) * (1 - f) * std::pow(f, 2. * order);
                checkGrey(seen(*through, slanted(degrees), "whitted:min-weight=0", 2 + 2 * order), T, 2e-5);
                checkGrey(seen(*back, slanted(degrees), "whitted:min-weight=0", 1 + 2 * order), R, 2e-5);
                R += (1 - f) * (1 - f) * f * std::pow(f, 2. * order);
            }
            checkGrey(seen(*through, slanted(degrees), "whitted:min-weight=0", 40), degrees == 0 ? .9230769231 : .836232463, 2e-5);
            checkGrey(seen(*back, slanted(degrees), "whitted:min-weight=0", 40), degrees == 0 ? .0769230769 : .163767537, 2e-5);
        }
    }

    TEST_CASE("where a refracted ray goes: Snell, the way inside, the shift, and out as it came in (C8, C9)") {
        const auto scene = compiled(slab(1, 0, false, 12));
        for (const auto& [degrees, shift, inside] : {std::tuple{45., .3291423082, 0.}, {60., .5124720132, 1.2247448714}}) {
            const CameraDesc camera = slanted(degrees);
            const Tree t = tree(*scene, camera, "whitted:aa=centre", 2);
            const auto& v = t.log.vertices();
            const auto chain = [&](std::size_t i) { return v[i].kind == PathLog::Kind::surface && v[i].event == Event::ST; };
            std::vector<std::size_t> way;
            for (std::size_t i = 0; i < v.size(); ++i)
                if (chain(i)) way.push_back(i);
            REQUIRE(way.size() == 2);
            const Vec3 in = normalize(v[way[0]].p - v[0].p), out = normalize(v[way[1]].p - v[way[0]].p);
            const double angle = degrees * std::numbers::pi / 180;
            CHECK(std::hypot(in.x, in.z) == doctest::Approx(std::sin(angle) / 1.5).epsilon(1e-5));
            CHECK(out.x == doctest::Approx(std::sin(angle)).epsilon(1e-5));
            if (inside > 0) CHECK(length(v[way[0]].p - v[0].p) == doctest::Approx(inside).epsilon(1e-5));
            const Vec3 straight{float(std::sin(angle)), float(-std::cos(angle)), 0}, off = v[way[0]].p - v[0].p;
            CHECK(length(off - straight * dot(off, straight)) == doctest::Approx(shift).epsilon(1e-5));
        }
    }

    TEST_CASE("facing mirrors: n images at depth n, and the tree ends by weight (J6)") {
        const auto scene = compiled(facingMirrors());
        for (uint32_t depth = 0; depth < 8; ++depth)
            checkGrey(seen(*scene, straightDown(), "whitted", depth), 2 - std::pow(.5, depth), 2e-6);
        const Tree t = tree(*scene, straightDown(), "whitted:aa=centre,min-weight=.01");
        CHECK(t.rays == 6);
        checkGrey(t.total, 2 - 1 / 64., 2e-6);
        REQUIRE(t.log.vertices().size() == 7);
        CHECK(std::string(t.log.vertices().back().note) == "contribution too small");
        Spectrum sum(0);
        for (std::size_t i = 0; i < 7; ++i) {
            CHECK(t.log.vertices()[i].throughput[0] == doctest::Approx(std::pow(.5, i)).epsilon(1e-6));
            CHECK(t.log.vertices()[i].parent == (i == 0 ? PathLog::none : uint32_t(i - 1)));
            sum += t.log.vertices()[i].contribution;
        }
        checkGrey(sum, t.total[0], 1e-6); // leaves sum to the pixel
        CHECK(tree(*scene, straightDown(), "whitted:aa=centre,min-weight=0,max-nodes=10").rays == 9);
    }

    TEST_CASE("a tree that is cut short says so") {
        const auto scene = compiled(facingMirrors());
        Bench bench(*scene, moved(*scene, straightDown()), {2, 2, 1});
        Film film(bench.layout());
        bench.render(film, "whitted:min-weight=0,max-nodes=10");
        REQUIRE(bench.notes.warnings().size() == 1);
        CHECK(bench.notes.warnings()[0].find("max-nodes") != std::string::npos);
    }

    TEST_CASE("radiance does not fade with distance, except where old texts say so (J7)") {
        for (const double distance : {1., 10., 100.}) {
            SceneDesc s;
            const int wall = shapes::add(s, shapes::lamp("wall", Spectrum(1)));
            shapes::add(s, "wall", plate({0, 0, 0}, {0, 1, 0}, 5), wall);
            const auto scene = compiled(std::move(s));
            const CameraDesc camera = probe({0, 0, 0}, {0, -1, 0}, distance);
            checkGrey(seen(*scene, camera, "whitted"), 1, 1e-6);
            checkGrey(seen(*scene, camera, "whitted:ray-falloff=on"), 1 / distance, 1e-6);
        }
    }

    TEST_CASE("a corner of three mirrors sends a ray back where it came from (J8)") {
        SceneDesc s;
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(1), 0));
        shapes::add(s, "x", plate({0, 5, 5}, {1, 0, 0}, 5), mirror);
        shapes::add(s, "y", plate({5, 0, 5}, {0, 1, 0}, 5), mirror);
        shapes::add(s, "z", plate({5, 5, 0}, {0, 0, 1}, 5), mirror);
        const auto scene = compiled(std::move(s));
        const Vec3d way = normalize(Vec3d{-1, -.8, -.6});
        const Tree t = tree(*scene, probe({1, 1.2, 0}, way, 1), "whitted:aa=centre");
        const auto& v = t.log.vertices();
        REQUIRE(v.size() == 4);
        REQUIRE(v[3].kind == PathLog::Kind::sky);
        const Vec3 back = normalize(v[3].p - v[2].p);
        CHECK(length(back + cast<float>(way)) < 2e-6f);
    }

    TEST_CASE("Schlick's curve for the exact one, inside by the transmitted angle, total reflection kept") {
        const double f0 = .04, cosine = .5, schlick = f0 + (1 - f0) * std::pow(1 - cosine, 5);
        checkGrey(seen(*compiled(slab(0, 1)), slanted(60), "whitted:fresnel=schlick", 1), schlick);
        checkGrey(seen(*compiled(slab(1, 0)), slanted(60), "whitted:fresnel=schlick", 2), (1 - schlick) * (1 - schlick));
        checkGrey(seen(*compiled(slab(1, 0, true)), slanted(60), "whitted:fresnel=schlick"), (1 - schlick) / (1 + schlick));
        // From inside glass at 60 degrees, beyond the critical angle: nothing leaves.
        SceneDesc s = slab(1, 0);
        const CameraDesc inside = probe({0, 0, 0}, {std::sin(1.0471975512), -.5, 0}, 0.3);
        const auto scene = compiled(std::move(s));
        checkGrey(seen(*scene, inside, "whitted:fresnel=schlick", 1), 0);
        checkGrey(seen(*scene, inside, "whitted", 1), 0);
    }

} // TEST_SUITE
