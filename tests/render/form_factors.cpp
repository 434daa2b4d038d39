// Form factors against closed forms (the catalogue of J. R. Howell, C-11, C-14, C-40, C-41 ...): kernels, rows of every method, matrices.
#include "integrators/radiosity/form_factors.h"
#include "core/math/warp.h"
#include "integrators/radiosity/form_factors_polygon.h"
#include "integrators/radiosity/hemicube.h"
#include "scenes/scenes.h"
#include "tests/render/patches_kit.h"
#include <numeric>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

constexpr double pi64 = std::numbers::pi;
using Corners = std::vector<Vec3d>;

// C-11: parallel rectangles a x b at distance d.
double parallel(double a, double b, double d) {
    const double x = a / d, y = b / d, x2 = x * x, y2 = y * y, p = std::sqrt(1 + x2), q = std::sqrt(1 + y2);
    return 2 / (pi64 * x * y) *
           (std::log(std::sqrt((1 + x2) * (1 + y2) / (1 + x2 + y2))) + x * q * std::atan(x / q) + y * p * std::atan(y / p) -
            x * std::atan(x) - y * std::atan(y));
}
// C-14: rectangles w and h wide that share an edge of length 1 at a right angle.
double perpendicular(double w, double h) {
    const double w2 = w * w, h2 = h * h, s = std::sqrt(h2 + w2), all = 1 + w2 + h2;
    return 1 / (pi64 * w) *
           (w * std::atan(1 / w) + h * std::atan(1 / h) - s * std::atan(1 / s) +
            .25 * std::log((1 + w2) * (1 + h2) / all * std::pow(w2 * all / ((1 + w2) * (w2 + h2)), w2) *
                           std::pow(h2 * all / ((1 + h2) * (w2 + h2)), h2)));
}
// C-41: coaxial discs of radii r1, r2 at distance h, from the first.
double discs(double r1, double r2, double h) {
    const double a = r1 / h, b = r2 / h, x = 1 + (1 + b * b) / (a * a);
    return (x - std::sqrt(x * x - 4 * (b / a) * (b / a))) / 2;
}

Corners floorOf(double a, double b) { return {{0, 0, 0}, {a, 0, 0}, {a, b, 0}, {0, b, 0}}; } // front +z
Corners ceilingOf(double a, double b, double d) { return {{0, 0, d}, {0, b, d}, {a, b, d}, {a, 0, d}}; }
Corners wallOf(double b, double h) { return {{0, 0, 0}, {0, b, 0}, {0, b, h}, {0, 0, h}}; } // on the floor's edge x = 0, front +x

double sumOf(const std::vector<Factor>& row) {
    return std::accumulate(row.begin(), row.end(), 0.0, [](double s, const Factor& f) { return s + double(f.factor); });
}
double factorOf(const std::vector<Factor>& row, uint32_t j) {
    for (const Factor& f : row)
        if (f.patch == j) return double(f.factor);
    return 0;
}
// From all patches of a part to all of another: the mean of their rows' sums by area.
double betweenParts(const FormFactors& f, uint32_t from, uint32_t to) {
    const Patches& p = f.patches();
    double flux = 0, area = 0;
    std::vector<Factor> row;
    for (const uint32_t i : ofPart(p, from)) {
        f.row(i, row);
        for (const Factor& x : row)
            if (p[x.patch].part == to) flux += double(p[i].area) * double(x.factor);
        area += double(p[i].area);
    }
    return flux / area;
}

FormFactorSettings by(FormFactorMethod method) {
    FormFactorSettings s;
    s.method = method;
    return s;
}
FormFactorSettings exact() {
    FormFactorSettings s = by(FormFactorMethod::analytic);
    s.shadowRays = 0;
    return s;
}

// Bit for bit symmetric, no self-factor, rows ascending.
void checkMatrix(const FormFactorMatrix& m) {
    bool symmetric = true, ascending = true, finiteAll = true;
    for (uint32_t i = 0; i < m.size(); ++i) {
        uint32_t last = 0;
        bool first = true;
        for (const Factor& f : m.exchange(i)) {
            ascending = ascending && (first || f.patch > last) && f.patch != i;
            last = f.patch, first = false;
            finiteAll = finiteAll && std::isfinite(f.factor) && f.factor >= 0;
            bool found = false;
            for (const Factor& g : m.exchange(f.patch))
                if (g.patch == i) found = g.factor == f.factor;
            symmetric = symmetric && found;
        }
    }
    CHECK(symmetric);
    CHECK(ascending);
    CHECK(finiteAll);
}
double sumOf(const FormFactorMatrix& m, uint32_t i) {
    double s = 0;
    for (const Factor& f : m.row(i)) s += double(f.factor);
    return s;
}

} // namespace

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

