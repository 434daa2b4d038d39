// Light tracing: the path tracer's picture on the paths that both see (F8), the energy of its particles (G1), direct light and spheres with
// known answers, lenses, and the same bits however it is run.
#include "core/render/path_log.h"
#include "tests/render/measure.h"
#include "tests/statistics.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;

Affine facingDown(double x, double y, double z) { return shapes::translation({x, y, z}) * rotation({1, 0, 0}, pi64 / 2); }

// A floor and a wall with a coarse smooth-shaded ball, a glass block and a thin pane, under a lamp and a spot.
SceneDesc still(bool smoothBall, bool glass) {
    SceneDesc s;
    const int grey = shapes::add(s, shapes::diffuse("grey", {.7f, .6f, .5f}));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 2), grey);
    shapes::add(s, "wall", plate({0, 1, -1.2}, {0, 0, 1}, 2), grey);
    shapes::add(s, "lamp", square(0.4), shapes::add(s, shapes::lamp("lamp", Spectrum(8))), facingDown(.3, 2.2, .4));
    if (smoothBall) {
        MaterialDesc gloss;
        gloss.name = "gloss";
        gloss.baseColor = {.2f, .5f, .8f};
        gloss.metallic = 0;
        gloss.roughness = .4f;
        shapes::add(s, "ball", shapes::sphere(.5, 1), shapes::add(s, gloss), shapes::translation({-.5, .5, 0}));
    }
    if (glass) {
        MaterialDesc block;
        block.name = "block";
        block.metallic = 0;
        block.roughness = 0;
        block.transmission = 1;
        block.volume = true;
        block.attenuationDistance = .5f;
        block.attenuationColor = {.9f, .5f, .7f};
        shapes::add(s, "block", shapes::box({.3, .3, .3}), shapes::add(s, block), shapes::translation({.7, .45, .3}));
        MaterialDesc pane = block;
        pane.name = "pane";
        pane.volume = false;
        pane.roughness = .3f;
        pane.baseColor = {.5f, .9f, .6f};
        shapes::add(s, "pane", plate({.2, 1.5, .2}, {.1, 1, .2}, .4), shapes::add(s, pane));
    }
    return s;
}

// Pixel by pixel on the paths that both cover: replicates of each, Welch's t.
struct Sides {
    std::vector<stats::Moments> pixels;
    stats::Moments mean;
};
Sides replicate(const Scene& scene, const CameraDesc& camera, Settings how, const std::string& integrator, const PathQuery& query) {
    Sides side;
    side.pixels.resize(std::size_t(how.width) * how.height);
    for (int r = 0; r < replicates; ++r) {
        how.seed = uint64_t(r) * 2 + (integrator == "path");
        Bench bench(scene, camera, how);
        bench.classes = PathClasses::make(query);
        FilmLayout layout = bench.layout();
        layout.splats = true;
        Film film(layout);
        bench.render(film, integrator);
        double sum = 0;
        for (uint32_t y = 0; y < how.height; ++y)
            for (uint32_t x = 0; x < how.width; ++x) {
                const double v = double(luminance(film.mean({x, y})));
                side.pixels[std::size_t(y) * how.width + x].add(v);
                sum += v;
            }
        side.mean.add(sum / double(side.pixels.size()));
        CHECK(film.dropped() == 0);
    }
    return side;
}
void checkSame(const Scene& scene, const CameraDesc& view, const Settings& how, const std::string& light, double resolution,
               const PathQuery& query = {.paths = "", .split = "", .within = "", .without = "L .* S E | Ld S+ (D|G) .* E"}) {
    CameraDesc camera = view;
    const Vec3d c = scene.centre();
    for (int i = 0; i < 3; ++i) camera.toWorld.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
    const Sides a = replicate(scene, camera, how, light, query), b = replicate(scene, camera, how, "path", query);
    double worst = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double error = std::hypot(a.pixels[i].error(), b.pixels[i].error());
        if (error > 0) worst = std::max(worst, std::fabs(a.pixels[i].mean - b.pixels[i].mean) / error);
        if (error == 0) CHECK(a.pixels[i].mean == Approx(b.pixels[i].mean));
    }
    CHECK(worst < criticalT); // 15 degrees of freedom at least
    const double error = std::hypot(a.mean.error(), b.mean.error());
    INFO("light " << a.mean.mean << " +- " << a.mean.error() << ", path " << b.mean.mean << " +- " << b.mean.error());
    CHECK(std::fabs(a.mean.mean - b.mean.mean) <= criticalT * error);
    CHECK(criticalT * error <= resolution * b.mean.mean);
}
const CameraDesc view = perspective({.2, 1.1, 3}, {.1, .6, 0}, .7);
// A box: in the tails of a wider filter the path tracer has too few samples for a normal error.
constexpr Settings small{12, 9, 512, {}, 2, 0, SamplerKind::sobol, FilterKind::box};

