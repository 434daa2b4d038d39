// Particles that leave lights: every kind emits exactly its power (rows G1, B7, B9, B10), positions and directions follow their densities,
// emissionPdf() tells those of emit(), and what arrives anywhere is what sampleTowards() says.
#include "core/math/warp.h"
#include "core/scene/lights.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <functional>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double degree = std::numbers::pi / 180;

PickAndPoint numbers(stats::Random& u) {
    const double pick = double(u.next() >> 32) * 0x1p-32;
    const float x = u();
    return {pick, {x, u()}};
}
std::optional<LightEmission> shot(const Scene& scene, stats::Random& u) {
    const PickAndPoint from = numbers(u), towards = numbers(u);
    return scene.lights().emit(from, towards, 0);
}

// A floor of half extent 1 at the origin, so that the scene has a size; its bounding sphere has radius sqrt(2).
SceneDesc withFloor() {
    SceneDesc s;
    shapes::add(s, "floor", shapes::quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}),
                shapes::add(s, shapes::diffuse("floor", Spectrum(.5f))));
    return s;
}
PunctualDesc punctual(PunctualKind kind, const Spectrum& intensity, const Affine& place) {
    PunctualDesc l;
    l.kind = kind;
    l.intensity = intensity;
    l.toWorld = place;
    return l;
}
// Looking down from a height; a square with its front down.
Affine down(double x, double y, double z) { return shapes::lookAt({x, y, z}, {x, y - 1, z}, {0, 0, 1}); }
Affine facingDown(double x, double y, double z) { return shapes::translation({x, y, z}) * rotation({1, 0, 0}, 90 * degree); }
void addPlate(SceneDesc& s, MaterialDesc m, double half, const Affine& place) {
    shapes::add(s, m.name, square(half), shapes::add(s, std::move(m)), place);
}
MaterialDesc lamp(float r, float g, float b) { return shapes::lamp("lamp", Spectrum(r, g, b)); }

stats::Moments flux(const Scene& scene, int n, uint64_t seed) {
    stats::Random u(seed);
    stats::Moments m;
    for (int i = 0; i < n; ++i) {
        const auto e = shot(scene, u);
        m.add(e ? double(luminance(e->flux)) : 0);
    }
    return m;
}

struct Kind {
    const char* name;
    double power;  // lumen
    double spread; // of single particles, relative: 0 where each carries all of it
    std::function<void(SceneDesc&)> add;
};
const double sceneDisc = std::numbers::pi * 2; // area of the disc across the sphere of the floor

