// The ray-tracing hierarchy: against brute force, scalar against 16 wide, watertight, hostile rays, instruction sets (rows I4 and M10).
#include "core/scene/accel.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

Vec3 direction(stats::Random& u) {
    const float z = 2 * u() - 1, phi = 2 * pi * u(), r = std::sqrt(std::max(0.f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}
PrimitiveDesc soup(int triangles, uint64_t seed) {
    PrimitiveDesc p;
    stats::Random u(seed);
    for (int i = 0; i < triangles; ++i) {
        const Vec3 c{u() * 2 - 1, u() * 2 - 1, u() * 2 - 1};
        for (int k = 0; k < 3; ++k) {
            p.positions.push_back(c + direction(u) * 0.4f);
            p.indices.push_back(uint32_t(p.indices.size()));
        }
    }
    return p;
}
// A soup in world space and another one under three nodes.
SceneDesc mixed() {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(d, "soup", soup(60, 1), grey);
    const Affine places[] = {shapes::translation({2, 0, 0}), shapes::translation({-2, 0, 0}) * scaling(1, -1, 2),
                             rotation({1, 1, 0}, 1) * scaling(0.5, 0.5, 0.5)};
    addInstances(d, soup(40, 2), grey, places);
    return d;
}
std::vector<Ray> randomRays(std::size_t n, uint64_t seed) {
    stats::Random u(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < n; ++i) {
        Ray r = rayFrom(direction(u) * (4 * u()), direction(u));
        if (i % 3 == 0) r.tfar = 3 * u();
        if (i % 5 == 0) r.tnear = std::min(r.tfar, u());
        rays.push_back(r);
    }
    return rays;
}
// Moller and Trumbore 1997, in double: the nearest hit, or infinity.
double bruteForce(const SceneDesc& desc, const Vec3d& centre, const Ray& r) {
    double nearest = double(infinity);
    const Vec3d o = cast<double>(r.o) + centre, d = cast<double>(r.d);
    for (const InstanceDesc& in : desc.instances)
        for (const PrimitiveDesc& p : desc.meshes[std::size_t(in.mesh)].primitives)
            for (std::size_t i = 0; i < p.indices.size(); i += 3) {
                const auto at = [&](std::size_t k) { return in.toWorld.point(cast<double>(p.positions[p.indices[i + k]])); };
                const Vec3d a = at(0), e1 = at(1) - a, e2 = at(2) - a, q = cross(d, e2), s = o - a, c = cross(s, e1);
                const double det = dot(e1, q), u = dot(s, q) / det, v = dot(d, c) / det, t = dot(e2, c) / det;
                if (u >= 0 && v >= 0 && u + v <= 1 && t >= double(r.tnear) && t <= double(r.tfar)) nearest = std::min(nearest, t);
            }
    return nearest;
}

} // namespace

TEST_SUITE("accel") {

    TEST_CASE("hits are those of brute force over all triangles") {
        const SceneDesc desc = mixed();
        const auto scene = compiled(desc);
        int different = 0, hits = 0;
        for (const Ray& r : randomRays(20'000, 3)) {
            const double expected = bruteForce(desc, scene->centre(), r);
            const Hit h = scene->intersect(r);
            hits += bool(h);
            const bool same = h ? std::fabs(double(h.t) - expected) < 1e-4 : expected == double(infinity);
            different += !same; // only where a ray passes an edge within rounding
        }
        CHECK(hits > 3000);
        CHECK(different <= 2);
    }

    TEST_CASE("one ray or sixteen, coherent or not: the same hits; occluded agrees with intersect") {
        const auto scene = compiled(mixed());
        for (const std::size_t n : {std::size_t(1), std::size_t(7), std::size_t(16), std::size_t(17), std::size_t(20'000)}) {
            const std::vector<Ray> rays = randomRays(n, 4);
            std::vector<Hit> wide(n), coherent(n);
            std::vector<uint8_t> shadow(n);
            scene->intersect(rays, wide, false);
            scene->intersect(rays, coherent, true);
            scene->occluded(rays, shadow);
            std::size_t different = 0, distance = 0, occlusion = 0;
            for (std::size_t i = 0; i < n; ++i) {
                const Hit h = scene->intersect(rays[i]);
                for (const Hit& w : {wide[i], coherent[i]}) {
                    different += h.geometry != w.geometry || h.triangle != w.triangle || h.instance != w.instance;
                    distance += h && w && std::fabs(h.t - w.t) > 1e-5f * (1 + h.t);
                }
                occlusion += scene->occluded(rays[i]) != bool(h) || bool(shadow[i]) != bool(h);
            }
            CHECK(different <= n / 5000); // a ray through an edge may name either of its triangles
            CHECK(distance <= n / 5000);
            CHECK(occlusion <= n / 5000);
        }
    }

    TEST_CASE("I4: a triangle, its parameter and weights") {
        SceneDesc d;
        shapes::add(d, "one", triangle({0, 0, 0}, {2, 0, 0}, {0, 2, 1}), shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f))));
        const auto scene = compiled(std::move(d));
        const Hit h = scene->intersect(rayFrom(local(*scene, {.5, .5, 5}), {0, 0, -1}));
        REQUIRE(h);
        CHECK(h.u == doctest::Approx(.25));
        CHECK(h.v == doctest::Approx(.25));
        CHECK(h.t == doctest::Approx(4.75));
    }

    TEST_CASE("I4, M10: from inside a closed mesh no ray escapes through an edge") {
        for (const bool instanced : {false, true}) {
            SceneDesc d;
            const PrimitiveDesc ball = shapes::sphere(1, 3);
            const std::vector<Affine> at(instanced ? 2 : 1, rotation({3, 1, 2}, 0.4));
            addInstances(d, ball, shapes::add(d, shapes::diffuse("grey", Spectrum(0.5f))), at);
            const auto scene = compiled(std::move(d));
            stats::Random u(6);
            constexpr std::size_t batch = 1024;
            std::size_t escaped = 0;
            for (int round = 0; round < 500; ++round) {
                std::vector<Ray> rays;
                std::vector<Hit> hits(batch);
                std::vector<uint8_t> shadows(batch);
                for (std::size_t i = 0; i < batch; ++i) {
                    const uint64_t t = u.next() % (ball.indices.size() / 3) * 3, k = u.next() % 3;
                    const auto corner = [&](uint64_t c) {
                        return local(*scene, at[0].point(cast<double>(ball.positions[ball.indices[t + c % 3]])));
                    };
                    const Vec3 o = direction(u) * (0.8f * u()), a = corner(k), b = corner(k + 1);
                    rays.push_back(rayFrom(o, a + (b - a) * u() - o));
                }
                scene->intersect(rays, hits, round % 2);
                scene->occluded(rays, shadows);
                for (std::size_t i = 0; i < batch; ++i)
                    escaped += !hits[i] || !shadows[i] || (round % 8 == 0 && !scene->intersect(rays[i]));
            }
            CHECK(escaped == 0);
        }
    }

    TEST_CASE("rays that are not rays neither abort nor hit") {
        const auto scene = compiled(mixed());
        const float nan = std::nanf("");
        std::vector<Ray> bad;
        const Ray good = rayFrom({0, 0, 9}, {0, 0, -1});
        for (const float x : {nan, infinity, -infinity, 1e30f, 3e38f})
            for (int k = 0; k < 9; ++k) {
                Ray r = good;
                float* const fields[] = {&r.o.x, &r.o.y, &r.o.z, &r.d.x, &r.d.y, &r.d.z, &r.tnear, &r.tfar, &r.time};
                *fields[k] = x;
                if ((k == 7 && x > 0) || (k >= 6 && std::fabs(x) < infinity)) continue; // an endless ray is one
                bad.push_back(r);
            }
        bad.push_back({good.o, -1, good.d, infinity, 0});
        bad.push_back({good.o, 5, good.d, 4, 0});
        for (const Ray& r : bad) {
            CAPTURE(r.o.x + r.o.y + r.o.z);
            CAPTURE(r.d.x + r.d.y + r.d.z);
            CAPTURE(r.tnear);
            CHECK(!scene->intersect(r));
            CHECK(scene->occluded(r)); // what cannot be traced brings no light
            std::vector<Ray> among(16, good);
            among[5] = r;
            std::vector<Hit> hits(16);
            std::vector<uint8_t> shadows(16);
            scene->intersect(among, hits, false);
            scene->occluded(among, shadows);
            CHECK(!hits[5]);
            CHECK(shadows[5] == 1);
            CHECK(bool(hits[4]) == bool(scene->intersect(good)));
        }
        for (const Vec3& d : {Vec3{0, 0, 0}, Vec3{0, 0, 1e-30f}, Vec3{1e-42f, 0, 0}})
            for (const Vec3& o : {Vec3{0, 0, 0}, Vec3{0, 0, 9}}) {
                const Ray r{o, 0, d, infinity, 0};
                (void)scene->intersect(r); // whatever it hits, it ends
                (void)scene->occluded(r);
            }
    }

    TEST_CASE("instruction sets by name") {
        const SceneDesc desc = mixed();
        const std::string best = compiled(desc)->isa();
        for (const char* isa : {"sse2", "sse4.2", "avx", "avx2", "avx512"}) {
            try {
                const auto scene = compiled(desc, isa);
                CHECK(scene->isa() == isa);
                int different = 0;
                const auto other = compiled(desc);
                for (const Ray& r : randomRays(2000, 8)) different += bool(scene->intersect(r)) != bool(other->intersect(r));
                CHECK(different <= 1);
            } catch (const Error& e) {
                CHECK(e.code == Exit::unsupported); // this machine is older than the name
                CHECK(std::string(e.what()).find(isa) != std::string::npos);
            }
        }
        CHECK(compiled(desc, best)->isa() == best);
        for (const char* wrong : {"avx1024", "AVX2", "best", "neon"}) try {
                compiled(desc, wrong);
                FAIL("accepted ", wrong);
            } catch (const Error& e) {
                CHECK(e.code == Exit::usage);
                CHECK(std::string(e.what()) == std::string("no instruction set \"") + wrong + "\"; have sse2, sse4.2, avx, avx2, avx512");
            }
        CHECK(Accel::version().starts_with("3."));
    }
}
