// Cameras: rows H1, H2 and H3 of the verification table, aspects, nodes with scale, depth.
#include "core/scene/camera.h"
#include "scenes/shapes.h"
#include "tests/scene_kit.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double degree = std::numbers::pi / 180;

CameraDesc perspective(double yfovDegrees, const Affine& m = {}) {
    CameraDesc c;
    c.yfov = yfovDegrees * degree;
    c.toWorld = m;
    return c;
}
CameraDesc orthographic(double xmag, double ymag, const Affine& m = {}) {
    CameraDesc c;
    c.projection = Projection::orthographic;
    c.xmag = xmag;
    c.ymag = ymag;
    c.toWorld = m;
    return c;
}
Ray centre(const Camera& c, uint32_t x, uint32_t y) { return c.ray({float(x) + 0.5f, float(y) + 0.5f}, {0.5f, 0.5f}, 0); }
void checkVector(const Vec3& v, double x, double y, double z, double tolerance = 1e-6) {
    CHECK(double(v.x) == doctest::Approx(x).epsilon(tolerance));
    CHECK(double(v.y) == doctest::Approx(y).epsilon(tolerance));
    CHECK(double(v.z) == doctest::Approx(z).epsilon(tolerance));
}
// Solid angle of a piece of the raster: two spherical triangles (Van Oosterom and Strackee 1983).
double solidAngle(const Camera& c, float x0, float y0, float x1, float y1) {
    const auto corner = [&](float x, float y) { return cast<double>(c.ray({x, y}, {0.5f, 0.5f}, 0).d); };
    const auto excess = [](const Vec3d& a, const Vec3d& b, const Vec3d& d) {
        return 2 * std::atan2(std::fabs(dot(a, cross(b, d))), 1 + dot(a, b) + dot(b, d) + dot(d, a));
    };
    const Vec3d a = corner(x0, y0), b = corner(x1, y0), d = corner(x1, y1), e = corner(x0, y1);
    return excess(a, b, d) + excess(a, d, e);
}

} // namespace