std::vector<Kind> kinds() {
    std::vector<Kind> all;
    all.push_back({"point", 4 * std::numbers::pi * 3, 0, [](SceneDesc& s) {
                       s.lights.push_back(punctual(PunctualKind::point, Spectrum(3), shapes::translation({.1, .5, .2})));
                   }});
    all.push_back({"spot (B7)", .7426103318 * 2, 0, [](SceneDesc& s) {
                       s.lights.push_back(punctual(PunctualKind::spot, Spectrum(2), down(.2, .9, .1)));
                       s.lights.back().innerCone = 20 * degree;
                       s.lights.back().outerCone = 40 * degree;
                   }});
    all.push_back({"narrow spot", 2 * std::numbers::pi * (1 - std::cos(1 * degree) + (std::cos(1 * degree) - std::cos(5 * degree)) / 3), 0,
                   [](SceneDesc& s) {
                       s.lights.push_back(punctual(PunctualKind::spot, Spectrum(1), down(.2, .9, .1)));
                       s.lights.back().innerCone = 1 * degree;
                       s.lights.back().outerCone = 5 * degree;
                   }});
    all.push_back({"directional (B9)", 1e5 * sceneDisc, 0, [](SceneDesc& s) {
                       s.lights.push_back(punctual(PunctualKind::directional, Spectrum(1e5f), down(0, 1, 0) * rotation({1, 0, 0}, .4)));
                   }});
    all.push_back({"plate (B10)", 31.41592654, 0, [](SceneDesc& s) { addPlate(s, lamp(1000, 1000, 1000), 0.05, facingDown(0, .7, 0)); }});
    all.push_back({"double-sided plate", 2 * std::numbers::pi * .04 * 5, 0, [](SceneDesc& s) {
                       MaterialDesc m = lamp(5, 5, 5);
                       m.doubleSided = true;
                       addPlate(s, m, 0.1, facingDown(0, .7, 0));
                   }});
    all.push_back({"textured plate", std::numbers::pi * .16 * 10 * .5, 1, [](SceneDesc& s) {
                       const uint8_t texels[] = {255, 0, 0, 255};
                       MaterialDesc m = lamp(10, 10, 10);
                       m.emissionTexture.texture = addTexture(s, 2, 2, 1, texels);
                       s.textures.back().filter = TextureFilter::nearest;
                       addPlate(s, m, 0.2, facingDown(0, .7, 0));
                   }});
    all.push_back({"half cut-out plate", std::numbers::pi * .16 * 10 * .3, 0, [](SceneDesc& s) {
                       MaterialDesc m = lamp(10, 10, 10);
                       m.alphaMode = AlphaMode::blend;
                       m.alpha = .3f;
                       addPlate(s, m, 0.2, facingDown(0, .7, 0));
                   }});
    all.push_back({"uniform sky", 4 * std::numbers::pi * .25 * sceneDisc, 0, [](SceneDesc& s) { s.environment = uniformSky(.25f); }});
    all.push_back({"sky with a sun", 0, 1, [](SceneDesc& s) {
                       s.environment = environment(
                           16, 8, [](int x, int y) { return x == 3 && y == 2 ? Spectrum(100) : Spectrum(.1f * float(y < 4)); },
                           TextureFilter::linear);
                   }});
    return all;
}

// What arrives on the floor: lux, per channel 0, in a grid of cells.
constexpr int cells = 4;
int cellOf(const Vec3& p) {
    const int x = int((p.x + 1) * cells / 2), z = int((p.z + 1) * cells / 2);
    return std::clamp(z, 0, cells - 1) * cells + std::clamp(x, 0, cells - 1);
}

} // namespace

