// The same light paths by the path tracer: to rounding where nothing is drawn by lot, statistically elsewhere, over the built-in scenes and
// those of ../shared/scenes where they exist.
#include "io/gltf.h"
#include "io/image_read.h"
#include "scenes/builtin.h"
#include "tests/render/whitted_kit.h"
#include <cstdio>
#include <filesystem>

using namespace chiaro;
using namespace chiaro::test;
namespace fs = std::filesystem;

namespace {

PathClasses covered(const std::string& integrator) {
    const IntegratorChoice choice = chooseIntegrator(integrator), path = chooseIntegrator("path");
    PathQuery q;
    q.within = choice.entry->traits(choice.options).covers;
    q.without = path.entry->traits(path.options).misses;
    return PathClasses::make(q);
}
std::unique_ptr<Film> film(const Scene& scene, const std::string& integrator, const PathClasses& classes, Settings how) {
    Bench bench(scene, scene.cameras()[0], how);
    bench.classes = classes;
    auto f = std::make_unique<Film>(bench.layout());
    bench.render(*f, integrator);
    CHECK(f->dropped() == 0);
    return f;
}
// Means of the picture from replicates with seeds of their own: a two-sample t-test, which must see a relative bias of `resolution`; where
// that is 1, only that nothing contradicts: few samples find the lamps there.
void checkAgrees(const Scene& scene, const std::string& integrator, uint32_t spp, double resolution) {
    const PathClasses classes = covered(integrator);
    constexpr int n = 12;
    double mean[2] = {}, square[2] = {};
    for (int side = 0; side < 2; ++side)
        for (int r = 0; r < n; ++r) {
            Settings how{32, 24, spp};
            how.seed = uint64_t(1000 * side + r);
            const double m = film(scene, side ? "path" : integrator, classes, how)->meanLuminance().value;
            mean[side] += m / n;
            square[side] += m * m / n;
        }
    double error = 0;
    for (int side = 0; side < 2; ++side) error += std::max(0., square[side] - mean[side] * mean[side]) / (n - 1);
    error = std::sqrt(error);
    INFO(integrator << ": " << mean[0] << ", path " << mean[1] << " +- " << error);
    CHECK(std::fabs(mean[0] - mean[1]) <= 5.5 * error + 2e-5 * mean[1]);
    if (resolution < 1) CHECK(5.5 * error <= resolution * mean[1]);
}

std::unique_ptr<const Scene> shared(const std::string& name) {
    for (const char* file : {"scene.gltf", "scene.glb"}) {
        const fs::path at = fs::path("../shared/scenes") / name / file;
        if (!fs::exists(at)) continue;
        Diagnostics notes;
        return Scene::compile(readGltf(at, {}, notes), notes, {}, nullptr, ClosureTable::make);
    }
    std::printf("SKIPPED: ../shared/scenes/%s is not here\n", name.c_str());
    return nullptr;
}

// A room of mirrors, matt walls and one lamp without size: nothing is left to chance.
SceneDesc room() {
    SceneDesc s;
    const int white = shapes::add(s, shapes::diffuse("white", {.7f, .6f, .5f})),
              mirror = shapes::add(s, shapes::metal("mirror", {.9f, .8f, .7f}, 0));
    const int gloss = shapes::add(s, shapes::metal("gloss", {.8f, .8f, .9f}, .4f));
    shapes::add(s, "room", shapes::insideOut(shapes::box({1, 1, 1})), white);
    shapes::add(s, "ball", shapes::sphere(.3, 4), mirror, shapes::translation({.4, -.7, .2}));
    shapes::add(s, "mirror", plate({-.9, 0, 0}, {1, 0, .2}, .6), mirror);
    shapes::add(s, "block", shapes::box({.2, .3, .15}), gloss, shapes::translation({-.3, -.7, -.3}));
    s.lights.push_back(pointLight({.2, .8, .1}, {3, 2, 1}));
    shapes::addCamera(s, "main", 1.2, shapes::lookAt({0, 0, .95}, {0, -.2, -1}));
    return s;
}

} // namespace

TEST_SUITE("whitted-agree") {

    TEST_CASE("one lamp and mirrors: every pixel equals the path tracer's to rounding") {
        const auto scene = compiled(room());
        for (const char* how : {"whitted:min-weight=0", "whitted:min-weight=0,shadows=opaque", "whitted:min-weight=0,area=sample"}) {
            CAPTURE(how);
            PathQuery q;
            q.within = "Ld (D|G) S* E";
            q.maxDepth = 6;
            const PathClasses classes = PathClasses::make(q);
            const auto w = film(*scene, how, classes, {48, 48, 4}), p = film(*scene, "path:rr-depth=100", classes, {48, 48, 4});
            double worst = 0, sum = 0;
            int differing = 0;
            for (uint32_t i = 0; i < 48 * 48; ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    const double a = w->mean({i % 48, i / 48})[c], b = p->mean({i % 48, i / 48})[c];
                    sum += b / (48 * 48 * 3);
                    const double d = std::fabs(a - b) / std::max(b, .01);
                    worst = std::max(worst, d);
                    differing += d > 1e-5;
                }
            CHECK(sum > .05);
            CAPTURE(worst);
            CHECK(differing == 0);
        }
    }

    TEST_CASE("built-in scenes") {
        for (const auto& [name, centre, sample] : {std::tuple{"@cornell", .1, .05},
                                                   {"@cornell-spheres", .1, .1},
                                                   {"@veach-mis", 1., 1.},
                                                   {"@furnace", .01, .01},
                                                   {"@caustic", 1., .1}}) {
            CAPTURE(name);
            const auto scene = compiled(findBuiltin(name)->make());
            checkAgrees(*scene, "whitted", 16, centre);
            checkAgrees(*scene, "whitted:area=sample", 32, sample);
        }
    }

    TEST_CASE("scenes of glTF files") {
        for (const auto& [name, centre, sample] : {std::tuple{"light-zoo", .15, .2},
                                                   {"cornell-spheres", .15, .15},
                                                   {"punctual-lamp", .2, .2},
                                                   {"glossy-room", 1., .15},
                                                   {"plates-mis", 1., 1.}}) {
            CAPTURE(name);
            const auto scene = shared(name);
            if (!scene) continue;
            checkAgrees(*scene, "whitted", 8, centre);
            checkAgrees(*scene, "whitted:area=sample", 16, sample);
        }
    }

    TEST_CASE("what a variant bends is not covered") {
        const auto covers = [](const std::string& how) {
            const IntegratorChoice c = chooseIntegrator(how);
            return c.entry->traits(c.options).covers;
        };
        CHECK(covers("whitted") == "Ld (D|G) S* E | (La|Le) S* E");
        CHECK(covers("whitted:area=sample") == "L (D|G) S* E | (La|Le) S* E");
        CHECK(covers("whitted:shadows=none") == "(La|Le) S* E");
        CHECK(covers("whitted:fresnel=schlick") == "Ld (D|G) E | (La|Le) E");
        CHECK(covers("whitted:transparency=interpolated") == "Ld D E | (La|Le) E");
        CHECK(covers("whitted:transparency=filtered") == "(La|Le) E");
        CHECK(covers("whitted:attenuation=classic,area=sample") == "(La|Le) (D|G) S* E | (La|Le) S* E");
        CHECK(covers("whitted:ray-falloff=on") == "Le E");
        const IntegratorChoice exact = chooseIntegrator("whitted:area=sample,shadows=opaque");
        CHECK(exact.entry->traits(exact.options).unbiased);
        CHECK_FALSE(exact.entry->traits(Options(exact.entry->options)).unbiased);
    }

} // TEST_SUITE
