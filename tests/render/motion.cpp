// Motion blur in pictures, against closed forms and against many still frames.
#include "core/scene/motion.h"
#include "tests/render/blur.h"
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr Interval second{0, 1};

MotionDesc shift(const Vec3d& from, const Vec3d& to) { return {shapes::translation(from), shapes::translation(to)}; }
void addMoving(SceneDesc& s, PrimitiveDesc shape, int material, MotionDesc motion) {
    shapes::add(s, "moving", std::move(shape), material, motion.front());
    s.instances.back().motion = std::move(motion);
    s.shutter = second;
}
// A lamp of radiance 1 over x in [0, 2] in the plane z = 0, far along y, which goes 5 along x while the shutter is open.
SceneDesc bar() {
    SceneDesc s;
    const int lamp = shapes::add(s, shapes::lamp("bar", Spectrum(1)));
    addMoving(s, shapes::quad({0, -50, 0}, {2, -50, 0}, {2, 50, 0}, {0, 50, 0}), lamp, shift({}, {5, 0, 0}));
    return s;
}
// The same at a moment, at rest.
SceneDesc frozen(SceneDesc s, double time) {
    for (InstanceDesc& i : s.instances) {
        if (i.motion.size() > 1) i.toWorld = Motion(i.motion, s.shutter).exact(time);
        i.motion.clear();
    }
    s.shutter = {};
    return s;
}
// Without vertex normals: interpolated ones lose light where they lean over their triangle.
PrimitiveDesc faceted(PrimitiveDesc p) {
    p.normals.clear();
    return p;
}
CameraDesc down(double x) { return probe({x, 0, 0}, {0, 0, -1}); }

// Receiver, a turning sheet above it, and a lamp that flies by: shadows, direct light and a moving emitter at once.
SceneDesc stage() {
    SceneDesc s;
    const int grey = shapes::add(s, shapes::diffuse("grey", Spectrum(0.6f))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(20)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 3), grey);
    MotionDesc turning, flying;
    for (int i = 0; i <= 8; ++i) {
        turning.push_back(shapes::translation({0, 1, 0}) * rotation({0, 0, 1}, i * pi64 / 8));
        flying.push_back(shapes::translation({-1 + i * 0.25, 2, 0.5}) * rotation({1, 0, 0}, i * 0.1) * scaling(1 + i * 0.2, 1, 1));
    }
    addMoving(s, shapes::box({0.6, 0.05, 0.6}), grey, turning);
    addMoving(s, plate({0, 0, 0}, {0, -1, 0}, 0.3), lamp, flying);
    return s;
}

} // namespace

