// Meshes that change their shape while the shutter is open: hits, points and corners against closed forms, error bounds, packets, lights,
// bounds, memory and name of the scene.
#include "core/scene/flat_triangle.h"
#include "core/scene/ray_packet.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>
#include <numbers>
#include <random>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr Interval second{0, 1};

struct Dice {
    std::mt19937 engine{11};
    double operator()(double low = -1, double high = 1) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Vec3d vector(double size = 1) { return Vec3d{(*this)(), (*this)(), (*this)()} * size; }
};

// The shape under a map at each step.
template <class Map> PrimitiveDesc bent(PrimitiveDesc p, int steps, Map map) {
    const PrimitiveDesc base = p;
    for (int i = 0; i <= steps; ++i) {
        ShapeDesc s;
        for (const Vec3& v : base.positions) s.positions.push_back(cast<float>(map(double(i) / steps, cast<double>(v))));
        s.normals = base.normals;
        if (i == 0)
            p.positions = s.positions;
        else
            p.steps.push_back(s);
    }
    return p;
}
SceneDesc scene(PrimitiveDesc p, const Affine& place = {}, Interval shutter = second) {
    SceneDesc s;
    s.shutter = shutter;
    const int material = shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(s, "thing", std::move(p), material, place);
    return s;
}
// A square of half extent 1 in z = 0 that rises by 3 and grows threefold.
PrimitiveDesc rising() {
    return bent(square(1), 1, [](double t, const Vec3d& p) { return Vec3d{p.x * (1 + 2 * t), p.y * (1 + 2 * t), 3 * t}; });
}
PrimitiveDesc wobbling(int level, double size, int steps) {
    return bent(shapes::sphere(size, level), steps, [=](double t, const Vec3d& p) {
        const double a = 2 * t;
        return Vec3d{p.x * (1 + t) + size * t, p.y * std::cos(a) - p.z * std::sin(a), p.y * std::sin(a) + p.z * std::cos(a) - size * t};
    });
}

} // namespace

