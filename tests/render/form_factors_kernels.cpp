// Form factors of polygons and of hemicube cells against closed forms.
#include "integrators/radiosity/form_factors_polygon.h"
#include "integrators/radiosity/hemicube.h"
#include "tests/render/form_factors_kit.h"

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

TEST_SUITE("form-factor-kernels") {
    TEST_CASE("parallel rectangles (A1)") {
        const double known[][4] = {
            {1, 1, 1, .1998248957}, {1, 1, .5, .4152532836}, {1, 1, 2, .0685895888}, {1, 1, 10, .0031620568}, {1, 2, 1, .2858753849}};
        for (const auto& [a, b, d, f] : known) {
            CHECK(parallel(a, b, d) == doctest::Approx(f).epsilon(1e-7));
            CHECK(exchangeArea(floorOf(a, b), {0, 0, 1}, ceilingOf(a, b, d), {0, 0, -1}) / (a * b) ==
                  doctest::Approx(parallel(a, b, d)).epsilon(1e-7));
        }
        for (const double d : {.3, .1, .01, .001})
            CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, ceilingOf(1, 1, d), {0, 0, -1}) ==
                  doctest::Approx(parallel(1, 1, d)).epsilon(1e-7));
    }
    TEST_CASE("rectangles at a right angle with a common edge (A2), and one that only touches") {
        const double known[][2] = {{1, .2000437761}, {2, .2328526028}, {.5, .1461866791}};
        for (const auto& [h, f] : known) {
            CHECK(perpendicular(1, h) == doctest::Approx(f).epsilon(1e-7));
            CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, wallOf(1, h), {1, 0, 0}) == doctest::Approx(perpendicular(1, h)).epsilon(1e-7));
        }
        // The wall twice as long, less the half that stands beside: what is left touches at a corner.
        const double whole = exchangeArea(floorOf(1, 1), {0, 0, 1}, wallOf(2, 1), {1, 0, 0}), beside = perpendicular(1, 1);
        const Corners rest{{0, 1, 0}, {0, 2, 0}, {0, 2, 1}, {0, 1, 1}};
        CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, rest, {1, 0, 0}) == doctest::Approx(whole - beside).epsilon(1e-7));
    }
    TEST_CASE("closure of a cube and of a box 2 x 3 x 4 (A3)") {
        CHECK(parallel(1, 1, 1) + 4 * perpendicular(1, 1) == doctest::Approx(1).epsilon(1e-12));
        const double floor = 6, ceiling = exchangeArea(floorOf(2, 3), {0, 0, 1}, ceilingOf(2, 3, 4), {0, 0, -1}) / floor;
        const double along3 = exchangeArea(floorOf(2, 3), {0, 0, 1}, wallOf(3, 4), {1, 0, 0}) / floor;
        const double along2 = exchangeArea(floorOf(3, 2), {0, 0, 1}, wallOf(2, 4), {1, 0, 0}) / floor;
        CHECK(ceiling == doctest::Approx(.0953919317).epsilon(1e-7));
        CHECK(along2 == doctest::Approx(.1828634185).epsilon(1e-7));
        CHECK(along3 == doctest::Approx(.2694406156).epsilon(1e-7));
        CHECK(ceiling + 2 * along2 + 2 * along3 == doctest::Approx(1).epsilon(1e-7));
    }
    TEST_CASE("a surface element to rectangles, to what is half below its horizon, to discs (A6, A7, B2)") {
        const Vec3d o{}, up{0, 0, 1};
        CHECK(pointToPolygon(o, up, ceilingOf(1, 1, 1)) == doctest::Approx(.1385316060).epsilon(1e-8));
        const Corners centred{{-.5, -.5, 1}, {-.5, .5, 1}, {.5, .5, 1}, {.5, -.5, 1}};
        CHECK(pointToPolygon(o, up, centred) == doctest::Approx(.2394564705).epsilon(1e-8));
        const Corners upright{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}; // seen from the origin: its front is -x
        const Corners turned(upright.rbegin(), upright.rend());
        CHECK(std::max(pointToPolygon(o, up, upright), pointToPolygon(o, up, turned)) == doctest::Approx(.0557341970).epsilon(1e-8));
        CHECK(std::min(pointToPolygon(o, up, upright), pointToPolygon(o, up, turned)) == 0);
        CHECK(pointToPolygon(o, {1, 0, 0}, centred) == doctest::Approx(.0875102648 / pi64).epsilon(1e-8)); // B2: half below
        for (const double r : {.5, 1., 2.}) { // a disc of 2^n corners has sin(x)/x of its area: two of them, extrapolated
            const auto polygon = [r](int n) {
                Corners c;
                for (int i = 0; i < n; ++i) c.push_back({r * std::cos(2 * pi64 * i / n), -r * std::sin(2 * pi64 * i / n), 1});
                return c;
            };
            const double coarse = pointToPolygon(o, up, polygon(256)), fine = pointToPolygon(o, up, polygon(512));
            CHECK((4 * fine - coarse) / 3 == doctest::Approx(r * r / (r * r + 1)).epsilon(1e-8));
        }
    }
    TEST_CASE("long strips, a wedge (A8)") {
        const double l = 4000; // of 1: the ends count by 1 / l
        CHECK(exchangeArea(floorOf(1, l), {0, 0, 1}, ceilingOf(1, l, 1), {0, 0, -1}) / l ==
              doctest::Approx(std::sqrt(2) - 1).epsilon(1e-3));
        CHECK(exchangeArea(floorOf(1, l), {0, 0, 1}, wallOf(l, 1), {1, 0, 0}) / l == doctest::Approx(1 - std::sin(pi64 / 4)).epsilon(1e-3));
        const double c = std::cos(pi64 / 3), s = std::sin(pi64 / 3);
        const Corners leaning{{0, 0, 0}, {0, l, 0}, {c, l, s}, {c, 0, s}};
        CHECK(exchangeArea(floorOf(1, l), {0, 0, 1}, leaning, {s, 0, -c}) / l == doctest::Approx(.5).epsilon(1e-3));
    }
    TEST_CASE("horizons: what lies behind the other's plane does not count, on either side") {
        // A wall from 1 below the floor to 1 above it sees it as its upper half does; likewise the other way about.
        const Corners tall{{0, 0, -1}, {0, 1, -1}, {0, 1, 1}, {0, 0, 1}};
        CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, tall, {1, 0, 0}) == doctest::Approx(perpendicular(1, 1)).epsilon(1e-7));
        CHECK(exchangeArea(tall, {1, 0, 0}, floorOf(1, 1), {0, 0, 1}) == doctest::Approx(perpendicular(1, 1)).epsilon(1e-7));
        const Corners below = ceilingOf(1, 1, -1);
        CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, below, {0, 0, -1}) == 0);
        const Corners same = {{2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}};
        CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, same, {0, 0, 1}) == 0); // one plane
    }
    TEST_CASE("the double integral agrees with the mean of Lambert's formula over the first polygon") {
        const Corners tilted{{-.3, .4, .6}, {.2, 1.4, .9}, {1.1, 1.2, 1.3}, {.6, .2, 1}};
        const Vec3d n = normalize(cross(tilted[1] - tilted[0], tilted[2] - tilted[0])); // nearly plane is not enough
        Corners flat = tilted;
        flat[3] = tilted[0] + tilted[2] - tilted[1];
        REQUIRE(n.z < 0);
        double sum = 0;
        const int m = 200;
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j) sum += pointToPolygon({(i + .5) / m, (j + .5) / m, 0}, {0, 0, 1}, flat);
        CHECK(exchangeArea(floorOf(1, 1), {0, 0, 1}, flat, n) == doctest::Approx(sum / (m * m)).epsilon(1e-4));
    }
    TEST_CASE("hemicube cells (A11)") {
        for (const uint32_t n : {2u, 32u, 64u, 128u}) {
            const Hemicube cube(n);
            double top = 0, side = 0, all = 0, middle = 0;
            for (uint32_t j = 0; j < n; ++j)
                for (uint32_t i = 0; i < n; ++i) {
                    top += double(cube.top(i, j));
                    middle += cube.topByMiddle(i, j);
                    if (j < n / 2) side += double(cube.side(i, j)), middle += 4 * cube.sideByMiddle(i, j);
                }
            for (uint32_t i = 0; i < cube.pixels(); ++i) {
                all += double(cube[i].factor);
                CHECK(length(cube[i].direction) == doctest::Approx(1).epsilon(1e-6));
            }
            CHECK(top == doctest::Approx(.5541264240).epsilon(1e-7));
            CHECK(side == doctest::Approx(.1114683940).epsilon(1e-7));
            CHECK(all == doctest::Approx(1).epsilon(1e-7));
            const double published = n == 32 ? 1.0005296 : n == 64 ? 1.0001323 : 1.0000331;
            if (n > 2) CHECK(middle == doctest::Approx(published).epsilon(1e-7));
        }
        const Hemicube cube(64);
        CHECK(cube.topByMiddle(32, 32) == doctest::Approx(3.105462e-4).epsilon(1e-6));
        CHECK(double(cube.top(32, 32)) == doctest::Approx(3.104453e-4).epsilon(1e-6));
        CHECK(cube.topByMiddle(0, 0) == doctest::Approx(3.601223e-5).epsilon(1e-6));
    }
    TEST_CASE("the unit square one above, seen by hemicubes: the aliasing of the method (A11)") {
        const double exactValue = .2394564705, known[][2] = {{16, .00298}, {64, .00019}, {512, .000003}};
        for (const auto& [n, error] : known) {
            const Hemicube cube{uint32_t(n)};
            double sum = 0;
            for (uint32_t i = 0; i < cube.pixels(); ++i) {
                const Vec3 d = cube[i].direction;
                if (d.z > 0 && std::fabs(d.x / d.z) <= .5f && std::fabs(d.y / d.z) <= .5f) sum += double(cube[i].factor);
            }
            INFO("resolution " << n << ": " << sum / exactValue - 1);
            // Where edges of cells meet the edges of the square, exact cells make an exact sum.
            CHECK(std::fabs(sum / exactValue - 1) < error + 1e-6);
        }
    }
} // TEST_SUITE
