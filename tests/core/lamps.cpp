// Lights as the classics see them: the triangles of a mesh as one lamp, its place, its front, and from far away exactly its light.
#include "tests/scene_kit.h"
#include <doctest/doctest.h>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// What all the triangles of a lamp send to a point, at normal incidence on each: lux.
Spectrum irradiance(const Scene& scene, const Lamp& lamp, const SurfacePoint& from) {
    constexpr int n = 16; // samples along each axis of a triangle
    Spectrum sum(0);
    for (uint32_t light = lamp.first; light < lamp.first + lamp.count; ++light)
        for (int i = 0; i < n * n; ++i) {
            const auto s = scene.lights().sampleOne(light, from, 0, {(float(i % n) + .5f) / n, (float(i / n) + .5f) / n});
            if (s && s->pdfW > 0) sum += s->radiance * (1 / s->pdfW / (n * n));
        }
    return sum;
}
void checkClose(const Spectrum& a, const Spectrum& b, double relative) {
    for (std::size_t c = 0; c < 3; ++c) CHECK(double(a[c]) == doctest::Approx(double(b[c])).epsilon(relative));
}

} // namespace

TEST_SUITE("lamps") {

    TEST_CASE("a flat lamp: centre of its area, front, L A candela along it, exact from far away") {
        SceneDesc d;
        const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(5, 3, 1)));
        // Unequal triangles: the centre is that of the area, not of the corners.
        PrimitiveDesc shape =
            shapes::joined(shapes::quad({0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}), triangle({1, 0, 0}, {2, 0, 0}, {1, 2, 0}));
        shapes::add(d, "lamp", shape, lamp, shapes::translation({3, 1, -2}) * rotation({1, 2, 3}, 0.7));
        const auto scene = compiled(std::move(d));
        const auto lamps = scene->lights().lamps();
        REQUIRE(lamps.size() == 1);
        const Lamp& l = lamps[0];
        CHECK(l.kind == LightKind::area);
        CHECK(l.first == 0);
        CHECK(l.count == 3);
        CHECK_FALSE(l.doubleSided);
        const Affine m = shapes::translation({3, 1, -2}) * rotation({1, 2, 3}, 0.7);
        const Vec3 centre = local(*scene, m.point({(2 * .5 + 4. / 3) / 3, (2 * 1. + 2. / 3) / 3, 0}));
        CHECK(length(l.centre - centre) < 1e-6f);
        CHECK(length(l.normal - cast<float>(m.vector({0, 0, 1}))) < 1e-6f);
        checkClose(l.intensity, Spectrum(15, 9, 3), 1e-6);
        for (const Vec3& way : {Vec3{0, 0, 1}, Vec3{.6f, 0, .8f}, Vec3{-.5f, .7f, .3f}}) {
            const Vec3 direction = normalize(cast<float>(m.vector(cast<double>(way))));
            SurfacePoint from;
            from.p = l.centre + direction * 1000;
            from.ng = from.ns = -direction;
            checkClose(irradiance(*scene, l, from), l.intensity * (dot(direction, l.normal) * 1e-6f), 2e-4);
        }
    }

    TEST_CASE("a ball shines alike everywhere: pi r^2 L, exact from far away; both sides count twice") {
        for (const bool both : {false, true}) {
            SceneDesc d;
            MaterialDesc m = shapes::lamp("bulb", Spectrum(2, 4, 6));
            m.doubleSided = both;
            const int lamp = shapes::add(d, m);
            PrimitiveDesc ball = shapes::sphere(.5, 5);
            const double area = shapes::area(ball);
            shapes::add(d, "bulb", std::move(ball), lamp, shapes::translation({1, 2, 3}));
            const auto scene = compiled(std::move(d));
            const auto lamps = scene->lights().lamps();
            REQUIRE(lamps.size() == 1);
            CHECK(lengthSquared(lamps[0].normal) == 0);
            CHECK(length(lamps[0].centre) < 1e-5f);
            checkClose(lamps[0].intensity, Spectrum(2, 4, 6) * float(area / 4 * (both ? 2 : 1)), 1e-5);
            SurfacePoint from;
            from.p = Vec3{300, -400, 100};
            from.ng = from.ns = normalize(-from.p);
            checkClose(irradiance(*scene, lamps[0], from), lamps[0].intensity * (1 / lengthSquared(from.p)), 2e-3);
        }
    }

    TEST_CASE("textures and opacity are in the intensity") {
        SceneDesc d;
        MaterialDesc m = shapes::lamp("picture", Spectrum(8));
        const uint8_t texels[] = {255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 0, 0};
        m.emissionTexture.texture =
            addTexture(d, 2, 2, 3, texels, {.image = -1, .wrapS = Wrap::clamp, .wrapT = Wrap::clamp, .filter = TextureFilter::nearest});
        m.alphaMode = AlphaMode::blend;
        m.alpha = 0.5f;
        shapes::add(d, "picture", square(1), shapes::add(d, m));
        const auto scene = compiled(std::move(d));
        const auto lamps = scene->lights().lamps();
        REQUIRE(lamps.size() == 1);
        // One texel of four white, one red, 4 m2, half of it opaque.
        checkClose(lamps[0].intensity, Spectrum(8, 4, 4), 0.1);
    }

    TEST_CASE("one lamp a mesh and node; punctual lights as they are; the sky is none; a mesh without area neither") {
        SceneDesc d;
        const int one = shapes::add(d, shapes::lamp("panel", Spectrum(1)));
        const Affine places[] = {shapes::translation({2, 0, 0}), shapes::translation({-2, 0, 0}) * scaling(1, 1, -1)};
        addInstances(d, square(0.5), one, places);
        shapes::add(d, "line", triangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), one);
        for (const PunctualKind kind : {PunctualKind::point, PunctualKind::spot, PunctualKind::directional}) {
            PunctualDesc l;
            l.kind = kind;
            l.intensity = Spectrum(float(int(kind) + 1));
            l.toWorld = shapes::translation({0, 3, double(int(kind))});
            d.lights.push_back(l);
        }
        d.environment = uniformSky(1);
        const auto scene = compiled(std::move(d));
        const auto lamps = scene->lights().lamps();
        REQUIRE(lamps.size() == 5);
        CHECK(lamps[0].normal.z == doctest::Approx(1));
        CHECK(lamps[1].normal.z == doctest::Approx(-1)); // mirrored: the front looks the other way
        for (int i = 0; i < 3; ++i) {
            const Lamp& l = lamps[std::size_t(2 + i)];
            CHECK(l.kind == LightKind::delta);
            CHECK(l.intensity == Spectrum(float(i + 1)));
            CHECK(l.count == 1);
            if (i < 2) CHECK(length(l.centre - local(*scene, {0, 3, double(i)})) < 1e-6f);
        }
        CHECK(lamps[4].first == scene->lights().count() - 2);
    }

    TEST_CASE("flat is flat at every place and size, and a fold is not") {
        for (const double scale : {1e-3, 1., 1e4})
            for (const bool folded : {false, true}) {
                SceneDesc d;
                const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(1)));
                PrimitiveDesc shape =
                    shapes::joined(shapes::quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}),
                                   shapes::quad({1, 0, 0}, {2, 0, folded ? .01 : 0}, {2, 1, folded ? .01 : 0}, {1, 1, 0}));
                shapes::add(d, "lamp", shape, lamp, shapes::translation({3, 4, 5}) * rotation({3, 1, 2}, 1) * scaling(scale, scale, scale));
                CHECK((lengthSquared(compiled(std::move(d))->lights().lamps()[0].normal) > 0) == !folded);
            }
    }

} // TEST_SUITE
