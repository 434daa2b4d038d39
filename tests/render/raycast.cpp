// Ray casting with local illumination: exact values (rows B6, D2, D3, J1, J2 of the verification table), and the path tracer where nothing
// is in the way (S1).
#include "integrators/classic_shading.h"
#include "tests/render/raycast_scenes.h"
#include <algorithm>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// Radiance of a floor of this material at the origin, seen from the polar angle `from` in the plane z = 0, against the light's side.
double floorUnder(const PunctualDesc& lamp, const MaterialDesc& material, const std::string& integrator, double from = 0) {
    SceneDesc d;
    shapes::add(d, "floor", plate({0, 0, 0}, {0, 1, 0}, 1), shapes::add(d, material));
    d.lights.push_back(lamp);
    const auto scene = compiled(std::move(d));
    Settings s;
    s.width = s.height = 2;
    s.spp = 1;
    const CameraDesc eye = probe({0, 0, 0}, {std::sin(from), -std::cos(from), 0}, 0.5, 1e-5);
    return luminance(rendered(*scene, placed(*scene, eye), s, integrator).mean);
}
// A lamp at a distance, at a polar angle in the plane z = 0.
Vec3d polar(double distance, double angle) { return {distance * std::sin(angle), distance * std::cos(angle), 0}; }
MaterialDesc mirrorLike() { return shapes::metal("white metal", Spectrum(1), 0.5f); }

// The largest relative difference between two pictures.
double worst(const Film& a, const Film& b) {
    double most = 0;
    const Rect c = a.layout().crop;
    for (uint32_t y = c.y0; y < c.y1; ++y)
        for (uint32_t x = c.x0; x < c.x1; ++x) {
            const Spectrum p = a.mean({x, y}), q = b.mean({x, y});
            for (std::size_t k = 0; k < 3; ++k)
                most = std::max(most, double(std::fabs(p[k] - q[k])) / std::max(1e-4, double(std::fabs(p[k])) + std::fabs(q[k])));
        }
    return most;
}

// Directional albedo by the midpoint rule over the hemisphere.
double albedo(const ClassicSurface& s, double polarAngle) {
    constexpr int rings = 1500, sectors = 360;
    const Vec3 n{0, 0, 1}, wo{float(std::sin(polarAngle)), 0, float(std::cos(polarAngle))};
    double sum = 0;
    for (int i = 0; i < rings; ++i) {
        const double theta = (i + 0.5) / rings * std::numbers::pi / 2, r = std::sin(theta);
        for (int j = 0; j < sectors; ++j) {
            const double phi = (j + 0.5) / sectors * 2 * std::numbers::pi;
            sum += r * s.answer(n, wo, {float(r * std::cos(phi)), float(r * std::sin(phi)), float(std::cos(theta))}).specular[0];
        }
    }
    return sum * (std::numbers::pi / 2 / rings) * (2 * std::numbers::pi / sectors);
}

} // namespace

