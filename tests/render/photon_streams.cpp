// Streams of photons against the single walk: the same photons in the same order, to the last bit, and the same ledger.
#include "integrators/emission_guide.h"
#include "integrators/photon_stream.h"
#include "scenes/builtin.h"
#include "tests/render/measure.h"
#include "tests/work_kit.h"
#include <cstring>
#include <functional>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double pi64 = std::numbers::pi;

// One path after the other.
TracedPhotons walked(const Work& work, const PhotonRequest& request) {
    TracedPhotons t;
    const PhotonRules rules{request.kinds};
    const double one = 1 / double(request.paths);
    for (uint64_t k = 0; k < request.paths; ++k) {
        const PhotonStart start = startPhoton(work, request, request.iteration * request.paths + k);
        if (!start.emission) continue;
        PhotonVisitor visitor{rules, [&](const Photon& photon) { t.photons.push_back(photon); }};
        const Fate fate =
            walkParticle(work, *start.emission, start.emission->flux, start.sampler, {request.rouletteDepth, nullptr}, visitor);
        t.statistics.emitted += double(luminance(start.emission->flux)) * one;
        t.statistics.absorbed += fate.absorbed * one;
        t.statistics.escaped += fate.escaped * one;
        t.statistics.ended += fate.ended * one;
        t.statistics.rays += fate.rays;
    }
    for (const Photon& photon : t.photons) t.statistics.storedFlux += double(luminance(photon.flux)) * one;
    return t;
}
void checkSame(const Work& work, const PhotonRequest& request) {
    const TracedPhotons streams = tracePhotons(work, request), walks = walked(work, request);
    REQUIRE(streams.photons.size() == walks.photons.size());
    CHECK(std::memcmp(streams.photons.data(), walks.photons.data(), sizeof(Photon) * walks.photons.size()) == 0);
    const PhotonStatistics &a = streams.statistics, &b = walks.statistics;
    const double small = 1e-10 * b.emitted;
    CHECK(a.rays == b.rays);
    CHECK(a.emitted == Approx(b.emitted).epsilon(1e-12));
    CHECK(std::fabs(a.absorbed - b.absorbed) <= small);
    CHECK(std::fabs(a.escaped - b.escaped) <= small);
    CHECK(std::fabs(a.ended - b.ended) <= small);
    CHECK(a.storedFlux == Approx(b.storedFlux).epsilon(1e-12));
}

// Plain, black, textured, smooth-shaded, glossy, moving and tinted surfaces under every kind of light.
SceneDesc everything() {
    SceneDesc s;
    const uint8_t texels[] = {255, 40, 90, 200};
    MaterialDesc tiles = shapes::diffuse("tiles", {.9f, .9f, .9f});
    tiles.baseColorTexture.texture = addTexture(s, 2, 2, 1, texels);
    const int grey = shapes::add(s, shapes::diffuse("grey", {.7f, .5f, .3f})),
              black = shapes::add(s, shapes::diffuse("black", Spectrum(0)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 2), grey);
    shapes::add(s, "wall", plate({0, 1, -1.2}, {0, 0, 1}, 1), shapes::add(s, tiles));
    shapes::add(s, "hole", plate({-1.2, 1, 0}, {1, 0, 0}, .5), black);
    shapes::add(s, "ball", shapes::sphere(.3, 2), grey, shapes::translation({.8, .4, -.5}));
    MaterialDesc gloss = shapes::metal("gloss", {.8f, .3f, .2f}, .3f);
    shapes::add(s, "gloss", shapes::sphere(.3, 2), shapes::add(s, gloss), shapes::translation({-.6, .5, 0}));
    MaterialDesc glass = shapes::glass("glass", 1.5f);
    glass.attenuationDistance = .5f;
    glass.attenuationColor = {.9f, .5f, .7f};
    shapes::add(s, "glass", shapes::sphere(.4, 3), shapes::add(s, glass), shapes::translation({.3, .7, .2}));
    shapes::add(s, "lamp", square(.4), shapes::add(s, shapes::lamp("lamp", Spectrum(8))),
                shapes::translation({.3, 2.2, .4}) * rotation({1, 0, 0}, pi64 / 2));
    shapes::add(s, "slider", plate({0, 0, 0}, {0, 1, 0}, .2), grey, shapes::translation({-.5, 1.2, .5}));
    s.instances.back().motion = {shapes::translation({-.5, 1.2, .5}), shapes::translation({-.3, 1.4, .6})};
    s.shutter = {0, 1};
    PunctualDesc bulb;
    bulb.intensity = {1, 2, 3};
    bulb.range = 3;
    bulb.toWorld = shapes::translation({.5, 1.5, .5});
    s.lights = {bulb};
    PunctualDesc sun;
    sun.kind = PunctualKind::directional;
    sun.intensity = Spectrum(.5f);
    sun.toWorld = shapes::lookAt({.5, 2, .3}, {0, 0, 0});
    s.lights.push_back(sun);
    s.environment = uniformSky(.2f);
    return s;
}

} // namespace