TEST_SUITE("form-factors") {
    TEST_CASE("two unit plates, by every method (A1, A2)") {
        struct Case {
            const char* name;
            SceneDesc desc;
            double factor;
        };
        const Case cases[] = {{"parallel", twoPlates({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}), parallel(1, 1, 1)},
                              {"near", twoPlates({0, .5, 0}, {1, .5, 0}, {1, .5, 1}, {0, .5, 1}), parallel(1, 1, .5)},
                              {"perpendicular", twoPlates({0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}), perpendicular(1, 1)}};
        for (const Case& c : cases) {
            CAPTURE(c.name);
            const auto scene = compiled(c.desc);
            const Bare bare(*scene);
            const Patches one = patchesOf(bare, 1);
            REQUIRE(one.size() == 2);
            const FormFactors analytic(bare.work, one, exact());
            CHECK(betweenParts(analytic, 0, 1) == doctest::Approx(c.factor).epsilon(1e-6));
            CHECK(analytic.unoccluded(0, 1) == analytic.unoccluded(1, 0));
            CHECK(analytic.visibility(0, 1, 64, 0) == 1);
            CHECK(analytic.unoccluded(one[0].centre, one[0].normal, std::span(one[1].corner.data(), 4)) > 0);
            FormFactorSettings rays = by(FormFactorMethod::hemisphere);
            rays.rays = 1 << 16;
            CHECK(betweenParts(FormFactors(bare.work, one, rays), 0, 1) == doctest::Approx(c.factor).epsilon(.003));
            const Patches four = patchesOf(bare, .5f);
            REQUIRE(four.size() == 8);
            CHECK(betweenParts(FormFactors(bare.work, four, exact()), 0, 1) == doctest::Approx(c.factor).epsilon(1e-6));
            FormFactorSettings cubes = by(FormFactorMethod::hemicube);
            cubes.resolution = 128;
            cubes.points = 64;
            CHECK(betweenParts(FormFactors(bare.work, four, cubes), 0, 1) == doctest::Approx(c.factor).epsilon(.01));
        }
    }
    TEST_CASE("coaxial discs, tessellated (A4)") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        const int corners = 64;
        shapes::add(d, "floor", shapes::disc(1, corners), grey);
        shapes::add(d, "lid", shapes::insideOut(shapes::disc(2, corners)), grey, shapes::translation({0, 1, 0}));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        const FormFactors f(bare.work, p, exact());
        // A polygon of n corners has 1 - (2 pi / n)^2 / 6 of the area of its circle, and nearly so its factor.
        const double slack = 2 * std::pow(2 * pi64 / corners, 2) / 6;
        CHECK(discs(1, 2, 1) == doctest::Approx(.7639320225).epsilon(1e-9));
        CHECK(betweenParts(f, 0, 1) == doctest::Approx(discs(1, 2, 1)).epsilon(slack));
        CHECK(betweenParts(f, 1, 0) == doctest::Approx(discs(2, 1, 1)).epsilon(slack));
    }
    TEST_CASE("an opaque disc between an element and a disc (A7), by every method") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "element", plate({0, 0, 0}, {0, 1, 0}, .005), grey);
        shapes::add(d, "lid", shapes::insideOut(shapes::disc(2, 128)), grey, shapes::translation({0, 2, 0}));
        shapes::add(d, "between", shapes::insideOut(shapes::disc(.5, 128)), grey, shapes::translation({0, 1, 0}));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .25f);
        FormFactorSettings s = by(FormFactorMethod::hemisphere);
        s.rays = 1 << 18;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.003));
        s = by(FormFactorMethod::hemicube);
        s.resolution = 512;
        s.points = 1;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.01));
        s = by(FormFactorMethod::analytic);
        s.shadowRays = 64;
        CHECK(betweenParts(FormFactors(bare.work, p, s), 0, 1) == doctest::Approx(.3).epsilon(.005));
        CHECK(betweenParts(FormFactors(bare.work, p, exact()), 0, 1) == doctest::Approx(.5).epsilon(.002)); // nothing between
    }
    TEST_CASE("sphere and disc (A9), within a sphere (A10)") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "ball", shapes::sphere(.5, 3), grey);
        shapes::add(d, "disc", shapes::insideOut(shapes::disc(1, 128)), grey, shapes::translation({0, 1, 0}));
        d.materials[0].doubleSided = false;
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches ball = patchesOf(bare, .5f);
        CHECK(betweenParts(FormFactors(bare.work, ball, by(FormFactorMethod::hemisphere)), 0, 1) ==
              doctest::Approx(.1464466094).epsilon(.003));

        SceneDesc nested;
        shapes::add(nested, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(nested, "inner", shapes::sphere(.5, 2), 0);
        shapes::add(nested, "outer", shapes::insideOut(shapes::sphere(1, 2)), 0);
        nested.materials[0].doubleSided = false;
        const auto both = compiled(nested);
        const Bare within(*both);
        const Patches p = patchesOf(within, 2);
        REQUIRE(p.size() == 2 * 320);
        const FormFactors f(within.work, p, by(FormFactorMethod::hemisphere));
        CHECK(betweenParts(f, 0, 1) == doctest::Approx(1).epsilon(1e-4));
        CHECK(betweenParts(f, 1, 0) == doctest::Approx(.25).epsilon(.005));
        CHECK(betweenParts(f, 1, 1) == doctest::Approx(.75).epsilon(.005));
        // Every element sees every patch of the sphere about it alike: A_j / (4 pi R^2), here between two that nothing hides.
        const auto outer = ofPart(p, 1);
        const double whole = std::accumulate(outer.begin(), outer.end(), 0.0, [&](double s, uint32_t i) { return s + double(p[i].area); });
        double ratio = 0;
        uint32_t n = 0;
        for (uint32_t k = 1; k < outer.size(); k += 7, ++n) ratio += f.unoccluded(outer[0], outer[k]) / (double(p[outer[k]].area) / whole);
        CHECK(ratio / n == doctest::Approx(1).epsilon(.01));
    }
    TEST_CASE("rows of closed rooms sum to one: analytic within 1e-6, rays to the last, cubes within .5 %") {
        const auto scene = compiled(room({1, 1.5, 2}));
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        REQUIRE(p.size() == 2 * (4 * 6 + 6 * 8 + 4 * 8));
        std::vector<Factor> row;
        double worst = 0;
        const FormFactors analytic(bare.work, p, exact());
        for (uint32_t i = 0; i < p.size(); ++i) {
            analytic.row(i, row);
            worst = std::max(worst, std::fabs(sumOf(row) - 1));
        }
        INFO("analytic " << worst);
        CHECK(worst < 1e-6);
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::hemicube}) {
            const FormFactors f(bare.work, p, by(method));
            for (uint32_t i = 0; i < p.size(); i += 17) {
                f.row(i, row);
                CHECK(sumOf(row) == doctest::Approx(1).epsilon(1e-5));
                CHECK(factorOf(row, i) == 0);
            }
        }
    }
} // TEST_SUITE

