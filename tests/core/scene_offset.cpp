// Rays that leave a surface: from beyond the error bound of the hit, at any scale and place, never into the surface they left; and never
// through a wall.
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Place {
    std::string name;
    Affine m;
    bool instanced;
};
std::vector<Place> places() {
    const Affine turn = rotation({1, 2, 3}, 1.1);
    std::vector<Place> all;
    for (const bool instanced : {false, true}) {
        all.push_back({"unit", turn, instanced});
        all.push_back({"small", scaling(1e-4, 1e-4, 1e-4) * turn, instanced});
        all.push_back({"large", scaling(1e5, 1e5, 1e5) * turn, instanced});
        all.push_back({"moved by its node", shapes::translation({1e5, -3e4, 2e5}) * turn, instanced});
        all.push_back({"not uniform", turn * scaling(1, 30, 0.1), instanced});
        all.push_back({"mirrored", turn * scaling(1, 1, -1), instanced});
    }
    return all;
}
std::unique_ptr<const Scene> placed(PrimitiveDesc shape, const Place& k) {
    SceneDesc desc;
    const int grey = shapes::add(desc, shapes::diffuse("grey", Spectrum(0.5f)));
    const std::vector<Affine> at(k.instanced ? 2 : 1, k.m);
    addInstances(desc, std::move(shape), grey, at);
    return compiled(std::move(desc));
}
Vec3 direction(stats::Random& u) {
    const float z = 2 * u() - 1, phi = 2 * pi * u(), r = std::sqrt(std::max(0.f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}
// A direction at a tiny angle above (or below, side < 0) a surface of normal n.
Vec3 grazing(stats::Random& u, const Vec3& n, float side) {
    const Frame f = Frame::about(n);
    const float phi = 2 * pi * u(), height = side * std::pow(10.f, -7 * u());
    return normalize(f.toWorld({std::cos(phi), std::sin(phi), height}));
}
SurfacePoint somePoint(const Scene& scene, stats::Random& u) {
    for (;;) {
        const Vec3 o = direction(u) * (u() * 2 * scene.radius());
        const Ray r = rayFrom(o, direction(u));
        if (const Hit h = scene.intersect(r)) return scene.point(h, r);
    }
}

} // namespace

TEST_SUITE("offset") {

    TEST_CASE("from a flat shape no ray meets the face it left, at any angle") {
        // From a triangle of a convex body outwards there is nothing to meet at all: any hit is the surface itself.
        for (const Place& k : places()) {
            CAPTURE(k.name);
            CAPTURE(k.instanced);
            const auto scene = placed(shapes::box({1, 0.7, 1.3}), k);
            stats::Random u(21);
            int met = 0, shadowed = 0, wrongSide = 0, finiteBound = 0;
            for (int i = 0; i < 10'000; ++i) {
                const SurfacePoint s = somePoint(*scene, u);
                Vec3 w = i % 2 ? grazing(u, s.ng, 1) : direction(u);
                if (dot(w, s.ng) < 0) w = -w;
                if (!(dot(w, s.ng) > 0)) continue;
                const Ray r = s.towards(w);
                met += bool(scene->intersect(r));
                shadowed += scene->occluded(r);
                wrongSide += dot(r.o - s.p, s.ng) < 0;
                finiteBound += s.error > 0 && s.error < 1e-3f * scene->radius();
            }
            CHECK(met == 0);
            CHECK(shadowed == 0);
            CHECK(wrongSide == 0);
            CHECK(finiteBound > 9000);
        }
    }

    TEST_CASE("inside a closed box every ray meets another wall: none meets its own, none gets out") {
        for (const Place& k : places()) {
            CAPTURE(k.name);
            CAPTURE(k.instanced);
            const auto scene = placed(shapes::box({1, 0.7, 1.3}), k);
            stats::Random u(22);
            int own = 0, escaped = 0, unseen = 0;
            SurfacePoint s = somePoint(*scene, u);
            Ray start = rayFrom({}, direction(u));
            s = scene->point(scene->intersect(start), start);
            for (int i = 0; i < 20'000; ++i) {
                Vec3 w = i % 4 == 0 ? grazing(u, s.ng, -1) : direction(u);
                if (dot(w, s.ng) > 0) w = -w; // fronts look outwards: stay inside
                if (!(dot(w, s.ng) < 0)) continue;
                const Ray r = s.towards(w);
                const Hit h = scene->intersect(r);
                if (!h) {
                    ++escaped;
                    s = scene->point(scene->intersect(start), start);
                    continue;
                }
                const SurfacePoint next = scene->point(h, r);
                own += dot(next.ng, s.ng) > 0.999f; // a box: walls with one normal are one wall
                if (dot(next.ng, s.ng) < 0.999f) unseen += scene->occluded(s.to(next));
                s = next;
            }
            CHECK(own == 0);
            CHECK(escaped == 0);
            // Two points of a box see each other, but close to an edge the segment is shorter than the bounds.
            CHECK(unseen < 20);
        }
    }

    TEST_CASE("a closed body of many triangles keeps a random walk inside") {
        for (const Place& k : places()) {
            CAPTURE(k.name);
            CAPTURE(k.instanced);
            const auto scene = placed(shapes::sphere(1, 4), k);
            stats::Random u(23);
            const Ray start = rayFrom({}, direction(u));
            SurfacePoint s = scene->point(scene->intersect(start), start);
            int escaped = 0;
            for (int i = 0; i < 20'000; ++i) {
                Vec3 w = direction(u);
                if (dot(w, s.ng) > 0) w = -w;
                const Ray r = s.towards(w);
                const Hit h = scene->intersect(r);
                escaped += !h;
                s = h ? scene->point(h, r) : scene->point(scene->intersect(start), start);
            }
            CHECK(escaped == 0);
        }
    }

    TEST_CASE("the position lies within its error bound of the true triangle") {
        for (const Place& k : places()) {
            CAPTURE(k.name);
            CAPTURE(k.instanced);
            const PrimitiveDesc shape = shapes::sphere(1, 2);
            const auto scene = placed(shape, k);
            stats::Random u(24);
            double worst = 0;
            for (int i = 0; i < 3000; ++i) {
                const Ray r = rayFrom(direction(u) * (3 * scene->radius()), {});
                const Ray in = rayFrom(r.o, -r.o + direction(u) * (0.3f * scene->radius()));
                const Hit h = scene->intersect(in);
                if (!h) continue;
                const SurfacePoint s = scene->point(h, in);
                const auto corner = [&](uint32_t c) {
                    return k.m.point(cast<double>(shape.positions[shape.indices[h.triangle * 3 + c]])) - scene->centre();
                };
                const Vec3d a = corner(0), n = normalize(cross(corner(1) - a, corner(2) - a));
                worst = std::max(worst, std::fabs(dot(cast<double>(s.p) - a, n)) /
                                            (double(s.error) * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z))));
            }
            CHECK(worst < 1);
        }
    }

    TEST_CASE("segments between points end before the surface at either end") {
        SceneDesc desc;
        const int grey = shapes::add(desc, shapes::diffuse("grey", Spectrum(0.5f)));
        shapes::add(desc, "floor", square(50), grey);
        shapes::add(desc, "ceiling", square(50), grey, shapes::translation({0, 0, 3}));
        const auto scene = compiled(std::move(desc));
        stats::Random u(25);
        int occluded = 0;
        for (int i = 0; i < 20'000; ++i) {
            const auto on = [&](float side) {
                const float x = u() * 90 - 45;
                const Ray r = rayFrom({x, u() * 90 - 45, 0}, {0, 0, side});
                return scene->point(scene->intersect(r), r);
            };
            const SurfacePoint a = on(-1), b = on(1);
            const Ray r = a.to(b);
            occluded += scene->occluded(r) || scene->occluded(b.to(a));
            if (i == 0) CHECK(length(r.o + r.d * r.tfar - b.p) < 1e-4f);
        }
        CHECK(occluded == 0);
        const SurfacePoint p = receiver(*scene, {1, 1, 1}, {0, 0, 1});
        CHECK(std::isfinite(p.to(p).tfar)); // a point to itself: an empty segment, no NaN
        CHECK(finite(p.to(p).d));
    }
}
