// Photons: their energy (G1), their independence of threads, what is aimed at glass, and where a glass ball sends them (G6, G7, G8).
#include "integrators/emission_guide.h"
#include "integrators/photon_trace.h"
#include "tests/render/measure.h"
#include "tests/statistics.h"
#include "tests/work_kit.h"
#include <cstring>
#include <functional>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;

struct Tracer : Bare {
    explicit Tracer(const Scene& s, const PathQuery& query = {}, unsigned threads = 2, uint64_t seed = 0)
        : Bare(s, threads, seed, ~std::size_t(0), SamplerKind::sobol, query) {}
    TracedPhotons trace(uint64_t paths, const std::function<void(PhotonRequest&)>& change = {}) const {
        PhotonRequest request;
        request.paths = paths;
        if (change) change(request);
        return tracePhotons(work, request);
    }
};

double fluxOf(const TracedPhotons& t) {
    double sum = 0;
    for (const Photon& photon : t.photons) sum += double(luminance(photon.flux));
    return sum / double(t.statistics.paths);
}
void checkLedger(const PhotonStatistics& s) {
    CHECK(s.absorbed + s.escaped + s.ended == Approx(s.emitted).epsilon(1e-10));
    CHECK(s.rays >= s.stored);
}

Affine facingDown(double x, double y, double z) { return shapes::translation({x, y, z}) * rotation({1, 0, 0}, pi64 / 2); }
PunctualDesc bulb(float intensity, const Vec3d& place) {
    PunctualDesc l;
    l.intensity = Spectrum(intensity);
    l.toWorld = shapes::translation(place);
    return l;
}
// A floor, and something of everything that scatters over it.
SceneDesc table() {
    SceneDesc s;
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 2), shapes::add(s, shapes::diffuse("floor", {.7f, .5f, .3f})));
    MaterialDesc gloss;
    gloss.name = "gloss";
    gloss.baseColor = {.8f, .3f, .2f};
    gloss.metallic = .5f;
    gloss.roughness = .3f;
    shapes::add(s, "ball", shapes::sphere(.4, 2), shapes::add(s, gloss), shapes::translation({-.6, .5, 0}));
    MaterialDesc glass = shapes::glass("glass", 1.5f);
    glass.attenuationDistance = .5f;
    glass.attenuationColor = {.9f, .5f, .7f};
    shapes::add(s, "glass", shapes::sphere(.4, 3), shapes::add(s, glass), shapes::translation({.6, .7, .2}));
    return s;
}
SceneDesc lit() {
    SceneDesc s = table();
    shapes::add(s, "lamp", square(.4), shapes::add(s, shapes::lamp("lamp", Spectrum(8))), facingDown(.3, 2.2, .4));
    s.lights.push_back(bulb(2, {.5, 1.5, .5}));
    return s;
}

struct Source {
    std::string name;
    double power; // lumen; 0: what the scene says
    double exact; // relative
    std::function<void(SceneDesc&)> add;
};
std::vector<Source> lamps() {
    std::vector<Source> all;
    all.push_back({"point", 12 * pi64, 1e-6, [](SceneDesc& s) { s.lights.push_back(bulb(3, {.1, 1.5, .2})); }});
    all.push_back({"spot", .7426103318 * 2, 1e-6, [](SceneDesc& s) {
                       PunctualDesc l = bulb(2, {});
                       l.kind = PunctualKind::spot;
                       l.toWorld = shapes::lookAt({.2, 1.9, .1}, {.2, 0, .1}, {0, 0, 1});
                       l.innerCone = 20 * pi64 / 180;
                       l.outerCone = 40 * pi64 / 180;
                       s.lights.push_back(l);
                   }});
    all.push_back({"directional", 0, 1e-6, [](SceneDesc& s) {
                       PunctualDesc l = bulb(1e5f, {});
                       l.kind = PunctualKind::directional;
                       l.toWorld = shapes::lookAt({.5, 2, .3}, {0, 0, 0});
                       s.lights.push_back(l);
                   }});
    all.push_back({"mesh", pi64 * .64 * 8, 1e-6, [](SceneDesc& s) {
                       shapes::add(s, "lamp", square(.4), shapes::add(s, shapes::lamp("lamp", Spectrum(8))), facingDown(.3, 2.2, .4));
                   }});
    all.push_back({"textured", pi64 * .64 * 8 * .5, 2e-3, [](SceneDesc& s) {
                       const uint8_t texels[] = {255, 0, 0, 255};
                       MaterialDesc m = shapes::lamp("lamp", Spectrum(8));
                       m.emissionTexture.texture = addTexture(s, 2, 2, 1, texels);
                       s.textures.back().filter = TextureFilter::nearest;
                       shapes::add(s, "lamp", square(.4), shapes::add(s, m), facingDown(.3, 2.2, .4));
                   }});
    all.push_back({"environment", 0, 2e-3, [](SceneDesc& s) {
                       s.environment = environment(
                           16, 8, [](int x, int y) { return x == 3 && y == 2 ? Spectrum(100) : Spectrum(.1f * float(y < 4)); },
                           TextureFilter::nearest);
                   }});
    all.push_back({"moving", pi64 * .64 * 8, 1e-6, [](SceneDesc& s) {
                       shapes::add(s, "lamp", square(.4), shapes::add(s, shapes::lamp("lamp", Spectrum(8))), facingDown(.3, 2.2, .4));
                       s.instances.back().motion = {facingDown(.3, 2.2, .4), facingDown(-.3, 1.8, .2)};
                       s.shutter = {0, 1};
                   }});
    return all;
}

