// The path tracer in lanes is the path tracer: sample for sample the same light but for rounding, and the same bits however many paths are
// under way.
#include "scenes/builtin.h"
#include "tests/render/measure.h"
#include <atomic>
#include <cstdlib>
#include <new>

using namespace chiaro;
using namespace chiaro::test;

namespace {

SceneDesc builtin(const char* name) { return findBuiltin(name)->make(); }

struct Difference {
    double share = 0;  // of pixels that differ by more than a thousandth
    double mean = 0;   // of the pictures' mean luminances, relative
    double albedo = 0; // of the albedo and normal layers, mean of a channel
};
Difference difference(const Scene& scene, const Settings& s, const std::string& options = "") {
    const std::string reference = "path:wide=off" + (options.empty() ? "" : "," + options);
    const Rendering a = rendered(scene, scene.cameras()[0], s, reference);
    const Rendering b = rendered(scene, scene.cameras()[0], s, options.empty() ? "path" : "path:" + options);
    Difference d;
    double sums[2] = {};
    for (uint32_t y = 0; y < s.height; ++y)
        for (uint32_t x = 0; x < s.width; ++x) {
            const Spectrum p = a.film->mean({x, y}), q = b.film->mean({x, y});
            sums[0] += double(luminance(p));
            sums[1] += double(luminance(q));
            d.share += !(std::fabs(luminance(p) - luminance(q)) <= 1e-3f * (luminance(p) + 1e-3f));
            for (const Aov v : {Aov::albedo, Aov::normal})
                for (std::size_t c = 0; c < 3; ++c)
                    d.albedo += std::fabs(double(a.film->aov({x, y}, v)[c]) - double(b.film->aov({x, y}, v)[c])) / 6;
        }
    const double n = double(s.width) * s.height;
    d.share /= n;
    d.albedo /= n;
    d.mean = sums[0] > 0 ? std::fabs(sums[1] / sums[0] - 1) : std::fabs(sums[1]);
    CHECK(b.film->dropped() == 0);
    return d;
}
// One sample a pixel: what differs is a path, not an average.
void same(const Scene& scene, const std::string& options = "", uint32_t maxDepth = unlimitedDepth) {
    Settings s{64, 48, 1};
    s.filter = FilterKind::blackmanHarris;
    s.maxDepth = maxDepth;
    const Difference d = difference(scene, s, options);
    CAPTURE(options);
    CAPTURE(maxDepth);
    CHECK(d.share < 0.01);
    CHECK(d.mean < 2e-3);
    CHECK(d.albedo < 1e-5);
}

// All that lanes leave to the scalar closure, and all that they do: textures, normal maps, rough, absorbing and dispersive glass, vertex
// colours, cut-outs, moving and mirrored instances, textured lamps, every punctual light.
MaterialDesc plain(const char* name, const Spectrum& color, float roughness) {
    MaterialDesc m;
    m.name = name;
    m.baseColor = color;
    m.metallic = 0;
    m.roughness = roughness;
    return m;
}
int chequer(SceneDesc& d, uint8_t alpha) {
    std::vector<uint8_t> texels;
    for (int i = 0; i < 64; ++i) {
        const bool light = (i ^ i >> 3) & 1;
        for (const uint8_t t :
             {uint8_t(light ? 230 : 40), uint8_t(light ? 200 : 90), uint8_t(light ? 120 : 160), light ? uint8_t(255) : alpha})
            texels.push_back(t);
    }
    return addTexture(d, 8, 8, 4, texels);
}
SceneDesc everything(bool moves) {
    SceneDesc d;
    const int texture = chequer(d, 0), grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f, 0.5f, 0.4f)));
    MaterialDesc textured = plain("textured", Spectrum(0.9f), 0.4f), bumpy = plain("bumpy", Spectrum(0.7f), 0.5f),
                 leaf = shapes::diffuse("leaf", Spectrum(0.8f)), rough = plain("rough glass", Spectrum(0.9f), 0.4f),
                 solid = plain("solid", Spectrum(0.8f, 0.9f, 1), 0), varied = plain("varied", Spectrum(0.5f), 1),
                 sign = shapes::lamp("sign", Spectrum(4)), metal = shapes::metal("metal", Spectrum(0.9f, 0.7f, 0.4f), 0.3f);
    textured.baseColorTexture.texture = leaf.baseColorTexture.texture = bumpy.normalTexture.texture =
        varied.metallicRoughnessTexture.texture = sign.emissionTexture.texture = texture;
    leaf.alphaMode = AlphaMode::mask;
    leaf.doubleSided = true;
    rough.transmission = solid.transmission = 1;
    solid.volume = true;
    solid.attenuationDistance = 0.5f;
    solid.attenuationColor = Spectrum(0.9f, 0.5f, 0.3f);
    rough.volume = true;
    const int ids[] = {shapes::add(d, textured), shapes::add(d, bumpy),  shapes::add(d, leaf), shapes::add(d, rough),
                       shapes::add(d, solid),    shapes::add(d, varied), shapes::add(d, sign), shapes::add(d, metal)};
    shapes::add(d, "room", shapes::insideOut(shapes::box({2, 2, 2})), grey);
    for (int i = 0; i < 8; ++i)
        shapes::add(d, "thing", i % 2 ? shapes::sphere(0.4, 3) : square(0.45), ids[i],
                    shapes::translation({-1.5 + i % 4, i < 4 ? -0.8 : 0.7, -1}));
    PrimitiveDesc coloured = shapes::sphere(0.35, 2);
    for (std::size_t i = 0; i < coloured.positions.size(); ++i) coloured.colors.push_back({i % 2 ? 1.f : 0.2f, 0.5f, 0.9f, 1});
    shapes::add(d, "coloured", std::move(coloured), grey, shapes::translation({1.2, -1.4, 0.3}));
    MaterialDesc flint = plain("flint", Spectrum(1), 0);
    flint.transmission = flint.dispersion = 1;
    flint.volume = true;
    shapes::add(d, "prism", shapes::sphere(0.35, 3), shapes::add(d, flint), shapes::translation({0.4, -1.5, -0.4}));
    const Affine places[] = {shapes::translation({-1.2, -1.5, 0}), shapes::translation({-0.3, -1.6, 0.4}) * scaling(-1, 0.5, 1.5)};
    addInstances(d, shapes::sphere(0.35, 3), ids[7], places);
    addInstances(d, shapes::box({0.2, 0.1, 0.2}), shapes::add(d, shapes::lamp("lamps", Spectrum(3, 2, 1))), places);
    if (moves) {
        d.shutter = {0, 1};
        d.instances.back().motion = {d.instances.back().toWorld, shapes::translation({0.5, 0.3, 0}) * d.instances.back().toWorld};
    }
    for (const PunctualKind kind : {PunctualKind::point, PunctualKind::directional, PunctualKind::spot}) {
        PunctualDesc l;
        l.kind = kind;
        l.intensity = Spectrum(2);
        l.toWorld = shapes::translation({0, 0, 1.5});
        d.lights.push_back(l);
    }
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0, 1.9}));
    return d;
}
SceneDesc underSky(TextureFilter filter) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f))),
              mirror = shapes::add(d, shapes::metal("metal", Spectrum(0.9f), 0.1f));
    shapes::add(d, "ground", plate({0, -1, 0}, {0, 1, 0}, 4), grey);
    shapes::add(d, "ball", shapes::sphere(0.8, 4), mirror);
    const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(5)));
    shapes::add(d, "lamp", plate({1.5, 1, 0}, {-1, -1, 0}, 0.3), lamp);
    d.environment = environment(
        16, 8, [](int x, int y) { return Spectrum(x == 3 && y == 2 ? 40.f : 0.2f, 0.3f, 0.1f * float(y)); }, filter);
    d.environment->rotate = 0.7f;
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0.3, 4}));
    return d;
}

