// Photon mapping as a picture: rooms with known answers, the path tracer on the paths that both see (G9), caustics that only light paths
// find, nothing counted twice, layers that sum, the same bits however it is run; the pre-pass in distributed ray tracing.
#include "core/render/archive.h"
#include "core/render/prepass.h"
#include "integrators/photon_field.h"
#include "scenes/builtin.h"
#include "tests/render/measure.h"
#include "tests/statistics.h"
#include <numbers>
#include <sstream>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr const char* unseen = "Ld S+ (D|G) .* E"; // by path
const CameraDesc inside = perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2);

// A closed ball of facets that glows: every point of it sees the same.
std::unique_ptr<const Scene> glowingBall(float rho) {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 3));
    shell.normals.clear();
    shapes::add(s, "wall", std::move(shell), shapes::add(s, shapes::lamp("wall", Spectrum(1), Spectrum(rho))));
    return compiled(std::move(s));
}

Affine facingDown(double x, double y, double z) { return shapes::translation({x, y, z}) * rotation({1, 0, 0}, pi64 / 2); }

// A room's corner with a ball of glass, one of polished plastic and a brushed one, under a lamp or a bulb.
SceneDesc corner(bool lamp, bool bulb, bool smoothShaded = true) {
    SceneDesc s;
    const int grey = shapes::add(s, shapes::diffuse("grey", {.7f, .6f, .5f}));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 1.5), grey);
    shapes::add(s, "wall", plate({0, 1, -1}, {0, 0, 1}, 1.5), shapes::add(s, shapes::diffuse("red", {.8f, .3f, .2f})));
    const auto ball = [&](const char* name, MaterialDesc m, double r, double x, double z) {
        PrimitiveDesc shape = shapes::sphere(r, 3);
        if (!smoothShaded) shape.normals.clear();
        shapes::add(s, name, std::move(shape), shapes::add(s, std::move(m)), shapes::translation({x, r, z}));
    };
    ball("glass", shapes::glass("glass", 1.5f), .3, -.4, .3);
    MaterialDesc plastic;
    plastic.name = "plastic";
    plastic.metallic = 0;
    plastic.baseColor = {.2f, .5f, .8f};
    plastic.roughness = .1f; // sharp
    ball("plastic", plastic, .3, .4, .2);
    ball("brushed", shapes::metal("brushed", {.9f, .8f, .5f}, .5f), .25, 0, -.4);
    if (lamp) shapes::add(s, "lamp", square(.3), shapes::add(s, shapes::lamp("lamp", Spectrum(8))), facingDown(.2, 1.8, .4));
    if (bulb) {
        PunctualDesc light;
        light.intensity = {1, 2, 3};
        light.toWorld = shapes::translation({-.3, 1.6, .5});
        s.lights = {light};
    }
    return s;
}
const CameraDesc view = perspective({.1, .9, 2.6}, {0, .35, 0}, .75);

// A resting camera in the space of the compiled scene.
CameraDesc local(const Scene& scene, CameraDesc camera) {
    const Vec3d c = scene.centre();
    for (int i = 0; i < 3; ++i) camera.toWorld.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
    return camera;
}
// Replicates of the mean picture under a query.
stats::Moments replicate(const Scene& scene, CameraDesc camera, Settings how, const std::string& integrator, const PathQuery& query,
                         uint64_t first, int n = replicates) {
    camera = local(scene, camera);
    const IntegratorChoice choice = chooseIntegrator(integrator);
    stats::Moments m;
    for (int r = 0; r < n; ++r) {
        how.seed = first * 1000 + uint64_t(r);
        Bench bench(scene, camera, how);
        bench.classes = PathClasses::make(query);
        FilmLayout layout = bench.layout();
        layout.splats = choice.entry->traits(choice.options).splats;
        Film film(layout);
        bench.render(film, integrator);
        CHECK(film.dropped() == 0);
        m.add(film.meanLuminance().value);
    }
    return m;
}
// Linear in the radius at edges: 2 L(h/2) - L(h) has no such part left, and of the quadratic one half of it with the other sign.
stats::Moments extrapolated(const stats::Moments& whole, const stats::Moments& half) {
    stats::Moments m = half;
    m.mean = 2 * half.mean - whole.mean;
    return m;
}
void checkSame(const stats::Moments& a, double errorOfA, const stats::Moments& b, double resolution, double bias) {
    const double error = std::hypot(errorOfA, b.error());
    INFO("" << a.mean << " +- " << errorOfA << ", path " << b.mean << " +- " << b.error());
    CHECK(std::fabs(a.mean - b.mean) <= criticalT * error + bias * b.mean);
    CHECK(criticalT * error <= resolution * b.mean);
}
PathQuery without(const std::string& paths, uint32_t depth = unlimitedDepth) {
    PathQuery q;
    q.without = paths;
    q.maxDepth = depth;
    return q;
}

} // namespace

