// The light tree: probabilities that are the frequencies of its choices and sum to one with that of no choice, none of zero for what can
// shine, direct light that does not depend on who chose the light.
#include "core/scene/light_tree.h"
#include "core/math/warp.h"
#include "core/render/executor.h"
#include "tests/core/wide_lookup.h"
#include "tests/render/measure.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

Vec3 inBox(stats::Random& u, float half) { return {(2 * u() - 1) * half, (2 * u() - 1) * half, (2 * u() - 1) * half}; }
Vec3 direction(stats::Random& u) {
    const float x = u();
    return uniformSphere(Point2{x, u()});
}
double pick(stats::Random& u) { return double(u.next() >> 32) * 0x1p-32; }

// What a small one-sided emitter brings to a point; its cosine as the paper bounds it.
float brought(const LightTree::Emitter& e, const Vec3& p) {
    const Vec3 way = p - e.centre;
    const float cosine = dot(normalize(way), e.axis);
    return e.intensity * (e.bothSides ? std::fabs(cosine) : std::max(cosine, 0.f)) / lengthSquared(way);
}

std::vector<LightTree::Emitter> scattered(uint32_t count, uint64_t seed) {
    stats::Random u(seed);
    std::vector<LightTree::Emitter> all;
    for (uint32_t i = 0; i < count; ++i) {
        LightTree::Emitter e;
        e.centre = inBox(u, 10);
        e.radius = 0.2f * u();
        e.axis = direction(u);
        e.intensity = i % 17 == 3 ? 0.f : std::exp(8 * u() - 4);
        e.area = e.radius * e.radius;
        e.bothSides = i % 5 == 1;
        if (i % 7 == 2) e.radius = e.area = 0, e.cosSpread = -1;                          // a point light
        if (i % 11 == 4) e.radius = e.area = 0, e.cosSpread = 0.9f, e.cosReach = 0.8f;    // a spot
        if (i % 13 == 5 && i > 0) e.centre = all.back().centre, e.axis = all.back().axis; // in the same place
        e.light = i;
        all.push_back(e);
    }
    return all;
}
// Bulbs of many triangles, some panels, points and a spot under a sky and a sun.
SceneDesc town(bool outside) {
    SceneDesc d;
    const int bulb = shapes::add(d, shapes::lamp("bulb", Spectrum(30, 20, 10)));
    MaterialDesc both = shapes::lamp("sheet", Spectrum(5));
    both.doubleSided = true;
    const int sheet = shapes::add(d, both), grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(d, "ground", square(6), grey);
    std::vector<Affine> places;
    stats::Random u(5);
    for (int i = 0; i < 12; ++i)
        places.push_back(shapes::translation({8.0 * u() - 4, 8.0 * u() - 4, 0.4 + u()}) * scaling(0.5 + u(), 1, 1));
    addInstances(d, shapes::sphere(0.1, 2), bulb, places);
    for (int i = 0; i < 4; ++i)
        shapes::add(d, "sheet", square(0.3), sheet, shapes::translation({3.0 * i - 5, -2, 1.5}) * rotation({1, 0, 0}, 0.7 * i));
    for (int i = 0; i < 6; ++i) {
        PunctualDesc l;
        l.kind = i % 3 == 2 ? PunctualKind::spot : PunctualKind::point;
        l.intensity = Spectrum(0.3f + u());
        l.toWorld = shapes::translation({8.0 * u() - 4, 8.0 * u() - 4, 1});
        d.lights.push_back(l);
    }
    if (outside) {
        PunctualDesc sun;
        sun.kind = PunctualKind::directional;
        sun.intensity = Spectrum(0.5f);
        d.lights.push_back(sun);
        d.environment = environment(8, 4, [](int x, int y) { return Spectrum(float(1 + x), float(y), 0.5f) * 0.02f; });
    }
    return d;
}

} // namespace

