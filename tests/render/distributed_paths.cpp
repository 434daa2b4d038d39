// The tree of distributed ray tracing against the path tracer on the light paths that both see; splitting, replay and bounds.
#include "core/render/path_log.h"
#include "scenes/builtin.h"
#include "tests/render/measure.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

// The mean of independent replicates on the light paths that the integrator covers.
Measured restricted(const Scene& scene, const Settings& s, const std::string& integrator, const Traits& traits) {
    PathQuery query;
    query.paths = "L .+ E"; // the edges of lamps in view would be most of the noise
    query.within = traits.covers;
    query.without = "Ld S+ (D|G) .* E | Ld S+ E";
    query.maxDepth = s.maxDepth;
    return overReplicates([&](int r) {
        Settings replicate = s;
        replicate.seed = s.seed * 1000 + uint64_t(r);
        Bench bench(scene, scene.cameras()[0], replicate);
        bench.classes = PathClasses::make(query);
        Film film(bench.layout());
        bench.render(film, integrator);
        CHECK(film.dropped() == 0);
        return film.meanLuminance().value;
    });
}
Traits traitsOf(const std::string& integrator) {
    const IntegratorChoice choice = chooseIntegrator(integrator);
    return choice.entry->traits(choice.options);
}
void checkSame(const Measured& a, const Measured& b, double resolution) {
    INFO(a.value << " +- " << a.error << " against " << b.value << " +- " << b.error);
    CHECK(std::fabs(a.value - b.value) <= criticalT * std::hypot(a.error, b.error) + 2e-5 * b.value);
    CHECK(criticalT * std::hypot(a.error, b.error) <= resolution * b.value);
}
std::unique_ptr<const Scene> builtin(const char* name) { return compiled(findBuiltin(name)->make()); }

// Matt, coated, brushed and frosted things between a lamp and a point light.
SceneDesc table() {
    SceneDesc s;
    const int floor = shapes::add(s, shapes::diffuse("floor", Spectrum(0.6f)));
    MaterialDesc coated = shapes::diffuse("coated", {.7f, .3f, .2f});
    coated.specular = 1;
    coated.roughness = 0.3f;
    MaterialDesc frosted = shapes::glass("frosted", 1.5f);
    frosted.roughness = 0.4f;
    const int coat = shapes::add(s, coated), brushed = shapes::add(s, shapes::metal("brushed", {.9f, .7f, .4f}, 0.4f));
    const int frost = shapes::add(s, frosted), mirror = shapes::add(s, shapes::metal("mirror", Spectrum(.9f), 0));
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(5)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 5), floor);
    shapes::add(s, "wall", plate({0, 0, -3}, {0, 0, 1}, 5), mirror);
    shapes::add(s, "coated", shapes::sphere(0.6, 4), coat, shapes::translation({-1.4, 0.6, 0}));
    shapes::add(s, "brushed", shapes::sphere(0.6, 4), brushed, shapes::translation({0, 0.6, 0}));
    shapes::add(s, "frosted", shapes::sphere(0.6, 4), frost, shapes::translation({1.4, 0.6, 0}));
    shapes::add(s, "lamp", plate({1, 4, 1}, {0, -1, 0}, 0.7), lamp);
    PunctualDesc point;
    point.intensity = Spectrum(6);
    point.toWorld = shapes::translation({-2, 3, 2});
    s.lights.push_back(point);
    shapes::addCamera(s, "main", 0.7, shapes::lookAt({0, 2, 6}, {0, 0.5, 0}));
    return s;
}

} // namespace

