// Distributed ray tracing against closed forms: soft shadows of every shape of lamp, gloss, panes; splitting; and the path tracer on the
// same light paths.
#include "core/render/path_log.h"
#include "core/render/prepass.h"
#include "scenes/builtin.h"
#include "tests/render/measure.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;
const char* const one = "distributed:light-samples=1,glossy-samples=1";
const char* const sixteen = "distributed:light-samples=16,glossy-samples=16";

// A lamp of radiance 1 over a small matt receiver.
SceneDesc lampOver(const Vec3d& at, const Vec3d& normal, PrimitiveDesc shape, float radiance = 1) {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho)));
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(radiance)));
    shapes::add(s, "receiver", plate(at, normal, 0.01), wall);
    shapes::add(s, "lamp", std::move(shape), lamp);
    return s;
}
PrimitiveDesc squareLamp(double x0 = -0.5, double x1 = 0.5) {
    return shapes::quad({x0, 1, -0.5}, {x1, 1, -0.5}, {x1, 1, 0.5}, {x0, 1, 0.5});
}
PrimitiveDesc moved(PrimitiveDesc shape, const Vec3d& by) {
    for (Vec3& p : shape.positions) p += cast<float>(by);
    return shape;
}
PrimitiveDesc discLamp(double radius) { return moved(shapes::insideOut(shapes::disc(radius, 512)), {0, 1, 0}); }

struct Row {
    const char* name;
    Vec3d at, normal;
    PrimitiveDesc lamp;
    double irradiance, floor = 2e-5;
};
void check(const Row& row, const char* integrator, uint32_t spp, double resolution) {
    CAPTURE(row.name);
    CAPTURE(integrator);
    const auto scene = compiled(lampOver(row.at, row.normal, row.lamp));
    checkEqual(measure(*scene, probe(row.at, -row.normal), {16, 16, spp, {}, 2}, integrator), rho * row.irradiance / pi64, resolution,
               row.floor);
}

} // namespace

