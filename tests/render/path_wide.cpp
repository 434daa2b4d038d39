// The path tracer in lanes is the path tracer: sample for sample the same light but for rounding, and the same bits however many paths are
// under way.
#include "tests/render/path_wide.h"
#include <atomic>
#include <cstdlib>
#include <new>

using namespace chiaro;
using namespace chiaro::test;

namespace {

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
        for (const char* split : {"", "paths"}) {
            CAPTURE(std::string(split));
            Bench bench(*scene, scene->cameras()[0], {32, 32, 1});
            bench.classes = asked("", split);
            FilmLayout layout = bench.layout();
            layout.layers = bench.classes.layerNames();
            const auto made = chooseIntegrator("path").entry->make(chooseIntegrator("path").options);
            made->prepare(bench.job);
            const auto pass = [&](uint32_t samples) {
                Film film(layout);
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
}
