// Motion over the shutter: maps taken apart and put together, the ray tracer's interpolation against the exact one, bounds, what cannot
// move.
#include "core/scene/motion.h"
#include "core/scene/camera.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>
#include <numbers>
#include <random>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr Interval second{0, 1};

struct Dice {
    std::mt19937 engine{7};
    double operator()(double low = -1, double high = 1) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Vec3d vector(double size = 1) { return Vec3d{(*this)(), (*this)(), (*this)()} * size; }
};
// Turned, stretched along every axis, sheared and moved; with a mirror or without.
Affine anyMap(Dice& dice, bool mirrored) {
    Affine stretch = scaling(dice(0.2, 3), dice(0.2, 3), dice(0.2, 3) * (mirrored ? -1 : 1));
    stretch.m[0][1] = dice();
    stretch.m[0][2] = dice();
    stretch.m[1][2] = dice();
    return shapes::translation(dice.vector(5)) * rotation(dice.vector(), dice(-3, 3)) * stretch;
}
double difference(const Affine& a, const Affine& b) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) worst = std::max(worst, std::fabs(a.m[i][j] - b.m[i][j]));
    return worst;
}
// What spins about an axis and goes along at once, in equal steps.
MotionDesc spin(const Vec3d& axis, double angle, const Vec3d& way, int steps) {
    MotionDesc maps;
    for (int i = 0; i <= steps; ++i) {
        const double f = double(i) / steps;
        maps.push_back(shapes::translation(way * f) * rotation(axis, angle * f));
    }
    return maps;
}
SceneDesc moving(PrimitiveDesc shape, MotionDesc motion) {
    SceneDesc s;
    s.shutter = second;
    const int material = shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f)));
    shapes::add(s, "thing", std::move(shape), material, motion.front());
    s.instances.back().motion = std::move(motion);
    return s;
}

} // namespace