TEST_SUITE("raycast-values") {
    TEST_CASE("B6: inverse square, cosine and albedo over pi, for lamps of every kind") {
        const MaterialDesc grey = shapes::diffuse("grey", Spectrum(0.8f));
        for (const char* how : {"raycast", "raycast:shadows=ray", "raycast:shadows=map", "raycast:shading=phong", "raycast:shading=blinn",
                                "raycast:shading=phong,highlight=legacy"}) {
            CAPTURE(how);
            CHECK(floorUnder(pointLight(1, {0, 1, 0}), grey, how) == doctest::Approx(.2546479089).epsilon(1e-5));
            CHECK(floorUnder(pointLight(1, polar(2, 60 * degree)), grey, how) ==
                  doctest::Approx(.125 * .8 / std::numbers::pi).epsilon(1e-5));
            const PunctualDesc sun = light(PunctualKind::directional, 3, polar(1, 60 * degree), {0, 0, 0});
            CHECK(floorUnder(sun, grey, how) == doctest::Approx(1.5 * .8 / std::numbers::pi).epsilon(1e-5));
            PunctualDesc spot = light(PunctualKind::spot, 4, polar(2, 60 * degree), {0, 0, 0});
            spot.innerCone = 0.2;
            CHECK(floorUnder(spot, grey, how) == doctest::Approx(.5 * .8 / std::numbers::pi).epsilon(1e-5));
        }
    }

    TEST_CASE("J1: diffuse, ambient and Phong's highlight add up") {
        const MaterialDesc grey = shapes::diffuse("grey", Spectrum(0.5f));
        const PunctualDesc above = pointLight(std::numbers::pi, {0, 1, 0});
        CHECK(floorUnder(above, grey, "raycast") == doctest::Approx(.5).epsilon(1e-5));
        CHECK(floorUnder(above, grey, "raycast:ambient=0.2") == doctest::Approx(.6).epsilon(1e-5));
        CHECK(floorUnder(above, grey, "raycast:shading=blinn,highlight=legacy,ambient=0.2") == doctest::Approx(.6).epsilon(1e-5));
        const PunctualDesc aside = pointLight(std::numbers::pi, polar(1, 30 * degree));
        const std::string legacy = "raycast:highlight=legacy,exponent=20,shading=", normalised = "raycast:exponent=20,shading=";
        // The viewer stands 10 degrees off the mirror direction; the half vector 5 degrees off the normal.
        const double phong = std::pow(std::cos(10 * degree), 20), blinn = std::pow(std::cos(5 * degree), 20);
        CHECK(phong == doctest::Approx(.7362566).epsilon(1e-6));
        CHECK(floorUnder(aside, mirrorLike(), legacy + "phong", 40 * degree) == doctest::Approx(phong).epsilon(1e-4));
        CHECK(floorUnder(aside, mirrorLike(), legacy + "blinn", 40 * degree) == doctest::Approx(blinn).epsilon(1e-4));
        const double irradiance = std::numbers::pi * std::cos(30 * degree);
        CHECK(floorUnder(aside, mirrorLike(), normalised + "phong", 40 * degree) ==
              doctest::Approx(phong * phongFactor(20.0) * irradiance).epsilon(1e-4));
        CHECK(floorUnder(aside, mirrorLike(), normalised + "blinn", 40 * degree) ==
              doctest::Approx(blinn * blinnFactor(20.0) * irradiance).epsilon(1e-4));
    }

    TEST_CASE("J2: classic attenuation by c1 + c2 d + c3 d^2, never above 1") {
        const MaterialDesc grey = shapes::diffuse("grey", Spectrum(0.5f));
        const auto at = [&](double d, const char* more) {
            return floorUnder(pointLight(std::numbers::pi, {0, d, 0}), grey, std::string("raycast:attenuation=classic") + more);
        };
        CHECK(at(2, "") == doctest::Approx(.5 * .2).epsilon(1e-5));
        CHECK(at(2, ",c1=0,c2=1,c3=0") == doctest::Approx(.5 * .5).epsilon(1e-5));
        CHECK(at(0.5, ",c1=0,c2=1,c3=0") == doctest::Approx(.5).epsilon(1e-5));
    }

    TEST_CASE("D2: albedos of the normalised Phong lobe") {
        const double angles[] = {0, 30, 60, 75, 85};
        const double expected[2][5] = {{1, .8660285, .5047360, .2919010, .1712746}, {1, .8660254, .5, .2589454, .0976134}};
        for (int row = 0; row < 2; ++row)
            for (int k = 0; k < 5; ++k) {
                CAPTURE(angles[k]);
                const ClassicSurface s{ClassicLobe::phong, true, Spectrum(0), Spectrum(1), row == 0 ? 10.f : 100.f};
                CHECK(albedo(s, angles[k] * degree) == doctest::Approx(expected[row][k]).epsilon(1e-4));
            }
    }

    TEST_CASE("D3: the energy factor of Blinn's lobe, and its albedo of 1 at normal incidence") {
        CHECK(blinnFactor(1.0) == doctest::Approx(.3496155268).epsilon(1e-9));
        CHECK(blinnFactor(10.0) == doctest::Approx(.6663683599).epsilon(1e-9));
        CHECK(blinnFactor(100.0) == doctest::Approx(4.220789091).epsilon(1e-9));
        for (const float n : {1.f, 10.f, 100.f})
            CHECK(albedo({ClassicLobe::blinn, true, Spectrum(0), Spectrum(1), n}, 0) == doctest::Approx(1).epsilon(1e-4));
        for (const float n : {1.f, 10.f, 100.f}) // nowhere more than arrives
            for (const double angle : {30., 60., 85.})
                CHECK(albedo({ClassicLobe::blinn, true, Spectrum(0), Spectrum(1), n}, angle * degree) < 1);
    }

    TEST_CASE("a rougher surface has the wider highlight, Phong's exponent is a quarter of Blinn's") {
        BsdfParameters p;
        float last = infinity;
        for (const float roughness : {0.f, 0.1f, 0.3f, 0.6f, 1.f}) {
            p.roughness = roughness;
            const float blinn = classicSurface(p, ClassicLobe::blinn, true, 0).exponent;
            CHECK(blinn <= last);
            CHECK(blinn <= mostExponent);
            if (roughness >= 0.3f) CHECK(classicSurface(p, ClassicLobe::phong, true, 0).exponent == doctest::Approx(blinn / 4));
            last = blinn;
        }
        p.roughness = 0.5f;
        CHECK(classicSurface(p, ClassicLobe::blinn, true, 0).exponent == doctest::Approx(30)); // 2 / 0.25^2 - 2
        CHECK(classicSurface(p, ClassicLobe::phong, true, 0).specular[0] == doctest::Approx(0.04));
    }
} // TEST_SUITE