TEST_SUITE("form-factor-matrix") {
    TEST_CASE("reciprocal to the last bit, rows keep their sums, near the exact factors: unequal patches") {
        SceneDesc d = room({1, 1.5, 2});
        shapes::add(d, "box", shapes::box({.3, .4, .2}), 0, shapes::translation({.2, -.5, .3}) * rotation({0, 1, 0}, .4));
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .6f);
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::hemicube, FormFactorMethod::analytic}) {
            CAPTURE(int(method));
            FormFactorSettings s = by(method);
            s.resolution = 64;
            s.shadowRays = 16;
            FormFactorCheck check;
            const FormFactorMatrix m = formFactorMatrix(bare.work, FormFactors(bare.work, p, s), &check);
            checkMatrix(m);
            CHECK(check.worstAsymmetryAfter == 0);
            CHECK((method == FormFactorMethod::analytic) == (check.worstAsymmetry < 1e-6));
            double worst = 0;
            for (uint32_t i = 0; i < p.size(); ++i) worst = std::max(worst, std::fabs(sumOf(m, i) - 1));
            INFO("rows after: " << worst);
            CHECK(check.closed);
            CHECK(worst < 1e-5);
            CHECK(check.worstRowSumAfter == doctest::Approx(worst).epsilon(1e-3));
        }
    }
    TEST_CASE("a matrix by rays is nearer to the exact one than the rows that it was made of") {
        const auto scene = compiled(room({1, 1.5, 2}));
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, .5f);
        const FormFactors rays(bare.work, p, by(FormFactorMethod::hemisphere)), analytic(bare.work, p, exact());
        const FormFactorMatrix m = formFactorMatrix(bare.work, rays);
        double before = 0, after = 0;
        std::vector<Factor> row;
        for (uint32_t i = 0; i < p.size(); ++i) {
            rays.row(i, row);
            std::vector<double> known(p.size()), found(p.size(), 0), merged(p.size(), 0);
            for (uint32_t j = 0; j < p.size(); ++j) known[j] = analytic.unoccluded(i, j);
            for (const Factor& f : row) found[f.patch] = double(f.factor);
            for (const Factor& f : m.row(i)) merged[f.patch] = double(f.factor);
            for (uint32_t j = 0; j < p.size(); ++j) {
                before += std::pow(found[j] - known[j], 2);
                after += std::pow(merged[j] - known[j], 2);
            }
        }
        CHECK(after < .6 * before); // two estimates of each
    }
    TEST_CASE("the same bits for any number of threads and in any order of rows") {
        const auto scene = compiled(makeCornell());
        const Bare one(*scene, 1), three(*scene, 3);
        const Patches p = patchesByCount(one, 500);
        FormFactorSettings s;
        s.rays = 256;
        const FormFactorMatrix a = formFactorMatrix(one.work, FormFactors(one.work, p, s)),
                               b = formFactorMatrix(three.work, FormFactors(three.work, p, s));
        CHECK(a.begin == b.begin);
        CHECK(std::equal(a.exchanges.begin(), a.exchanges.end(), b.exchanges.begin(), b.exchanges.end(),
                         [](const Factor& x, const Factor& y) { return x.patch == y.patch && x.factor == y.factor; }));
        const FormFactors f(one.work, p, s);
        std::vector<Factor> first, other, again;
        f.row(7, first), f.row(300, other), f.row(7, again);
        CHECK(std::equal(first.begin(), first.end(), again.begin(), again.end(),
                         [](const Factor& x, const Factor& y) { return x.patch == y.patch && x.factor == y.factor; }));
        f.hemisphereRow(7, 256, 1, other);
        CHECK(sumOf(other) == doctest::Approx(sumOf(first)).epsilon(.05));
    }
    TEST_CASE("alpha-masked patches stay reciprocal: half a screen before a wall") {
        SceneDesc d = twoPlates({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1});
        d.materials.push_back(shapes::diffuse("screen", Spectrum(.5f)));
        d.materials[1].alphaMode = AlphaMode::blend;
        d.materials[1].alpha = .5f;
        d.meshes[1].primitives[0].material = 1;
        const auto scene = compiled(d);
        const Bare bare(*scene);
        const Patches p = patchesOf(bare, 1);
        REQUIRE(p.size() == 2);
        CHECK(p[1].coverage == doctest::Approx(.5));
        CHECK(p[1].area == doctest::Approx(.5));
        for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::analytic}) {
            FormFactorSettings s = by(method);
            s.rays = 1 << 16;
            const FormFactors f(bare.work, p, s);
            CHECK(betweenParts(f, 0, 1) == doctest::Approx(parallel(1, 1, 1) / 2).epsilon(.01));
            CHECK(betweenParts(f, 1, 0) == doctest::Approx(parallel(1, 1, 1)).epsilon(.01));
        }
    }
    TEST_CASE("no more memory than allowed; a stop leaves nothing; nothing gives nothing") {
        const auto scene = compiled(room());
        Bare bare(*scene);
        const Patches p = patchesOf(bare, .1f);
        Bare small(*scene, 1, 0, 200'000);
        try {
            formFactorMatrix(small.work, FormFactors(small.work, p, {}));
            FAIL("not refused");
        } catch (const Error& e) { CHECK(e.code == Exit::resources); }
        bare.stop.request();
        CHECK(formFactorMatrix(bare.work, FormFactors(bare.work, p, {})).size() == 0);
        const auto empty = compiled(SceneDesc{});
        const Bare nothing(*empty);
        const Patches none = patchesByCount(nothing, 10);
        FormFactorCheck check;
        CHECK(formFactorMatrix(nothing.work, FormFactors(nothing.work, none, {}), &check).size() == 0);
        CHECK(check.worstRowSum == 0);
    }
} // TEST_SUITE