TEST_SUITE("light-tree") {

    TEST_CASE("its probabilities are the frequencies of its choices, and sum to one with that of none") {
        for (const uint32_t count : {2u, 5u, 9u, 300u, 6000u}) {
            CAPTURE(count);
            const auto emitters = scattered(count, count);
            const LightTree tree(emitters, count);
            REQUIRE(!tree.empty());
            stats::Random u(2);
            for (int point = 0; point < 20; ++point) {
                const Vec3 p = inBox(u, point < 10 ? 12.f : 100.f), n = direction(u);
                double sum = 0;
                for (uint32_t i = 0; i < count; ++i) sum += double(tree.pmf(i, p, n));
                CHECK(sum < 1 + 1e-4);
            }
            const Vec3 p = inBox(u, 8), n = direction(u);
            constexpr int draws = 100'000;
            // Bounds err: where a part is entered from which nothing comes after all, there is no choice. That is rare.
            std::vector<double> observed(count + 1), expected(count + 1);
            int wrong = 0;
            for (int i = 0; i < draws; ++i) {
                const LightTree::Pick c = tree.choose(p, n, pick(u));
                const bool none = c.light == LightTree::none;
                ++observed[none ? count : c.light];
                wrong += !none && std::fabs(c.pmf / tree.pmf(c.light, p, n) - 1) > 1e-5f;
            }
            CHECK(wrong == 0);
            double sum = 0;
            for (uint32_t i = 0; i < count; ++i) {
                expected[i] = draws * double(tree.pmf(i, p, n));
                sum += expected[i];
            }
            expected[count] = std::max(0.0, draws - sum);
            CHECK((sum > 0.8 * draws || sum == 0));
            CHECK(stats::chiSquare(observed, expected).p > stats::sidak(5));
        }
    }

    TEST_CASE("what can shine on a point is never left out, and takes about its part") {
        constexpr uint32_t count = 4000;
        const auto emitters = scattered(count, 9);
        const LightTree tree(emitters, count);
        stats::Random u(3);
        int left = 0, dark = 0;
        for (int i = 0; i < 100'000; ++i) {
            const LightTree::Emitter& e = emitters[std::size_t(u() * count)];
            const Vec3 p = i % 2 ? inBox(u, 12) : e.centre + inBox(u, 0.5f), n = direction(u);
            const Vec3 way = normalize(p - e.centre);
            const float cosine = e.bothSides ? std::fabs(dot(way, e.axis)) : dot(way, e.axis);
            const bool arrives = e.intensity > 0 && (e.cosSpread < 0 || (e.cosSpread < 1 ? cosine > 0.5f : cosine > 1e-3f));
            const float pmf = tree.pmf(e.light, p, n);
            left += arrives && pmf == 0;
            dark += e.intensity == 0 && pmf > 0;
        }
        CHECK(left == 0);
        CHECK(dark == 0);
        // The mean square of brought / pmf is that of the error: far below that of a choice by intensity.
        double tree2 = 0, power2 = 0, intensity = 0;
        for (const auto& e : emitters) intensity += double(e.intensity);
        for (int i = 0; i < 50; ++i) {
            const Vec3 p = inBox(u, 10), n = direction(u);
            double sum = 0, t = 0, w = 0;
            for (const auto& e : emitters) {
                if (e.radius == 0 || e.intensity == 0) continue;
                const double b = double(brought(e, p));
                sum += b;
                if (b > 0) t += b * b / double(tree.pmf(e.light, p, n));
                w += b * b / (double(e.intensity) / intensity);
            }
            tree2 += t / (sum * sum);
            power2 += w / (sum * sum);
        }
        MESSAGE("second moment over the square of the mean: tree " << tree2 / 50 << ", intensity " << power2 / 50);
        CHECK(tree2 < power2 / 3);
    }

    TEST_CASE("sixteen points at once choose what each of them would, in either instruction set") {
        std::vector<TreeProgram*> programs;
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) programs.push_back(treeAvx2);
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
            __builtin_cpu_supports("avx512vl"))
            programs.push_back(treeAvx512);
        for (const uint32_t count : {2u, 9u, 300u, 6000u})
            for (TreeProgram* const program : programs) {
                CAPTURE(count);
                std::vector<LightTree::Emitter> emitters = scattered(count, count);
                for (uint32_t i = 0; i < 40; ++i) // a sheet of many triangles: a patch
                    emitters.push_back({.centre = {0.1f * float(i % 8), 0.1f * float(i / 8), 20},
                                        .radius = 0.1f,
                                        .intensity = 1 + float(i),
                                        .area = 0.01f,
                                        .light = count + i});
                const LightTree tree(emitters, count + 40);
                stats::Random u(6);
                int others = 0, same = 0, off = 0;
                double drift = 0;
                for (int round = 0; round < 2500; ++round) {
                    TreeLanes l;
                    const auto lanes = uint32_t(round % 3 == 0 ? 0xffffu : u.next() >> 48);
                    const Vec3 together = inBox(u, 12);
                    for (uint32_t k = 0; k < TreeLanes::size; ++k) {
                        const Vec3 p = round % 2 ? inBox(u, round % 5 ? 12.f : 100.f) : together + inBox(u, 0.01f), n = direction(u);
                        l.px[k] = p.x, l.py[k] = p.y, l.pz[k] = p.z, l.nx[k] = n.x, l.ny[k] = n.y, l.nz[k] = n.z;
                        l.pick[k] = uint32_t(u.next() >> 32);
                    }
                    program(viewOf(tree), lanes, l);
                    for (uint32_t k = 0; k < TreeLanes::size; ++k) {
                        if ((lanes >> k & 1) == 0) continue;
                        const LightTree::Pick c =
                            tree.choose({l.px[k], l.py[k], l.pz[k]}, {l.nx[k], l.ny[k], l.nz[k]}, double(l.pick[k]) * 0x1p-32);
                        if (c.light != l.light[k]) { // a number that lies between two
                            ++others;
                            continue;
                        }
                        if (c.light == LightTree::none) continue;
                        ++same;
                        const double ratio = double(l.pmf[k]) / double(c.pmf) - 1;
                        off += !(std::fabs(ratio) < 1e-3);
                        drift += ratio;
                    }
                }
                CHECK(same > 10'000);
                CHECK(others < same / 5000 + 2);
                CHECK(off == 0);
                CHECK(std::fabs(drift / same) < 1e-6);
            }
    }

    TEST_CASE("the same for any number of threads; nothing to choose from; one patch; extreme places") {
        const auto emitters = scattered(20'000, 4);
        const Executor one(1), two(2);
        const LightTree a(emitters, 20'000, &one), b(emitters, 20'000, &two), c(emitters, 20'000);
        stats::Random u(6);
        int differ = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 p = inBox(u, 12), n = direction(u);
            const double x = pick(u);
            const auto s = a.choose(p, n, x), t = b.choose(p, n, x), w = c.choose(p, n, x);
            differ += s.light != t.light || s.light != w.light || s.pmf != t.pmf || s.pmf != w.pmf;
        }
        CHECK(differ == 0);
        CHECK(LightTree().empty());
        CHECK(LightTree({}, 7).empty());
        LightTree::Emitter half;
        half.radius = 0.5f;
        half.intensity = 1;
        half.area = 0.4f;
        LightTree::Emitter other = half;
        other.light = 1;
        CHECK(LightTree(std::vector{half, other}, 2).empty()); // a square of two
        other.centre = {5, 0, 0};
        const LightTree pair(std::vector{half, other}, 2);
        REQUIRE(!pair.empty());
        const double nearly = 1 - 0x1p-32;
        for (const Vec3& p : {Vec3{}, Vec3{5, 0, 0}, Vec3{1e18f, 0, 0}, Vec3{0, 0, 1e-18f}, Vec3{0, 0, -3}})
            for (const double x : {0.0, 0.5, nearly}) {
                const auto s = pair.choose(p, {0, 0, 1}, x);
                CHECK(std::isfinite(s.pmf));
                CHECK((s.light == LightTree::none || s.pmf > 0));
            }
    }
}