TEST_SUITE("distributed") {

    TEST_CASE("a square lamp, by one and by sixteen light samples (B1, B2, B13)") {
        const Vec3d up{0, 1, 0}, x{1, 0, 0};
        const Row rows[] = {{"below the centre", {0, 0, 0}, up, squareLamp(), .7522746885},
                            {"below the corner", {.5, 0, .5}, up, squareLamp(), .4352098757},
                            {"beside", {1, 0, 0}, up, squareLamp(), .2650048523},
                            {"diagonal", {1, 0, 1}, up, squareLamp(), .1243532338},
                            {"far", {2, 0, 0}, up, squareLamp(), .0437426483},
                            {"vertical receiver", {0, 0, 0}, x, squareLamp(.5, 1.5), .2260633376},
                            {"half below the horizon", {0, 0, 0}, x, squareLamp(), .0875102648}};
        for (const Row& row : rows) {
            check(row, one, 512, 0.006);
            check(row, sixteen, 64, 0.006);
        }
    }

    TEST_CASE("triangle, disc and sphere as lamps (B3, B4, B5)") {
        const Vec3d up{0, 1, 0}, z{0, 0, 1};
        const PrimitiveDesc corner = triangle({0, 0, 1}, {0, 1, 1}, {1, 0, 1});
        const auto ball = [](double radius, const Vec3d& centre) { return moved(shapes::sphere(radius, 5), centre); };
        const auto leaning = [](double degrees) {
            return Vec3d{2 * std::sin(degrees * pi64 / 180), 2 * std::cos(degrees * pi64 / 180), 0};
        };
        const Row rows[] = {
            {"triangle", {0, 0, 0}, z, corner, .3022998940},
            {"triangle, leaning receiver", {0, 0, 0}, normalize(Vec3d{1, 1, 1}), corner, .2789169159},
            {"disc, below", {0, 0, 0}, up, discLamp(.5), .6283185307, 6e-5},
            {"disc, below the edge", {.5, 0, 0}, up, discLamp(.5), .4600755923, 6e-5},
            {"disc, beside", {1, 0, 0}, up, discLamp(.5), .2069631884, 6e-5},
            {"disc, far", {2, 0, 0}, up, discLamp(.5), .0336939190, 6e-5},
            {"wide disc, below its edge", {1, 0, 0}, up, discLamp(1), .8683148537, 6e-5},
            {"sphere overhead", {0, 0, 0}, up, ball(.5, {0, 2, 0}), .1963495408, 1e-3},
            {"sphere aside", {0, 0, 0}, up, ball(.5, {1, 2, 0}), .1404962946, 1e-3},
            {"sphere at 60 degrees", {0, 0, 0}, up, ball(1, leaning(60)), .3926990817, 1e-3},
            {"sphere cut by the horizon", {0, 0, 0}, up, ball(1, leaning(90)), .0905860737, 2e-3},
        };
        for (const Row& row : rows) check(row, sixteen, 128, 0.02);
    }

    TEST_CASE("a lamp of 1000 nit is not a point (B10)") {
        const auto shape = shapes::quad({-.05, 1, -.05}, {.05, 1, -.05}, {.05, 1, .05}, {-.05, 1, .05});
        const auto scene = compiled(lampOver({0, 0, 0}, {0, 1, 0}, shape, 1000));
        checkEqual(measure(*scene, probe({0, 0, 0}, {0, -1, 0}), {16, 16, 64, {}, 2}, "distributed"), rho * 9.966782906 / pi64, 1e-3);
    }

    TEST_CASE("half a lamp behind an opaque half-plane: the penumbra, as light and as the share of shadow rays (B11)") {
        struct Penumbra {
            double x, share;
        };
        for (const Penumbra p : {Penumbra{-.5, 0}, {-.25, .222182003}, {0, .5}, {.25, .777817997}, {.5, 1}}) {
            CAPTURE(p.x);
            const auto light = [&](bool blocked, const char* integrator) {
                SceneDesc s = lampOver({p.x, 0, 0}, {0, 1, 0}, shapes::quad({-.5, 2, -.5}, {.5, 2, -.5}, {.5, 2, .5}, {-.5, 2, .5}));
                const int black = shapes::add(s, shapes::diffuse("blocker", Spectrum(0)));
                if (blocked)
                    shapes::add(s, "blocker", shapes::quad({-huge, 1, -huge}, {-huge, 1, huge}, {0, 1, huge}, {0, 1, -huge}), black);
                return measure(*compiled(std::move(s)), probe({p.x, 0, 0}, {0, -1, 0}), {16, 16, 64, {}, 2}, integrator);
            };
            const Measured dark = light(true, sixteen), open = light(false, sixteen);
            CHECK(std::fabs(dark.value - p.share * open.value) <= criticalT * (dark.error + open.error) + 2e-5);
            CHECK(criticalT * dark.error <= 0.005 * open.value);
            if (p.x == 0) checkEqual(dark, rho * .1154183989 / pi64, 0.01);
            const Measured off = light(true, "distributed:shadows=off");
            CHECK(std::fabs(off.value - open.value) <= criticalT * (off.error + open.error) + 1e-5);
            const Measured view = light(true, "distributed:show=shadow,light-samples=16");
            if (p.share == 0 || p.share == 1) CHECK(std::fabs(view.value - p.share) < 4e-4); // the probe is 1e-4 wide
            if (p.share == .5) checkEqual(view, .5, 0.01);
        }
    }

    TEST_CASE("a metal under a white sky shows its albedo (D4)") {
        struct Metal {
            double alpha, mu, albedo;
        };
        for (const Metal m :
             {Metal{.1, 1, .988304}, {.1, .2, .904559}, {.25, .8, .897272}, {.5, .5, .698251}, {1, 1, .306853}, {1, .5, .450694}}) {
            CAPTURE(m.alpha);
            CAPTURE(m.mu);
            SceneDesc s;
            const int metal = shapes::add(s, shapes::metal("metal", Spectrum(1), float(std::sqrt(m.alpha))));
            s.materials[std::size_t(metal)].compensated = false;
            shapes::add(s, "plate", plate({0, 0, 0}, {0, 1, 0}, 0.1), metal);
            s.environment = uniformSky(1);
            const auto scene = compiled(std::move(s));
            const CameraDesc camera = probe({0, 0, 0}, {std::sqrt(1 - m.mu * m.mu), -m.mu, 0});
            checkEqual(measure(*scene, camera, {16, 16, 128, {}, 2}, one), m.albedo, 0.02, 2e-6);
            checkEqual(measure(*scene, camera, {16, 16, 16, {}, 2}, sixteen), m.albedo, 0.02, 2e-6);
        }
    }

    TEST_CASE("frosted glass seen from the air: what it reflects, and reflects and lets through together (D9)") {
        struct Glass {
            double alpha, mu, R;
        };
        for (const Glass g : {Glass{.1, .5, .085882}, {.5, 1, .028175}, {1, .5, .023387}}) {
            CAPTURE(g.alpha);
            CAPTURE(g.mu);
            const auto under = [&](float above, float below, const char* integrator) {
                SceneDesc s;
                MaterialDesc m = shapes::glass("frosted", 1.5f);
                m.roughness = float(std::sqrt(g.alpha));
                m.compensated = false;
                const int glass = shapes::add(s, m);
                shapes::add(s, "plate", plate({0, 0, 0}, {0, 1, 0}, 0.1), glass);
                s.environment = environment(4, 2, [&](int, int y) { return Spectrum(y == 0 ? above : below); });
                return measure(*compiled(std::move(s)), probe({0, 0, 0}, {std::sqrt(1 - g.mu * g.mu), -g.mu, 0}), {16, 16, 128, {}, 2},
                               integrator);
            };
            checkEqual(under(1, 0, "distributed"), g.R, 0.05, 1e-4);
            const Measured both = under(1, 1, "distributed"), path = under(1, 1, "path");
            CHECK(std::fabs(both.value - path.value) <= criticalT * std::hypot(both.error, path.error) + 1e-5);
        }
    }

    TEST_CASE("panes and slabs: all orders of reflection without dice (J5, C7)") {
        for (const bool thin : {true, false}) {
            CAPTURE(thin);
            SceneDesc s;
            MaterialDesc m = shapes::glass("glass", 1.5f);
            m.volume = !thin;
            const int glass = shapes::add(s, m), lamp = shapes::add(s, shapes::lamp("wall", Spectrum(.5f)));
            if (thin) shapes::add(s, "pane", plate({0, 0, 0}, {0, 1, 0}, huge), glass);
            if (!thin) shapes::add(s, "slab", shapes::box({huge, 0.5, huge}), glass);
            shapes::add(s, "wall", plate({0, -5, 0}, {0, 1, 0}, huge), lamp);
            const auto scene = compiled(std::move(s));
            const Measured whole = measure(*scene, probe({0, 1, 0}, {0, -1, 0}, 2), {16, 16, 64}, "distributed");
            checkEqual(whole, .4615384615, 0.002);
            const Measured fine = measure(*scene, probe({0, 1, 0}, {0, -1, 0}, 2), {4, 4, 16}, "distributed:min-weight=1e-4");
            CHECK(fine.value == doctest::Approx(.4615384615).epsilon(1e-4));
            CHECK(fine.error <= 1e-4);
        }
    }

    TEST_CASE("a glass ball in a furnace is invisible: the tree of reflections and refractions loses nothing (C14)") {
        SceneDesc s;
        const int glass = shapes::add(s, shapes::glass("glass", 1.5f));
        shapes::add(s, "ball", shapes::sphere(1, 4), glass);
        s.environment = uniformSky(1);
        const auto scene = compiled(std::move(s));
        checkEqual(measure(*scene, perspective({0, 0, 4}, {0, 0, 0}, 0.6), {24, 24, 64, {}, 2}, "distributed"), 1, 0.002, 1e-3);
    }

    TEST_CASE("an edge at 0.3 of the pixel (H5)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1))), black = shapes::add(s, shapes::diffuse("floor", Spectrum(0)));
        shapes::add(s, "lamp", shapes::quad({-.5, -1, 0}, {-.2, -1, 0}, {-.2, 1, 0}, {-.5, 1, 0}), lamp);
        shapes::add(s, "floor", plate({0, 0, -1}, {0, 0, 1}, 2), black);
        checkEqual(measure(*compiled(std::move(s)), probe({0, 0, 0}, {0, 0, -1}, 1, .5), {1, 1, 16384}, "distributed"), .3, 0.01);
    }

    TEST_CASE("ambient light is a constant on the diffuse part, and a pre-pass replaces it") {
        struct Field final : Prepass {
            void solve(const Work&) override {}
            void save(Writer&) const override {}
            void load(const Work&, Reader&) override {}
            void addIndirect(const PathClasses&, const Hit&, const SurfacePoint&, const Bsdf&, PathState, const Spectrum& weight,
                             Outputs& out) const noexcept override {
                out.add(otherLayer, weight * 3.f);
            }
        } const field;
        SceneDesc s;
        const int wall = shapes::add(s, shapes::diffuse("wall", Spectrum(rho)));
        shapes::add(s, "wall", plate({0, 0, 0}, {0, 1, 0}, 1), wall);
        const auto scene = compiled(std::move(s));
        Bench bench(*scene, probe({0, 0, 0}, {0, -1, 0}), {8, 8, 4});
        for (const bool solved : {false, true}) {
            bench.job.prepass = solved ? &field : nullptr;
            Film film(bench.layout());
            bench.render(film, "distributed:ambient=2");
            CHECK(film.meanLuminance().value == doctest::Approx(solved ? 3 : 2 * rho));
        }
    }

} // TEST_SUITE
