// The thin lens: circles of confusion of row H11, the shape and area of the opening, the plane of focus off the axis; and the importance of
// every kind of camera: the same geometry as its rays, and the same solid angles.
#include "core/math/warp.h"
#include "core/scene/camera.h"
#include "scenes/shapes.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;
using doctest::Approx;

namespace {

constexpr double degree = std::numbers::pi / 180;

CameraDesc lensed(LensDesc lens, double yfov = 60 * degree, const Affine& m = {}) {
    CameraDesc c;
    c.yfov = yfov;
    c.toWorld = m;
    c.lens = lens;
    return c;
}
CameraDesc telecentric(LensDesc lens, double xmag, double ymag, const Affine& m = {}) {
    CameraDesc c;
    c.projection = Projection::orthographic;
    c.xmag = xmag;
    c.ymag = ymag;
    c.toWorld = m;
    c.lens = lens;
    return c;
}
Point2 anyPoint(stats::Random& u) {
    const auto x = float(u());
    return {x, float(u())};
}
SurfacePoint at(const Vec3& p, const Vec3& n) {
    SurfacePoint s;
    s.p = p;
    s.ng = s.ns = normalize(n);
    s.error = 1e-6f;
    return s;
}

// Every kind of view of 64 x 48 pixels, turned and moved.
std::vector<Camera> everyCamera() {
    const Affine place = shapes::translation({1, -2, 3}) * rotation({1, 2, -1}, 0.7);
    std::vector<Camera> all;
    for (const CameraDesc& c : {lensed({}, 1, place), lensed({0.05, 2}, 1, place), lensed({0.1, 3, 5, 0.3}, 0.5, place),
                                telecentric({}, 2, 1, place), telecentric({0.2, 3}, 2, 1.5, place)})
        all.emplace_back(c, 64, 48);
    return all;
}

// The largest distance on the plane z metres away between a ray of the middle of the raster and the axis.
double discRadius(const Camera& c, Point2 raster, double z) {
    double most = 0;
    const Ray centre = c.ray(raster, {0.5f, 0.5f}, 0);
    for (int i = 0; i < 4096; ++i) {
        const Ray r = c.ray(raster, {(float(i % 64) + 0.5f) / 64, (float(i / 64) + 0.5f) / 64}, 0);
        const Vec3d p = cast<double>(r.o) + cast<double>(r.d) * (-z / double(r.d.z)),
                    m = cast<double>(centre.o) + cast<double>(centre.d) * (-z / double(centre.d.z));
        most = std::max(most, length(p - m));
    }
    return most * 64 / 63; // the outermost ring of samples lies at 63/64
}

} // namespace