TEST_SUITE("light-choice") {

    TEST_CASE("over all lights the choice towards a point sums to one or little less, and is that of the samples and of the hits") {
        for (const bool outside : {false, true}) {
            const auto scene = compiled(town(outside));
            const Lights& lights = scene->lights();
            REQUIRE(lights.byTree());
            stats::Random u(8);
            for (int i = 0; i < 20; ++i) {
                const SurfacePoint at = receiver(*scene, {8.0 * u() - 4, 8.0 * u() - 4, 3.0 * u() - 0.5}, direction(u));
                double sum = 0;
                for (uint32_t k = 0; k < lights.count(); ++k) sum += double(lights.pmf(k, at));
                CHECK(sum < 1 + 1e-4);
                CHECK(sum > 0.95);
            }
            int wrong = 0, hits = 0;
            for (int i = 0; i < 20'000; ++i) {
                const SurfacePoint at = receiver(*scene, {8.0 * u() - 4, 8.0 * u() - 4, 0.05}, {0, 0, 1});
                const double x = pick(u);
                const float v = u();
                const auto s = lights.sampleTowards(at, x, {v, u()});
                if (!s) continue;
                if (s->delta) {
                    wrong += std::fabs(s->pdfW / lights.pmf(s->light, at) - 1) > 1e-4f;
                    continue;
                }
                if (s->kind == LightKind::environment || scene->occluded(s->shadow)) continue;
                const Ray r = rayFrom(at.p, s->wi);
                const SurfacePoint there = scene->point(scene->intersect(r), r);
                if (there.light != s->light) continue;
                ++hits;
                const LightHit h = lights.hit(there, -r.d, &at);
                wrong += std::fabs(h.pdfW / s->pdfW - 1) > 5e-3f;
                wrong += std::fabs(lights.emissionPdf(there, -r.d, &at).pdfDirectW / h.pdfW - 1) > 1e-5f;
            }
            CHECK(hits > 2000);
            CHECK(wrong <= hits / 500);
        }
    }

    TEST_CASE("direct light is the same by the tree and by the table of powers") {
        for (const bool outside : {false, true}) {
            const auto scene = compiled(town(outside));
            const Lights& lights = scene->lights();
            const double edge = double(lights.pickEnvironment());
            for (const Vec3d& p : {Vec3d{0, 0, 0.02}, Vec3d{3, -2, 0.02}, Vec3d{-3.5, 3, 0.02}}) {
                const SurfacePoint at = receiver(*scene, p, {0, 0, 1});
                const auto value = [&](const std::optional<LightSample>& s, float pmf) {
                    if (!s || !(s->pdfW > 0) || !(s->wi.z > 0) || scene->occluded(s->shadow)) return 0.0;
                    return double(luminance(s->radiance) * s->wi.z / (s->pdfW * pmf));
                };
                const auto replicate = [&](bool tree, int r) {
                    double sum = 0;
                    constexpr uint32_t n = 4096;
                    for (uint32_t i = 0; i < n; ++i) {
                        Sampler sampler(uint64_t(r) * 2 + tree, SamplerKind::sobol, Stream::pixel, 1, i);
                        const PickAndPoint u = sampler.get3D();
                        if (tree) {
                            sum += value(lights.sampleTowards(at, u.pick, u.u), 1);
                        } else if (u.pick < edge) {
                            sum += value(lights.sampleOne(lights.count() - 1, at, u.pick / edge, u.u), float(edge));
                        } else {
                            const Choice c = lights.byPower().choose((u.pick - edge) / (1 - edge), u.u.x);
                            sum += value(lights.sampleOne(c.index, at, 0, {c.u, u.u.y}), float(1 - edge) * c.pmf);
                        }
                    }
                    return sum / n;
                };
                const Measured tree = overReplicates([&](int r) { return replicate(true, r); });
                const Measured power = overReplicates([&](int r) { return replicate(false, r); });
                MESSAGE("tree " << tree.value << " +- " << tree.error << ", power " << power.value << " +- " << power.error);
                CHECK(std::fabs(tree.value - power.value) < criticalT * std::hypot(tree.error, power.error));
                CHECK(tree.error < 0.02 * tree.value);
            }
        }
    }

    TEST_CASE("few lamps, and lamps that move, are chosen by power") {
        const auto of = [](int lamps, bool moving) {
            SceneDesc d;
            const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(3)));
            for (int i = 0; i < lamps; ++i) shapes::add(d, "panel", square(0.2), lamp, shapes::translation({double(i), 0, 0}));
            d.shutter = {0, 1};
            if (moving)
                for (InstanceDesc& i : d.instances) i.motion = {i.toWorld, shapes::translation({0, 0, 0.5}) * i.toWorld};
            return compiled(std::move(d));
        };
        CHECK(!of(4, false)->lights().byTree());
        CHECK(of(5, false)->lights().byTree());
        const auto moving = of(5, true);
        CHECK(!moving->lights().byTree());
        const SurfacePoint at = receiver(*moving, {0, 0, 2}, {0, 0, -1});
        for (uint32_t i = 0; i < moving->lights().count(); ++i) CHECK(moving->lights().pmf(i, at) == moving->lights().pmf(i));
    }

    TEST_CASE("the power of a lamp with few texels is that of what its look-ups show") {
        for (const int size : {1, 2, 3, 5})
            for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear}) {
                CAPTURE(size);
                SceneDesc d;
                MaterialDesc m = shapes::lamp("lamp", Spectrum(1));
                std::vector<uint8_t> texels;
                stats::Random u{uint64_t(size)};
                for (int i = 0; i < size * size * 3; ++i) texels.push_back(uint8_t(i % 4 == 1 ? 255 : 40 * u()));
                m.emissionTexture.texture = addTexture(d, size, size, 3, texels);
                d.textures[std::size_t(m.emissionTexture.texture)].filter = filter;
                shapes::add(d, "panel", square(0.5), shapes::add(d, m));
                const auto scene = compiled(std::move(d));
                double sum = 0;
                constexpr int n = 400;
                for (uint32_t t = 0; t < 2; ++t)
                    for (int i = 0; i < n; ++i)
                        for (int j = 0; j < n; ++j) {
                            const Point2 b = uniformTriangle(Point2{(float(i) + .5f) / n, (float(j) + .5f) / n});
                            SurfacePoint at = scene->attributes({0, t, Hit::none, b.x, b.y, 0});
                            sum += double(luminance(scene->lights().hit(at, {0, 0, 1}, nullptr).radiance));
                        }
                const double exact = std::numbers::pi * sum / (2.0 * n * n);
                CHECK(scene->lights().power() == doctest::Approx(exact).epsilon(0.02));
            }
    }
}
