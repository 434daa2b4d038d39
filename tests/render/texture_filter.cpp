// Textures under ray cones in pictures: far away they do not flicker, close by they are as sharp as ever, and nothing gets brighter or
// darker.
#include "tests/render/measure.h"

using namespace chiaro;
using namespace chiaro::test;

namespace {

// Squares of eight texels. With `nearest` nothing is filtered.
int board(SceneDesc& d, TextureFilter filter, uint8_t dark = 20, uint8_t light = 235) {
    std::vector<uint8_t> texels;
    for (int i = 0; i < 64 * 64; ++i)
        for (int c = 0; c < 3; ++c) texels.push_back((i / 8 + i / 512) % 2 ? light : c == 1 ? uint8_t(dark / 2) : dark);
    return addTexture(d, 64, 64, 3, texels, {0, Wrap::repeat, Wrap::repeat, filter});
}
MaterialDesc tiled(SceneDesc& d, TextureFilter filter, float repeats) {
    MaterialDesc m = shapes::diffuse("tiles", Spectrum(0.9f));
    m.baseColorTexture.texture = board(d, filter);
    m.baseColorTexture.transform[0][0] = m.baseColorTexture.transform[1][1] = repeats;
    return m;
}
// A floor of two hundred metres with squares of an eighth of a metre, under a white sky.
std::unique_ptr<const Scene> plain(TextureFilter filter) {
    SceneDesc d;
    shapes::add(d, "floor", plate({0, 0, 0}, {0, 1, 0}, 100), shapes::add(d, tiled(d, filter, 200)));
    d.environment = uniformSky(1);
    shapes::addCamera(d, "low", 0.9, shapes::lookAt({0, 1.5, 60}, {0, -10, 0}, {0, 1, 0}));
    return compiled(std::move(d));
}
// A room whose walls and things are all textured, seen directly, in a mirror, through glass and by bounces.
std::unique_ptr<const Scene> room(TextureFilter filter) {
    SceneDesc d;
    MaterialDesc glossy = tiled(d, filter, 6), mirror = shapes::metal("mirror", Spectrum(0.9f), 0), glass;
    glossy.specular = 1;
    glossy.roughness = 0.3f;
    glass.name = "glass";
    glass.metallic = glass.roughness = 0;
    glass.transmission = 1;
    glass.volume = true;
    shapes::add(d, "room", shapes::insideOut(shapes::box({2, 1.5, 2})), shapes::add(d, tiled(d, filter, 8)));
    shapes::add(d, "box", shapes::box({0.4, 0.5, 0.4}), shapes::add(d, glossy), shapes::translation({-0.8, -1, -0.5}));
    shapes::add(d, "mirror", shapes::sphere(0.5, 3), shapes::add(d, mirror), shapes::translation({0.8, -0.9, -0.7}));
    shapes::add(d, "glass", shapes::sphere(0.35, 3), shapes::add(d, glass), shapes::translation({0.1, -1.1, 0.4}));
    shapes::add(d, "lamp", plate({0, 1.49, 0}, {0, -1, 0}, 0.5), shapes::add(d, shapes::lamp("lamp", Spectrum(8))));
    shapes::addCamera(d, "main", 1.0, shapes::translation({0, 0, 1.9}));
    return compiled(std::move(d));
}
// Standard deviation of the luminance of pixels that see the far part of the floor, and its mean.
struct Far {
    double deviation = 0, mean = 0;
};
Far farRows(const Scene& scene, uint32_t spp, const char* integrator) {
    Settings s{96, 64, spp};
    s.filter = FilterKind::blackmanHarris;
    const Rendering r = rendered(scene, scene.cameras()[0], s, integrator);
    double sum = 0, squares = 0;
    int n = 0;
    for (uint32_t y = 22; y < 25; ++y) // from 18 to 40 metres away
        for (uint32_t x = 20; x < 76; ++x, ++n) {
            const auto v = double(luminance(r.film->mean({x, y})));
            sum += v;
            squares += v * v;
        }
    return {std::sqrt(squares / n - sqr(sum / n)), sum / n};
}

} // namespace