TEST_SUITE("distributed-paths") {

    TEST_CASE("the path tracer on the same paths: a matt room, mirror and glass, and every gloss") {
        struct Row {
            const char* scene;
            uint32_t spp;
            double resolution;
        };
        for (const Row& row : {Row{"@cornell", 8, 0.02}, {"@cornell-spheres", 32, 0.08}}) {
            CAPTURE(row.scene);
            const auto scene = builtin(row.scene);
            const Settings how{24, 24, row.spp};
            checkSame(restricted(*scene, how, "distributed", traitsOf("distributed")),
                      restricted(*scene, how, "path", traitsOf("distributed")), row.resolution);
        }
    }

    TEST_CASE("lamps of every size in plates of every gloss: light and lobe samples count together once") {
        for (const float roughness : {0.1f, 0.3f, 0.7f})
            for (const double radius : {0.02, 0.2, 0.8}) {
                CAPTURE(roughness);
                CAPTURE(radius);
                SceneDesc s;
                MaterialDesc coated = shapes::diffuse("coated", Spectrum(0.1f)); // beside the highlight and inside it
                coated.specular = 1;
                coated.roughness = roughness;
                const int plastic = shapes::add(s, coated),
                          lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1 / float(radius * radius))));
                shapes::add(s, "plate", plate({0, 0, 0}, {0, 1, 0}, 1), plastic);
                shapes::add(s, "lamp", shapes::sphere(radius, 3), lamp, shapes::translation({-1.05, 1.5, 0}));
                const auto scene = compiled(std::move(s));
                const CameraDesc camera = probe({0, 0, 0}, {-1, -1.5, 0});
                Settings how{16, 16, 256, {}, 2};
                how.maxDepth = 1;
                const Measured path = measure(*scene, camera, how, "path");
                checkSame(measure(*scene, camera, how, "distributed:light-samples=1,glossy-samples=1"), path, 0.05);
                how.spp = 64;
                checkSame(measure(*scene, camera, how, "distributed:light-samples=3,glossy-samples=8"), path, 0.05);
            }
    }

    TEST_CASE("every switch leaves its paths out and nothing else") {
        const auto scene = compiled(table());
        for (const std::string name : {"distributed", "distributed:gloss=off", "distributed:translucency=off"}) {
            CAPTURE(name);
            const Settings how{16, 16, 48};
            checkSame(restricted(*scene, how, name, traitsOf(name)), restricted(*scene, how, "path", traitsOf(name)), 0.05);
        }
    }

    TEST_CASE("splitting does not change the mean, however it decays") {
        const auto scene = compiled(table());
        const Settings how{16, 16, 48};
        const Measured path = restricted(*scene, how, "path", traitsOf("distributed"));
        for (const char* n : {"light-samples=1,glossy-samples=1", "light-samples=4,glossy-samples=16,split-decay=2",
                              "light-samples=16,glossy-samples=3,split-decay=1", "min-weight=1"}) {
            CAPTURE(n);
            checkSame(restricted(*scene, how, "distributed:" + std::string(n), traitsOf("distributed")), path, 0.05);
        }
    }

    TEST_CASE("depth limits cut the tree where they cut the path") {
        const auto scene = compiled(table());
        for (const uint32_t depth : {1u, 2u, 3u}) {
            CAPTURE(depth);
            Settings how{16, 16, 32};
            how.maxDepth = depth;
            checkSame(restricted(*scene, how, "distributed", traitsOf("distributed")),
                      restricted(*scene, how, "path", traitsOf("distributed")), 0.04);
        }
    }

    TEST_CASE("the same bits for any number of threads") {
        const auto scene = compiled(table());
        const auto picture = [&](unsigned threads) {
            Settings s{40, 40, 4};
            s.threads = threads;
            return rendered(*scene, scene->cameras()[0], s, "distributed:light-samples=16");
        };
        CHECK(samePicture(*picture(1).film, *picture(3).film));
    }

    TEST_CASE("the log of a sample sums to the sample, and knows its parents") {
        const auto scene = compiled(table());
        Bench bench(*scene, scene->cameras()[0], {32, 32, 1});
        const IntegratorChoice choice = chooseIntegrator("distributed:ambient=0.1");
        const auto integrator = choice.entry->make(choice.options);
        const auto& camera = dynamic_cast<const CameraIntegrator&>(*integrator);
        for (uint32_t i = 0; i < 32; ++i) {
            PathStart start = startPixel(bench.job, {i, 31 - i / 2}, i), again = start;
            Outputs out(bench.layout()), silent(bench.layout());
            PathLog log;
            out.log = &log;
            camera.radiance(bench.job, start, out);
            camera.radiance(bench.job, again, silent);
            CHECK(out.total() == silent.total());
            CHECK(out.rays == silent.rays);
            Spectrum sum(0);
            uint32_t rays = 0;
            for (uint32_t v = 0; v < log.vertices().size(); ++v) {
                const PathLog::Vertex& vertex = log.vertices()[v];
                sum += vertex.contribution;
                if (vertex.blocked) CHECK(black(vertex.contribution));
                CHECK((v == 0) == (vertex.parent == PathLog::none));
                if (v > 0) CHECK(vertex.parent < v);
                ++rays;
            }
            CHECK(rays == out.rays + 1); // the first one was traced before
            for (std::size_t c = 0; c < 3; ++c) CHECK(sum[c] == doctest::Approx(out.total()[c]).epsilon(1e-4));
        }
    }

    TEST_CASE("trees that never lose light end all the same") {
        SceneDesc s;
        const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(1), 0)),
                  brushed = shapes::add(s, shapes::metal("brushed", Spectrum(1), .3f));
        const int glass = shapes::add(s, shapes::glass("glass", 1.5f)), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
        shapes::add(s, "room", shapes::insideOut(shapes::box({2, 2, 2})), mirror);
        shapes::add(s, "ball", shapes::sphere(0.5, 3), glass, shapes::translation({.7, 0, 0}));
        shapes::add(s, "brushed", shapes::sphere(0.5, 3), brushed, shapes::translation({-.7, 0, 0}));
        shapes::add(s, "lamp", plate({0, 1.9, 0}, {0, -1, 0}, 0.3), lamp);
        const auto scene = compiled(std::move(s));
        const Rendering r = rendered(*scene, perspective({0, 0, 1.8}, {0, 0, 0}, 1), {4, 4, 4},
                                     "distributed:glossy-samples=64,split-decay=1,min-weight=0.001");
        CHECK(r.film->dropped() == 0);
        CHECK(luminance(r.mean) > 0);
    }

} // TEST_SUITE