TEST_SUITE("deform") {
    TEST_CASE("a square that rises and grows: hits, normals and corners at every time") {
        for (const bool instanced : {false, true}) {
            CAPTURE(instanced);
            const Affine place = shapes::translation({5, 0, 0}) * rotation({1, 0, 0}, std::numbers::pi / 2); // z becomes -y
            SceneDesc d = scene(rising(), place);
            if (instanced) d.instances.push_back({0, shapes::translation({-50, 0, 0}), "twin"});
            const auto s = compiled(std::move(d));
            for (const float t : {0.f, 0.25f, 0.5f, 0.9f, 1.f}) {
                CAPTURE(t);
                const double half = 1 + 2 * double(t), height = -3 * double(t);
                for (const double x : {0.98, 1.02}) {
                    Ray ray = rayFrom(local(*s, {5 + x * half, 10, 0.1}), {0, -1, 0});
                    ray.time = t;
                    const Hit hit = s->intersect(ray);
                    CHECK(bool(hit) == (x < 1));
                    CHECK(s->occluded(ray) == (x < 1));
                    if (!hit) continue;
                    const SurfacePoint p = s->point(hit, ray);
                    CHECK(double(p.p.y) + s->centre().y == doctest::Approx(height).epsilon(1e-5));
                    CHECK(hit.t == doctest::Approx(10 - height).epsilon(1e-6));
                    CHECK(std::fabs(p.ng.y) == doctest::Approx(1));
                    CHECK(p.time == t);
                    FlatTriangle flat;
                    CHECK_FALSE(s->flat(hit, flat));
                }
                const auto corners = s->corners(s->parts()[0], 0, t);
                CHECK(length(corners[1] - corners[0]) == doctest::Approx(2 * half));
            }
            CHECK(s->moves(s->parts()[0]));
            CHECK(double(s->radius()) > 3);
        }
    }

    TEST_CASE("normals and tangents go along") {
        PrimitiveDesc p = square(1);
        p.normals.assign(4, {0, 0, 1});
        p.tangents.assign(4, {1, 0, 0, -1});
        ShapeDesc leaning{p.positions, std::vector<Vec3>(4, {1, 0, 0}), std::vector<Vec4>(4, {0, 1, 0, -1})};
        leaning.positions[0].z += 1e-3f;
        p.steps = {leaning};
        SceneDesc d = scene(p);
        d.materials[0].normalTexture.texture = 0;
        const uint8_t texel[] = {128, 128, 255};
        addTexture(d, 1, 1, 3, texel);
        const auto s = compiled(std::move(d));
        Ray ray = rayFrom(local(*s, {0.1, 0.2, 5}), {0, 0, -1});
        ray.time = 0.25f;
        const SurfacePoint at = s->point(s->intersect(ray), ray);
        const Vec3 n = normalize(Vec3{0.25f, 0, 0.75f});
        CHECK(length(at.ns - n) < 1e-6f);
        CHECK(length(normalize(at.tangent) - normalize(Vec3{0.75f, 0.25f, 0})) < 1e-6f);
        CHECK(at.tangentSign == -1);
    }

    TEST_CASE("a hit lies on its ray, under a moving node too, and no ray from it meets its own surface") {
        Dice dice;
        for (const double size : {1e-3, 1., 1e4})
            for (const bool moving : {false, true}) {
                CAPTURE(size);
                CAPTURE(moving);
                SceneDesc d = scene(wobbling(3, size, 3), shapes::translation(Vec3d{100, -30, 7} * size));
                if (moving)
                    for (int i = 0; i <= 4; ++i)
                        d.instances[0].motion.push_back(shapes::translation(Vec3d{100, -30, 7.0 + i} * size) *
                                                        rotation({0.2, 1, 0}, i * 0.4));
                const auto s = compiled(std::move(d));
                double worst = 0;
                int met = 0, lost = 0, hits = 0;
                for (int r = 0; r < 3000; ++r) {
                    const float time = r % 50 == 0 ? float(r % 100 == 0) : float(dice(0, 1));
                    Vec3 middle; // of three triangles far from each other
                    for (const uint32_t k : {0u, 427u, 853u})
                        for (const Vec3& p : s->corners(s->parts()[0], (uint32_t(r) + k) % s->parts()[0].triangles, time))
                            middle += p * (1 / 9.f);
                    Ray ray = rayFrom(middle, cast<float>(dice.vector()));
                    ray.time = time;
                    const Hit hit = s->intersect(ray); // from inside: a leak is a miss
                    if (!hit) {
                        ++lost;
                        continue;
                    }
                    ++hits;
                    const SurfacePoint p = s->point(hit, ray);
                    const double off = double(std::fabs(dot(p.p - ray.o - ray.d * hit.t, p.ng)));
                    worst = std::max(worst, off / (double(p.error) * std::sqrt(3.) + 4 * size * 0x1p-24));
                    for (int k = 0; k < 4; ++k) {
                        Vec3 out = normalize(cast<float>(dice.vector()));
                        if (dot(out, p.ng) < 0) out = -out;
                        met += s->occluded(p.towards(out)); // convex: outwards there is nothing
                        lost += !s->occluded(p.towards(-out));
                    }
                }
                CHECK(hits > 2900);
                CHECK(worst < 1);
                CHECK(met == 0);
                CHECK(lost == 0);
            }
    }

    TEST_CASE("packets of mixed times see what single rays see") {
        SceneDesc d = scene(wobbling(3, 1, 4));
        shapes::add(d, "still", shapes::box({0.5, 0.5, 0.5}), 0, shapes::translation({4, 0, 0}));
        const auto s = compiled(std::move(d));
        Dice dice;
        std::vector<Ray> rays;
        for (int i = 0; i < 4000; ++i) {
            Ray ray = rayFrom(local(*s, {dice(-1, 5), dice(-1.5, 1.5), 6}), {float(dice()) * 0.1f, float(dice()) * 0.1f, -1});
            ray.time = float(dice(0, 1));
            rays.push_back(ray);
        }
        std::vector<Hit> hits(rays.size());
        std::vector<uint8_t> dark(rays.size());
        s->intersect(rays, hits, false);
        s->occluded(rays, dark);
        int differ = 0, seen = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit one = s->intersect(rays[i]);
            seen += bool(one);
            differ += one.geometry != hits[i].geometry || bool(one) != bool(dark[i]);
        }
        CHECK(seen > 1000);
        CHECK(differ <= 2); // edges, where another kernel rounds otherwise
    }

    TEST_CASE("a lamp that changes its shape: area, front and density at a time, at rest or under a node") {
        for (const int under : {0, 1, 2}) {
            CAPTURE(under);
            SceneDesc d;
            d.shutter = second;
            const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(2)));
            shapes::add(d, "lamp", rising(), lamp, rotation({1, 0, 0}, std::numbers::pi)); // shines down, sinks
            if (under == 1) d.instances.push_back({0, shapes::translation({0, 500, 0}), "twin"});
            if (under == 2) d.instances[0].motion = {d.instances[0].toWorld, shapes::translation({1, 0, 0}) * d.instances[0].toWorld};
            const auto s = compiled(std::move(d));
            CHECK(s->counts().emissiveTriangles == (under == 1 ? 4 : 2));
            for (const float t : {0.f, 0.3f, 1.f}) {
                CAPTURE(t);
                const double half = 1 + 2 * double(t), x = under == 2 ? double(t) : 0;
                SurfacePoint from = receiver(*s, {x, 0, -10}, {0, 0, 1});
                from.time = t;
                const auto sample = s->lights().sampleOne(0, from, 0, {0.3f, 0.4f});
                REQUIRE(sample);
                CHECK_FALSE(s->occluded(sample->shadow));
                Ray ray = rayFrom(from.p, sample->wi);
                ray.time = t;
                const Hit hit = s->intersect(ray);
                REQUIRE(hit);
                const double distance = double(hit.t);
                CHECK(double(sample->wi.z) * distance == doctest::Approx(10 - 3 * double(t)).epsilon(1e-5));
                CHECK(double(sample->pdfW) ==
                      doctest::Approx(distance * distance / (double(sample->wi.z) * 2 * half * half)).epsilon(1e-5));
                const SurfacePoint at = s->point(hit, ray);
                CHECK(s->lights().hit(at, -sample->wi, &from).radiance[0] == 2);
                const EmissionPdf pdf = s->lights().emissionPdf(at, -sample->wi, &from);
                CHECK(double(pdf.pdfA) == doctest::Approx(1 / (2 * half * half)).epsilon(1e-5));
            }
        }
    }

    TEST_CASE("the scene's sphere holds every shape; memory counts them; the name tells them apart; an instant is rest") {
        Dice dice;
        const PrimitiveDesc shape = wobbling(2, 1, 5);
        const auto s = compiled(scene(shape));
        for (const ShapeDesc& step : shape.steps)
            for (const Vec3& v : step.positions) CHECK(length(cast<double>(v) - s->centre()) <= double(s->radius()) * 1.000001);
        PrimitiveDesc still = shape;
        still.steps.clear();
        const auto rest = compiled(scene(still));
        CHECK(s->counts().bytes.geometry > 4 * rest->counts().bytes.geometry);
        CHECK(s->hash() != rest->hash());
        PrimitiveDesc other = shape;
        other.steps[3].positions[7].x += 0.1f;
        CHECK(compiled(scene(other))->hash() != s->hash());
        CHECK(compiled(scene(shape, {}, {0, 2}))->hash() != s->hash());
        CHECK(compiled(scene(shape, {}, {}))->hash() == compiled(scene(still, {}, {}))->hash());
        PrimitiveDesc same = still;
        same.steps = {{same.positions, same.normals, {}}, {same.positions, same.normals, {}}};
        CHECK(compiled(scene(same))->hash() == rest->hash());
        CHECK_FALSE(rest->moves(rest->parts()[0]));
        PrimitiveDesc many = still;
        many.steps.assign(129, {many.positions, many.normals, {}});
        CHECK_THROWS_AS(compiled(scene(many)), Error);
    }
} // TEST_SUITE