TEST_SUITE("texture-filter") {

    TEST_CASE("a far floor: one sample a pixel shows its mean, many show the same picture") {
        const auto filtered = plain(TextureFilter::linear), bare = plain(TextureFilter::nearest);
        for (const char* integrator : {"albedo", "raycast:ambient=1", "whitted:ambient=1"}) {
            CAPTURE(std::string(integrator));
            const Far one = farRows(*filtered, 1, integrator), without = farRows(*bare, 1, integrator);
            INFO("deviation " << one.deviation << " against " << without.deviation << ", mean " << one.mean << " against " << without.mean);
            CHECK(one.deviation < without.deviation / 4);
            const Far many = farRows(*filtered, 256, integrator), truth = farRows(*bare, 256, integrator);
            CHECK(std::fabs(many.mean - truth.mean) < 0.01 * truth.mean);
            CHECK(std::fabs(one.mean - truth.mean) < 0.03 * truth.mean);
        }
        // By paths, in lanes and one by one: the noise that is left is that of the light.
        for (const char* integrator : {"path:wide=off", "path"}) {
            const Far a = farRows(*filtered, 1, integrator), b = farRows(*bare, 1, integrator);
            CHECK(a.deviation < b.deviation / 2);
        }
    }

    TEST_CASE("close by, every pixel keeps its bits") {
        // A pixel covers a quarter of a texel: the picture is that of a texture without a pyramid, which a single level is.
        const auto seen = [](bool pyramid, const char* integrator) {
            SceneDesc d;
            const MaterialDesc m = tiled(d, TextureFilter::linear, 1);
            shapes::add(d, "plate", square(1), shapes::add(d, m));
            if (!pyramid) d.materials.back().unlit = true;
            shapes::addCamera(d, "main", 0.5, shapes::translation({0.1, 0.2, 0.5}));
            const auto scene = compiled(std::move(d));
            CHECK(scene->textures().filtered() == pyramid);
            return rendered(*scene, scene->cameras()[0], {32, 32, 4}, integrator).film;
        };
        const auto lit = seen(true, "whitted:ambient=1"), base = seen(false, "whitted");
        for (uint32_t y = 0; y < 32; ++y)
            for (uint32_t x = 0; x < 32; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    CHECK(lit->mean({x, y})[c] == doctest::Approx(double(base->mean({x, y})[c])).epsilon(1e-6));
    }

    TEST_CASE("a textured room is as bright with ray cones as without, by every kind of path") {
        const auto filtered = room(TextureFilter::linear), bare = room(TextureFilter::nearest);
        for (const char* integrator : {"path:wide=off", "path", "distributed:ambient=0.2", "whitted:ambient=0.2"}) {
            CAPTURE(std::string(integrator));
            Settings s{24, 24, 16 * 32};
            s.maxDepth = 6;
            const Measured a = measure(*filtered, filtered->cameras()[0], s, integrator);
            const Measured b = measure(*bare, bare->cameras()[0], s, integrator);
            INFO("filtered " << a.value << " +- " << a.error << ", bare " << b.value << " +- " << b.error);
            CHECK(std::fabs(a.value - b.value) <= criticalT * std::hypot(a.error, b.error) + 1e-3 * b.value);
            CHECK(criticalT * std::hypot(a.error, b.error) < 0.05 * b.value);
        }
    }

    TEST_CASE("lanes and single paths give the same samples under cones") {
        const auto scene = room(TextureFilter::linear);
        Settings s{64, 48, 1};
        s.maxDepth = 6;
        const Rendering a = rendered(*scene, scene->cameras()[0], s, "path:wide=off"), b = rendered(*scene, scene->cameras()[0], s, "path");
        int other = 0;
        for (uint32_t y = 0; y < s.height; ++y)
            for (uint32_t x = 0; x < s.width; ++x) {
                const float p = luminance(a.film->mean({x, y})), q = luminance(b.film->mean({x, y}));
                other += !(std::fabs(p - q) <= 1e-3f * (p + 1e-3f));
            }
        INFO(other << " pixels differ");
        CHECK(other < 64 * 48 / 100);
    }
}