// Irradiance of a polygon of radiance 1 that is all above the horizon (Lambert 1760).
double lambert(const std::vector<Vec3d>& corners, const Vec3d& p, const Vec3d& n) {
    double e = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = normalize(corners[i] - p), b = normalize(corners[(i + 1) % corners.size()] - p), g = cross(a, b);
        e += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * dot(normalize(g), n);
    }
    return std::fabs(e) / 2;
}

// The flux of many light paths by number of scatterings before arrival, and what escapes, lumen.
struct Ledger {
    stats::Moments arrived, escaped, emitted, bounce[4];
};
Ledger account(const Scene& scene, const std::string& integrator, int paths) {
    Bench bench(scene, perspective({0, 0, 0}, {0, 0, -1}, 1), {4, 4, 1});
    const IntegratorChoice choice = chooseIntegrator(integrator);
    const auto made = choice.entry->make(choice.options);
    made->prepare(bench.job);
    const auto* source = dynamic_cast<const PathSource*>(made.get());
    REQUIRE(source);
    Ledger ledger;
    for (int i = 0; i < paths; ++i) {
        PathLog log;
        source->tellPath(bench.job, uint64_t(i), log);
        double arrived = 0, escaped = 0, emitted = 0, bounce[4] = {};
        int depth = 0;
        for (const PathLog::Vertex& v : log.vertices()) {
            const double flux = double(luminance(v.throughput));
            if (v.kind == PathLog::Kind::emission) emitted += flux;
            if (v.kind == PathLog::Kind::sky) escaped += flux;
            if (v.kind != PathLog::Kind::surface) continue;
            arrived += flux;
            if (depth < 4) bounce[depth] += flux;
            ++depth;
        }
        ledger.arrived.add(arrived);
        ledger.escaped.add(escaped);
        ledger.emitted.add(emitted);
        for (int k = 0; k < 4; ++k) ledger.bounce[k].add(bounce[k]);
    }
    return ledger;
}

} // namespace

TEST_SUITE("light-and-path") {
    TEST_CASE("light is path, pixel by pixel: a matt scene, a smooth-shaded ball, glass and a pane (F8)") {
        for (const auto& [ball, glass] : {std::pair{false, false}, {true, false}, {true, true}}) {
            CAPTURE(ball);
            CAPTURE(glass);
            const auto scene = compiled(still(ball, glass));
            checkSame(*scene, view, small, "light", 0.08);
        }
    }
    TEST_CASE("every kind of light, every kind of camera") {
        SceneDesc s = still(true, false);
        PunctualDesc spot;
        spot.kind = PunctualKind::spot;
        spot.intensity = {3, 6, 2};
        spot.innerCone = .1;
        spot.outerCone = .5;
        spot.toWorld = shapes::lookAt({-1, 2, 1}, {-.2, 0, 0});
        PunctualDesc sun;
        sun.kind = PunctualKind::directional;
        sun.intensity = {1, 2, 1};
        sun.toWorld = shapes::lookAt({1, 2, 1.5}, {0, 0, 0});
        PunctualDesc bulb;
        bulb.intensity = Spectrum(2);
        bulb.range = 2;
        bulb.toWorld = shapes::translation({.9, .8, .2});
        s.lights = {spot, sun, bulb};
        s.environment = environment(8, 4, [](int x, int y) { return y < 2 ? Spectrum(.1f * float(x)) : Spectrum(.05f); });
        const auto scene = compiled(std::move(s));
        CameraDesc lens = view, polygon = view, flat = probe({0, .6, 0}, {-.1, -.4, -1}, 3, 1);
        lens.lens = {.1, 3};
        polygon.lens = {.2, 2, 6, .2};
        Settings how = small;
        how.spp = 256;
        for (const CameraDesc& camera : {view, lens, polygon, flat}) checkSame(*scene, camera, how, "light", 0.1);
        flat.lens = {.1, 3};
        checkSame(*scene, flat, how, "light", 0.1);
    }
    TEST_CASE("unaimed light rays that go through a wide lens make the same picture") {
        const auto scene = compiled(still(false, false));
        CameraDesc wide = perspective({0, 1, 2.2}, {0, .5, 0}, .9);
        wide.lens = {.4, 2};
        Settings how = small;
        how.width = how.height = 4;
        how.spp = 8192;
        checkSame(*scene, wide, how, "light:connect=off", 0.3, {.paths = "", .split = "", .within = "", .without = "Ld S* E"});
        Bench bench(*scene, view, small);
        const IntegratorChoice off = chooseIntegrator("light:connect=off");
        CHECK_THROWS_AS(off.entry->make(off.options)->prepare(bench.job), Error);
    }
}