TEST_SUITE("camera") {

    TEST_CASE("H1: pixel rays of a perspective camera") {
        const Camera c(perspective(60), 1920, 1080);
        checkVector(centre(c, 0, 0).d, -.6642563771, .3734927728, -.6475080031);
        checkVector(centre(c, 1440, 270).d, .4426531083, .2482726591, -.861637344);
        const Ray left = c.ray({0, 540}, {0, 0}, 0), right = c.ray({1920, 540}, {0, 0}, 0);
        CHECK(std::acos(double(dot(left.d, right.d))) / degree == doctest::Approx(91.4928445).epsilon(1e-6));
        const Camera small(perspective(90), 2, 2);
        checkVector(centre(small, 0, 0).d, -.4082482905, .4082482905, -.8164965809);
        checkVector(centre(small, 1, 1).d, .4082482905, -.4082482905, -.8164965809);
        CHECK(centre(c, 3, 4).tnear == 0);
        CHECK(centre(c, 3, 4).tfar == infinity);
        CHECK(c.ray({0, 0}, {0, 0}, 0.25f).time == 0.25f);
    }

    TEST_CASE("H2: pixel rays of an orthographic camera") {
        const Camera c(orthographic(2, 1), 4, 2);
        const Ray r = centre(c, 0, 0);
        checkVector(r.o, -1.5, .5, 0);
        checkVector(r.d, 0, 0, -1);
        checkVector(centre(c, 3, 1).o, 1.5, -.5, 0);
        // A sphere of radius 1 at xmag = ymag = 2 covers pi/16 of the frame.
        SceneDesc desc;
        shapes::add(desc, "ball", shapes::sphere(1, 5), shapes::add(desc, shapes::diffuse("grey", Spectrum(.5f))));
        const auto scene = compiled(std::move(desc));
        const Camera frame(orthographic(2, 2, shapes::translation({0, 0, 5})), 512, 512);
        int hits = 0;
        for (uint32_t y = 0; y < 512; ++y)
            for (uint32_t x = 0; x < 512; ++x) hits += bool(scene->intersect(centre(frame, x, y)));
        CHECK(hits / (512.0 * 512) == doctest::Approx(std::numbers::pi / 16).epsilon(2e-3));
    }

    TEST_CASE("H3: solid angles of the frame and of pixels") {
        const Camera wide(perspective(60), 1920, 1080), square(perspective(90), 100, 100);
        CHECK(solidAngle(wide, 0, 0, 1920, 1080) == doctest::Approx(1.465053615).epsilon(1e-6));
        CHECK(solidAngle(square, 0, 0, 100, 100) == doctest::Approx(2 * std::numbers::pi / 3).epsilon(1e-6));
        // Rays are floats: a pixel is some 1e-3 wide, its corners known to 1e-7.
        CHECK(solidAngle(wide, 959.5f, 539.5f, 960.5f, 540.5f) == doctest::Approx(1.1431181e-6).epsilon(2e-3));
        CHECK(solidAngle(wide, 0, 0, 1, 1) == doctest::Approx(3.1033208e-7).epsilon(2e-3));
        CHECK(solidAngle(wide, 0, 0, 64, 64) + solidAngle(wide, 64, 0, 1920, 64) + solidAngle(wide, 0, 64, 1920, 1080) ==
              doctest::Approx(1.465053615).epsilon(1e-5));
    }

    TEST_CASE("aspects: perspective keeps the vertical angle, orthographic shows more and never stretches") {
        for (const uint32_t width : {10u, 100u, 400u}) {
            const Camera c(perspective(40), width, 100);
            const Ray top = c.ray({float(width) / 2, 0}, {0, 0}, 0), bottom = c.ray({float(width) / 2, 100}, {0, 0}, 0);
            CHECK(std::acos(double(dot(top.d, bottom.d))) / degree == doctest::Approx(40).epsilon(1e-5));
        }
        const struct {
            uint32_t width, height;
            double x, y;
        } cases[] = {{200, 100, 2, 1}, {400, 100, 4, 1}, {100, 100, 2, 2}, {50, 100, 2, 4}};
        for (const auto& k : cases) {
            const Camera c(orthographic(2, 1), k.width, k.height);
            checkVector(c.ray({float(k.width), 0}, {0, 0}, 0).o, k.x, k.y, 0);
        }
    }

    TEST_CASE("a camera has no scale: its node may be scaled, mirrored, sheared") {
        const Affine place = shapes::translation({1, 2, 3}) * rotation({1, 2, -1}, 0.7);
        const Camera plain(perspective(50, place), 64, 48);
        for (const Affine& s : {scaling(2, 2, 2), scaling(0.01, 3, 5), scaling(-1, 1, 1)}) {
            const Camera scaled(perspective(50, place * s), 64, 48);
            for (const Point2 at : {Point2{0, 0}, {64, 0}, {10, 40}}) {
                const Ray a = plain.ray(at, {0, 0}, 0), b = scaled.ray(at, {0, 0}, 0);
                CHECK(length(a.d - b.d) < 1e-6f);
                CHECK(length(a.o - b.o) < 1e-6f);
            }
        }
        Affine shear;
        shear.m[1][0] = 0.3;
        const Camera sheared(perspective(50, shear), 64, 48);
        for (const Point2 at : {Point2{0, 0}, {64, 0}, {10, 40}}) CHECK(length(sheared.ray(at, {0, 0}, 0).d) == doctest::Approx(1));
        CHECK(sheared.axis() == Vec3{0, 0, -1});
    }

    TEST_CASE("footprints are those of one pixel") {
        const Footprint p = Camera(perspective(60), 1920, 1080).footprint();
        CHECK(p.width == 0);
        CHECK(p.spread == doctest::Approx(2 * std::atan(std::tan(30 * degree) / 1080)));
        const Footprint o = Camera(orthographic(2, 1), 400, 100).footprint();
        CHECK(o.spread == 0);
        CHECK(o.width == doctest::Approx(0.02));
    }

    TEST_CASE("depth is the distance along the axis") {
        const Camera c(perspective(60, shapes::translation({0, 0, 10})), 100, 100);
        for (const Point2 at : {Point2{50, 50}, {0, 0}, {99, 3}}) {
            const Ray r = c.ray(at, {0, 0}, 0);
            CHECK(c.depth(r.o + r.d * (7 / -r.d.z)) == doctest::Approx(7));
        }
        CHECK(c.depth({3, 4, 11}) == doctest::Approx(-1));
        CHECK(Camera(orthographic(1, 1), 10, 10).depth({9, 9, -4}) == doctest::Approx(4));
    }

    TEST_CASE("the automatic view shows all of the scene") {
        SceneDesc desc;
        shapes::add(desc, "ball", shapes::sphere(3, 3), shapes::add(desc, shapes::diffuse("grey", Spectrum(.5f))),
                    shapes::translation({100, -50, 7}) * scaling(5, 1, 1));
        const auto scene = compiled(std::move(desc));
        for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
            const CameraDesc auto_ = frameScene(*scene, aspect);
            const Camera c(auto_, uint32_t(100 * aspect), 100);
            int hits = 0, border = 0;
            for (uint32_t y = 0; y < 100; ++y)
                for (uint32_t x = 0; x < uint32_t(100 * aspect); ++x) {
                    const bool hit = bool(scene->intersect(centre(c, x, y)));
                    hits += hit;
                    border += hit && (x == 0 || y == 0 || x + 1 == uint32_t(100 * aspect) || y == 99);
                }
            CHECK(border == 0);
            CHECK(hits > 300);
        }
    }
}