std::atomic<uint64_t> allocations{0};

} // namespace

// Counts what the whole test program allocates. Not inlined: the compiler would see one half of a pair.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
    allocations.fetch_add(1, std::memory_order_relaxed);
    if (void* p = std::malloc(bytes ? bytes : 1)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

TEST_SUITE("path-wide") {

    TEST_CASE("lanes and single paths give the same samples in the built-in scenes") {
        for (const char* name : {"@cornell", "@cornell-spheres", "@veach-mis", "@caustic", "@playground"}) {
            CAPTURE(std::string(name));
            const auto scene = compiled(builtin(name));
            same(*scene);
        }
    }

    TEST_CASE("at every depth, without light samples, without weights, with roulette from the start") {
        const auto scene = compiled(builtin("@cornell-spheres"));
        for (const uint32_t depth : {0u, 1u, 2u, 3u}) same(*scene, "", depth);
        for (const char* options : {"nee=off", "mis=off", "rr-depth=0", "rr-depth=100,stream=32"}) same(*scene, options, 12);
    }

    TEST_CASE("textures, normal maps, cut-outs, instances, motion, every glass and every light") {
        for (const bool moves : {false, true}) {
            CAPTURE(moves);
            const auto scene = compiled(everything(moves));
            for (const uint32_t depth : {0u, 1u, 4u, unlimitedDepth}) same(*scene, "", depth);
        }
    }

    TEST_CASE("in either instruction set, as far as this machine has them") {
        for (const char* isa : {"avx2", "avx512"}) {
            CAPTURE(std::string(isa));
            try {
                same(*compiled(everything(true), isa));
                same(*compiled(underSky(TextureFilter::linear), isa));
            } catch (const Error&) { MESSAGE("not on this machine: ", isa); }
        }
        CHECK(difference(*compiled(underSky(TextureFilter::linear), "sse2"), {16, 16, 1}).share == 0); // one by one
    }

    TEST_CASE("under the sky, with and without a filter, and a lamp beside it") {
        for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear}) same(*compiled(underSky(filter)));
    }

    TEST_CASE("nothing to hit, nothing that shines, a single triangle") {
        SceneDesc d;
        shapes::addCamera(d, "main", 0.9, {});
        const auto empty = compiled(std::move(d));
        CHECK(difference(*empty, {16, 16, 1}).share == 0);
        SceneDesc one;
        shapes::add(one, "one", triangle({-1, -1, -2}, {1, -1, -2}, {0, 1, -2}), shapes::add(one, shapes::diffuse("grey", Spectrum(0.5f))));
        one.environment = uniformSky(1);
        shapes::addCamera(one, "main", 0.9, {});
        same(*compiled(std::move(one)));
    }

    TEST_CASE("any number of paths under way, any number of threads and any cut into passes: the same bits") {
        for (const bool all : {false, true}) {
            const auto scene = compiled(all ? everything(true) : builtin("@cornell-spheres"));
            Settings s{40, 24, 7};
            s.filter = FilterKind::gauss;
            const Rendering a = rendered(*scene, scene->cameras()[0], s, "path:stream=32");
            for (const char* stream : {"path:stream=48", "path:stream=512", "path:stream=4096"}) {
                CAPTURE(std::string(stream));
                CHECK(samePicture(*a.film, *rendered(*scene, scene->cameras()[0], s, stream).film));
            }
            for (const unsigned threads : {2u, 5u}) {
                s.threads = threads;
                CHECK(samePicture(*a.film, *rendered(*scene, scene->cameras()[0], s, "path").film));
            }
            Bench bench(*scene, scene->cameras()[0], s);
            Film parts(bench.layout());
            const auto made = chooseIntegrator("path").entry->make(chooseIntegrator("path").options);
            made->prepare(bench.job);
            for (const auto& [begin, end] : {std::pair{0u, 1u}, std::pair{1u, 6u}, std::pair{6u, 7u}})
                made->render(bench.job, {begin, end, nullptr}, parts);
            CHECK(samePicture(*a.film, parts));
        }
    }

    TEST_CASE("no allocation a sample: as many in a pass of 64 as in one of 16") {
        const auto scene = compiled(builtin("@cornell-spheres"));
        Bench bench(*scene, scene->cameras()[0], {32, 32, 1});
        const auto made = chooseIntegrator("path").entry->make(chooseIntegrator("path").options);
        made->prepare(bench.job);
        const auto pass = [&](uint32_t samples) {
            Film film(bench.layout());
            const uint64_t before = allocations.load();
            made->render(bench.job, {0, samples, nullptr}, film);
            return allocations.load() - before;
        };
        pass(1); // the threads' own memory
        const uint64_t few = pass(16), many = pass(64);
        CHECK(few > 0); // the list of tiles: the count counts
        CHECK(many == few);
    }
}
