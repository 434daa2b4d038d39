// What must not change a picture: threads, scale, place, brightness, mirrors. And what must not happen: light through closed walls.
#include "scenes/builtin.h"
#include "tests/render/measure.h"
#include <cstring>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// A small room with a mirror, a glass ball, an instanced block and a lamp.
SceneDesc room() {
    SceneDesc s;
    const int white = shapes::add(s, shapes::diffuse("white", {.7f, .6f, .5f})), lamp = shapes::add(s, shapes::lamp("lamp", {8, 7, 6}));
    const int glass = shapes::add(s, shapes::glass("glass", 1.5f)), mirror = shapes::add(s, shapes::metal("mirror", {.9f, .8f, .7f}, 0));
    const int gloss = shapes::add(s, shapes::metal("gloss", {.8f, .8f, .9f}, .3f));
    shapes::add(s, "room", shapes::insideOut(shapes::box({1, 1, 1})), white);
    shapes::add(s, "lamp", shapes::quad({-.3, .99, -.3}, {.3, .99, -.3}, {.3, .99, .3}, {-.3, .99, .3}), lamp);
    shapes::add(s, "ball", shapes::sphere(.3, 4), glass, shapes::translation({.4, -.7, .2}));
    shapes::add(s, "mirror", shapes::sphere(.3, 4), mirror, shapes::translation({-.4, -.7, -.4}));
    const Affine places[] = {shapes::translation({-.5, -.9, .5}), shapes::translation({.5, -.9, -.6}) * rotation({0, 1, 0}, .5)};
    addInstances(s, shapes::box({.2, .1, .15}), gloss, places);
    shapes::addCamera(s, "main", 1.2, shapes::lookAt({0, 0, .95}, {0, -.2, -1}));
    return s;
}

// The whole scene under a map at the root.
SceneDesc under(SceneDesc s, const Affine& root) {
    for (InstanceDesc& in : s.instances) in.toWorld = root * in.toWorld;
    for (CameraDesc& c : s.cameras) c.toWorld = root * c.toWorld;
    for (PunctualDesc& l : s.lights) l.toWorld = root * l.toWorld;
    return s;
}

// Of a compiled scene's own camera: it is recentred already.
Spectrum meanPicture(const Scene& scene, const Settings& how) { return rendered(scene, scene.cameras()[0], how).mean; }

void checkRatio(const Spectrum& a, const Spectrum& b, double tolerance) {
    for (std::size_t c = 0; c < 3; ++c) CHECK(double(a[c]) / double(b[c]) == doctest::Approx(1).epsilon(tolerance));
}

} // namespace

