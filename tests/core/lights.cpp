// Lights: densities that agree with one another, choice in proportion to power, punctual lights (rows B6 to B10 of the verification table).
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double degree = std::numbers::pi / 180;

// One of every kind: lamps under plain, scaled, mirrored and instanced nodes, a textured one, a double-sided one, a sky.
SceneDesc zoo(bool sky) {
    SceneDesc d;
    const int one = shapes::add(d, shapes::lamp("one-sided", Spectrum(5, 3, 1)));
    MaterialDesc both = shapes::lamp("both", Spectrum(2));
    both.doubleSided = true;
    const int two = shapes::add(d, both);
    MaterialDesc textured = shapes::lamp("textured", Spectrum(9));
    const uint8_t texels[] = {255, 255, 255, 0, 128, 0, 30, 30, 30, 255, 0, 0};
    textured.emissionTexture.texture = addTexture(d, 2, 2, 3, texels);
    const int picture = shapes::add(d, textured);
    MaterialDesc unlit = shapes::diffuse("sign", Spectrum(0.8f));
    unlit.unlit = true;
    const int sign = shapes::add(d, unlit);
    shapes::add(d, "panel", square(0.5), one, shapes::translation({3, 0, 0}) * rotation({0, 1, 0}, -1.2));
    shapes::add(d, "mirrored", triangle({0, 0, 0}, {1, 0, 0}, {0, 2, 0}), one, shapes::translation({-3, 1, 0}) * scaling(1, 1, -3));
    shapes::add(d, "sheet", square(0.7), two, shapes::translation({0, 3, 0}) * rotation({1, 0, 0}, 1.5));
    shapes::add(d, "picture", square(1), picture, shapes::translation({0, -3, 0}) * rotation({1, 0, 0}, -1.4));
    shapes::add(d, "sign", square(0.4), sign, shapes::translation({0, 0, -3}));
    const Affine places[] = {shapes::translation({2, 2, 2}) * scaling(1, -0.5, 2), shapes::translation({-2, 2, -2}) * scaling(0.3, 2, 1)};
    addInstances(d, shapes::sphere(0.4, 1), one, places);
    const Affine elsewhere[] = {shapes::translation({2, -2, 2}) * scaling(1, -0.5, 2), shapes::translation({-2, -2, -2})};
    addInstances(d, shapes::insideOut(shapes::sphere(0.4, 1)), two, elsewhere);
    if (sky) d.environment = environment(8, 4, [](int x, int y) { return Spectrum(float(1 + x) * 0.1f, float(y), 0.5f) * 0.05f; });
    return d;
}
PunctualDesc punctual(PunctualKind kind, double intensity, const Affine& m = {}) {
    PunctualDesc l;
    l.kind = kind;
    l.intensity = Spectrum(float(intensity));
    l.toWorld = m;
    return l;
}
// The lamp alone, over the origin, and what it sends there.
std::optional<LightSample> sent(const PunctualDesc& l, const Vec3d& to) {
    SceneDesc d;
    d.lights.push_back(l);
    const auto scene = compiled(std::move(d));
    return scene->lights().sampleOne(0, receiver(*scene, to, {0, 0, 1}), 0.5, {0.5f, 0.5f});
}

} // namespace