TEST_SUITE("light-energy") {
    TEST_CASE("absorbed and escaped flux is the emitted flux; a closed room stores Phi / (1 - rho) (G1)") {
        for (const float rho : {0.5f, 0.8f}) {
            CAPTURE(rho);
            SceneDesc s;
            PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 2));
            shell.normals.clear();
            shapes::add(s, "wall", shell, shapes::add(s, shapes::diffuse("wall", Spectrum(rho))));
            PunctualDesc bulb;
            bulb.intensity = Spectrum(2);
            bulb.toWorld = shapes::translation({.2, .1, -.3});
            s.lights = {bulb};
            const auto scene = compiled(std::move(s));
            const double phi = 8 * pi64;
            const Ledger l = account(*scene, "light:rr-depth=2", 20'000);
            CHECK(l.emitted.mean == Approx(phi).epsilon(1e-6));
            CHECK(l.escaped.mean == 0);
            CHECK(std::fabs(l.arrived.mean - phi / (1 - double(rho))) < 5 * l.arrived.error());
            CHECK(l.arrived.error() < 0.01 * l.arrived.mean);
            for (int k = 0; k < 3; ++k) // before the roulette every particle carries the same
                CHECK(l.bounce[k].mean == Approx(phi * std::pow(double(rho), k)).epsilon(1e-4));
            CHECK(std::fabs(l.bounce[3].mean - phi * std::pow(double(rho), 3)) < 5 * l.bounce[3].error() + 1e-4 * phi);
        }
        SceneDesc open = still(false, false); // matt: what is absorbed is (1 - albedo) of what arrives
        for (MaterialDesc& m : open.materials) m.baseColor = Spectrum(.6f);
        const auto scene = compiled(std::move(open));
        const Ledger l = account(*scene, "light", 40'000);
        const double phi = pi64 * .64 * 8, absorbed = .4 * l.arrived.mean;
        CHECK(l.emitted.mean == Approx(phi).epsilon(1e-5));
        CHECK(l.escaped.mean > 0);
        CHECK(std::fabs(absorbed + l.escaped.mean - phi) < 5 * (.4 * l.arrived.error() + l.escaped.error()));
    }
    TEST_CASE("direct light of a square lamp (B13, the values of B1 over a floor)") {
        SceneDesc s;
        const float rho = .8f;
        shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 1.5), shapes::add(s, shapes::diffuse("floor", Spectrum(rho))));
        shapes::add(s, "lamp", square(.5), shapes::add(s, shapes::lamp("lamp", Spectrum(1))), facingDown(0, 1, 0));
        const auto scene = compiled(std::move(s));
        const std::vector<Vec3d> corners{{-.5, 1, -.5}, {.5, 1, -.5}, {.5, 1, .5}, {-.5, 1, .5}};
        CHECK(lambert(corners, {1, 0, 1}, {0, 1, 0}) == Approx(.1243532338).epsilon(1e-8));
        CHECK(lambert(corners, {0, 0, 0}, {0, 1, 0}) == Approx(.7522746885).epsilon(1e-8));
        for (const auto& [middle, resolution] : {std::pair{0.0, 0.06}, {1.0, 0.15}}) {
            double mean = 0;
            constexpr int n = 64;
            const auto along = [&](int i) { return middle + .25 * (2 * (i + .5) / n - 1); };
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) mean += lambert(corners, {along(i), 0, along(j)}, {0, 1, 0}) / n / n;
            // The camera stands between the lamp and the floor, and hides nothing.
            const Settings how{16, 16, 2048, {}, 2, 0, SamplerKind::sobol, FilterKind::box};
            checkEqual(measure(*scene, probe({middle, 0, middle}, {0, -1, 0}, .5, .25), how, "light"), double(rho) * mean / pi64,
                       resolution);
        }
    }
    TEST_CASE("integrating spheres, by depth, and a lamp in the middle of one (F1, F3)") {
        const CameraDesc camera = perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2);
        PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 3));
        shell.normals.clear();
        for (const float rho : {0.5f, 0.8f}) {
            SceneDesc s;
            shapes::add(s, "wall", shell, shapes::add(s, shapes::lamp("wall", Spectrum(1), Spectrum(rho))));
            const auto scene = compiled(std::move(s));
            for (const uint32_t depth : {0u, 1u, 2u, unlimitedDepth}) {
                CAPTURE(rho);
                CAPTURE(depth);
                const double r = double(rho), expected = depth == unlimitedDepth ? 1 / (1 - r) : (1 - std::pow(r, depth + 1.)) / (1 - r);
                checkEqual(measure(*scene, camera, {12, 12, 256, {}, 2, 0, SamplerKind::sobol, FilterKind::gauss, depth}, "light"),
                           expected, 0.08);
            }
        }
        SceneDesc s;
        shapes::add(s, "wall", shell, shapes::add(s, shapes::diffuse("wall", Spectrum(.5f))));
        PunctualDesc bulb;
        bulb.intensity = Spectrum(float(pi64));
        s.lights = {bulb};
        // Facets: the wall lies a little nearer than 1 m, so that all the flux falls on a slightly smaller area.
        checkEqual(measure(*compiled(std::move(s)), camera, {12, 12, 512, {}, 2, 0, SamplerKind::sobol, FilterKind::gauss}, "light"),
                   2 * .5 / (1 - .5) / 2 * 4 * pi64 / shapes::area(shell), 0.05, 1e-2);
    }
    TEST_CASE("defocus keeps the light of an emitter (H11)") {
        SceneDesc s;
        shapes::add(s, "lamp", square(.1), shapes::add(s, shapes::lamp("lamp", Spectrum(1000))), shapes::translation({.2, -.1, -4}));
        const auto scene = compiled(std::move(s));
        const double half = std::tan(pi64 / 18), expected = 1000 * .04 / (4 * half * half * 16);
        for (const LensDesc& lens : {LensDesc{}, LensDesc{.05, 4}, LensDesc{.05, 2}, LensDesc{.05, 1, 5}}) {
            CameraDesc c;
            c.yfov = pi64 / 9;
            c.lens = lens;
            checkEqual(measure(*scene, c, {32, 32, 1024, {}, 2, 0, SamplerKind::sobol, FilterKind::box, 0}), expected, 0.05);
        }
    }
}

