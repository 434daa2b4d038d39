// Irradiance from area lamps against closed forms: rows B1 to B5 of the verification table, by next-event samples with Lambert's cosine.
#include "tests/scene_kit.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

std::unique_ptr<const Scene> lamp(PrimitiveDesc shape, const Affine& m = {}) {
    SceneDesc d;
    shapes::add(d, "lamp", std::move(shape), shapes::add(d, shapes::lamp("lamp", Spectrum(1))), m);
    return compiled(std::move(d));
}
double irradiance(const Scene& scene, const Vec3d& p, const Vec3& n, uint32_t samples = 1 << 16) {
    const SurfacePoint at = receiver(scene, p, n);
    double sum = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        Sampler u(0, SamplerKind::sobol, Stream::pixel, 3, i);
        const double pick = u.getPick();
        const auto s = scene.lights().sampleTowards(at, pick, u.get2D());
        if (!s || scene.occluded(s->shadow)) continue;
        sum += double(s->radiance[0]) * std::max(0.0, double(dot(s->wi, at.ns))) / double(s->pdfW);
    }
    return sum / samples;
}
const Affine down = rotation({1, 0, 0}, std::numbers::pi); // turns a front from +z to -z
doctest::Approx within(double v, double relative = 1e-3) { return doctest::Approx(v).epsilon(relative); }

} // namespace

TEST_SUITE("direct-light") {

    TEST_CASE("B1: a unit square facing down at height 1") {
        const double table[][3] = {
            {0, 0, .7522746885}, {.5, .5, .4352098757}, {1, 0, .2650048523}, {1, 1, .1243532338}, {2, 0, .0437426483}};
        const Affine at = shapes::translation({0, 0, 1});
        // The same lamp plain, from a scaled and mirrored mesh, and as an ideal of many pieces.
        PrimitiveDesc pieces;
        for (int i = 0; i < 8; ++i) {
            const double x = -0.5 + i / 8.0;
            const PrimitiveDesc strip = shapes::quad({x, -.5, 0}, {x + 1 / 8.0, -.5, 0}, {x + 1 / 8.0, .5, 0}, {x, .5, 0});
            pieces = i ? shapes::joined(pieces, strip) : strip;
        }
        const std::unique_ptr<const Scene> lamps[] = {lamp(square(0.5), at * down), lamp(square(5), at * down * scaling(-0.1, 0.1, 1)),
                                                      lamp(pieces, at * down)};
        for (const auto& scene : lamps)
            for (const auto& [x, y, expected] : table) CHECK(irradiance(*scene, {x, y, 0}, {0, 0, 1}) == within(expected));
    }

    TEST_CASE("B2: the horizon cuts the lamp") {
        const auto aside = lamp(square(0.5), shapes::translation({1, 0, 1}) * down),
                   centred = lamp(square(0.5), shapes::translation({0, 0, 1}) * down);
        CHECK(irradiance(*aside, {}, {1, 0, 0}) == within(.2260633376));
        CHECK(irradiance(*centred, {}, {1, 0, 0}) == within(.0875102648));
    }

    TEST_CASE("B3: a triangle") {
        const auto scene = lamp(triangle({0, 0, 1}, {0, 1, 1}, {1, 0, 1})); // clockwise from above: its front looks down
        CHECK(irradiance(*scene, {}, {0, 0, 1}) == within(.3022998940));
        CHECK(irradiance(*scene, {}, {1, 1, 1}) == within(.2789169159));
    }

    TEST_CASE("B4: a disc") {
        const auto disc = [](double radius) {
            return lamp(shapes::disc(radius, 512), shapes::translation({0, 1, 0}) * rotation({1, 0, 0}, std::numbers::pi));
        };
        const double table[][2] = {{0, .6283185307}, {.5, .4600755923}, {1, .2069631884}, {2, .0336939190}};
        const auto half = disc(0.5);
        for (const auto& [r, expected] : table) CHECK(irradiance(*half, {r, 0, 0}, {0, 1, 0}) == within(expected));
        CHECK(irradiance(*disc(1), {1, 0, 0}, {0, 1, 0}) == within(.8683148537));
    }

    TEST_CASE("B5: a sphere, whole and cut by the horizon") {
        const auto half = lamp(shapes::sphere(0.5, 5));
        CHECK(irradiance(*half, {0, 0, -2}, {0, 0, 1}) == within(std::numbers::pi / 16));
        CHECK(irradiance(*half, {-1, 0, -2}, {0, 0, 1}) == within(.1404962946));
        const double table[][2] = {{60, .3926990817}, {75, .2212008801}, {90, .0905860737}, {100, .0354490}, {110, .0067530656}};
        const auto unit = lamp(shapes::sphere(1, 5));
        for (const auto& [degrees, expected] : table) {
            const double a = degrees * std::numbers::pi / 180;
            const Vec3 n{float(std::sin(a)), 0, float(std::cos(a))}; // the ball's centre lies along +z
            CHECK(irradiance(*unit, {0, 0, -2}, n, 1 << 18) == within(expected, degrees > 100 ? 5e-3 : 2e-3));
        }
    }

    TEST_CASE("B15: four lamps of a quarter are one lamp") {
        SceneDesc one, four;
        PunctualDesc l;
        l.intensity = Spectrum(8);
        l.toWorld = shapes::translation({0.3, 0.2, 1});
        one.lights = {l};
        l.intensity = Spectrum(2);
        four.lights = {l, l, l, l};
        const double a = irradiance(*compiled(std::move(one)), {}, {0, 0, 1}, 256),
                     b = irradiance(*compiled(std::move(four)), {}, {0, 0, 1}, 256);
        CHECK(a == within(b, 1e-6));
    }
}
