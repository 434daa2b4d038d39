// Radiosity against the other solvers and against the path tracer; what does not depend on views, threads and files.
#include "core/render/archive.h"
#include "core/render/prepass.h"
#include "integrators/radiosity/solve_options.h"
#include "scenes/builtin.h"
#include "tests/render/radiosity_kit.h"
#include <fmt/format.h>
#include <sstream>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

Solved solved(const Scene& scene, const std::string& text, uint32_t apart = 1, unsigned threads = 2) {
    const Options o = Options::parse(solveOptions, text, "radiosity");
    SolveSettings how = solveSettings(o);
    how.limits.apart = apart;
    return RadiosityBench(scene, threads).solve(patchSettings(o), how);
}
std::unique_ptr<const Scene> builtin(const char* name) { return compiled(findBuiltin(name)->make()); }
double meanIrradiance(const Solved& s, const Vec3& towards) {
    return meanOver(
        s.patches, [&](const Patch& p) { return dot(p.normal, towards) > .9f; },
        [&](uint32_t i) { return luminance(s.solution.irradiance(i)); });
}
// Root mean square of the difference in irradiance over all patches, relative to its mean.
double difference(const Solved& a, const Solved& b) {
    const auto every = [](const Patch&) { return true; };
    const double mean = meanOver(a.patches, every, [&](uint32_t i) { return luminance(a.solution.irradiance(i)); });
    return std::sqrt(meanOver(a.patches, every,
                              [&](uint32_t i) { return sqr(luminance(a.solution.irradiance(i)) - luminance(b.solution.irradiance(i))); })) /
           mean;
}

// Matt walls about a box, a small lamp, a spot, a little sky through a hole: every kind of light.
SceneDesc mixedRoom() {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("wall", {.7f, .6f, .5f})),
              red = shapes::add(s, shapes::diffuse("red", {.6f, .1f, .1f}));
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(8)));
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1})
            if (!(axis == 2 && side == 1)) shapes::add(s, "face", unitFace(axis, side), axis == 0 && side == 1 ? red : wall);
    shapes::add(s, "box", shapes::box({.12, .15, .12}), wall, shapes::translation({.1, -.34, .05}));
    shapes::add(s, "lamp", plate({0, .49, 0}, {0, -1, 0}, .1), lamp);
    PunctualDesc spot;
    spot.kind = PunctualKind::spot;
    spot.intensity = Spectrum(.4f);
    spot.outerCone = .5;
    spot.toWorld = shapes::lookAt({-.3, .3, .2}, {-.1, -.5, -.2});
    s.lights.push_back(spot);
    s.environment = uniformSky(.3f);
    return s;
}

} // namespace