TEST_SUITE("light-bits") {
    TEST_CASE("emission seen directly is the path tracer's, to the bit") {
        const auto scene = compiled(still(true, true));
        Settings how = small;
        how.maxDepth = 0;
        how.spp = 8;
        const CameraDesc up = perspective({0, .5, 3}, {.3, 2, .4}, .8);
        CHECK(samePicture(*rendered(*scene, up, how, "light").film, *rendered(*scene, up, how, "path").film));
    }
    TEST_CASE("the same bits for one, two and five threads, in one run or in several") {
        const auto scene = compiled(still(true, true));
        Settings how{37, 29, 6, {3, 2, 33, 27}, 1, 7, SamplerKind::sobol, FilterKind::blackmanHarris};
        const Rendering one = rendered(*scene, view, how, "light");
        for (const unsigned threads : {2u, 5u}) {
            how.threads = threads;
            CHECK(samePicture(*one.film, *rendered(*scene, view, how, "light").film));
        }
        how.spp = 2;
        Bench bench(*scene, view, how);
        FilmLayout layout = bench.layout();
        layout.splats = true;
        Film film(layout);
        bench.render(film, "light");
        bench.settings.spp = 6;
        bench.render(film, "light");
        CHECK(samePicture(*one.film, film));
        // A crop is a window of the whole picture.
        Settings whole = how;
        whole.spp = 6;
        whole.crop = {};
        const Rendering all = rendered(*scene, view, whole, "light");
        CHECK(all.film->mean({10, 10}) == one.film->mean({10, 10}));
    }
}