TEST_SUITE("motion") {
    TEST_CASE("a map is translation, rotation and stretch, mirrored ones too") {
        Dice dice;
        for (int i = 0; i < 200; ++i) {
            const bool mirrored = i % 2 == 1;
            const Affine maps[] = {anyMap(dice, mirrored), anyMap(dice, mirrored)};
            const Motion m(maps, second);
            CHECK(difference(m.exact(0), maps[0]) < 1e-12);
            CHECK(difference(m.exact(1), maps[1]) < 1e-12);
            for (const Motion::Key& k : m.keys()) {
                const auto [w, x, y, z] = k.rotation;
                CHECK(w * w + x * x + y * y + z * z == doctest::Approx(1));
                CHECK(k.stretch[0][0] > 0);
                CHECK(k.stretch[1][1] > 0);
                CHECK(k.stretch[2][2] * (mirrored ? -1 : 1) > 0);
            }
            // Never flat on the way.
            for (double t = 0; t <= 1; t += 0.125) CHECK((m.exact(t).determinant() < 0) == mirrored);
        }
    }

    TEST_CASE("half a quarter turn is 45 degrees and keeps its length (H12)") {
        const Affine maps[] = {{}, rotation({0, 0, 1}, pi64 / 2)};
        const Motion m(maps, second);
        const Vec3d half = m.exact(0.5).point({1, 0, 0});
        CHECK(half.x == doctest::Approx(std::sqrt(0.5)).epsilon(1e-12));
        CHECK(half.y == doctest::Approx(std::sqrt(0.5)).epsilon(1e-12));
        for (double t = 0; t <= 1; t += 1. / 16) {
            const Vec3d p = m.exact(t).point({1, 0, 0});
            CHECK(std::atan2(p.y, p.x) == doctest::Approx(t * pi64 / 2).epsilon(1e-12));
            CHECK(length(m.at(float(t)).point(Vec3{1, 0, 0})) == doctest::Approx(1).epsilon(2e-7));
        }
    }

    TEST_CASE("the short way round, linear in translation and stretch, still outside the interval") {
        const Affine maps[] = {rotation({0, 0, 1}, 0.1), shapes::translation({2, 4, 6}) * rotation({0, 0, 1}, -0.1) * scaling(3, 3, 3)};
        const Motion m(maps, {-1, 3});
        CHECK(difference(m.exact(1), shapes::translation({1, 2, 3}) * scaling(2, 2, 2)) < 1e-12);
        CHECK(difference(m.exact(-7), maps[0]) < 1e-12);
        CHECK(difference(m.exact(9), maps[1]) < 1e-12);
        const Affine around[] = {rotation({0, 1, 0}, 3.0), rotation({0, 1, 0}, -3.0)};
        CHECK(difference(Motion(around, second).exact(0.5), rotation({0, 1, 0}, pi64)) < 1e-12);
    }

    TEST_CASE("keys are refined where it turns, and 129 are the most") {
        const Affine shift[] = {{}, shapes::translation({1, 0, 0})};
        CHECK(Motion(shift, second).keys().size() == 2);
        CHECK(Motion(spin({0, 0, 1}, 1, {}, 2), second).keys().size() > 10);
        CHECK(Motion(spin({0, 0, 1}, 50, {}, 100), second).keys().size() <= Motion::mostKeys);
        CHECK(Motion(spin({0, 0, 1}, 3, {1, 0, 0}, 400), second).keys().size() == Motion::mostKeys);
        const Motion many(spin({0, 0, 1}, 3, {1, 0, 0}, 400), second);
        CHECK(difference(many.exact(0.37), shapes::translation({0.37, 0, 0}) * rotation({0, 0, 1}, 3 * 0.37)) < 1e-4);
    }

    TEST_CASE("a hit lies on its ray, whatever turns and however far") {
        Dice dice;
        double worst = 0;
        for (int i = 0; i < 60; ++i) {
            MotionDesc maps;
            const bool mirrored = i % 3 == 0;
            for (int k = 0; k < (i % 4 == 0 ? 9 : 2); ++k) maps.push_back(anyMap(dice, mirrored));
            const auto scene = compiled(moving(shapes::sphere(1, 2), maps));
            const Motion motion(maps, second);
            int hits = 0;
            for (int r = 0; r < 400; ++r) {
                const float time = float(dice(0, 1));
                const Vec3 target = local(*scene, motion.exact(double(time)).point(dice.vector(0.5)));
                Ray ray = rayFrom(target + normalize(cast<float>(dice.vector())) * 20, {1, 0, 0});
                ray.d = normalize(target - ray.o);
                ray.time = time;
                const Hit hit = scene->intersect(ray);
                if (!hit) continue;
                ++hits;
                const SurfacePoint p = scene->point(hit, ray);
                CHECK(p.time == time);
                // Along the normal, where it matters; the ray's own coordinates are rounded at 20 m.
                const double off = double(std::fabs(dot(p.p - ray.o - ray.d * hit.t, p.ng)));
                worst = std::max(worst, off / (double(p.error) * std::sqrt(3.) + 8 * 20 * 0x1p-24));
            }
            CHECK(hits > 390); // aimed into the body: all but those that graze it in a sheared corner
        }
        INFO("worst distance from the ray: " << worst << " bounds");
        CHECK(worst < 1);
    }

    TEST_CASE("no point of a spinning, flying ball meets the ball again") {
        Dice dice;
        for (const double size : {1e-3, 1., 1e4}) {
            for (const double angle : {0.5, 6., 400.}) {
                CAPTURE(size);
                CAPTURE(angle);
                MotionDesc maps = spin({0.3, 1, -0.2}, angle, Vec3d{7, -3, 2} * size, 128);
                const auto scene = compiled(moving(shapes::sphere(size, 3), maps));
                const Motion motion(maps, second);
                int met = 0, lost = 0, tried = 0;
                for (int r = 0; r < 4000; ++r) {
                    const float time = r % 50 == 0 ? float(r % 100 == 0) : float(dice(0, 1));
                    const Vec3 centre = local(*scene, motion.exact(double(time)).point({0, 0, 0}));
                    Ray ray = rayFrom(centre, cast<float>(dice.vector()));
                    ray.time = time;
                    const Hit hit = scene->intersect(ray); // from inside: a leak is a miss
                    if (!hit) {
                        ++lost;
                        continue;
                    }
                    const SurfacePoint p = scene->point(hit, ray);
                    for (int k = 0; k < 4; ++k) {
                        Vec3 out = normalize(cast<float>(dice.vector()));
                        if (dot(out, p.ng) < 0) out = -out;
                        ++tried;
                        met += scene->occluded(p.towards(out)); // convex: outwards there is nothing
                        lost += !scene->occluded(p.towards(-out));
                    }
                }
                CHECK(tried == 16000);
                CHECK(met == 0);
                CHECK(lost == 0);
            }
        }
    }

    TEST_CASE("packets of mixed times see what single rays see") {
        SceneDesc s;
        s.shutter = second;
        const int material = shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f)));
        for (int i = 0; i < 5; ++i) {
            shapes::add(s, "thing", shapes::box({0.5, 0.3, 0.2}), material, shapes::translation({2. * i, 0, 0}));
            if (i == 2) continue; // one at rest among them
            for (const Affine& m : spin({1, 1, double(i)}, 2 + i, {0, 1. * i, 0}, 1 << i))
                s.instances.back().motion.push_back(shapes::translation({2. * i, 0, 0}) * m);
        }
        const auto scene = compiled(std::move(s));
        Dice dice;
        std::vector<Ray> rays;
        for (int i = 0; i < 5000; ++i) {
            Ray ray = rayFrom(local(*scene, {dice(-1, 9), dice(-1, 5), 6}), {float(dice()) * 0.1f, float(dice()) * 0.1f, -1});
            ray.time = float(dice(0, 1));
            rays.push_back(ray);
        }
        std::vector<Hit> hits(rays.size());
        std::vector<uint8_t> dark(rays.size());
        scene->intersect(rays, hits, false);
        scene->occluded(rays, dark);
        int differ = 0, seen = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit one = scene->intersect(rays[i]);
            seen += bool(one);
            differ += one.instance != hits[i].instance || bool(one) != bool(dark[i]);
        }
        CHECK(seen > 200);
        CHECK(differ <= 2); // edges, where another kernel rounds otherwise
    }

    TEST_CASE("the scene's sphere holds what moves at every time") {
        Dice dice;
        for (int i = 0; i < 20; ++i) {
            const MotionDesc maps = {anyMap(dice, false), anyMap(dice, false), anyMap(dice, false)};
            const PrimitiveDesc shape = shapes::box({1, 0.5, 0.25});
            const auto scene = compiled(moving(shape, maps));
            const Motion motion(maps, second);
            for (double t = 0; t <= 1; t += 1. / 64)
                for (const Vec3& v : shape.positions)
                    CHECK(length(motion.exact(t).point(cast<double>(v)) - scene->centre()) <= double(scene->radius()) * 1.000001);
        }
    }

    TEST_CASE("what shrinks to nothing or turns inside out is mended, with a warning") {
        for (const double end : {0., -1.}) {
            MotionDesc maps;
            for (int i = 0; i <= 4; ++i) maps.push_back(scaling(1 + (end - 1) * i / 4, 1, 1));
            SceneDesc s = moving(shapes::sphere(1, 2), maps);
            Diagnostics notes;
            const auto scene = Scene::compile(std::move(s), notes);
            REQUIRE(notes.warnings().size() == 1);
            CHECK(notes.warnings()[0].find("to nothing or inside out") != std::string::npos);
            for (float t = 0; t <= 1; t += 1 / 64.f) {
                Ray ray = rayFrom(local(*scene, {0.001, 0.001, 5}), {0, 0, -1});
                ray.time = t;
                const Hit hit = scene->intersect(ray);
                if (t < 0.2f) CHECK(hit);
                if (hit) CHECK(scene->point(hit, ray).ng.z > 0);
            }
        }
    }

    TEST_CASE("an instant, or equal steps, is rest: the same scene as without motion") {
        SceneDesc still = moving(shapes::sphere(1, 2), {shapes::translation({1, 2, 3})});
        still.instances[0].motion.clear();
        const uint64_t hash = compiled(still)->hash();
        SceneDesc instant = moving(shapes::sphere(1, 2), {shapes::translation({1, 2, 3}), {}});
        instant.shutter = {0.5f, 0.5f};
        CHECK(compiled(instant)->hash() == hash);
        const SceneDesc equal = moving(shapes::sphere(1, 2), MotionDesc(3, shapes::translation({1, 2, 3})));
        CHECK(compiled(equal)->hash() == hash);
        SceneDesc flying = moving(shapes::sphere(1, 2), {shapes::translation({1, 2, 3}), {}});
        CHECK(compiled(flying)->hash() != hash);
        const uint64_t first = compiled(flying)->hash();
        flying.shutter.close = 2;
        CHECK(compiled(flying)->hash() != first);
    }

    TEST_CASE("a moving camera stands where its motion says") {
        CameraDesc c;
        c.motion = {shapes::lookAt({0, 0, 5}, {0, 0, 0}), shapes::lookAt({5, 0, 0}, {0, 0, 0})};
        c.toWorld = c.motion.front();
        const Camera camera(c, 64, 64, {1, 3});
        CHECK(camera.moves());
        for (const float t : {0.f, 0.25f, 0.5f, 1.f}) {
            const Ray r = camera.ray({32, 32}, {0.5f, 0.5f}, 1 + 2 * t);
            const double turn = double(t) * pi64 / 2;
            CHECK(r.o.x == doctest::Approx(5 * double(t)).epsilon(1e-6));
            CHECK(r.o.z == doctest::Approx(5 - 5 * double(t)).epsilon(1e-6));
            CHECK(r.d.x == doctest::Approx(-std::sin(turn)).epsilon(1e-6));
            CHECK(r.d.z == doctest::Approx(-std::cos(turn)).epsilon(1e-6));
            CHECK(r.time == 1 + 2 * t);
            // What it sees there, it says so back.
            SurfacePoint p;
            p.p = r.o + r.d * 3;
            p.ng = -r.d;
            p.time = r.time;
            const auto back = camera.importance(p, {0.5f, 0.5f});
            REQUIRE(back);
            CHECK(back->raster.x == doctest::Approx(32).epsilon(1e-4));
            CHECK(back->raster.y == doctest::Approx(32).epsilon(1e-4));
        }
        CHECK_FALSE(Camera(c, 64, 64).moves());
    }
} // TEST_SUITE