TEST_SUITE("photon-rooms") {
    TEST_CASE("integrating sphere: 1 / (1 - rho) and its partial sums by depth; direct light once (F1)") {
        for (const float rho : {.5f, .8f}) {
            const auto scene = glowingBall(rho);
            for (const char* how :
                 {"photon:count=4k,radius=0.1,gather=0", "photon:count=4k,radius=0.1,gather=1", "photon:count=4k,radius=0.1,gather=3",
                  "photon:count=4k,gather=0,estimate=knn,k=40,radius=0.2", "sppm:count=2k,radius=0.1"})
                for (const uint32_t depth : {1u, 2u, unlimitedDepth}) {
                    CAPTURE(rho);
                    CAPTURE(how);
                    CAPTURE(depth);
                    const double r = double(rho);
                    const double expected = depth == unlimitedDepth ? 1 / (1 - r) : (1 - std::pow(r, depth + 1.)) / (1 - r);
                    // Facets bend: a disc about a point holds a little more of the ball than of a plane.
                    checkEqual(measure(*scene, inside, {12, 12, 32, {}, 2, 0, SamplerKind::sobol, FilterKind::box, depth}, how), expected,
                               0.03, 4e-3);
                }
        }
    }
    TEST_CASE("a lamp without extent, off the centre of a ball: indirect light is even (F3)") {
        SceneDesc s;
        PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 4));
        shell.normals.clear();
        shapes::add(s, "wall", std::move(shell), shapes::add(s, shapes::diffuse("wall", Spectrum(.5f))));
        PunctualDesc bulb;
        bulb.toWorld = shapes::translation({0, .5, 0});
        s.lights = {bulb};
        const auto scene = compiled(std::move(s));
        for (const char* how : {"photon:count=8k,radius=0.08", "photon:count=8k,radius=0.08,gather=0", "sppm:count=2k,radius=0.08"}) {
            CAPTURE(how);
            const Settings few{12, 12, 64, {}, 2};
            checkEqual(measure(*scene, probe({.01, -.999, .012}, {0, -1, 0}, .3, .25), few, how), .2298905, 0.07, 1.2e-2);
        }
    }
}