TEST_SUITE("emission") {

    TEST_CASE("every light emits exactly its power") {
        for (const Kind& k : kinds()) {
            INFO(std::string(k.name));
            SceneDesc s = withFloor();
            k.add(s);
            const auto scene = compiled(std::move(s));
            const stats::Moments m = flux(*scene, k.spread > 0 ? 400'000 : 2000, 1);
            double expected = k.power;
            if (expected == 0) { // the sky's radiance over all directions, through the disc
                stats::Random v(11);
                stats::Moments sky;
                for (int i = 0; i < 400'000; ++i) {
                    const float x = v();
                    sky.add(4 * std::numbers::pi *
                            double(luminance(scene->lights().miss(rayFrom({}, uniformSphere(Point2{x, v()})), nullptr).radiance)));
                }
                expected = sky.mean * std::numbers::pi * sqr(double(scene->radius()));
                CHECK(std::fabs(m.mean - expected) < 5 * (m.error() + sky.error() * sceneDisc));
                continue;
            }
            if (k.spread == 0)
                CHECK(m.mean == Approx(expected).epsilon(1e-5));
            else
                CHECK(std::fabs(m.mean - expected) < 5 * m.error());
            if (k.spread == 0) CHECK(std::sqrt(m.variance()) < 1e-5 * m.mean);
            // What is told, and what lights are chosen by: textures on a grid, without cut-outs.
            if (k.spread == 0 && !std::string(k.name).starts_with("half")) CHECK(scene->lights().power() == Approx(expected).epsilon(1e-5));
        }
    }

    TEST_CASE("among many lights each is chosen in proportion, and the flux is the sum of theirs") {
        SceneDesc s = withFloor();
        double sum = 0;
        for (const Kind& k : kinds()) {
            const std::string name = k.name;
            if (name.find("sky") != std::string::npos || name.find("directional") != std::string::npos || name.find("textured") == 0)
                continue;
            k.add(s);
            sum += k.power;
        }
        s.environment = uniformSky(.25f);
        const auto scene = compiled(std::move(s));
        sum += 4 * std::numbers::pi * .25 * std::numbers::pi * sqr(double(scene->radius()));
        stats::Random u(2);
        constexpr int n = 400'000;
        std::vector<double> observed(scene->lights().count()), expected(scene->lights().count());
        stats::Moments m;
        int wrong = 0;
        for (int i = 0; i < n; ++i) {
            const auto e = shot(*scene, u);
            REQUIRE(e);
            m.add(double(luminance(e->flux)));
            ++observed[e->light];
            wrong += e->pmf != scene->lights().pmf(e->light);
        }
        for (uint32_t i = 0; i < expected.size(); ++i) expected[i] = n * double(scene->lights().pmf(i));
        CHECK(wrong == 0);
        CHECK(stats::chiSquare(observed, expected).p > 1e-6);
        CHECK(std::fabs(m.mean - sum) < 5 * m.error() + 1e-5 * sum);
    }

    TEST_CASE("directions follow the cosine, the sphere and the ramp of a spot") {
        constexpr int bins = 20, n = 200'000;
        for (const Kind& k : kinds()) {
            const std::string name = k.name;
            const bool plate = name.find("plate") != std::string::npos, spot = name.find("spot") != std::string::npos;
            if (!plate && !spot && name != "point") continue;
            INFO(name);
            SceneDesc s = withFloor();
            k.add(s);
            const double inner = name == "narrow spot" ? 1 : 20, outer = name == "narrow spot" ? 5 : 40, ci = std::cos(inner * degree),
                         co = std::cos(outer * degree);
            const auto scene = compiled(std::move(s));
            stats::Random u(3);
            std::vector<double> observed(bins), expected(bins), turn(bins);
            double kept = 0;
            int wrong = 0;
            for (int i = 0; i < n; ++i) {
                const auto e = shot(*scene, u);
                if (!e) continue;
                ++kept;
                const double c = -double(e->ray.d.y); // all look down
                // The cumulative distribution of each, evenly spread over the bins.
                double f = (1 - c) / 2;
                if (plate) f = 1 - c * c;
                if (plate && c < 0) f = 1 - c * c;
                if (spot) {
                    const double ramp = (ci - co) / 3, total = ramp + 1 - ci, t = (c - co) / (ci - co);
                    f = c < ci ? ramp * t * t * t / total : (ramp + c - ci) / total;
                    // Inside the cone, and the density told is the one by which the ramp was drawn.
                    const double ramped = std::clamp(t, 0.0, 1.0), density = ramped * ramped / (2 * std::numbers::pi * total);
                    wrong += c < co - 1e-5 || std::fabs(double(e->pdfW) - density) > 5e-3 * (density + 1);
                }
                ++observed[std::size_t(std::clamp(f * bins, 0.0, bins - 1.0))];
                const double phi = std::atan2(double(e->ray.d.z), double(e->ray.d.x)) / (2 * std::numbers::pi) + 0.5;
                ++turn[std::size_t(std::clamp(phi * bins, 0.0, bins - 1.0))];
            }
            std::fill(expected.begin(), expected.end(), kept / bins);
            CHECK(wrong == 0);
            CHECK(stats::chiSquare(observed, expected).p > 1e-6);
            CHECK(stats::chiSquare(turn, expected).p > 1e-6);
        }
    }

    TEST_CASE("positions are uniform over the emitter, and over the disc across the scene") {
        for (const Kind& k : kinds()) {
            const std::string name = k.name;
            const bool plate = name.find("plate") != std::string::npos && name.find("textured") == std::string::npos;
            const bool disc = name.find("sky") != std::string::npos || name.find("directional") != std::string::npos;
            if (!plate && !disc) continue;
            INFO(name);
            SceneDesc s = withFloor();
            k.add(s);
            const auto scene = compiled(std::move(s));
            const float r = scene->radius();
            stats::Random u(4);
            constexpr int n = 100'000, bins = 16;
            std::vector<double> observed(bins), expected(bins);
            double kept = 0;
            float reach = 0;
            int wrong = 0;
            for (int i = 0; i < n; ++i) {
                const auto e = shot(*scene, u);
                if (!e) continue;
                ++kept;
                if (plate) {
                    reach = std::max(reach, std::fabs(e->ray.o.x));
                    continue;
                }
                const Vec3 across = e->ray.o - e->ray.d * dot(e->ray.o, e->ray.d);
                ++observed[std::size_t(std::min(lengthSquared(across) / (r * r) * bins, float(bins) - 1))];
                wrong += lengthSquared(across) > r * r * 1.0001f || dot(e->ray.o, e->ray.d) >= -r || // before everything
                         std::fabs(double(e->pdfA) * std::numbers::pi * double(r) * double(r) - 1) > 1e-5;
            }
            CHECK(wrong == 0);
            if (disc) {
                std::fill(expected.begin(), expected.end(), kept / bins);
                CHECK(stats::chiSquare(observed, expected).p > 1e-6);
            } else {
                stats::Random v(5);
                stats::Moments x2, xz;
                for (int i = 0; i < n; ++i) {
                    const auto e = shot(*scene, v);
                    if (!e) continue;
                    const double x = double(e->ray.o.x) / double(reach), z = double(e->ray.o.z) / double(reach);
                    x2.add(x * x);
                    xz.add(x * z);
                }
                CHECK(std::fabs(x2.mean - 1.0 / 3) < 5 * x2.error() + 1e-4);
                CHECK(std::fabs(xz.mean) < 5 * xz.error());
            }
        }
    }

    TEST_CASE("emissionPdf tells the densities of emit, and of sampleTowards from the other end") {
        SceneDesc s = withFloor();
        MaterialDesc both = lamp(1, 2, 3);
        both.doubleSided = true;
        addPlate(s, both, 0.3, facingDown(-.5, .9, 0) * rotation({1, 0, 0}, .3));
        addPlate(s, lamp(5, 5, 5), 0.1, facingDown(.5, .8, .2));
        s.environment = environment(
            8, 4, [](int x, int y) { return Spectrum(float(1 + x + y)); }, TextureFilter::linear);
        const auto scene = compiled(std::move(s));
        stats::Random u(6);
        int area = 0, sky = 0;
        for (int i = 0; i < 60'000; ++i) {
            const auto e = shot(*scene, u);
            if (!e) continue;
            CHECK(e->cosine > 0);
            // Back along the ray, to where it came from.
            const SurfacePoint there = receiver(*scene, scene->centre() + cast<double>(e->ray.o + e->ray.d * 0.5f), {0, 1, 0});
            if (e->kind == LightKind::environment) {
                const EmissionPdf d = scene->lights().emissionPdf(Ray{there.p, 0, -e->ray.d, infinity, 0}, &there);
                CHECK(d.pmf == e->pmf);
                CHECK(d.pdfA == e->pdfA);
                if (std::fabs(d.pdfW / e->pdfW - 1) > 1e-5f) continue; // on the edge of a texel
                CHECK(d.pdfDirectW == scene->lights().miss(Ray{there.p, 0, -e->ray.d, infinity, 0}, &there).pdfW);
                ++sky;
                continue;
            }
            const Ray back{there.p, 0, -e->ray.d, infinity, 0};
            const Hit hit = scene->intersect(back);
            if (!hit) continue;
            const SurfacePoint at = scene->point(hit, back);
            if (at.light == Lights::none) continue;
            const EmissionPdf d = scene->lights().emissionPdf(at, e->ray.d, &there);
            CHECK(d.pmf == e->pmf);
            CHECK(d.pdfA == Approx(e->pdfA).epsilon(1e-5));
            CHECK(d.pdfW == Approx(e->pdfW).epsilon(1e-3));
            CHECK(d.pdfDirectW == Approx(scene->lights().hit(at, e->ray.d, &there).pdfW).epsilon(1e-5));
            CHECK(scene->lights().emissionPdf(at, e->ray.d, nullptr).pdfDirectW == 0);
            // The flux is the radiance over the densities.
            const Spectrum le = scene->lights().hit(at, e->ray.d, nullptr).radiance;
            CHECK(e->flux[0] == Approx(le[0] * e->cosine / (e->pmf * e->pdfA * e->pdfW)).epsilon(1e-4));
            ++area;
        }
        CHECK(area > 300);
        CHECK(sky > 3000);
        // The dark side of a lamp emits nothing.
        SurfacePoint at;
        const Ray up = rayFrom(local(*scene, {.51, 0.5, .22}), {0, 1, 0});
        const Hit hit = scene->intersect(up);
        REQUIRE(hit);
        at = scene->point(hit, up);
        CHECK(scene->lights().emissionPdf(at, {0, -1, 0}, nullptr).pdfW > 0);
        CHECK(scene->lights().emissionPdf(at, {0, 1, 0}, nullptr).pdfW == 0);
    }

    TEST_CASE("what arrives is what sampling the lights says: every kind, everywhere on a floor") {
        auto all = kinds();
        all.push_back({"point with a range", 0, 0, [](SceneDesc& s) {
                           s.lights.push_back(punctual(PunctualKind::point, Spectrum(3), shapes::translation({.1, .5, .2})));
                           s.lights.back().range = 0.9;
                       }});
        for (const Kind& k : all) {
            INFO(std::string(k.name));
            SceneDesc s = withFloor();
            k.add(s);
            const auto scene = compiled(std::move(s));
            const float floorY = local(*scene, {0, 0, 0}).y;
            stats::Random u(7);
            constexpr int n = 100'000;
            std::array<double, cells * cells> landed{}, squares{}, lit{}, litSquares{}, looks{};
            for (int i = 0; i < n; ++i) {
                const auto e = shot(*scene, u);
                if (!e) continue;
                const Hit hit = scene->intersect(e->ray);
                if (!hit || e->ray.d.y >= 0) continue;
                const Vec3 p = e->ray.o + e->ray.d * hit.t;
                if (std::fabs(p.y - floorY) > 1e-4f) continue;
                const double v = double(e->flux[0]) * cells * cells / 4;
                landed[std::size_t(cellOf(p))] += v;
                squares[std::size_t(cellOf(p))] += v * v;
            }
            for (int i = 0; i < n; ++i) {
                const float x = u(), z = u();
                SurfacePoint at = receiver(*scene, {2 * double(x) - 1, 0, 2 * double(z) - 1}, {0, 1, 0});
                at.error = 1e-5f; // it lies on the floor
                const PickAndPoint pick = numbers(u);
                const auto l = scene->lights().sampleTowards(at, pick.pick, pick.u);
                const auto cell = std::size_t(cellOf(at.p));
                ++looks[cell];
                if (!l || l->wi.y <= 0 || scene->occluded(l->shadow)) continue;
                const double v = double(l->radiance[0] * l->wi.y / l->pdfW);
                lit[cell] += v;
                litSquares[cell] += v * v;
            }
            double brightest = 0;
            for (std::size_t c = 0; c < cells * cells; ++c) brightest = std::max(brightest, lit[c] / looks[c]);
            CHECK(brightest > 0);
            for (std::size_t c = 0; c < cells * cells; ++c) {
                const double a = landed[c] / n, b = lit[c] / looks[c];
                const double va = (squares[c] / n - a * a) / n, vb = (litSquares[c] / looks[c] - b * b) / looks[c];
                INFO("cell " << c << ": " << a << " arrived, " << b << " expected");
                CHECK(std::fabs(a - b) <= 5.5 * std::sqrt(va + vb) + 1e-6 * b);
                CHECK(std::sqrt(va + vb) <= 0.08 * brightest);
            }
        }
    }
}
