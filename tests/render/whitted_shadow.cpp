// Shadows and transparency of the classics: rows J3 and J4 of the verification table; lamps that do not shadow themselves.
#include "tests/render/whitted_kit.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

MaterialDesc film(float transmission, const Spectrum& colour, bool thin = true) { // index-matched: no Fresnel to tell from
    MaterialDesc m = shapes::glass("film", 1);
    m.transmission = transmission;
    m.baseColor = colour;
    m.volume = !thin;
    m.specular = 0;
    return m;
}
// The floor of J1 with the lamp at 1 m, panes in between.
SceneDesc under(std::initializer_list<MaterialDesc> panes) {
    SceneDesc s = litFloor();
    double height = .5;
    for (const MaterialDesc& m : panes) {
        const int material = shapes::add(s, m);
        shapes::add(s, "pane", plate({0, height, 0}, {0, 1, 0}, 1), material);
        height += .1;
    }
    return s;
}
Spectrum floorUnder(std::initializer_list<MaterialDesc> panes, const std::string& how = "whitted", uint32_t depth = unlimitedDepth) {
    return seen(*compiled(under(panes)), slantedOnOrigin(), how, depth);
}

} // namespace

TEST_SUITE("whitted-shadow") {

    TEST_CASE("shadow rays through k_t = .5 and .8 keep .4, by channel; opaque surfaces keep nothing (J3)") {
        checkGrey(floorUnder({}), .5);
        checkGrey(floorUnder({film(.5f, Spectrum(1)), film(.8f, Spectrum(1))}), .2);
        checkRgb(floorUnder({film(.5f, {1, .5f, .25f}), film(.8f, {.5f, 1, 1})}), .1, .1, .05);
        checkGrey(floorUnder({film(.5f, Spectrum(1)), shapes::diffuse("wall", Spectrum(1))}), 0);
        checkGrey(floorUnder({film(0, Spectrum(1))}), 0);
        for (float k = 0; k <= 1; k += .125f) checkGrey(floorUnder({film(k, Spectrum(1))}), .5 * double(k), 1e-5); // continuous
        checkGrey(floorUnder({film(.5f, Spectrum(1))}, "whitted:shadows=opaque"), 0);
        checkGrey(floorUnder({shapes::diffuse("wall", Spectrum(1))}, "whitted:shadows=none"), .5);
        // Each surface passed is a scattering: light, T, T, D.
        checkGrey(floorUnder({film(.5f, Spectrum(1)), film(.8f, Spectrum(1))}, "whitted", 2), 0);
        checkGrey(floorUnder({film(.5f, Spectrum(1)), film(.8f, Spectrum(1))}, "whitted", 3), .2);
    }

    TEST_CASE("shadow rays through alpha blend keep 1 - alpha, continuous and without dice (J3, J4)") {
        const auto veil = [](float alpha, float transmission = 0, const Spectrum& colour = Spectrum(1)) {
            MaterialDesc m = transmission > 0 ? film(transmission, colour) : shapes::diffuse("veil", colour);
            m.alphaMode = AlphaMode::blend;
            m.alpha = alpha;
            return m;
        };
        for (float a = 0; a <= 1; a += .125f) checkGrey(floorUnder({veil(a)}), .5 * (1 - double(a)), 1e-5);
        checkGrey(floorUnder({veil(.25f), veil(.4f)}), .5 * .75 * .6);
        checkGrey(floorUnder({veil(.25f), shapes::diffuse("wall", Spectrum(1))}), 0);
        checkGrey(floorUnder({veil(.25f), film(.5f, Spectrum(1))}), .5 * .75 * .5);
        // Half of it is glass of k_t = .6, its colour times; the other half is not there.
        checkRgb(floorUnder({veil(.5f, .6f, {1, .5f, 0})}), .5 * (.5 + .3), .5 * (.5 + .15), .5 * .5);
        // To be covered in part is no scattering: light, D.
        checkGrey(floorUnder({veil(.25f), veil(.4f)}, "whitted", 1), .5 * .75 * .6);
        checkGrey(floorUnder({veil(.25f)}, "whitted:shadows=none"), .5);
        // A mask is all or nothing.
        MaterialDesc mask = veil(.25f);
        mask.alphaMode = AlphaMode::mask;
        checkGrey(floorUnder({mask}), .5);
        mask.alpha = .75f;
        checkGrey(floorUnder({mask}), 0);
    }

    TEST_CASE("alpha blend before the lamp: the mean of the path tracer") {
        SceneDesc s = litFloor();
        MaterialDesc veil = shapes::diffuse("veil", Spectrum(.8f));
        veil.alphaMode = AlphaMode::blend;
        veil.alpha = .3f;
        const int material = shapes::add(s, veil);
        shapes::add(s, "veil", plate({0, .5, 0}, {0, 1, 0}, .3), material);
        shapes::add(s, "veil", plate({.1, .6, 0}, {0, 1, 0}, .3), material);
        const auto scene = compiled(std::move(s));
        const double exact = seen(*scene, slantedOnOrigin(), "whitted")[0];
        CHECK(exact == doctest::Approx(.5 * .49).epsilon(1e-4));
        Settings direct{16, 16, 1024};
        direct.maxDepth = 1;
        checkEqual(measure(*scene, slantedOnOrigin(), direct, "path"), exact, 0.02);
    }

    TEST_CASE("a solid on the way absorbs by the length inside it (C13)") {
        SceneDesc s = litFloor(2);
        MaterialDesc gel = film(1, Spectrum(1), false);
        gel.attenuationDistance = 2;
        gel.attenuationColor = {.5f, .25f, .8f};
        const int material = shapes::add(s, gel);
        shapes::add(s, "gel", shapes::box({.5, .5, .5}), material, shapes::translation({0, 1, 0}));
        const double share = .125; // at 2 m; the way inside is 1 m: the square root of the colour
        checkRgb(seen(*compiled(std::move(s)), slantedOnOrigin(), "whitted"), share * std::sqrt(.5), share * std::sqrt(.25),
                 share * std::sqrt(.8));
    }

    TEST_CASE("interpolated and filtered transparency (J4)") {
        // k_t = .3 over a surface that shines with 1, .2 behind it.
        const auto scene = [](float specular) {
            SceneDesc s;
            MaterialDesc m = film(.3f, Spectrum(.5f));
            m.ior = 1.5f;
            m.specular = specular;
            m.roughness = .5f;
            m.doubleSided = true;
            const int veil = shapes::add(s, m), wall = shapes::add(s, shapes::lamp("wall", Spectrum(.2f)));
            shapes::add(s, "veil", plate({0, 0, 0}, {0, 1, 0}, 5), veil);
            shapes::add(s, "wall", plate({0, -1, 0}, {0, 1, 0}, 5), wall);
            s.lights.push_back(pointLight({0, 1, 0}, Spectrum(2 * piFloat)));
            return compiled(std::move(s));
        };
        const auto matt = scene(0), shiny = scene(1);
        const CameraDesc camera = probe({0, 0, 0}, {0, -1, 0}, .5);
        const std::string how = "whitted:transparency=";
        // The wall's lamp lights the back of the veil, which a diffuse surface does not show.
        checkGrey(seen(*matt, camera, how + "interpolated"), .76);
        checkGrey(seen(*matt, camera, how + "filtered"), 1.03);
        checkGrey(seen(*matt, camera, how + "specular-added"), .76);
        const double whole = seen(*shiny, camera, how + "filtered")[0] - .03, blended = seen(*shiny, camera, how + "interpolated")[0] - .06,
                     added = seen(*shiny, camera, how + "specular-added")[0] - .06;
        CHECK(blended == doctest::Approx(.7 * whole).epsilon(1e-4));
        // Highlights once in full, the rest blended: between the two by the diffuse part, which the coat dims to what is left of it.
        CHECK(added > blended * 1.01);
        CHECK(added < whole);
    }

    TEST_CASE("alpha blend .25 of .4 over .8 (J4)") {
        SceneDesc s;
        MaterialDesc veil = shapes::lamp("veil", Spectrum(.4f), Spectrum(0));
        veil.alphaMode = AlphaMode::blend;
        veil.alpha = .25f;
        const int front = shapes::add(s, veil), back = shapes::add(s, shapes::lamp("wall", Spectrum(.8f), Spectrum(0)));
        shapes::add(s, "veil", plate({0, 0, 0}, {0, 1, 0}, 5), front);
        shapes::add(s, "wall", plate({0, -1, 0}, {0, 1, 0}, 5), back);
        checkEqual(measure(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {32, 32, 64}, "whitted"), .7, 0.02);
    }

    TEST_CASE("a lamp does not shadow itself: flat, bulb and bowl; its shade does") {
        const auto lit = [](PrimitiveDesc shape, bool shade, const std::string& how) {
            SceneDesc s;
            const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(.5f))),
                      lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(100)));
            shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), floor);
            shapes::add(s, "lamp", std::move(shape), lamp, shapes::translation({0, 3, 0}));
            if (shade) shapes::add(s, "shade", plate({0, 2.5, 0}, {0, 1, 0}, .3), floor);
            return double(seen(*compiled(std::move(s)), slantedOnOrigin(), how)[0]);
        };
        const PrimitiveDesc flat = plate({0, 0, 0}, {0, -1, 0}, .05), bulb = shapes::sphere(.05, 4), box = shapes::box({.05, .05, .05});
        const double towards = .5 / double(piFloat) / 9;
        CHECK(lit(flat, false, "whitted") == doctest::Approx(towards * 100 * .01).epsilon(1e-4));
        CHECK(lit(bulb, false, "whitted") == doctest::Approx(towards * 100 * shapes::area(bulb) / 4).epsilon(1e-4));
        CHECK(lit(box, false, "whitted") == doctest::Approx(towards * 100 * .06 / 4).epsilon(1e-4));
        for (const PrimitiveDesc* shape : {&flat, &bulb, &box}) {
            CHECK(lit(*shape, true, "whitted") == 0);
            CHECK(lit(*shape, true, "whitted:shadows=none") > 0);
        }
        // From far away the one light is the lamp's own light, as its surface would give it.
        CHECK(lit(flat, false, "whitted") == doctest::Approx(lit(flat, false, "whitted:area=sample")).epsilon(0.01));
    }

    TEST_CASE("a pre-pass takes the place of the constant, weighted by the way to the eye") {
        struct Field final : Prepass {
            void solve(const Work&) override {}
            void save(Writer&) const override {}
            void load(const Work&, Reader&) override {}
            void addIndirect(const PathClasses&, const Hit&, const SurfacePoint&, const Bsdf&, PathState, const Spectrum& weight,
                             Outputs& out) const noexcept override {
                out.add(otherLayer, weight * .25f);
            }
        };
        const Field field;
        SceneDesc s = litFloor();
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(.8f), 0));
        shapes::add(s, "mirror", plate({0, 2, 0}, {0, -1, 0}, 1), mirror);
        const auto scene = compiled(std::move(s));
        Bench bench(*scene, moved(*scene, probe({0, 2, 0}, {0, 1, 0}, .5)), {2, 2, 1});
        bench.job.prepass = &field;
        Film film(bench.layout());
        bench.render(film, "whitted:ambient=5");
        checkGrey(meanOf(film), .25 + .8 * (.5 + .25)); // the mirror's own point asks too: what a mirror has no use for is its own business
    }

} // TEST_SUITE