TEST_SUITE("lights") {

    TEST_CASE("the pmf sums to one and is the frequency of the choice") {
        for (const bool sky : {false, true}) {
            SceneDesc d = zoo(sky);
            for (const PunctualKind k : {PunctualKind::point, PunctualKind::spot, PunctualKind::directional})
                d.lights.push_back(punctual(k, 3, shapes::translation({0, 5, 0})));
            const auto scene = compiled(std::move(d));
            const Lights& lights = scene->lights();
            constexpr int n = 200'000;
            std::vector<double> expected(lights.count()), observed(lights.count());
            double sum = 0;
            for (uint32_t i = 0; i < lights.count(); ++i) { sum += double(lights.pmf(i)); }
            CHECK(sum == doctest::Approx(1).epsilon(1e-5));
            // Every light is seen from within a shell of points; those that face away answer nothing, so that only delta lights and the sky
            // are counted against the rest together.
            stats::Random u(1);
            std::vector<double> kinds(3), share(3);
            const SurfacePoint at = receiver(*scene, {0.1, 0.2, 0.3}, {0, 0, 1});
            for (uint32_t i = 0; i < lights.count(); ++i) expected[i] = n * double(lights.pmf(i, at));
            int empty = 0;
            for (int i = 0; i < n; ++i) {
                const double pick = double(u.next() >> 32) * 0x1p-32;
                const float x = u();
                const auto s = lights.sampleTowards(at, pick, {x, u()});
                if (s) ++observed[s->light];
                empty += !s;
            }
            uint32_t delta = 0;
            for (uint32_t i = 0; i < lights.count(); ++i) {
                const bool always = i + 3 + (sky ? 1 : 0) >= lights.count() && i != lights.count() - (sky ? 3 : 2); // not the spot
                if (!always) continue;
                ++delta;
                CHECK(std::fabs(observed[i] - expected[i]) < 4.5 * std::sqrt(expected[i] + 1));
            }
            CHECK(delta == (sky ? 3 : 2));
        }
    }

    TEST_CASE("sampleTowards gives the density and the radiance that hit() and miss() give for the same direction") {
        for (const bool sky : {false, true}) {
            const auto scene = compiled(zoo(sky));
            const Lights& lights = scene->lights();
            stats::Random u(2);
            std::vector<int> seen(lights.count());
            int lost = 0, kinds = 0, density = 0, colour = 0;
            for (int i = 0; i < 100'000; ++i) {
                const SurfacePoint at = receiver(*scene, {u() * 2 - 1.0, u() * 2 - 1.0, u() * 2 - 1.0}, {0, 1, 0});
                const double pick = double(u.next() >> 32) * 0x1p-32;
                const float x = u();
                const auto s = lights.sampleTowards(at, pick, {x, u()});
                if (!s || scene->occluded(s->shadow)) continue;
                ++seen[s->light];
                CHECK(!s->delta);
                const Ray r = rayFrom(at.p, s->wi);
                const Hit h = scene->intersect(r);
                LightHit found;
                if (h) {
                    const SurfacePoint p = scene->point(h, r);
                    if (p.light != s->light) {
                        ++lost; // the edge of a neighbour
                        continue;
                    }
                    found = lights.hit(p, -r.d, &at);
                    CHECK(lights.hit(p, -r.d, nullptr).pdfW == 0);
                } else {
                    found = lights.miss(r, &at);
                }
                kinds += found.kind != s->kind;
                // Grazing lamps magnify the rounding of the position.
                density += std::fabs(found.pdfW / s->pdfW - 1) > 2e-3f;
                for (std::size_t c = 0; c < 3; ++c)
                    colour += std::fabs(found.radiance[c] - s->radiance[c]) > 1e-2f * maxComponent(s->radiance);
            }
            const int total = std::accumulate(seen.begin(), seen.end(), 0);
            CHECK(total > 20'000);
            CHECK(lost < total / 500);
            CHECK(kinds == 0);
            CHECK(density <= total / 2000);
            CHECK(colour <= total / 500);
            CHECK(std::count(seen.begin(), seen.end(), 0) < std::ssize(seen) / 2); // the rest of the balls faces away
        }
    }

    TEST_CASE("the densities of directions to a triangle integrate to one: chi-square over its area") {
        for (const Affine& m : {Affine{}, scaling(1, -2, 1), shapes::translation({1, 1, 0}) * rotation({1, 0, 0}, 0.8)})
            for (const bool instanced : {false, true}) {
                SceneDesc d;
                const std::vector<Affine> at(instanced ? 2 : 1, m);
                addInstances(d, triangle({0, 0, 0}, {1, 0, 0}, {0, 2, 0}), shapes::add(d, shapes::lamp("lamp", Spectrum(1))), at);
                const auto scene = compiled(std::move(d));
                const double sign = m.determinant() < 0 ? -1 : 1;
                const Vec3d middle = m.point({0.33, 0.66, 0}), n = normalize(m.normal(Vec3d{0, 0, 1})) * sign;
                const SurfacePoint from = receiver(*scene, middle + n * 1.5 + Vec3d{0.4, 0.1, 0.2}, cast<float>(-n));
                // Mean of 1 / pdfW over samples is the solid angle; by Van Oosterom and Strackee 1983 too.
                const Vec3d a = m.point({0, 0, 0}) - scene->centre() - cast<double>(from.p),
                            b = m.point({1, 0, 0}) - scene->centre() - cast<double>(from.p),
                            c = m.point({0, 2, 0}) - scene->centre() - cast<double>(from.p);
                const double la = length(a), lb = length(b), lc = length(c);
                const double solid =
                    2 * std::fabs(std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb));
                stats::Random u(3);
                stats::Moments inverse;
                for (int i = 0; i < 100'000; ++i) {
                    const float x = u();
                    const auto s = scene->lights().sampleOne(0, from, 0.5, {x, u()});
                    REQUIRE(s);
                    inverse.add(1 / double(s->pdfW));
                }
                CHECK(std::fabs(inverse.mean - solid) < 4.5 * inverse.error());
                CHECK(inverse.mean == doctest::Approx(solid).epsilon(0.005));
            }
    }

    TEST_CASE("a lamp shines from its front alone unless it is double-sided; its back has no density") {
        for (const bool doubleSided : {false, true})
            for (const double mirror : {1.0, -1.0}) {
                SceneDesc d;
                MaterialDesc m = shapes::lamp("lamp", Spectrum(7));
                m.doubleSided = doubleSided;
                shapes::add(d, "lamp", square(1), shapes::add(d, m), scaling(mirror, 1, 1));
                const auto scene = compiled(std::move(d));
                for (const float side : {1.f, -1.f}) {
                    CAPTURE(side);
                    CAPTURE(mirror);
                    const bool shines = doubleSided || side > 0; // the front of a mirrored square is the mirror image of its front
                    const SurfacePoint at = receiver(*scene, {0.1, 0.2, double(side)}, {0, 0, -side});
                    const auto s = scene->lights().sampleTowards(at, 0.3, {0.4f, 0.3f});
                    CHECK(bool(s) == shines);
                    const Ray r = rayFrom(at.p, {0, 0, -side});
                    const LightHit h = scene->lights().hit(scene->point(scene->intersect(r), r), -r.d, &at);
                    CHECK(bool(h) == shines);
                    CHECK((h.pdfW > 0) == shines);
                    if (shines) CHECK(h.radiance == Spectrum(7));
                }
            }
    }

    TEST_CASE("B6, B9: point and directional lights; the node's scale changes neither") {
        for (const Affine& s : {Affine{}, scaling(10, 10, 10), scaling(-1, 0.1, 3)}) {
            const auto near = sent(punctual(PunctualKind::point, 1, shapes::translation({0, 0, 1}) * s), {});
            REQUIRE(near);
            CHECK(near->radiance[0] == doctest::Approx(1));
            CHECK(0.8 / std::numbers::pi * double(near->radiance[0]) == doctest::Approx(.2546479089).epsilon(1e-6));
            CHECK(near->delta);
            CHECK(near->kind == LightKind::delta);
            CHECK(near->shadow.tfar == doctest::Approx(1));
            const Vec3d away{2 * std::sin(60 * degree), 0, 2 * std::cos(60 * degree)};
            const auto far = sent(punctual(PunctualKind::point, 1, shapes::translation(away) * s), {});
            CHECK(far->radiance[0] * far->wi.z == doctest::Approx(.125));
            const auto sun = sent(punctual(PunctualKind::directional, 1e5, rotation({1, 0, 0}, 0) * s), {});
            CHECK(0.18 / std::numbers::pi * double(sun->radiance[0] * std::fabs(sun->wi.z)) == doctest::Approx(5729.577951).epsilon(1e-6));
            CHECK(sun->shadow.tfar == infinity);
        }
    }

    TEST_CASE("B7: the cone of a spot, and its flux") {
        PunctualDesc l = punctual(PunctualKind::spot, 1, shapes::translation({0, 0, 1}));
        l.innerCone = 20 * degree;
        l.outerCone = 40 * degree;
        const double table[][2] = {{0, 1}, {20, 1}, {25, .6524510}, {30, .3315081}, {35, .0935347}, {39.99, 0}, {50, 0}, {120, 0}};
        for (const auto& [angle, expected] : table) {
            const auto s = sent(l, {std::sin(angle * degree), 0, 1 - std::cos(angle * degree)});
            CHECK(double(s ? s->radiance[0] : 0) == doctest::Approx(expected).epsilon(1e-4));
        }
        SceneDesc d;
        d.lights.push_back(l);
        CHECK(compiled(std::move(d))->lights().power() == doctest::Approx(.7426103318).epsilon(1e-6));
        l.innerCone = l.outerCone; // a hard edge
        CHECK(sent(l, {std::sin(39 * degree), 0, 1 - std::cos(39 * degree)})->radiance[0] == doctest::Approx(1).epsilon(1e-4));
        l.innerCone = 0.8 * degree; // a slit's beam
        l.outerCone = 1 * degree;
        for (const auto& [angle, expected] : {std::pair{0., 1.}, {0.5, 1.}, {0.79, 1.}, {0.9, .2785}, {1.01, 0.}}) {
            const auto s = sent(l, {std::sin(angle * degree), 0, 1 - std::cos(angle * degree)});
            CHECK(std::fabs(double(s ? s->radiance[0] : 0) - expected) < 0.01);
        }
        SceneDesc slit;
        slit.lights.push_back(l);
        const double inner = std::cos(l.innerCone), outer = std::cos(l.outerCone);
        CHECK(compiled(std::move(slit))->lights().power() ==
              doctest::Approx(2 * std::numbers::pi * (1 - inner + (inner - outer) / 3)).epsilon(1e-5).scale(0));
    }

    TEST_CASE("B8: range") {
        PunctualDesc l = punctual(PunctualKind::point, 1);
        l.range = 5;
        const double table[][2] = {{1, .9984}, {2, .2436}, {4, .0369}, {5, 0}, {6, 0}};
        for (const auto& [distance, expected] : table) {
            const auto s = sent(l, {0, 0, distance});
            CHECK(double(s ? s->radiance[0] : 0) == doctest::Approx(expected).epsilon(1e-5));
        }
    }

    TEST_CASE("B10: a small panel, its flux, its colour; powers of all kinds") {
        SceneDesc d;
        shapes::add(d, "panel", square(0.05), shapes::add(d, shapes::lamp("lamp", Spectrum(1000))));
        const auto scene = compiled(std::move(d));
        CHECK(scene->lights().power() == doctest::Approx(31.41592654).epsilon(1e-6)); // pi A L
        const SurfacePoint at = receiver(*scene, {0, 0, 1}, {0, 0, -1});
        double lux = 0;
        constexpr uint32_t n = 1 << 14;
        for (uint32_t i = 0; i < n; ++i) {
            Sampler u(0, SamplerKind::sobol, Stream::pixel, 0, i);
            const double pick = u.getPick();
            const auto s = scene->lights().sampleTowards(at, pick, u.get2D());
            lux += double(s->radiance[0] * -s->wi.z / s->pdfW) / n;
        }
        CHECK(lux == doctest::Approx(9.966782906).epsilon(1e-5));
        SceneDesc all;
        shapes::add(all, "panel", square(0.5), shapes::add(all, shapes::lamp("lamp", Spectrum(1, .5f, .25f) * 5.f)));
        all.lights = {punctual(PunctualKind::point, 2), punctual(PunctualKind::directional, 3)};
        all.environment = uniformSky(4);
        const auto mixed = compiled(std::move(all));
        const double disc = std::numbers::pi * double(sqr(mixed->radius())), panel = std::numbers::pi * 5 * .58825;
        CHECK(mixed->lights().power() ==
              doctest::Approx(panel + 8 * std::numbers::pi + 3 * disc + 16 * std::numbers::pi * disc).epsilon(1e-5));
        const std::vector<LightInfo> info = mixed->lights().describe();
        REQUIRE(info.size() == 4);
        CHECK(info[0].name == "lamp");
        CHECK(info[0].triangles == 2);
        CHECK(info[0].power == doctest::Approx(panel).epsilon(1e-5));
        CHECK(std::string(info[3].kind) == "environment");
    }

    TEST_CASE("a faint lamp on a wide plain under the sky keeps its share of the samples") {
        SceneDesc d;
        shapes::add(d, "plain", square(1e5), shapes::add(d, shapes::diffuse("grass", Spectrum(0.2f))));
        d.lights.push_back(punctual(PunctualKind::point, 10, shapes::translation({0, 0, 2})));
        d.environment = uniformSky(1000);
        const auto scene = compiled(std::move(d));
        CHECK(scene->lights().pmf(0) >= 1.f / 1024);
        CHECK(scene->lights().pmf(0) + scene->lights().pmf(1) == doctest::Approx(1));
        // Rare among finite lights as well: the pmf is no smaller than the chance that the numbers give it.
        SceneDesc e;
        shapes::add(e, "plain", square(1e5), shapes::add(e, shapes::diffuse("grass", Spectrum(0.2f))));
        e.lights = {punctual(PunctualKind::point, 10, shapes::translation({0, 0, 2})), punctual(PunctualKind::directional, 1e5)};
        const auto sunny = compiled(std::move(e));
        const auto rarest = sunny->lights().sampleTowards(receiver(*sunny, {}, {0, 0, 1}), 0.25, {0, 0.5f});
        REQUIRE(rarest);
        CHECK(rarest->light == 0);
        CHECK(double(rarest->pdfW) == 0x1p-25); // one of 2^24 test numbers, in one of two cells
    }
}