TEST_SUITE("photon-and-path") {
    TEST_CASE("as the radius shrinks: path, on a scene of every kind of lobe (G9)") {
        const auto scene = compiled(corner(true, false));
        const Settings how{16, 12, 16, {}, 2, 0, SamplerKind::sobol, FilterKind::box};
        Settings reference = how;
        reference.spp = 256;
        const stats::Moments path = replicate(*scene, view, reference, "path", without(unseen), 1);
        uint64_t seed = 2;
        for (const std::string base :
             {"photon:gather=2,count=8k,caustic-count=16k,radius=0.06,caustic-radius=0.03",
              "photon:gather=0,count=8k,caustic-count=16k,radius=0.06,caustic-radius=0.03",
              "photon:gather=1,sharp=0,count=8k,caustic-count=16k,radius=0.06,caustic-radius=0.03", "sppm:radius=0.06"}) {
            CAPTURE(base);
            const stats::Moments whole = replicate(*scene, view, how, base, without(unseen), seed++);
            const stats::Moments half = replicate(*scene, view, how, base + ",shrink=0.5", without(unseen), seed++);
            INFO("at h " << whole.mean << " +- " << whole.error() << ", at h/2 " << half.mean << " +- " << half.error());
            checkSame(extrapolated(whole, half), std::hypot(2 * half.error(), whole.error()), path, 0.12, 2e-3);
        }
    }
    TEST_CASE("direct light is the path tracer's: shadow rays, lobes and lamps in mirrors") {
        const auto scene = compiled(corner(true, true));
        const Settings how{16, 12, 64, {}, 2, 0, SamplerKind::sobol, FilterKind::box};
        PathQuery direct = without(unseen, 4);
        direct.paths = "L (D|G)? S* E"; // none of it from photons
        uint64_t seed = 20;
        for (const char* other : {"photon:gather=0,count=1k,caustic-count=1k", "photon:gather=3,count=1k,caustic-count=1k"})
            for (const char* sharp : {",sharp=0", ",sharp=0.3"}) {
                CAPTURE(other);
                CAPTURE(sharp);
                const stats::Moments same = replicate(*scene, view, how, "path", direct, seed);
                const stats::Moments m = replicate(*scene, view, how, std::string(other) + sharp, direct, seed + 1);
                seed += 2;
                checkSame(m, m.error(), same, 0.05, 0);
            }
    }
}

TEST_SUITE("photon-caustics") {
    TEST_CASE("a bulb above a glass ball: photon, sppm and light agree, path sees nothing") {
        SceneDesc s;
        shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 1.2), shapes::add(s, shapes::diffuse("floor", Spectrum(.8f))));
        shapes::add(s, "ball", shapes::sphere(.3, 4), shapes::add(s, shapes::glass("glass", 1.5f)), shapes::translation({0, .5, 0}));
        PunctualDesc bulb;
        bulb.intensity = Spectrum(3);
        bulb.toWorld = shapes::translation({.1, 2, 0});
        s.lights = {bulb};
        const auto scene = compiled(std::move(s));
        // From the side and below the ball: the floor is seen directly, and every piece of it counts the same, blurred or not.
        const CameraDesc camera = probe({0, 0, 0}, {0, -.2, -1}, 1.5, .2);
        const Settings how{16, 16, 64, {}, 2, 0, SamplerKind::sobol, FilterKind::box};
        PathQuery caustic;
        caustic.paths = "L S+ D E";
        Settings many = how;
        many.spp = 256;
        const stats::Moments light = replicate(*scene, camera, many, "light", caustic, 1);
        CHECK(replicate(*scene, camera, how, "path", caustic, 2).mean == 0);
        // The replicates of two radii share their photons, so that the extrapolated ones are hardly noisier than one radius; there is no
        // edge near, and the bias goes with its square.
        uint64_t seed = 3;
        for (const std::string other :
             {"photon:count=1k,caustic-count=64k,caustic-radius=0.06", "photon:gather=0,count=1k,caustic-count=64k,caustic-radius=0.06",
              "sppm:radius=0.06,count=1k,caustic-count=8k"}) {
            CAPTURE(other);
            stats::Moments limit;
            for (uint64_t r = 0; r < replicates; ++r) {
                double at0 = 0;
                for (const auto& [shrink, weight] : {std::pair{"1", -1. / 3}, {"0.5", 4. / 3}}) {
                    Settings one = how;
                    one.seed = seed * 1000 + r;
                    Bench bench(*scene, local(*scene, camera), one);
                    bench.classes = PathClasses::make(caustic);
                    Film film(bench.layout());
                    bench.render(film, other + ",shrink=" + shrink);
                    at0 += weight * film.meanLuminance().value;
                }
                limit.add(at0);
            }
            ++seed;
            checkSame(limit, limit.error(), light, 0.08, 0);
        }
        // The nearest ones: blurred by as much as they lie apart.
        const stats::Moments m =
            replicate(*scene, camera, how, "photon:estimate=knn,k=60,count=1k,caustic-count=6k,caustic-radius=0.2", caustic, seed);
        checkSame(m, m.error(), light, 0.08, 2e-2);
    }
    TEST_CASE("the focus of a ball lens holds the energy that optics says (@caustic, G7)") {
        SceneDesc desc = findBuiltin("@caustic")->make();
        const auto scene = compiled(std::move(desc));
        const CameraDesc focus = scene->cameras()[1];
        REQUIRE(focus.name == "focus");
        const Settings how{16, 16, 64, {}, 2, 0, SamplerKind::sobol, FilterKind::box, 3};
        for (const char* name : {"photon:count=1k,caustic-count=32k,caustic-radius=0.0004",
                                 "photon:gather=0,count=1k,caustic-count=32k,caustic-radius=0.0004", "sppm:radius=0.0006"}) {
            CAPTURE(name);
            stats::Moments m;
            for (int r = 0; r < replicates; ++r) {
                Settings one = how;
                one.spp = 4;
                one.seed = uint64_t(r);
                m.add(rendered(*scene, focus, one, name).film->meanLuminance().value);
            }
            INFO("" << m.mean << " +- " << m.error());
            CHECK(std::fabs(m.mean - 14.21) <= criticalT * m.error() + 0.01 * 14.21);
            CHECK(criticalT * m.error() < 0.05 * 14.21);
        }
    }
}

