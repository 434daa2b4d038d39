// Rows of form factors by every method against closed forms.
#include "tests/render/form_factors_kit.h"

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

TEST_SUITE("form-factors") {
    TEST_CASE("two unit plates, by every method (A1, A2)") {
        struct Case {
            const char* name;
            SceneDesc desc;
            double factor;
        };
        const Case cases[] = {{"parallel", twoPlates({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}), parallel(1, 1, 1)},
                              {"near", twoPlates({0, .5, 0}, {1, .5, 0}, {1, .5, 1}, {0, .5, 1}), parallel(1, 1, .5)},
                              {"perpendicular", twoPlates({0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}), perpendicular(1, 1)}};
        for (const Case& c : cases) {
            CAPTURE(c.name);
            const auto scene = compiled(c.desc);
            const Bare bare(*scene);
            const Patches one = patchesOf(bare, 1);
            REQUIRE(one.size() == 2);
            const FormFactors analytic(bare.work, one, exact());
            CHECK(betweenParts(analytic, 0, 1) == doctest::Approx(c.factor).epsilon(1e-6));
            CHECK(analytic.unoccluded(0, 1) == analytic.unoccluded(1, 0));
            CHECK(analytic.visibility(0, 1, 64, 0) == 1);
            CHECK(analytic.unoccluded(one[0].centre, one[0].normal, std::span(one[1].corner.data(), 4)) > 0);
            FormFactorSettings rays = by(FormFactorMethod::hemisphere);
            rays.rays = 1 << 16;
            CHECK(betweenParts(FormFactors(bare.work, one, rays), 0, 1) == doctest::Approx(c.factor).epsilon(.003));
            const Patches four = patchesOf(bare, .5f);
            REQUIRE(four.size() == 8);
            CHECK(betweenParts(FormFactors(bare.work, four, exact()), 0, 1) == doctest::Approx(c.factor).epsilon(1e-6));
            FormFactorSettings cubes = by(FormFactorMethod::hemicube);
            cubes.resolution = 128;
            cubes.points = 64;
            CHECK(betweenParts(FormFactors(bare.work, four, cubes), 0, 1) == doctest::Approx(c.factor).epsilon(.01));
        }
    }
    TEST_CASE("coaxial discs, tessellated (A4)") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        const int corners = 64;
        shapes::add(d, "floor", shapes::disc(1, corners), grey);
        shapes::add(d, "lid", shapes::insideOut(shapes::disc(2, corners)), grey, shapes::translation({0, 1, 0}));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        const FormFactors f(bare.work, p, exact());
        // A polygon of n corners has 1 - (2 pi / n)^2 / 6 of the area of its circle, and nearly so its factor.
        const double slack = 2 * std::pow(2 * pi64 / corners, 2) / 6;
        CHECK(discs(1, 2, 1) == doctest::Approx(.7639320225).epsilon(1e-9));
        CHECK(betweenParts(f, 0, 1) == doctest::Approx(discs(1, 2, 1)).epsilon(slack));
        CHECK(betweenParts(f, 1, 0) == doctest::Approx(discs(2, 1, 1)).epsilon(slack));
    }
    TEST_CASE("an opaque disc between an element and a disc (A7), by every method") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "element", plate({0, 0, 0}, {0, 1, 0}, .005), grey);
        shapes::add(d, "lid", shapes::insideOut(shapes::disc(2, 128)), grey, shapes::translation({0, 2, 0}));
        shapes::add(d, "between", shapes::insideOut(shapes::disc(.5, 128)), grey, shapes::translation({0, 1, 0}));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .25f);
        FormFactorSettings s = by(FormFactorMethod::hemisphere);
        s.rays = 1 << 18;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.003));
        s = by(FormFactorMethod::hemicube);
        s.resolution = 512;
        s.points = 1;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.01));
        s = by(FormFactorMethod::analytic);
        s.shadowRays = 64;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.005));
        CHECK(betweenParts(FormFactors(bare.work, p, exact()), 0, 1) == doctest::Approx(.5).epsilon(.002)); // nothing between
    }
    TEST_CASE("sphere and disc (A9), within a sphere (A10)") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "ball", shapes::sphere(.5, 3), grey);
        shapes::add(d, "disc", shapes::insideOut(shapes::disc(1, 128)), grey, shapes::translation({0, 1, 0}));
        d.materials[0].doubleSided = false;
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches ball = patchesOf(bare, .5f);
        CHECK(betweenParts(FormFactors(bare.work, ball, by(FormFactorMethod::hemisphere)), 0, 1) ==
              doctest::Approx(.1464466094).epsilon(.003));

        SceneDesc nested;
        shapes::add(nested, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(nested, "inner", shapes::sphere(.5, 2), 0);
        shapes::add(nested, "outer", shapes::insideOut(shapes::sphere(1, 2)), 0);
        nested.materials[0].doubleSided = false;
        const auto both = compiled(nested);
        const Bare within(*both);
        const Patches p = patchesOf(within, 2);
        REQUIRE(p.size() == 2 * 320);
        const FormFactors f(within.work, p, by(FormFactorMethod::hemisphere));
        CHECK(betweenParts(f, 0, 1) == doctest::Approx(1).epsilon(1e-4));
        CHECK(betweenParts(f, 1, 0) == doctest::Approx(.25).epsilon(.005));
        CHECK(betweenParts(f, 1, 1) == doctest::Approx(.75).epsilon(.005));
        // Every element sees every patch of the sphere about it alike: A_j / (4 pi R^2), here between two that nothing hides.
        const auto outer = ofPart(p, 1);
        const double whole = std::accumulate(outer.begin(), outer.end(), 0.0, [&](double s, uint32_t i) { return s + double(p[i].area); });
        double ratio = 0;
        uint32_t n = 0;
        for (uint32_t k = 1; k < outer.size(); k += 7, ++n) ratio += f.unoccluded(outer[0], outer[k]) / (double(p[outer[k]].area) / whole);
        CHECK(ratio / n == doctest::Approx(1).epsilon(.01));
    }
    TEST_CASE("rows of closed rooms sum to one: analytic within 1e-6, rays to the last, cubes within .5 %") {
        const auto scene = compiled(room({1, 1.5, 2}));
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        REQUIRE(p.size() == 2 * (4 * 6 + 6 * 8 + 4 * 8));
        std::vector<Factor> row;
        double worst = 0;
        const FormFactors analytic(bare.work, p, exact());
        for (uint32_t i = 0; i < p.size(); ++i) {
            analytic.row(i, row);
            worst = std::max(worst, std::fabs(sumOf(row) - 1));
        }
        INFO("analytic " << worst);
        CHECK(worst < 1e-6);
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::hemicube}) {
            const FormFactors f(bare.work, p, by(method));
            for (uint32_t i = 0; i < p.size(); i += 17) {
                f.row(i, row);
                CHECK(sumOf(row) == doctest::Approx(1).epsilon(1e-5));
                CHECK(factorOf(row, i) == 0);
            }
        }
    }
} // TEST_SUITE
