// Direct light on a diffuse receiver: closed forms (Lambert's polygon formula, Howell's factors), by every estimator of the path tracer.
#include "tests/render/measure.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;

// A square lamp of radiance 1 in the plane y = 1, one metre wide, shining down, over a receiver at `at`.
SceneDesc lampOver(const Vec3d& at, const Vec3d& normal, const PrimitiveDesc& lampShape) {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho)));
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "receiver", plate(at, normal, 0.01), wall);
    shapes::add(s, "lamp", lampShape, lamp);
    return s;
}
PrimitiveDesc squareLamp(double x0 = -0.5, double x1 = 0.5) {
    return shapes::quad({x0, 1, -0.5}, {x1, 1, -0.5}, {x1, 1, 0.5}, {x0, 1, 0.5});
}

struct Row {
    const char* name;
    Vec3d at, normal;
    double x0, x1, irradiance;
};
const Row rows[] = {
    {"B1 below the centre", {0, 0, 0}, {0, 1, 0}, -.5, .5, .7522746885},
    {"B1 below the corner", {.5, 0, .5}, {0, 1, 0}, -.5, .5, .4352098757},
    {"B1 beside", {1, 0, 0}, {0, 1, 0}, -.5, .5, .2650048523},
    {"B1 diagonal", {1, 0, 1}, {0, 1, 0}, -.5, .5, .1243532338},
    {"B1 far", {2, 0, 0}, {0, 1, 0}, -.5, .5, .0437426483},
    {"B2 vertical receiver", {0, 0, 0}, {1, 0, 0}, .5, 1.5, .2260633376},
    {"B2 lamp half below the horizon", {0, 0, 0}, {1, 0, 0}, -.5, .5, .0875102648},
};

} // namespace

TEST_SUITE("direct-light") {

    TEST_CASE("a square lamp, by light sampling, by BSDF sampling and by both") {
        for (const Row& row : rows)
            for (const char* estimator : {"path", "path:nee=off", "path:mis=off"}) {
                const std::string name = row.name;
                CAPTURE(name);
                CAPTURE(estimator);
                const auto scene = compiled(lampOver(row.at, row.normal, squareLamp(row.x0, row.x1)));
                const bool rare = std::string(estimator) == "path:nee=off";
                const Measured m = measure(*scene, probe(row.at, -row.normal), {16, 16, rare ? 4096u : 512u, {}, 2}, estimator);
                checkEqual(m, rho * row.irradiance / pi64, rare ? 0.06 : 0.006);
            }
    }

    TEST_CASE("the front of a lamp is lit and its back is black") {
        const auto scene = compiled(lampOver({0, 2, 0}, {0, -1, 0}, squareLamp()));
        CHECK(measure(*scene, probe({0, 2, 0}, {0, 1, 0}), {8, 8, 16}).value == 0);
        CHECK(measure(*scene, probe({0, 1, 0}, {0, 1, 0}), {8, 8, 16}).value == doctest::Approx(1));
        CHECK(measure(*scene, probe({0, 1, 0}, {0, -1, 0}), {8, 8, 16}).value == 0);
    }

    TEST_CASE("irradiance does not depend on the tessellation of the lamp") {
        PrimitiveDesc fine;
        for (int i = 0; i < 7; ++i)
            for (int j = 0; j < 5; ++j) {
                const double x0 = i * i / 49. - .5, x1 = (i + 1) * (i + 1) / 49. - .5, z0 = j / 5. - .5, z1 = (j + 1) / 5. - .5;
                fine = shapes::joined(fine, shapes::quad({x0, 1, z0}, {x1, 1, z0}, {x1, 1, z1}, {x0, 1, z1}));
            }
        const auto scene = compiled(lampOver({1, 0, 0}, {0, 1, 0}, fine));
        checkEqual(measure(*scene, probe({1, 0, 0}, {0, -1, 0}), {16, 16, 512, {}, 2}), rho * .2650048523 / pi64, 0.008);
    }

    TEST_CASE("half a lamp behind an opaque half-plane: the penumbra of B11") {
        struct Penumbra {
            double x, share;
        };
        for (const Penumbra p : {Penumbra{-.5, 0}, {-.25, .222182003}, {0, .5}, {.25, .777817997}, {.5, 1}}) {
            CAPTURE(p.x);
            const auto irradiance = [&](bool blocked) {
                SceneDesc s = lampOver({p.x, 0, 0}, {0, 1, 0}, shapes::quad({-.5, 2, -.5}, {.5, 2, -.5}, {.5, 2, .5}, {-.5, 2, .5}));
                const int black = shapes::add(s, shapes::diffuse("blocker", Spectrum(0)));
                if (blocked)
                    shapes::add(s, "blocker", shapes::quad({-huge, 1, -huge}, {-huge, 1, huge}, {0, 1, huge}, {0, 1, -huge}), black);
                return measure(*compiled(std::move(s)), probe({p.x, 0, 0}, {0, -1, 0}), {16, 16, 1024, {}, 2});
            };
            const Measured dark = irradiance(true), open = irradiance(false);
            CHECK(std::fabs(dark.value - p.share * open.value) <= criticalT * (dark.error + open.error) + 2e-5);
            CHECK(criticalT * dark.error <= 0.005 * open.value);
            if (p.x == 0) checkEqual(dark, rho * .1154183989 / pi64, 0.01);
        }
    }

    TEST_CASE("four lamps of a quarter are one lamp: no choice is forgotten in the weights") {
        SceneDesc s;
        const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho)));
        shapes::add(s, "receiver", plate({0, 0, 0}, {0, 1, 0}, 0.01), wall);
        for (int i = 0; i < 4; ++i) {
            PunctualDesc l;
            l.intensity = Spectrum(0.25f);
            l.toWorld = shapes::translation({0, 1, 0});
            s.lights.push_back(l);
        }
        checkEqual(measure(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {8, 8, 16}), rho / pi64, 1e-4);
    }

    TEST_CASE("a diffuse ball under a directional light (B16)") {
        for (const auto& [phase, expected] : {std::pair{0.0, 2. / 3}, {90.0, .2122065908}}) {
            CAPTURE(phase);
            SceneDesc s;
            const int wall = shapes::add(s, shapes::diffuse("ball", Spectrum(rho)));
            shapes::add(s, "ball", shapes::sphere(1, 6), wall);
            PunctualDesc sun;
            sun.kind = PunctualKind::directional;
            sun.intensity = Spectrum(float(pi64));
            const double a = phase * pi64 / 180;
            sun.toWorld = shapes::lookAt({std::sin(a), 0, std::cos(a)}, {0, 0, 0});
            s.lights.push_back(sun);
            // The ball covers pi / 4 of a frame that fits it.
            const Measured m = measure(*compiled(std::move(s)), probe({0, 0, 0}, {0, 0, -1}, 3, 1),
                                       {64, 64, 64, {}, 2, 0, SamplerKind::sobol, FilterKind::box, 1});
            checkEqual(m, expected * rho * pi64 / 4, 0.005, 4e-4); // of the tessellation
        }
    }

} // TEST_SUITE