TEST_SUITE("camera-lens") {

    TEST_CASE("H11: circles of confusion") {
        // 50 mm at f/2.8, focused at 2 m: on the sensor c = A f |z - zf| / (z (zf - f)). An ideal lens of diameter A spreads a point at z
        // over A |z - zf| / zf on the plane at z; its picture behind a thin lens of focal length f, magnified by f / (zf - f) at the plane
        // of focus, is c.
        const double f = 0.05, diameter = f / 2.8, focus = 2;
        const Camera c(lensed({diameter / 2, focus}), 1920, 1080);
        const struct {
            double z, millimetres;
        } rows[] = {{1, .457875458}, {1.5, .152625153}, {4, .228937729}, {10, .366300366}, {1e5, .457875458 * (1 - 2e-5)}};
        for (const auto& row : rows) {
            const double onFocus = 2 * discRadius(c, {960, 540}, row.z) * focus / row.z; // brought to the plane of focus
            CHECK(onFocus * f / (focus - f) * 1000 == Approx(row.millimetres).epsilon(1e-3));
        }
        CHECK(discRadius(c, {960, 540}, focus) < 1e-6);
        const Camera wide(lensed({0.05, 2}), 1920, 1080);
        const double onFocus = discRadius(wide, {960, 540}, 4) * 2 / 4;
        CHECK(onFocus == Approx(.025).epsilon(1e-3));
        CHECK(onFocus / (2 * std::tan(30 * degree) * 2) * 1080 == Approx(11.6913).epsilon(1e-3));
    }

    TEST_CASE("the plane of focus is a plane: sharp in every corner, at one distance along the axis") {
        for (const Camera& c : {Camera(lensed({0.2, 3}, 80 * degree), 200, 100), Camera(telecentric({0.2, 3}, 2, 1), 200, 100)}) {
            stats::Random u(1);
            for (const Point2 raster : {Point2{100, 50}, {0, 0}, {200, 100}, {3, 90}}) {
                Vec3 first;
                for (int i = 0; i < 200; ++i) {
                    const Ray r = c.ray(raster, anyPoint(u), 0);
                    const Vec3 p = r.o + r.d * (3 / -r.d.z);
                    if (i == 0) first = p;
                    CHECK(length(p - first) < 3e-6f);
                    CHECK(length(r.d) == Approx(1));
                    CHECK(c.depth(r.o) == Approx(0));
                }
            }
        }
    }

    TEST_CASE("a lens without size is the pinhole, to the bit; the middle of the lens shows its picture") {
        const Camera pinhole(lensed({}), 64, 48), lens(lensed({0.1, 2}), 64, 48);
        CHECK_FALSE(pinhole.hasLens());
        CHECK(lens.hasLens());
        stats::Random u(2);
        for (int i = 0; i < 100; ++i) {
            const Point2 raster{64 * float(u()), 48 * float(u())};
            const Ray a = pinhole.ray(raster, anyPoint(u), 0), b = pinhole.ray(raster, {0.5f, 0.5f}, 0);
            CHECK(a.d == b.d);
            CHECK(a.o == b.o);
            CHECK(length(lens.ray(raster, {0.5f, 0.5f}, 0).d - b.d) < 1e-6f);
        }
    }

    TEST_CASE("the opening is uniform: moments of the disc and of polygons, corners and area") {
        for (const int blades : {0, 3, 5, 6, 8, 9}) {
            INFO(blades);
            const double rotation = 0.4, radius = 0.1;
            const Camera c(lensed({radius, 2, blades, rotation}), 64, 64);
            stats::Random u(3);
            constexpr int n = 400'000;
            double r2 = 0, xx = 0, xy = 0, x = 0, y = 0, most = 0;
            int inner = 0;
            const double step = 2 * std::numbers::pi / std::max(blades, 1), apothem = blades ? std::cos(step / 2) : 1;
            double outside = 0; // beyond an edge, in units of the radius
            for (int i = 0; i < n; ++i) {
                const Ray r = c.ray({32, 32}, anyPoint(u), 0);
                const double px = double(r.o.x) / radius, py = double(r.o.y) / radius, rr = px * px + py * py;
                r2 += rr, xx += px * px, xy += px * py, x += px, y += py;
                most = std::max(most, std::sqrt(rr));
                inner += rr < 0.09;
                for (int k = 0; k < blades; ++k) { // normals of the edges, the first corner at the top turned towards +x
                    const double a = rotation + (k + 0.5) * step;
                    outside = std::max(outside, px * std::sin(a) + py * std::cos(a) - apothem);
                }
            }
            // Area and second moment of a regular polygon of circumradius 1: N/2 sin t, and <r^2> = (2 + cos t) / 6 with t = 2 pi / N.
            const double area = blades ? blades / 2.0 * std::sin(step) : std::numbers::pi;
            const double expected = blades ? (2 + std::cos(step)) / 6 : 0.5;
            CHECK(r2 / n == Approx(expected).epsilon(3e-3));
            CHECK(xx / n == Approx(expected / 2).epsilon(1e-2)); // isotropic
            CHECK(std::fabs(xy / n) < 3e-3);
            CHECK(std::fabs(x / n) < 3e-3);
            CHECK(std::fabs(y / n) < 3e-3);
            CHECK(double(inner) / n == Approx(std::numbers::pi * 0.09 / area).epsilon(1e-2));
            CHECK(most > 0.985);
            CHECK(most < 1 + 1e-6);
            CHECK(outside < 1e-6);
        }
    }

    TEST_CASE("importance names the raster position, the lens point and the direction of the camera's own ray") {
        for (const Camera& c : everyCamera()) {
            stats::Random u(4);
            for (int i = 0; i < 300; ++i) {
                const Point2 raster{80 * float(u()) - 8, 80 * float(u()) - 8}, lens = anyPoint(u); // beyond the frame too
                const Ray r = c.ray(raster, lens, 0);
                const float t = 0.5f + 6 * float(u());
                const SurfacePoint p = at(r.o + r.d * t, -r.d + c.axis() * 0.3f);
                const auto seen = c.importance(p, lens);
                REQUIRE(seen);
                CHECK(std::fabs(seen->raster.x - raster.x) < 2e-3f);
                CHECK(std::fabs(seen->raster.y - raster.y) < 2e-3f);
                CHECK(length(seen->wi + r.d) < 1e-5f);
                CHECK(length(seen->shadow.o + seen->shadow.d * seen->shadow.tfar - r.o) < 1e-5f);
                const auto landed = c.landing({p.p, 0, -r.d, infinity, 0});
                CHECK(bool(landed) == c.hasLens());
                if (!landed) continue;
                CHECK(landed->t == Approx(t).epsilon(1e-4));
                CHECK(std::fabs(landed->raster.x - raster.x) < 5e-3f);
                CHECK(std::fabs(landed->raster.y - raster.y) < 5e-3f);
            }
            CHECK_FALSE(c.importance(at(c.position() - c.axis(), c.axis()), {0.5f, 0.5f}));
            CHECK_FALSE(c.landing({c.position() - c.axis(), 0, c.axis(), infinity, 0}));
            CHECK_FALSE(c.landing({c.position() - c.axis(), 0, -c.axis(), infinity, 0}));
        }
    }

    TEST_CASE("importance is the Jacobian of the rays: finite differences") {
        for (const Camera& c : everyCamera()) {
            stats::Random u(5);
            for (int i = 0; i < 200; ++i) {
                const Point2 raster{4 + 50 * float(u()), 4 + 30 * float(u())}, lens = anyPoint(u);
                const float t = 1 + 5 * float(u());
                const Ray r = c.ray(raster, lens, 0);
                const Vec3d p = cast<double>(r.o) + cast<double>(r.d) * double(t),
                            n = normalize(cast<double>(-r.d) + Vec3d{0.2, 0.3, -0.1});
                // Where the rays of neighbouring raster positions meet the tangent plane: its area per unit of raster.
                const auto meets = [&](float dx, float dy) {
                    const Ray s = c.ray({raster.x + dx, raster.y + dy}, lens, 0);
                    const Vec3d o = cast<double>(s.o), d = cast<double>(s.d);
                    return o + d * (dot(p - o, n) / dot(d, n));
                };
                const float h = 0.5f;
                const double area = length(cross(meets(h, 0) - meets(-h, 0), meets(0, h) - meets(0, -h))) / (4 * double(h) * double(h));
                const auto seen = c.importance(at(cast<float>(p), cast<float>(n)), lens);
                REQUIRE(seen);
                CHECK(double(seen->importance) * std::fabs(dot(cast<double>(seen->wi), n)) * area == Approx(1).epsilon(3e-3));
            }
        }
    }

    TEST_CASE("all importance that leaves a camera is its raster: importance x cos over a far plane") {
        for (const Camera& c : everyCamera()) {
            const Vec3 right = normalize(cross(c.axis(), {0.3f, 1, 0.2f})), up = cross(right, c.axis());
            const double half = 4, z = 3.7;
            stats::Random u(6);
            constexpr int n = 400'000;
            double sum = 0, squares = 0;
            constexpr double pixels = 64 * 48;
            for (int i = 0; i < n; ++i) {
                const Point2 q = anyPoint(u), lens = anyPoint(u);
                const Vec3 p = c.position() + c.axis() * float(z) + right * float(half * (2 * double(q.x) - 1)) +
                               up * float(half * (2 * double(q.y) - 1));
                const auto seen = c.importance(at(p, -c.axis()), lens);
                if (!seen || seen->raster.x < 0 || seen->raster.y < 0 || seen->raster.x >= 64 || seen->raster.y >= 48) continue;
                const double v = double(seen->importance) * double(-dot(seen->wi, c.axis())) * 4 * half * half;
                sum += v;
                squares += v * v;
            }
            const double mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
            CHECK(std::fabs(mean - pixels) < 5 * error);
            CHECK(error < 0.01 * pixels);
        }
    }

    TEST_CASE("landing counts what it is given: the flux of a uniform field through the opening, spread over the raster") {
        // Radiance 1 from everywhere: every pixel's mean is 1. Rays through random points of the opening with directions drawn by cosine.
        for (const Camera& c : {Camera(lensed({0.3, 2, 6}, 1.2), 8, 8), Camera(lensed({0.3, 2}, 1.2), 8, 8)}) {
            stats::Random u(7);
            constexpr int n = 1'000'000;
            double sum = 0;
            const double box = 4 * sqr(0.3); // the square about the opening
            for (int i = 0; i < n; ++i) {
                const Point2 q = anyPoint(u);
                const Vec3 d = cosineHemisphere(anyPoint(u)), from{0.3f * (2 * q.x - 1), 0.3f * (2 * q.y - 1), 0};
                const Vec3 w{d.x, d.y, -d.z};
                const auto landed = c.landing({from + w * 3.f, 0, -w, infinity, 0});
                if (!landed || landed->raster.x < 0 || landed->raster.x >= 8 || landed->raster.y < 0 || landed->raster.y >= 8) continue;
                sum += double(landed->importance) * box * std::numbers::pi / n;
            }
            CHECK(sum == Approx(64).epsilon(5e-3));
        }
    }
}