TEST_SUITE("motion") {
    TEST_CASE("a bar 2 wide that moves 5: the share of the time in which it covers a place (H12)") {
        const auto scene = compiled(bar());
        for (const auto& [x, share] : {std::pair{-0.01, 0.}, {1., .2}, {2., .4}, {3.5, .4}, {6., .2}, {7.01, 0.}}) {
            CAPTURE(x);
            checkEqual(measure(*scene, down(x), {.width = 4, .height = 4, .spp = 1 << 14}), share, 5e-3, 1e-4);
        }
    }

    TEST_CASE("a camera that moves sees the bar at rest alike") {
        SceneDesc s = bar();
        s.instances[0].motion.clear();
        const auto scene = compiled(std::move(s));
        for (const auto& [x, share] : {std::pair{1., .2}, {2., .4}, {3.5, .4}, {6., .2}}) {
            CAPTURE(x);
            CameraDesc c = down(x);
            c.motion = {c.toWorld, shapes::translation({-5, 0, 0}) * c.toWorld};
            checkEqual(measure(*scene, c, {.width = 4, .height = 4, .spp = 1 << 14}), share, 5e-3, 1e-4);
        }
    }

    TEST_CASE("an edge at unit speed is a linear ramp (H12)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("edge", Spectrum(1)));
        addMoving(s, shapes::quad({-50, -50, 0}, {0, -50, 0}, {0, 50, 0}, {-50, 50, 0}), lamp, shift({}, {1, 0, 0}));
        const auto scene = compiled(std::move(s));
        for (const double x : {0.125, 0.25, 0.5, 0.75, 0.9}) {
            CAPTURE(x);
            checkEqual(measure(*scene, down(x), {.width = 4, .height = 4, .spp = 1 << 14}), 1 - x, 1e-2, 1e-4);
        }
    }

    TEST_CASE("a quarter turn at half time is 45 degrees at full length (H12)") {
        // A needle from the centre to radius 1, 0.02 wide: it crosses the pixel at radius 0.98 on the diagonal for 0.02 / 0.98 of a radian.
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("needle", Spectrum(1)));
        addMoving(s, shapes::quad({0, -0.01, 0}, {1, -0.01, 0}, {1, 0.01, 0}, {0, 0.01, 0}), lamp, {{}, rotation({0, 0, 1}, pi64 / 2)});
        const auto scene = compiled(std::move(s));
        const double r = 0.98, crossing = 2 * std::asin(0.01 / r) / (pi64 / 2);
        checkEqual(measure(*scene, probe(Vec3d{r, r, 0} * std::sqrt(0.5), {0, 0, -1}), {.width = 4, .height = 4, .spp = 1 << 14}), crossing,
                   2e-2, 1e-3);
    }

    TEST_CASE("point and spot lights that move: the mean over their way") {
        const double h = 1.5, a = 2, rho = 0.8;
        for (const PunctualKind kind : {PunctualKind::point, PunctualKind::spot}) {
            SceneDesc s;
            s.shutter = {-2, 2};
            const int grey = shapes::add(s, shapes::diffuse("grey", Spectrum(float(rho))));
            shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 10), grey);
            PunctualDesc l;
            l.kind = kind;
            l.innerCone = 1.5; // wide enough for the whole way
            l.outerCone = 1.55;
            const Affine along = shapes::lookAt({-a, h, 0}, {-a, 0, 0}, {0, 0, 1});
            l.motion = {along, shapes::translation({2 * a, 0, 0}) * along};
            l.toWorld = along;
            s.lights.push_back(l);
            const auto scene = compiled(std::move(s));
            // I / (2 a) times the integral of h / (x^2 + h^2)^1.5 over [-a, a].
            const double expected = rho / pi64 / (h * std::sqrt(a * a + h * h));
            checkEqual(measure(*scene, probe({0, 0, 0}, {0, -1, 0}), {.width = 8, .height = 8, .spp = 256}), expected, 5e-3, 1e-4);
        }
    }

    TEST_CASE("a sun that turns: the mean of the cosine") {
        SceneDesc s;
        s.shutter = second;
        const int grey = shapes::add(s, shapes::diffuse("grey", Spectrum(0.5f)));
        shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 10), grey);
        PunctualDesc sun;
        sun.kind = PunctualKind::directional;
        for (int i = 0; i <= 16; ++i) sun.motion.push_back(rotation({0, 0, 1}, i * pi64 / 48) * rotation({1, 0, 0}, -pi64 / 2));
        sun.toWorld = sun.motion.front();
        s.lights.push_back(sun);
        const auto scene = compiled(std::move(s));
        const double expected = 0.5 / pi64 * std::sin(pi64 / 3) / (pi64 / 3); // from the zenith to 60 degrees
        checkEqual(measure(*scene, probe({0, 0, 0}, {0, -1, 0}), {.width = 8, .height = 8, .spp = 256}), expected, 5e-3, 1e-4);
    }

    TEST_CASE("a lamp that flies, turns and grows: light samples, both strategies and particles agree, and equal many still frames") {
        checkBlur(stage(), frozen);
    }

    TEST_CASE("a closed furnace that spins and flies is exact, from within and from without") {
        SceneDesc inside;
        MaterialDesc wall = shapes::lamp("wall", Spectrum(0.5f), Spectrum(0.5f));
        const int glow = shapes::add(inside, std::move(wall));
        MotionDesc wild;
        for (int i = 0; i <= 16; ++i) wild.push_back(shapes::translation({i * 0.02, 0, i * -0.01}) * rotation({1, 2, 3}, i * 0.7));
        addMoving(inside, faceted(shapes::insideOut(shapes::sphere(1, 3))), glow, wild);
        checkEqual(measure(*compiled(std::move(inside)), perspective({0.1, 0, 0}, {1, 0.2, 0}, 1.2),
                           {.width = 16, .height = 16, .spp = 128}, "path:rr-depth=64"),
                   1, 2e-3, 1e-4);
        SceneDesc outside;
        const int white = shapes::add(outside, shapes::diffuse("white", Spectrum(1)));
        for (Affine& m : wild) m = m * scaling(1, 0.6, 1.3);
        addMoving(outside, faceted(shapes::sphere(1, 3)), white, wild);
        outside.environment = uniformSky(1);
        checkEqual(measure(*compiled(std::move(outside)), perspective({0, 0, 4}, {0, 0, 0}, 0.6), {.width = 16, .height = 16, .spp = 1024}),
                   1, 2e-3, 1e-4);
    }

    TEST_CASE("the same bits for any number of threads; an open shutter over a still scene changes nothing") {
        const auto scene = compiled(stage());
        const CameraDesc view = perspective({0, 3, 4}, {0, 0.5, 0}, 0.7);
        Settings how{.width = 48, .height = 32, .spp = 8};
        const Rendering one = rendered(*scene, view, how);
        how.threads = 4;
        CHECK(samePicture(*one.film, *rendered(*scene, view, how).film));
        SceneDesc still = frozen(stage(), 0.3);
        const Rendering closed = rendered(*compiled(still), view, how);
        still.shutter = second;
        CHECK(samePicture(*closed.film, *rendered(*compiled(still), view, how).film));
    }
} // TEST_SUITE