TEST_SUITE("invariance") {

    TEST_CASE("one, two and five threads give the same bits") {
        const auto scene = compiled(room());
        Settings how{48, 48, 16};
        const Rendering one = rendered(*scene, scene->cameras()[0], how);
        for (const unsigned threads : {2u, 5u}) {
            how.threads = threads;
            CHECK(samePicture(*one.film, *rendered(*scene, scene->cameras()[0], how).film));
        }
    }

    TEST_CASE("scale and place do not matter (M6)") {
        const Settings how{48, 48, 256, {}, 2};
        const Spectrum expected = meanPicture(*compiled(room()), how);
        for (const double scale : {1e-4, 1e-2, 1e3, 1e5}) {
            CAPTURE(scale);
            checkRatio(meanPicture(*compiled(under(room(), scaling(scale, scale, scale))), how), expected, 0.005);
        }
        checkRatio(meanPicture(*compiled(under(room(), shapes::translation({1e5, -1e5, 1e5}))), how), expected, 0.005);
        checkRatio(meanPicture(*compiled(under(room(), rotation({1, 2, 3}, 1.1))), how), expected, 0.005);
    }

    TEST_CASE("scale by a power of two changes no bit") {
        const Settings how{24, 24, 16};
        const auto a = compiled(room()), b = compiled(under(room(), scaling(1024, 1024, 1024)));
        CHECK(samePicture(*rendered(*a, a->cameras()[0], how).film, *rendered(*b, b->cameras()[0], how).film));
    }

    TEST_CASE("twice the emission is twice the picture, to the bit (M1)") {
        SceneDesc bright = room();
        for (MaterialDesc& m : bright.materials) m.emission *= 2.f;
        const Settings how{24, 24, 16};
        const auto a = compiled(room()), b = compiled(std::move(bright));
        const Rendering once = rendered(*a, a->cameras()[0], how), twice = rendered(*b, b->cameras()[0], how);
        bool same = true;
        for (uint32_t y = 0; y < 24; ++y)
            for (uint32_t x = 0; x < 24; ++x) same = same && once.film->mean({x, y}) * 2.f == twice.film->mean({x, y});
        CHECK(same);
    }

    TEST_CASE("two lamps are the sum of each (M2)") {
        const auto with = [](float first, float second) {
            SceneDesc s = room();
            s.materials[1].emission = Spectrum(first);
            PunctualDesc l;
            l.intensity = Spectrum(second);
            l.toWorld = shapes::translation({.5, .5, .5});
            s.lights.push_back(l);
            const auto scene = compiled(std::move(s));
            return meanPicture(*scene, {48, 48, 256, {}, 2});
        };
        checkRatio(with(8, 3), with(8, 0) + with(0, 3), 0.006);
    }

    TEST_CASE("no light enters a closed box (M10)") {
        SceneDesc s;
        const int white = shapes::add(s, shapes::diffuse("white", Spectrum(.9f)));
        shapes::add(s, "inner", shapes::insideOut(shapes::box({1, 1, 1})), white, rotation({1, 2, 3}, .7));
        shapes::addCamera(s, "main", 1.4, shapes::lookAt({.1, .2, .3}, {1, .5, -1}));
        s.environment = uniformSky(1000);
        PunctualDesc l;
        l.intensity = Spectrum(1e6f);
        l.toWorld = shapes::translation({0, 5, 0});
        s.lights.push_back(l);
        for (const double scale : {1e-4, 1.0, 1e5}) {
            CAPTURE(scale);
            const auto scene = compiled(under(s, scaling(scale, scale, scale)));
            const Rendering r =
                rendered(*scene, scene->cameras()[0], {64, 64, 64, {}, 2, 0, SamplerKind::sobol, FilterKind::box, 32}, "path:rr-depth=32");
            CHECK(r.mean == Spectrum(0));
        }
    }

    TEST_CASE("a furnace of metals and coated diffuse never shines, and loses nothing where the model loses nothing") {
        struct Row {
            const char* name;
            MaterialDesc material;
            bool lossless;
        };
        MaterialDesc lambert = shapes::diffuse("lambert", Spectrum(1)), coat;
        coat.metallic = 0;
        MaterialDesc smooth = coat, rough = coat;
        smooth.roughness = 0;
        rough.roughness = .5f;
        const Row rows[] = {{"lambert", lambert, true},
                            {"mirror", shapes::metal("m", Spectrum(1), 0), true},
                            {"glass", shapes::glass("g", 1.5f), true},
                            {"smooth coat over white", smooth, true},
                            {"rough coat over white", rough, true},
                            {"metal .3", shapes::metal("m", Spectrum(1), .3f), false},
                            {"metal .7", shapes::metal("m", Spectrum(1), .7f), false},
                            {"metal 1", shapes::metal("m", Spectrum(1), 1), false}};
        for (const Row& row : rows) {
            const std::string name = row.name;
            CAPTURE(name);
            SceneDesc s;
            const int material = shapes::add(s, row.material);
            shapes::add(s, "ball", shapes::sphere(1, 5), material);
            s.environment = uniformSky(1);
            const auto scene = compiled(std::move(s));
            // The ball fills the picture from its middle to its edge.
            const Measured m = measure(*scene, probe({.5, 0, 0}, {0, 0, -1}, 3, .49), {32, 32, 256, {}, 2});
            INFO("measured " << m.value << " +- " << m.error);
            CHECK(m.value <= 1 + criticalT * m.error + 1e-4);
            if (row.lossless) CHECK(m.value >= 1 - 0.002);
        }
    }

} // TEST_SUITE