TEST_SUITE("photon-classes") {
    TEST_CASE("the layers of a split sum to the picture; a mask shows its layer") {
        const auto scene = compiled(corner(true, true));
        const Settings how{12, 9, 8, {}, 2, 3};
        CameraDesc camera = view;
        const Vec3d c = scene->centre();
        for (int i = 0; i < 3; ++i) camera.toWorld.m[i][3] -= i == 0 ? c.x : i == 1 ? c.y : c.z;
        for (const char* name : {"photon:gather=2", "photon:gather=0", "sppm"})
            for (const char* split : {"bounces", "caustic=L S+ D E,direct=L D S* E,rest"}) {
                CAPTURE(name);
                CAPTURE(split);
                PathQuery q;
                q.split = split;
                q.maxDepth = 10;
                Bench bench(*scene, camera, how);
                bench.classes = PathClasses::make(q);
                FilmLayout layout = bench.layout();
                layout.layers = bench.classes.layerNames();
                Film film(layout);
                bench.render(film, name);
                double worst = 0, caustic = 0;
                for (uint32_t y = 0; y < how.height; ++y)
                    for (uint32_t x = 0; x < how.width; ++x) {
                        Spectrum sum(0);
                        for (int l = 0; l < int(layout.layers.size()); ++l) sum += film.mean({x, y}, l);
                        worst = std::max(worst, std::fabs(double(luminance(sum)) - double(luminance(film.mean({x, y})))));
                        if (std::string(split) != "bounces") caustic += double(luminance(film.mean({x, y}, 1)));
                    }
                CHECK(worst < 1e-5);
                if (std::string(split) == "bounces") continue;
                CHECK(caustic > 0);
                PathQuery alone;
                alone.paths = "L S+ D E";
                alone.maxDepth = 10;
                Bench masked(*scene, camera, how);
                masked.classes = PathClasses::make(alone);
                Film only(masked.layout());
                masked.render(only, name);
                double sum = 0;
                for (uint32_t y = 0; y < how.height; ++y)
                    for (uint32_t x = 0; x < how.width; ++x) sum += double(luminance(only.mean({x, y})));
                CHECK(sum == Approx(caustic).epsilon(0.1)); // other radii, other dice
            }
    }
    TEST_CASE("the depth limit is the path tracer's") {
        const auto scene = glowingBall(.7f);
        for (const uint32_t depth : {0u, 1u})
            for (const char* name : {"photon", "photon:gather=0", "sppm"}) {
                const Settings how{8, 8, 4, {}, 1, 0, SamplerKind::sobol, FilterKind::box, depth};
                CHECK(double(rendered(*scene, inside, how, name).mean[1]) ==
                      Approx(depth == 0 ? 1 : 1.7).epsilon(depth == 0 ? 1e-6 : 0.02));
            }
    }
}