TEST_SUITE("radiosity-agree") {
    TEST_CASE("all solvers agree to half a percent") {
        const auto scene = builtin("@cornell");
        const char* same = "patches=500,light-rays=64,rays=4096";
        const Solved reference = solved(*scene, fmt::format("{},solver=direct", same));
        for (const char* solver : {"gauss-seidel", "jacobi", "shoot,direct=rays,factors=hemisphere",
                                   "shoot,overshoot=on,direct=rays,tolerance=1e-4", "hierarchical", "stochastic,shots=2048"}) {
            CAPTURE(std::string(solver));
            const Solved s = solved(*scene, fmt::format("{},solver={}", same, solver));
            for (const Vec3& n : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}})
                CHECK(meanIrradiance(s, n) == near(meanIrradiance(reference, n), 5e-3));
            CHECK(difference(s, reference) < .02); // patch by patch, of the mean
        }
    }

    // Small patches: the block hangs a hundredth above the floor, and a patch that reaches below it has less light than what is seen of it.
    // With an edge of 0.08 direct light is 2.5 % off, with 0.04 up to 0.6 %, either way, with 0.01 less than 0.1 %.
    TEST_CASE("with the path tracer, bounce by bounce and in sum, with lights of every kind") {
        const auto scene = compiled(mixedRoom());
        const CameraDesc camera = recentred(*scene, perspective({0, 0, .49}, {0, -.1, -.5}, 1.5));
        constexpr uint32_t most = 3;
        const std::vector<double> path = byBounce(*scene, camera, {24, 24, 4096, {}, 2}, most, "path");
        for (const char* show : {"interpolated", "gather", "patch"}) {
            const std::vector<double> seen =
                byBounce(*scene, camera, {24, 24, 64, {}, 2}, most,
                         fmt::format("radiosity:size=.02,light-rays=64,solver=stochastic,shots=128,show={}", show));
            CHECK(seen[0] == path[0]); // the lamp is seen from behind
            for (uint32_t k = 1; k <= most + 1; ++k) {
                INFO(std::string(show) << (k > most ? ", in sum" : ", bounce ") << k << ": " << 100 * (seen[k] / path[k] - 1) << " %");
                CHECK(std::fabs(seen[k] / path[k] - 1) < .01);
            }
        }
    }

    TEST_CASE("whitted and distributed with the pre-pass: direct light by rays, the rest by radiosity") {
        const auto scene = compiled(mixedRoom());
        const CameraDesc camera = recentred(*scene, perspective({0, 0, .49}, {0, -.1, -.5}, 1.5));
        Settings how{24, 24, 1024, {}, 2};
        const double path = double(luminance(rendered(*scene, camera, how).mean));
        how.spp = 256;
        Bench bench(*scene, camera, how);
        const PrepassChoice choice = choosePrepass("radiosity:patches=1500,light-rays=128");
        const std::unique_ptr<Prepass> prepass = choice.entry->make(choice.options);
        prepass->solve(bench.job);
        const auto with = [&](const Prepass* p, const std::string& integrator) {
            auto film = std::make_unique<Film>(bench.layout());
            const Job job{static_cast<const Work&>(bench.job), bench.view, p};
            const IntegratorChoice i = chooseIntegrator(integrator);
            chiaro::render(job, *i.entry->make(i.options), *film, {how.spp, infinity}, bench.stop);
            return film;
        };
        const char* viewer = "distributed";
        const auto both = with(prepass.get(), viewer);
        CHECK(double(luminance(meanOf(*both))) == near(path, .01));

        // Saved and loaded: the same bits.
        std::stringstream file;
        Writer writer(file);
        prepass->save(writer);
        const std::unique_ptr<Prepass> again = choice.entry->make(choice.options);
        Reader reader(file, "test", file.str().size());
        again->load(bench.job, reader);
        CHECK(reader.left() == 0);
        CHECK(samePicture(*both, *with(again.get(), viewer)));

        // Of another mesh: refused.
        std::stringstream other(file.str());
        Reader wrong(other, "test", file.str().size());
        const PrepassChoice coarse = choosePrepass("radiosity:patches=100");
        CHECK_THROWS_WITH_AS(coarse.entry->make(coarse.options)->load(bench.job, wrong), doctest::Contains("another mesh"), Error);
        CHECK_THROWS_WITH_AS(choosePrepass("radiosity:bounces=1").entry->make(choosePrepass("radiosity:bounces=1").options),
                             doctest::Contains("direct light is never in a pre-pass"), Error);
    }

    TEST_CASE("the same point has the same radiance from every camera (M9)") {
        const auto scene = compiled(mixedRoom());
        const auto at = [&](const Vec3d& direction) {
            return rendered(*scene, recentred(*scene, probe({.013, -.5, .3}, direction, .05, 1e-6)), {4, 4, 4}, "radiosity:patches=300")
                .mean;
        };
        const Spectrum above = at({0, -1, 0}), aslant = at({.5, -.6, -.3});
        for (std::size_t c = 0; c < 3; ++c) CHECK(above[c] == near(double(aslant[c]), 1e-4));
    }

    TEST_CASE("any number of threads gives the same bits, by every solver") {
        const auto scene = compiled(mixedRoom());
        for (const char* solver : {"gauss-seidel", "jacobi", "direct", "shoot", "hierarchical", "stochastic"}) {
            CAPTURE(std::string(solver));
            const std::string text = fmt::format("patches=200,solver={},rays=256,light-rays=16", solver);
            const Solved one = solved(*scene, text, 1, 1), three = solved(*scene, text, 1, 3);
            REQUIRE(one.solution.terms.size() == three.solution.terms.size());
            for (std::size_t k = 0; k < one.solution.terms.size(); ++k) CHECK(one.solution.terms[k] == three.solution.terms[k]);
        }
    }

    TEST_CASE("layers by bounce add up; kinds of light cannot be parted") {
        const auto scene = compiled(mixedRoom());
        const CameraDesc camera = recentred(*scene, perspective({0, 0, .49}, {0, -.1, -.5}, 1.5));
        Bench bench(*scene, camera, {8, 8, 16});
        const auto render = [&](const PathClasses& classes) {
            FilmLayout layout = bench.layout();
            layout.layers = classes.layerNames();
            auto film = std::make_unique<Film>(layout);
            const Job job{{*scene, classes, bench.view.shutter, 0, SamplerKind::sobol, bench.run, bench.stop, bench.progress, bench.notes},
                          bench.view};
            const IntegratorChoice i = chooseIntegrator("radiosity:patches=200,solver=jacobi,tolerance=1e-9");
            chiaro::render(job, *i.entry->make(i.options), *film, {16, infinity}, bench.stop);
            return film;
        };
        PathQuery bounces;
        bounces.split = "bounces";
        const auto split = render(PathClasses::make(bounces)), whole = render(PathClasses());
        const Pixel p{4, 5};
        Spectrum sum(0);
        for (int l = 0; l < int(split->layout().layers.size()); ++l) sum += split->mean(p, l);
        CHECK(sum[0] == near(double(whole->mean(p)[0]), 1e-4));
        CHECK(split->mean(p, 2)[0] > 0);
        CHECK(split->mean(p, 3)[0] > 0);
        PathQuery one;
        one.paths = "La D+ E";
        CHECK_THROWS_WITH_AS(render(PathClasses::make(one)), doctest::Contains("write L for La"), Error);
    }
} // TEST_SUITE
