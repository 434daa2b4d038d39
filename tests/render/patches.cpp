// Patches: they cover the surfaces exactly, share their points, and say what the material says.
#include "core/math/warp.h"
#include "scenes/builtin.h"
#include "scenes/scenes.h"
#include "tests/render/patches_kit.h"
#include "tests/statistics.h"
#include <map>
#include <set>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

double sumOfAreas(const Patches& p) {
    double sum = 0;
    for (const Patch& x : p.all()) sum += double(x.area);
    return sum;
}
double drawnArea(const Scene& scene) {
    double sum = 0;
    for (const DrawnPart& part : scene.parts())
        for (uint32_t i = 0; i < part.triangles; ++i) {
            const auto c = scene.corners(part, i, 0);
            sum += double(length(cross(c[1] - c[0], c[2] - c[0]))) / 2;
        }
    return sum;
}
// Fronts only: backs repeat them. Of all their polygons, open or not.
double frontArea(const Patches& p) {
    double sum = 0;
    for (uint32_t i = 0; i < p.size(); ++i)
        if (p[i].other == ~0u || p[i].other > i) sum += double(p[i].area) / double(p[i].open);
    return sum;
}

std::tuple<float, float, float> key(const Vec3& p) { return {p.x + 0.f, p.y + 0.f, p.z + 0.f}; }

// Vertices of patches that lie strictly inside an edge of a patch of the same part.
int tJunctions(const Patches& p) {
    std::map<uint32_t, std::set<std::tuple<float, float, float>>> points;
    for (const Patch& x : p.all())
        for (uint32_t k = 0; k < x.corners; ++k) points[x.part].insert(key(x.corner[k]));
    int found = 0;
    for (const Patch& x : p.all())
        for (uint32_t k = 0; k < x.corners; ++k) {
            const Vec3 &a = x.corner[k], &b = x.corner[(k + 1) % x.corners], d = b - a;
            for (const auto& [px, py, pz] : points[x.part]) {
                const Vec3 q = Vec3{px, py, pz} - a;
                const float t = dot(q, d) / lengthSquared(d);
                if (t > 1e-3f && t < 1 - 1e-3f && length(q - d * t) < 1e-5f * length(d)) ++found;
            }
        }
    return found;
}

// Flat, tilted triangles of very unequal edges that share some of them, under separate vertices: a hexagon about a point off its middle.
PrimitiveDesc irregular() {
    const Vec3d hub{.1, .2, .3}, rim[6] = {{1, 0, 0}, {.4, .9, .1}, {-.3, .5, .6}, {-1.2, .1, .2}, {-.2, -.8, 0}, {.3, -.2, -.1}};
    PrimitiveDesc p;
    for (int i = 0; i < 6; ++i) {
        const auto first = uint32_t(p.positions.size());
        for (const Vec3d& v : {hub, rim[i], rim[(i + 1) % 6]}) p.positions.push_back(cast<float>(v));
        p.indices.insert(p.indices.end(), {first, first + 1, first + 2});
    }
    return p;
}

SceneDesc one(PrimitiveDesc shape, const MaterialDesc& material) {
    SceneDesc d;
    shapes::add(d, "shape", std::move(shape), shapes::add(d, material));
    return d;
}
SceneDesc one(PrimitiveDesc shape) { return one(std::move(shape), shapes::diffuse("grey", Spectrum(.5f))); }

// Every hit lies in its patch, where the coordinates say, and on its side.
void checkPlaces(const Scene& scene, const Patches& patches, int rays) {
    stats::Random random(7);
    int hits = 0, wrong = 0;
    for (int i = 0; i < rays; ++i) {
        const Vec3 from = Vec3{random() - .5f, random() - .5f, random() - .5f} * (2 * scene.radius());
        const Ray ray = rayFrom(from, uniformSphere(Point2{random(), random()}));
        const Hit hit = scene.intersect(ray);
        if (!hit) continue;
        const SurfacePoint s = scene.point(hit, ray);
        const auto place = patches.at(hit, dot(s.ng, ray.d) < 0);
        const uint32_t seen = patches.seen(hit, ray.d);
        if (!place) {
            wrong += seen != ~0u;
            continue;
        }
        ++hits;
        const Patch& p = patches[place->patch];
        const float slack = 1e-3f;
        if (seen != place->patch || dot(p.normal, ray.d) > 1e-4f || length(p.at(place->s, place->t) - s.p) > 8 * (p.error + s.error) ||
            place->s < -slack || place->t < -slack || place->s > 1 + slack || place->t > 1 + slack ||
            (p.corners == 3 && place->s + place->t > 1 + slack))
            ++wrong;
    }
    CHECK(hits > rays / 20);
    CHECK(wrong == 0);
}

} // namespace