TEST_SUITE("photon-bits") {
    TEST_CASE("the same bits for any number of threads and any cut into passes") {
        const auto scene = compiled(corner(true, true));
        for (const std::string name : {"photon:gather=5", "photon:gather=0,estimate=knn"}) {
            Settings how{19, 14, 4, {2, 1, 18, 13}, 1, 7, SamplerKind::sobol, FilterKind::blackmanHarris};
            const Rendering one = rendered(*scene, view, how, name);
            for (const unsigned threads : {2u, 5u}) {
                how.threads = threads;
                CHECK(samePicture(*one.film, *rendered(*scene, view, how, name).film));
            }
            how.spp = 1;
            Bench bench(*scene, view, how);
            Film film(bench.layout());
            bench.render(film, name);
            bench.settings.spp = 4;
            bench.render(film, name);
            CHECK(samePicture(*one.film, film));
        }
    }
    TEST_CASE("a stop while photons are traced ends in an empty film, not in a crash") {
        const auto scene = compiled(corner(true, false));
        Bench bench(*scene, view, {8, 8, 4});
        bench.stop.request();
        for (const char* name : {"photon", "sppm"}) {
            Film film(bench.layout());
            bench.render(film, name);
            CHECK(film.done() == 0);
        }
    }
    TEST_CASE("what the lookups found is kept for the photon layer") {
        const auto scene = glowingBall(.5f);
        for (const char* name : {"photon:gather=0,radius=0.1,kernel=constant", "sppm:radius=0.1"}) {
            Bench bench(*scene, inside, {8, 8, 1});
            FilmLayout layout = bench.layout();
            layout.photons = true;
            Film film(layout);
            bench.render(film, name);
            const Gathered g = film.gathered({4, 4});
            CHECK(g.radius == Approx(.1));
            CHECK(g.count > 0);
            CHECK(double(g.density) == Approx(double(g.count) / (pi64 * .01)).epsilon(1e-4));
        }
    }
}

TEST_SUITE("photon-prepass") {
    TEST_CASE("distributed with photons is 1 / (1 - rho); its solution goes to a file and comes back with the same bits") {
        const auto scene = glowingBall(.5f);
        const PrepassChoice choice = choosePrepass("photon:radius=0.06,count=100k");
        CHECK(choice.entry->field(choice.options) == "L (D|G|S)+ D");
        const auto field = choice.entry->make(choice.options);
        Bench bench(*scene, inside, {16, 16, 16, {}, 2});
        field->solve(bench.job);
        CHECK(bench.notes.facts().size() == 2); // what was chosen, and where the light went
        const Job with{bench.job, bench.view, field.get()};
        const IntegratorChoice distributed = chooseIntegrator("distributed");
        const auto picture = [&](const Job& job) {
            auto film = std::make_unique<Film>(bench.layout());
            chiaro::render(job, *distributed.entry->make(distributed.options), *film, {16, infinity}, bench.stop);
            return film;
        };
        const auto film = picture(with);
        CHECK(film->meanLuminance().value == Approx(2).epsilon(0.015)); // and not 2.5: direct light is not in it twice

        std::stringstream file;
        Writer writer(file);
        field->save(writer);
        const std::string bytes = file.str();
        const auto again = choice.entry->make(choice.options);
        std::istringstream from(bytes);
        Reader reader(from, "photons", bytes.size());
        again->load(bench.job, reader);
        CHECK(reader.left() == 0);
        CHECK(samePicture(*film, *picture({bench.job, bench.view, again.get()})));
        std::istringstream cut(bytes.substr(0, bytes.size() / 2));
        Reader half(cut, "photons", bytes.size() / 2);
        CHECK_THROWS_AS(again->load(bench.job, half), Error);
    }
}
