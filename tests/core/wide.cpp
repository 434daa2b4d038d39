// What runs in lanes gives the bits of what runs alone: starts, packets of rays, positions on flat triangles, sums of a film.
#include "core/math/sobol.h"
#include "core/scene/flat_triangle.h"
#include "core/scene/ray_packet.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

SceneDesc hall() {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.6f)));
    shapes::add(d, "hall", shapes::insideOut(shapes::box({2, 2, 2})), grey);
    shapes::add(d, "block", shapes::box({0.4, 0.7, 0.3}), grey, shapes::translation({0.3, -1, 0.2}));
    shapes::add(d, "ball", shapes::sphere(0.5, 2), grey, shapes::translation({-0.9, 0, 0}));
    const Affine places[] = {shapes::translation({0.9, 0.8, 0}), shapes::translation({-0.8, 0.9, -0.6})};
    addInstances(d, shapes::box({0.2, 0.2, 0.2}), grey, places);
    shapes::addCamera(d, "main", 0.9, shapes::translation({0, 0, 1.9}));
    return d;
}
Vec3 anyDirection(Sampler& s) {
    const Point2 u = s.get2D(), v = s.get2D();
    return normalize(Vec3{u.x - 0.5f, u.y - 0.5f, v.x - 0.5f});
}
bool same(const Hit& a, const Hit& b) {
    return a.geometry == b.geometry && a.triangle == b.triangle && a.instance == b.instance && a.u == b.u && a.v == b.v && a.t == b.t;
}
bool same(const PathStart& a, const PathStart& b) {
    Sampler s = a.sampler, t = b.sampler;
    return a.pixel == b.pixel && a.sample == b.sample && a.ray.o == b.ray.o && a.ray.d == b.ray.d && a.ray.tnear == b.ray.tnear &&
           a.ray.tfar == b.ray.tfar && a.ray.time == b.ray.time && a.footprint.width == b.footprint.width &&
           a.footprint.spread == b.footprint.spread && s.dimension() == t.dimension() && s.get1D() == t.get1D() && same(a.first, b.first);
}

} // namespace