TEST_SUITE("photon-streams") {
    TEST_CASE("the photons of walks one by one, bit by bit") {
        const auto scene = compiled(everything());
        PhotonRequest request;
        request.paths = 9000; // two tasks, streams that end early
        for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
            const Bare bare(*scene, 2, 5, ~std::size_t(0), sampler);
            checkSame(bare.work, request);
        }
    }
    TEST_CASE("whatever is asked for") {
        const auto scene = compiled(everything());
        const Bare bare(*scene, 2);
        const auto with = [&](const std::function<void(PhotonRequest&)>& change) {
            PhotonRequest request;
            request.paths = 3000;
            change(request);
            checkSame(bare.work, request);
        };
        for (const PhotonKinds kinds : {PhotonKinds{true, false, false}, PhotonKinds{false, true, false}, PhotonKinds{false, false, true},
                                        PhotonKinds{true, true, false}, PhotonKinds{false, true, true}})
            with([&](PhotonRequest& r) { r.kinds = kinds; });
        with([](PhotonRequest& r) { r.rouletteDepth = 0; });
        with([](PhotonRequest& r) { r.map = 7, r.iteration = 3; });
        with([](PhotonRequest& r) { r.time = .3f; });
        with([](PhotonRequest& r) { r.iteration = (uint64_t(1) << 32) / r.paths; }); // over a multiple of 2^32
        with([](PhotonRequest& r) { r.paths = 1; });
        const auto guide = learnEmission(bare.work, 1 << 15);
        REQUIRE(guide);
        with([&](PhotonRequest& r) { r.guide = guide.get(), r.kinds = {false, true, false}; });
    }
    TEST_CASE("masks, layers and depth limits") {
        const auto scene = compiled(everything());
        PathQuery query;
        PhotonRequest request;
        request.paths = 3000;
        for (const char* split : {"paths", "bounces"}) {
            query.split = split;
            checkSame(Bare(*scene, 2, 0, ~std::size_t(0), SamplerKind::sobol, query).work, request);
        }
        query = {};
        for (const uint32_t depth : {1u, 2u, 4u}) {
            query.maxDepth = depth;
            checkSame(Bare(*scene, 2, 0, ~std::size_t(0), SamplerKind::sobol, query).work, request);
        }
        query = {};
        for (const char* paths : {"L D E", "L S+ D E", "Ld .* E", "L G .* E"}) {
            query.paths = paths;
            checkSame(Bare(*scene, 2, 0, ~std::size_t(0), SamplerKind::sobol, query).work, request);
        }
    }
    TEST_CASE("built-in scenes") {
        for (const char* name : {"@cornell", "@cornell-spheres", "@caustic"}) {
            CAPTURE(name);
            const auto scene = compiled(findBuiltin(name)->make());
            PhotonRequest request;
            request.paths = 5000;
            checkSame(Bare(*scene, 2).work, request);
        }
    }
} // TEST_SUITE