TEST_SUITE("raycast-pictures") {
    TEST_CASE("S1: without occluders it is the path tracer's direct light, pixel by pixel, for every kind of punctual light") {
        Settings s = sharp(64);
        s.maxDepth = 1;
        s.spp = 4;
        for (const PunctualDesc& lamp : lampKinds()) {
            CAPTURE(int(lamp.kind));
            const auto scene = compiled(openScene(lamp));
            const auto truth = picture(*scene, overview(), s, "path");
            CHECK(truth->meanLuminance().value > 0.01);
            for (const char* how : {"raycast", "raycast:shadows=ray"}) CHECK(worst(*truth, *picture(*scene, overview(), s, how)) < 2e-5);
        }
    }

    TEST_CASE("with shadow rays it is that with occluders too") {
        Settings s = sharp(96);
        s.maxDepth = 1;
        s.spp = 4;
        for (const PunctualDesc& lamp : lampKinds()) {
            CAPTURE(int(lamp.kind));
            const auto scene = compiled(shadowedScene(lamp));
            const auto truth = picture(*scene, overview(), s, "path:wide=off");
            CHECK(worst(*truth, *picture(*scene, overview(), s, "raycast:shadows=ray")) < 2e-5);
            CHECK(worst(*truth, *picture(*scene, overview(), s, "raycast")) > 0.1); // and without them it is not
        }
    }

    TEST_CASE("lamps add up, area lights too; depth 0 is emission, and the sky lights nothing") {
        const std::vector<PunctualDesc> lamps = lampKinds();
        SceneDesc all = openScene(lamps[0]);
        all.lights = lamps;
        const auto scene = compiled(std::move(all));
        const Settings s = sharp(48);
        const auto sum = picture(*scene, overview(), s, "raycast");
        Spectrum parts(0);
        for (const PunctualDesc& lamp : lamps) parts += meanOf(*picture(*compiled(openScene(lamp)), overview(), s, "raycast"));
        CHECK(luminance(meanOf(*sum)) == doctest::Approx(luminance(parts)).epsilon(1e-4));

        SceneDesc lit = openScene(lamps[0]);
        lit.lights.clear();
        shapes::add(lit, "panel", plate({0, 3, 0}, {0, -1, 0}, 0.05), shapes::add(lit, shapes::lamp("panel", Spectrum(400))));
        const auto panel = compiled(lit);
        const double direct = luminance(meanOf(*picture(*panel, overview(), s, "raycast")));
        Settings emission = s;
        emission.maxDepth = 0;
        CHECK(samePicture(*picture(*panel, overview(), emission, "raycast"), *picture(*panel, overview(), emission, "path:wide=off")));
        lit.environment = uniformSky(0.25f);
        const auto open = compiled(std::move(lit));
        CHECK(worst(*picture(*open, overview(), emission, "raycast"), *picture(*open, overview(), emission, "path")) < 1e-6);
        const double shown = luminance(meanOf(*picture(*open, overview(), emission, "raycast"))) -
                             luminance(meanOf(*picture(*panel, overview(), emission, "raycast")));
        CHECK(shown > 0.05);
        CHECK(luminance(meanOf(*picture(*open, overview(), s, "raycast"))) == doctest::Approx(direct + shown).epsilon(1e-4));
    }

    TEST_CASE("a small panel far away is its point at the centre, with and without shadows") {
        SceneDesc d = shadowedScene(lampKinds()[0]);
        d.lights.clear();
        shapes::add(d, "panel", plate({0.3, 6, 0.5}, {0, -1, 0}, 0.02), shapes::add(d, shapes::lamp("panel", Spectrum(30000))));
        const auto scene = compiled(std::move(d));
        Settings s = sharp(64);
        s.maxDepth = 1;
        s.spp = 256;
        const double truth = picture(*scene, overview(), s, "path")->meanLuminance().value;
        for (const char* how : {"raycast:shadows=ray", "raycast:shadows=map,map-size=1024"})
            CHECK(picture(*scene, overview(), s, how)->meanLuminance().value == doctest::Approx(truth).epsilon(0.01));
        CHECK(picture(*scene, overview(), s, "raycast")->meanLuminance().value > 1.02 * truth);
    }

    TEST_CASE("at the pixel's centre there is one picture, whatever the seed; samples and threads change nothing") {
        const auto scene = compiled(shadowedScene(lampKinds()[0]));
        Settings a = sharp(40), b = a;
        b.seed = 7;
        b.threads = 2;
        for (const char* how : {"raycast:aa=centre,shadows=ray", "raycast:aa=centre,shadows=map,map-size=64"})
            CHECK(samePicture(*picture(*scene, overview(), a, how), *picture(*scene, overview(), b, how)));
        b.spp = 5;
        CHECK(worst(*picture(*scene, overview(), a, "raycast:aa=centre"), *picture(*scene, overview(), b, "raycast:aa=centre")) < 1e-6);
    }

    TEST_CASE("one sample alone is the sample of the picture, bit by bit") {
        const auto scene = compiled(shadowedScene(lampKinds()[1]));
        for (const char* how : {"raycast:shadows=ray", "raycast:shading=blinn,ambient=0.1,shadows=map,map-size=32"}) {
            Bench bench(*scene, placed(*scene, overview()), sharp(24));
            const IntegratorChoice choice = chooseIntegrator(how);
            const auto made = choice.entry->make(choice.options);
            const auto& raycast = dynamic_cast<const CameraIntegrator&>(*made);
            Film film(bench.layout()), again(bench.layout());
            chiaro::render(bench.job, *made, film, {1, infinity}, bench.stop);
            for (uint32_t y = 0; y < 24; ++y)
                for (uint32_t x = 0; x < 24; ++x) {
                    PathStart start = startPixel(bench.job, {x, y}, 0, raycast.starts(bench.job));
                    Outputs out(bench.layout());
                    raycast.radiance(bench.job, start, out);
                    again.add({x, y}, 0, out);
                }
            CHECK(samePicture(film, again));
        }
    }

    TEST_CASE("it vouches for what is exact, and for nothing else") {
        const auto of = [](const char* text) {
            const IntegratorChoice c = chooseIntegrator(text);
            return c.entry->traits(c.options);
        };
        CHECK(of("raycast:shadows=ray").covers == "Ld (D|G) E | (La|Le) E");
        for (const char* how :
             {"raycast", "raycast:shadows=map", "raycast:shadows=ray,shading=phong", "raycast:shadows=ray,attenuation=classic"})
            CHECK(of(how).covers == "(La|Le) E");
        CHECK(of("raycast").unbiased);
        CHECK_FALSE(of("raycast:ambient=0.1").unbiased);
        CHECK(of("raycast:aa=centre").deterministic);
        CHECK_FALSE(of("raycast").deterministic); // the filter places its samples at random
    }

    TEST_CASE("layers: light by class, the ambient term apart, together the picture") {
        const auto scene = compiled(openScene(lampKinds()[0]));
        Bench bench(*scene, placed(*scene, overview()), sharp(32));
        PathQuery query;
        query.split = "diffuse=L D E,glossy=L G E";
        bench.classes = PathClasses::make(query);
        FilmLayout layout = bench.layout();
        layout.layers = bench.classes.layerNames();
        for (const char* how : {"raycast:ambient=0.1", "raycast:ambient=0.1,shading=phong"}) {
            Film film(layout);
            bench.render(film, how);
            std::vector<double> of(layout.layers.size());
            double sum = 0;
            for (uint32_t y = 0; y < 32; ++y)
                for (uint32_t x = 0; x < 32; ++x)
                    for (std::size_t l = 0; l < of.size(); ++l) of[l] += luminance(film.mean({x, y}, int(l)));
            for (const double v : of) sum += v;
            CHECK(of[0] > 0);              // no light path: ambient
            CHECK(of[1] > 0);              // diffuse
            CHECK(of[2] > 0);              // glossy
            CHECK(of[of.size() - 1] == 0); // the rest
            CHECK(sum / 1024 == doctest::Approx(luminance(meanOf(film))).epsilon(1e-5));
        }
    }
} // TEST_SUITE
