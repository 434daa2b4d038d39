// Alpha in rays: MASK cuts at alpha >= cutoff, BLEND lets a ray through with probability 1 - alpha, the same for one ray and for sixteen.
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

MaterialDesc alpha(AlphaMode mode, float a, float cutoff = 0.5f) {
    MaterialDesc m = shapes::diffuse("leaf", Spectrum(0.5f));
    m.alphaMode = mode;
    m.alpha = a;
    m.alphaCutoff = cutoff;
    return m;
}
// A square of the material, and nothing behind it.
std::unique_ptr<const Scene> card(MaterialDesc m, bool instanced = false) {
    SceneDesc d;
    const int id = shapes::add(d, std::move(m));
    const std::vector<Affine> at(instanced ? 2 : 1);
    addInstances(d, square(1), id, at);
    return compiled(std::move(d));
}
std::vector<Ray> raysAt(std::size_t n, uint64_t seed) {
    stats::Random u(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 target{1.9f * u() - 0.95f, 1.9f * u() - 0.95f, 0}, from{u() - 0.5f, u() - 0.5f, 2};
        rays.push_back(rayFrom(from, target - from));
    }
    return rays;
}
std::size_t hits(const Scene& scene, const std::vector<Ray>& rays) {
    std::size_t n = 0;
    for (const Ray& r : rays) n += bool(scene.intersect(r));
    return n;
}

} // namespace

TEST_SUITE("alpha") {

    TEST_CASE("MASK: opaque where alpha reaches the cut-off, in camera and shadow rays") {
        const struct {
            float alpha, cutoff;
            bool opaque;
        } cases[] = {{0.5f, 0.5f, true}, {0.49999f, 0.5f, false}, {1, 0.5f, true},  {0, 0, true},
                     {0, 0.5f, false},   {0.25f, 0.25f, true},    {1, 1.1f, false}, {0.7f, 0.8f, false}};
        const std::vector<Ray> rays = raysAt(64, 1);
        for (const auto& k : cases)
            for (const bool instanced : {false, true}) {
                CAPTURE(k.alpha);
                CAPTURE(k.cutoff);
                const auto scene = card(alpha(AlphaMode::mask, k.alpha, k.cutoff), instanced);
                std::vector<Hit> wide(rays.size());
                std::vector<uint8_t> shadow(rays.size());
                scene->intersect(rays, wide, true);
                scene->occluded(rays, shadow);
                for (std::size_t i = 0; i < rays.size(); ++i) {
                    REQUIRE(bool(scene->intersect(rays[i])) == k.opaque);
                    REQUIRE(scene->occluded(rays[i]) == k.opaque);
                    REQUIRE(bool(wide[i]) == k.opaque);
                    REQUIRE(bool(shadow[i]) == k.opaque);
                }
            }
    }

    TEST_CASE("MASK by texture: a leaf covers what its alpha covers, and its shadow likewise") {
        MaterialDesc m = alpha(AlphaMode::mask, 1);
        SceneDesc d;
        const uint8_t texels[] = {255, 255, 255, 200, 255, 255, 255, 100, 255, 255, 255, 128, 255, 255, 255, 127}; // opaque: 200 and 128
        m.baseColorTexture.texture = addTexture(d, 2, 2, 4, texels, {0, Wrap::clamp, Wrap::clamp, TextureFilter::nearest});
        shapes::add(d, "card", square(1), shapes::add(d, m));
        const auto scene = compiled(std::move(d));
        int wrong = 0;
        for (const Ray& r : raysAt(4000, 2)) {
            const Vec3 p = r.o + r.d * (r.o.z / -r.d.z);
            if (std::fabs(p.x) < 1e-4f) continue;
            // Where a hit is found its own UV must name an opaque texel; the left half of the picture is opaque.
            const Hit h = scene->intersect(r);
            const bool left = h ? scene->attributes(h).uv[0].x < 0.5f : false;
            wrong += h && !left;
            wrong += bool(h) != scene->occluded(r);
            wrong += bool(h) != (p.x < 0);
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("BLEND: rays pass with probability 1 - alpha; scalar, wide, camera and shadow rays agree ray by ray") {
        constexpr std::size_t n = 40'000;
        const std::vector<Ray> rays = raysAt(n, 3);
        for (const float a : {0.f, 0.1f, 0.5f, 0.75f, 0.99f, 1.f})
            for (const bool instanced : {false, true}) {
                CAPTURE(a);
                const auto scene = card(alpha(AlphaMode::blend, a), instanced);
                std::vector<Hit> wide(n);
                std::vector<uint8_t> shadow(n);
                scene->intersect(rays, wide, true);
                scene->occluded(rays, shadow);
                std::size_t different = 0, stopped = 0;
                for (std::size_t i = 0; i < n; ++i) {
                    const bool h = bool(scene->intersect(rays[i]));
                    stopped += h;
                    // Two equal instances lie on one another: which of them is named may differ, not whether a ray is stopped.
                    different += h != bool(wide[i]) || h != scene->occluded(rays[i]) || h != bool(shadow[i]);
                }
                CHECK(different == 0);
                const double p = instanced ? 1 - (1 - double(a)) * (1 - double(a)) : double(a);
                const double sigma = std::sqrt(p * (1 - p) / n);
                CHECK(std::fabs(double(stopped) / n - p) <= 4.5 * sigma);
            }
    }

    TEST_CASE("BLEND: layers are independent, vertex alpha and factor multiply, the same ray always gets the same answer") {
        SceneDesc d;
        const int id = shapes::add(d, alpha(AlphaMode::blend, 0.5f));
        PrimitiveDesc p = square(1);
        p.colors.assign(p.positions.size(), {1, 1, 1, 0.8f}); // 0.4 in all
        for (int i = 0; i < 3; ++i) shapes::add(d, "card", p, id, shapes::translation({0, 0, -0.1 * i}));
        const auto scene = compiled(std::move(d));
        const std::vector<Ray> rays = raysAt(40'000, 4);
        const double expected = 1 - 0.6 * 0.6 * 0.6, n = double(rays.size()), sigma = std::sqrt(expected * (1 - expected) / n);
        CHECK(std::fabs(double(hits(*scene, rays)) / n - expected) < 4.5 * sigma);
        CHECK(hits(*scene, rays) == hits(*scene, rays));
        std::vector<double> first(4);
        for (const Ray& r : rays) {
            const Hit h = scene->intersect(r);
            ++first[h ? h.geometry : 3];
        }
        const std::vector<double> share = {0.4 * n, 0.24 * n, 0.144 * n, 0.216 * n};
        CHECK(stats::chiSquare(first, share).p > 1e-4);
    }

    TEST_CASE("opaque mode ignores alpha") {
        const auto scene = card(alpha(AlphaMode::opaque, 0));
        CHECK(hits(*scene, raysAt(100, 5)) == 100);
    }
}