TEST_SUITE("patches") {
    TEST_CASE("a face of a box at one per edge is one patch; sizes divide it") {
        const auto scene = compiled(room());
        const Bare bare(*scene);
        for (const uint32_t n : {1u, 2u, 3u, 7u}) {
            const Patches p = patchesOf(bare, 1.f / float(n));
            CHECK(p.size() == 6 * n * n); // the outside of the room sees nothing
            CHECK(std::all_of(p.all().begin(), p.all().end(), [](const Patch& x) { return x.corners == 4 && x.coverage == 1; }));
            CHECK(sumOfAreas(p) == doctest::Approx(6).epsilon(1e-6));
            CHECK(p.longestEdge() == doctest::Approx(1.0 / n).epsilon(1e-5));
            CHECK(p.points() == 6 * (n + 1) * (n + 1)); // walls meet at creases
            for (const Patch& x : p.all()) {
                CHECK(dot(x.normal, x.centre) < 0); // inwards
                CHECK(dot(cross(x.corner[1] - x.corner[0], x.corner[3] - x.corner[0]), x.normal) > 0);
                CHECK(x.other == ~0u);
            }
        }
    }
    TEST_CASE("about as many as asked for") {
        const auto scene = compiled(makeCornell());
        const Bare bare(*scene);
        for (const uint32_t n : {300u, 1000u, 2000u, 10000u}) {
            const double found = double(patchesByCount(bare, n).size());
            INFO(found << " for " << n);
            CHECK(found > .8 * n);
            CHECK(found < 1.25 * n);
        }
    }
    TEST_CASE("no T-junctions, areas kept, hits found again: boxes, spheres, discs, unequal triangles, rooms") {
        SceneDesc mixed = one(shapes::sphere(.5, 2));
        shapes::add(mixed, "box", shapes::box({.3, .2, .1}), 0, shapes::translation({1, .2, 0}) * rotation({1, 2, 3}, .7));
        shapes::add(mixed, "disc", shapes::disc(.6, 13), 0, shapes::translation({-1, 0, 0}));
        const std::vector<std::pair<const char*, SceneDesc>> all = {
            {"room", room({.5, .7, .9})},
            {"irregular", one(irregular())},
            {"mixed", mixed},
            {"cornell", makeCornell()},
            {"trapezoid", one(shapes::quad({0, 0, 0}, {1, 0, 0}, {1.05, 1, 0}, {0, 1.02, 0}))}};
        for (const auto& [name, desc] : all) {
            CAPTURE(name);
            const auto scene = compiled(desc);
            const Bare bare(*scene);
            const float radius = scene->radius();
            for (const float size : {radius, radius / 3, radius / 7.3f}) {
                CAPTURE(size);
                const Patches p = patchesOf(bare, size);
                CHECK(tJunctions(p) == 0);
                CHECK(frontArea(p) == doctest::Approx(drawnArea(*scene)).epsilon(1e-5));
                CHECK(p.longestEdge() <= size * 1.0002f);
                checkPlaces(*scene, p, 4000);
            }
        }
    }
    TEST_CASE("a trapezoid is one grid, its points uniform over each patch") {
        const auto scene = compiled(one(shapes::quad({0, 0, 0}, {1, 0, 0}, {1.05, 1, 0}, {0, 1.02, 0})));
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, 10);
        REQUIRE(p.size() == 1);
        CHECK(p[0].corners == 4);
        Vec3d mean{};
        const uint32_t n = 4096;
        for (uint32_t k = 0; k < n; ++k) {
            Sampler s(1, SamplerKind::sobol, Stream::prepass, 0, k);
            mean += cast<double>(p.point(0, s.get2D())) * (1.0 / n);
        }
        // The centroid of a quadrilateral by its two triangles.
        Vec3d exact{};
        double area = 0;
        for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            const Vec3d a = cast<double>(p[0].corner[std::size_t(t[0])]), b = cast<double>(p[0].corner[std::size_t(t[1])]),
                        c = cast<double>(p[0].corner[std::size_t(t[2])]);
            const double w = length(cross(b - a, c - a));
            exact += (a + b + c) * (w / 3);
            area += w;
        }
        CHECK(length(mean - exact * (1 / area)) < 1e-4);
    }
    TEST_CASE("smooth neighbours share points, creases and materials do not") {
        SceneDesc lit = one(shapes::sphere(1, 2));
        lit.environment = uniformSky(1); // which no back sees
        const auto ball = compiled(lit);
        const Patches p = patchesOf(Bare(*ball), 10);
        CHECK(p.size() == 320);
        CHECK(p.points() == 162); // V of the sphere: 10 x 4^2 + 2
        const Patches fine = patchesOf(Bare(*ball), length(p[0].corner[1] - p[0].corner[0]) * .8f);
        std::map<uint32_t, std::tuple<float, float, float>> places;
        for (const Patch& x : fine.all())
            for (uint32_t k = 0; k < x.corners; ++k) {
                const auto [at, isNew] = places.try_emplace(x.vertex[k], key(x.corner[k]));
                CHECK(at->second == key(x.corner[k])); // one number, one place
            }
        CHECK(places.size() == fine.points());
        std::set<std::tuple<float, float, float>> distinct;
        for (const auto& [number, place] : places) distinct.insert(place);
        CHECK(distinct.size() == places.size()); // and one place, one number: the sphere is smooth all over
        const auto flat = compiled(room());
        CHECK(patchesOf(Bare(*flat), 1).points() == 24);
    }
    TEST_CASE("a sheet that light reaches from both sides has a patch on each; a closed box has none within") {
        SceneDesc d = one(shapes::quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}));
        shapes::add(d, "box", shapes::box({.2, .2, .2}), 0, shapes::translation({3, 0, 0}));
        d.environment = uniformSky(1);
        const auto scene = compiled(d);
        const Patches p = patchesOf(Bare(*scene), 10);
        CHECK(p.size() == 2 + 6);
        for (uint32_t i = 0; i < p.size(); ++i) {
            if (p[i].part != 0) continue;
            REQUIRE(p[i].other != ~0u);
            const Patch& back = p[p[i].other];
            CHECK(back.other == i);
            CHECK(dot(back.normal, p[i].normal) == -1);
            CHECK(back.centre == p[i].centre);
        }
        checkPlaces(*scene, p, 2000);
    }
    TEST_CASE("mirrored and instanced parts keep their fronts") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        const Affine places[] = {shapes::translation({-2, 0, 0}), shapes::translation({2, 0, 0}) * scaling(-1, 1, 1),
                                 shapes::translation({0, 2, 0}) * rotation({0, 0, 1}, .5)};
        addInstances(d, shapes::box({.5, .4, .3}), grey, places);
        shapes::add(d, "mirrored", shapes::box({.5, .4, .3}), grey, scaling(1, 1, -1) * shapes::translation({0, 0, 2}));
        const auto scene = compiled(d);
        const Patches p = patchesOf(Bare(*scene), .35f);
        for (uint32_t part = 0; part < scene->parts().size(); ++part) {
            Vec3 middle{};
            const auto own = ofPart(p, part);
            for (const uint32_t i : own) middle += p[i].centre * (1 / float(own.size()));
            for (const uint32_t i : own) CHECK((dot(p[i].normal, p[i].centre - middle) > 0) == (p[i].other == ~0u || p[i].other > i));
        }
        CHECK(tJunctions(p) == 0);
        checkPlaces(*scene, p, 4000);
    }
    TEST_CASE("the same patches for any number of threads") {
        const auto scene = compiled(makePlayground());
        const Patches a = patchesByCount(Bare(*scene, 1), 4000), b = patchesByCount(Bare(*scene, 3), 4000);
        REQUIRE(a.size() == b.size());
        bool same = true;
        for (std::size_t i = 0; i < a.size(); ++i)
            same = same && a[i].corner == b[i].corner && a[i].vertex == b[i].vertex && a[i].reflectance == b[i].reflectance &&
                   a[i].emission == b[i].emission && a[i].area == b[i].area && a[i].other == b[i].other;
        CHECK(same);
    }
    TEST_CASE("hostile scenes: nothing, one triangle, needles, too many") {
        SceneDesc empty;
        const auto nothing = compiled(empty);
        CHECK(patchesByCount(Bare(*nothing), 100).size() == 0);
        const auto single = compiled(one(triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})));
        CHECK(patchesOf(Bare(*single), 10).size() == 1);
        CHECK(std::abs(int(patchesByCount(Bare(*single), 100).size()) - 100) <= 5);
        PrimitiveDesc broken = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        broken = shapes::joined(broken, triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1}));
        broken = shapes::joined(broken, triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}));
        broken = shapes::joined(broken, triangle({0, 0, 0}, {1, 0, 0}, {.5f, 1e-12f, 0}));
        const auto degenerate = compiled(one(broken));
        const Bare bare(*degenerate);
        const Patches p = patchesByCount(bare, 50);
        CHECK(p.size() >= 40);
        for (const Patch& x : p.all()) CHECK((finite(x.centre) && x.area > 0 && finite(x.reflectance)));
        PatchSettings tiny;
        tiny.size = 1e-5f;
        try {
            Patches::of(Bare(*single).work, tiny);
            FAIL("not refused");
        } catch (const Error& e) { CHECK(e.code == Exit::resources); }
    }
    TEST_CASE("things that move are taken where they are when the shutter opens, and it is said") {
        SceneDesc d = one(shapes::box({.2, .2, .2}));
        d.shutter = {0, 1};
        d.environment = uniformSky(1);
        d.instances[0].motion = {shapes::translation({0, 0, 0}), shapes::translation({1, 0, 0})};
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, 10);
        CHECK(p.size() == 6);
        CHECK(p[0].area == doctest::Approx(.16).epsilon(1e-4));
        CHECK(bare.notes.warnings().size() == 1);
    }
} // TEST_SUITE