// A closed room of facets and reflectance rho with a bulb in it.
std::unique_ptr<const Scene> room(float rho) {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 2));
    shell.normals.clear();
    shapes::add(s, "wall", shell, shapes::add(s, shapes::diffuse("wall", Spectrum(rho))));
    s.lights.push_back(bulb(2, {.2, .1, -.3}));
    return compiled(std::move(s));
}
// A fine glass ball of radius 1 at the origin in light that falls straight down; a black floor below it, where there is one.
std::unique_ptr<const Scene> ballInSun(double floorHalf, double floorAt) {
    SceneDesc s;
    shapes::add(s, "ball", shapes::sphere(1, 7), shapes::add(s, shapes::glass("glass", 1.5f)));
    if (floorHalf > 0)
        shapes::add(s, "floor", plate({0, floorAt, 0}, {0, 1, 0}, floorHalf), shapes::add(s, shapes::diffuse("floor", Spectrum(.5f))));
    PunctualDesc sun = bulb(1, {});
    sun.kind = PunctualKind::directional;
    sun.toWorld = shapes::lookAt({0, 1, 0}, {0, 0, 0}, {0, 0, 1});
    s.lights.push_back(sun);
    return compiled(std::move(s));
}

} // namespace

TEST_SUITE("photon-energy") {
    TEST_CASE("every light emits exactly its power, and emitted = absorbed + escaped + ended (G1)") {
        for (const Source& lamp : lamps()) {
            CAPTURE(lamp.name);
            SceneDesc s = table();
            lamp.add(s);
            const auto scene = compiled(std::move(s));
            const TracedPhotons t = Tracer(*scene).trace(1 << 16);
            const double power = lamp.power > 0 ? lamp.power : scene->lights().power();
            CHECK(t.statistics.emitted == Approx(power).epsilon(lamp.exact));
            checkLedger(t.statistics);
            CHECK(t.statistics.absorbed > 0);
            CHECK(t.statistics.escaped > 0);
            CHECK(std::fabs(t.statistics.ended) < 0.01 * power); // roulette alone
            CHECK(t.statistics.stored == t.photons.size());
        }
    }

    TEST_CASE("a closed room stores Phi / (1 - rho), by kind and by bounce (G1)") {
        const double phi = 8 * pi64;
        for (const float rho : {0.5f, 0.8f}) {
            CAPTURE(rho);
            const auto scene = room(rho);
            const double r = double(rho);
            stats::Moments all, indirect;
            for (int seed = 0; seed < replicates; ++seed) {
                const Tracer tracer(*scene, {}, 2, uint64_t(seed));
                const TracedPhotons t = tracer.trace(4096);
                checkLedger(t.statistics);
                CHECK(t.statistics.escaped == 0);
                all.add(fluxOf(t));
                const TracedPhotons later = tracer.trace(4096, [](PhotonRequest& q) { q.kinds.direct = false; });
                indirect.add(fluxOf(later));
                const TracedPhotons direct = tracer.trace(4096, [](PhotonRequest& q) { q.kinds = {true, false, false}; });
                CHECK(fluxOf(direct) == Approx(phi).epsilon(1e-6));
                CHECK(direct.photons.size() == 4096);
                CHECK(direct.statistics.rays == 4096);
            }
            CHECK(std::fabs(all.mean - phi / (1 - r)) < criticalT * all.error() + 1e-5 * phi);
            CHECK(std::fabs(indirect.mean - phi * r / (1 - r)) < criticalT * indirect.error() + 1e-5 * phi);
            CHECK(criticalT * all.error() < 0.03 * all.mean);
            // Before the roulette every photon carries the same: the sums by depth are exact.
            double sum = 0;
            for (uint32_t depth = 1; depth <= 4; ++depth) {
                sum += phi * std::pow(r, depth - 1.);
                PathQuery query;
                query.maxDepth = depth;
                CHECK(fluxOf(Tracer(*scene, query).trace(2048)) == Approx(sum).epsilon(1e-5));
            }
        }
    }

    TEST_CASE("the same photons for one, two and five threads; iterations and maps go on with other numbers") {
        const auto scene = compiled(lit());
        const TracedPhotons one = Tracer(*scene, {}, 1).trace(20'000);
        const auto same = [&](const TracedPhotons& t) {
            return t.photons.size() == one.photons.size() &&
                   std::memcmp(t.photons.data(), one.photons.data(), sizeof(Photon) * t.photons.size()) == 0;
        };
        for (const unsigned threads : {2u, 5u}) {
            const TracedPhotons t = Tracer(*scene, {}, threads).trace(20'000);
            CHECK(same(t));
            CHECK(t.statistics.emitted == one.statistics.emitted);
            CHECK(t.statistics.absorbed == one.statistics.absorbed);
            CHECK(t.statistics.ended == one.statistics.ended);
        }
        const Tracer tracer(*scene);
        CHECK_FALSE(same(tracer.trace(20'000, [](PhotonRequest& q) { q.iteration = 1; })));
        CHECK_FALSE(same(tracer.trace(20'000, [](PhotonRequest& q) { q.map = 1; })));
        CHECK_FALSE(same(Tracer(*scene, {}, 2, 1).trace(20'000)));
        // Two iterations of half as many are one of all.
        const TracedPhotons first = tracer.trace(10'000), second = tracer.trace(10'000, [](PhotonRequest& q) { q.iteration = 1; });
        CHECK(first.photons.size() + second.photons.size() == one.photons.size());
        CHECK(std::memcmp(first.photons.data(), one.photons.data(), sizeof(Photon) * first.photons.size()) == 0);
    }

    TEST_CASE("unwanted paths are not followed, and what that cost is in the ledger") {
        const auto scene = compiled(lit());
        for (const char* paths : {"L D E", "L S+ D E", "L D D E", "La .* D E"}) {
            CAPTURE(paths);
            const TracedPhotons t = Tracer(*scene, {.paths = paths, .split = "", .within = "", .without = ""}).trace(20'000);
            checkLedger(t.statistics);
            CHECK(t.photons.size() > 0);
        }
        PathQuery none;
        none.maxDepth = 0;
        const TracedPhotons t = Tracer(*scene, none).trace(1000);
        CHECK(t.photons.empty());
        checkLedger(t.statistics);
        CHECK(Tracer(*scene).trace(0).photons.empty());
    }

    TEST_CASE("no lights, a stop, and too little memory") {
        const auto dark = compiled(table());
        const TracedPhotons none = Tracer(*dark).trace(1000);
        CHECK(none.photons.empty());
        CHECK(none.statistics.emitted == 0);
        const auto scene = compiled(lit());
        Tracer stopped(*scene);
        stopped.stop.request();
        CHECK(stopped.trace(100'000).photons.empty());
        Tracer small(*scene);
        small.work.memoryLimit = 1 << 20;
        try {
            small.trace(100'000'000);
            FAIL("not refused");
        } catch (const Error& e) {
            CHECK(e.code == Exit::resources);
            CHECK(std::string(e.what()).find("--max-memory") != std::string::npos);
        }
    }
} // TEST_SUITE

TEST_SUITE("photon-glass") {
    TEST_CASE("aimed emission finds the same light in far more photons") {
        for (const Source& lamp : lamps()) {
            CAPTURE(lamp.name);
            SceneDesc s = table();
            lamp.add(s);
            const auto scene = compiled(std::move(s));
            stats::Moments plain, aimed;
            double photonsPlain = 0, photonsAimed = 0;
            const auto guide = learnEmission(Tracer(*scene, {}, 2, 99).work, 1 << 16);
            REQUIRE(guide);
            for (int seed = 0; seed < replicates; ++seed) {
                const Tracer tracer(*scene, {}, 2, uint64_t(seed));
                const auto caustic = [&](const EmissionGuide* g) {
                    return tracer.trace(1 << 13, [&](PhotonRequest& q) {
                        q.kinds = {false, true, false};
                        q.guide = g;
                    });
                };
                const TracedPhotons a = caustic(nullptr), b = caustic(guide.get());
                checkLedger(b.statistics);
                plain.add(fluxOf(a));
                aimed.add(fluxOf(b));
                photonsPlain += double(a.photons.size());
                photonsAimed += double(b.photons.size());
            }
            INFO("plain " << plain.mean << " +- " << plain.error() << ", aimed " << aimed.mean << " +- " << aimed.error());
            CHECK(std::fabs(plain.mean - aimed.mean) < criticalT * std::hypot(plain.error(), aimed.error()));
            CHECK(photonsAimed > 2 * photonsPlain);
        }
        const auto matt = room(.5f);
        CHECK(learnEmission(Tracer(*matt).work, 1 << 12) == nullptr);
    }

    TEST_CASE("light through a glass ball by order, and what reaches a floor below it (G6, G8)") {
        const auto scene = ballInSun(0, 0);
        const Tracer tracer(*scene);
        double order[4] = {}, all = 0, down = 0;
        for (uint64_t number = 0; number < 40'000; ++number) {
            PathLog log;
            PhotonRequest request;
            request.rouletteDepth = 1000;
            tellPhotonPath(tracer.work, request, number, log);
            const std::size_t n = log.vertices().size(); // emission, surfaces, sky
            if (n < 3) continue;                         // beside the ball
            const PathLog::Vertex& end = log.vertices().back();
            REQUIRE(end.kind == PathLog::Kind::sky);
            const double flux = double(luminance(end.throughput));
            all += flux;
            order[std::min<std::size_t>(n - 3, 3)] += flux; // scattered once: reflected; twice: straight through; ...
            if (n == 4 && end.p.y < log.vertices()[2].p.y) down += flux;
        }
        CHECK(order[0] / all == Approx(.0917779593).epsilon(0.01));
        CHECK(order[1] / all == Approx(.8355444).epsilon(0.002));
        CHECK(order[2] / all == Approx(.0611832167).epsilon(0.015));
        CHECK(order[3] / all == Approx(.0114944).epsilon(0.03));
        CHECK(down / all == Approx(.8354100).epsilon(0.002));
        CHECK(all / 40'000 == Approx(pi64).epsilon(0.002));
    }

    TEST_CASE("the caustic of a glass ball: where it is and how much light is in it (G7)") {
        const auto scene = ballInSun(3, -1.5);
        const Tracer tracer(*scene, {.paths = "L ST ST D E", .split = "", .within = "", .without = ""});
        const auto guide = learnEmission(tracer.work, 1 << 16);
        REQUIRE(guide);
        const TracedPhotons t = tracer.trace(1 << 17, [&](PhotonRequest& q) {
            q.kinds = {false, true, false};
            q.guide = guide.get();
        });
        const auto paths = double(t.statistics.paths);
        const PhotonStore store(tracer.run, t.photons, .05f);
        const Vec3 focus = local(*scene, {0, -1.5, 0});
        double inside = 0, wide = 0, x = 0, z = 0;
        const float rim = .0417462685f;
        store.within(focus, rim, [&](const Photon& photon, float) {
            const double f = double(luminance(photon.flux)) / paths;
            inside += f;
            x += f * double(photon.p.x - focus.x);
            z += f * double(photon.p.z - focus.z);
        });
        store.within(focus, 2.5f, [&](const Photon& photon, float) { wide += double(luminance(photon.flux)) / paths; });
        CHECK(inside == Approx(.2301805762 * pi64).epsilon(0.01));
        CHECK(inside / (pi64 * sqr(double(rim))) == Approx(132.079).epsilon(0.01));
        CHECK(std::fabs(x / inside) < 2e-4);
        CHECK(std::fabs(z / inside) < 2e-4);
        CHECK(wide < .8354100 * pi64 * 1.002);
        // Rays of height .1 meet the floor within 2.8e-4 of the axis, those of .3 within 8e-3.
        double narrow = 0;
        store.within(focus, .0079717f, [&](const Photon& photon, float) { narrow += double(luminance(photon.flux)) / paths; });
        CHECK(narrow == Approx(.09 * pi64 * .92).epsilon(0.02));
    }
} // TEST_SUITE