TEST_SUITE("wide") {

    TEST_CASE("the tile loop's starts are those of startPixel, to the last bit, for every camera, sampler, filter, shutter and batch") {
        const auto scene = compiled(hall());
        for (int variant = 0; variant < 7; ++variant) {
            CAPTURE(variant);
            CameraDesc camera = scene->cameras()[0];
            Settings s{21, 19, 20};
            s.filter = variant == 1 ? FilterKind::gauss : variant == 2 ? FilterKind::box : FilterKind::blackmanHarris;
            if (variant == 3) s.sampler = SamplerKind::independent;
            if (variant == 4) camera.lens.radius = 0.05;
            if (variant == 5) camera.projection = Projection::orthographic;
            Bench bench(*scene, camera, s);
            if (variant == 6) bench.job.shutter = {0.25f, 0.75f};
            for (const uint32_t width : {7u, 256u}) {
                Starts how;
                how.width = width;
                int wrong = 0, count = 0;
                Film film(bench.layout());
                uint32_t begin = 0;
                for (const uint32_t end : {1u, 3u, 20u}) {
                    forEachBatch(
                        bench.job, {begin, end, nullptr}, film,
                        [&](std::span<PathStart> p, std::span<Outputs>) {
                            for (const PathStart& start : p) wrong += !same(start, startPixel(bench.job, start.pixel, start.sample));
                            count += int(p.size());
                        },
                        how);
                    begin = end;
                }
                CHECK(count == 21 * 19 * 20);
                CHECK(wrong == 0);
            }
        }
    }

    TEST_CASE("pairSeeds and at() draw what get2D draws") {
        for (uint32_t sample = 0; sample < 500; ++sample) {
            Sampler one(7, SamplerKind::sobol, Stream::pixel, 12345, sample), other(7, SamplerKind::sobol, Stream::pixel, 12345, 3);
            one.skip(4);
            other.skip(4);
            const Sampler::PairSeeds seeds = other.pairSeeds();
            const Point2 lane = sobolPair(shuffledIndex(sample, seeds.index), seeds.x, seeds.y), moved = other.at(sample).get2D(),
                         alone = one.get2D();
            CHECK(lane.x == alone.x);
            CHECK(lane.y == alone.y);
            CHECK(moved.x == alone.x);
            CHECK(moved.y == alone.y);
        }
    }

    TEST_CASE("a packet answers as its rays do, and leaves out those that are none") {
        const auto scene = compiled(hall());
        Sampler s(1, SamplerKind::independent, Stream::pixel, 0, 0);
        int wrong = 0;
        for (int round = 0; round < 200; ++round) {
            RayPacket packet;
            std::vector<Ray> rays;
            for (std::size_t k = 0; k < RayPacket::size; ++k) {
                rays.push_back({{0.1f, 0.2f, 1.5f}, 0, anyDirection(s), k % 3 ? infinity : 0.8f, 0});
                if (k == 5) rays.back().tfar = -1;
                if (k == 6) rays.back().d.x = std::nanf("");
                if (k == 7) rays.back().o.y = 1e30f;
                packet.set(k, rays.back());
            }
            Hit hits[RayPacket::size], each[RayPacket::size];
            uint8_t blocked[RayPacket::size], alone[RayPacket::size];
            const std::size_t n = 1 + std::size_t(round) % RayPacket::size;
            scene->intersect(packet, {hits, n}, false);
            scene->occluded(packet, {blocked, n});
            scene->intersect(std::span(rays).first(n), {each, n}, false);
            scene->occluded(std::span(rays).first(n), {alone, n});
            for (std::size_t k = 0; k < n; ++k) {
                wrong += !same(hits[k], each[k]) || blocked[k] != alone[k];
                if (k >= 5 && k <= 7) wrong += bool(hits[k]) || blocked[k] != 1;
            }
        }
        CHECK(wrong == 0);
    }

    TEST_CASE("a point on a flat triangle is that of point(); smooth and instanced ones are not flat") {
        const auto scene = compiled(hall());
        Sampler s(2, SamplerKind::independent, Stream::pixel, 0, 0);
        int flat = 0, others = 0, wrong = 0;
        const auto compare = [&](const Hit& hit, const Ray& ray) {
            const SurfacePoint p = scene->point(hit, ray);
            FlatTriangle f;
            if (!scene->flat(hit, f)) {
                ++others;
                return;
            }
            ++flat;
            wrong += !(f.at(hit.u, hit.v) == p.p) || !(f.ng == p.ng) || !(f.ng == p.ns) || f.error != p.error || f.material != p.material ||
                     f.light != p.light || !(p.p + f.ng * reachOf(f.ng, f.error) == p.offset(f.ng));
        };
        for (int i = 0; i < 20'000; ++i) {
            const Ray ray = rayFrom({0.1f, 0.2f, 1.5f}, anyDirection(s));
            Hit hit = scene->intersect(ray);
            if (!hit) continue;
            compare(hit, ray);
            const Point2 edge = s.get2D(); // on the very edges too
            hit.u = i % 2 ? 0 : edge.x * 1e-6f;
            hit.v = edge.y;
            compare(hit, ray);
        }
        CHECK(flat > 5000);
        CHECK(others > 500);
        CHECK(wrong == 0);
    }

    TEST_CASE("samples added together are samples added one by one: bright, tiny, negative, not finite, from an odd one on") {
        const FilmLayout plain{2, 1, {0, 0, 2, 1}, {}, false};
        Sampler s(3, SamplerKind::independent, Stream::pixel, 0, 0);
        for (const bool bright : {false, true}) {
            Film together(plain), apart(plain);
            uint32_t next = 0;
            for (const uint32_t n : {1u, 16u, 5u, 32u, 3u, 40u}) {
                std::vector<Outputs> outs(n, Outputs(plain));
                for (uint32_t k = 0; k < n; ++k) {
                    const float scale = std::ldexp(1.f, int(s.get1D() * 60) - 52);
                    outs[k].add(otherLayer, {scale * (s.get1D() - 0.3f), k % 4 ? s.get1D() : 0.f, k % 5 ? 1.f : 511.99f});
                    outs[k].aov(Aov::albedo, {s.get1D(), 2 * s.get1D(), 0.5f});
                    outs[k].aov(Aov::normal, {s.get1D() - 1, -s.get1D() * 3, std::ldexp(s.get1D(), -25)});
                    if (bright && k == 2) outs[k].layer[0][1] = 1e7f;
                    if (bright && k == 3) outs[k].layer[0][2] = std::nanf("");
                    if (bright && k == 7) outs[k].aovs[0][2] = infinity;
                }
                together.add({1, 0}, next, outs);
                for (uint32_t k = 0; k < n; ++k) apart.add({1, 0}, next + k, {&outs[k], 1});
                next += n;
            }
            CHECK(samePicture(together, apart));
            CHECK(together.dropped() == apart.dropped());
            CHECK((together.dropped() > 0) == bright);
        }
    }

    TEST_CASE("outputs begin black in every layer that they have, whatever lay there before") {
        alignas(Outputs) std::byte room[sizeof(Outputs)];
        for (const std::size_t layers : {std::size_t(0), std::size_t(1), std::size_t(5), std::size_t(Outputs::maxLayers)}) {
            FilmLayout layout{1, 1, {0, 0, 1, 1}, {}, false};
            for (std::size_t i = 0; i < layers; ++i) layout.layers.push_back("layer");
            std::fill_n(room, sizeof room, std::byte(0x7f));
            const Outputs& o = *::new (room) Outputs(layout);
            CHECK(o.layers() == int(std::max<std::size_t>(layers, 1)));
            for (int l = 0; l < o.layers(); ++l) CHECK(black(o.layer[l]));
            CHECK(black(o.total()));
        }
    }
}
