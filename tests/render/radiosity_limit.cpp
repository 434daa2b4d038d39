// Where radiosity must arrive as patches shrink: at the path tracer, bounce by bounce, with bodies that stand on a floor; and at closed
// forms of curved and of endless surfaces that patches only come near.
#include "core/math/sobol.h"
#include "integrators/radiosity/solve_options.h"
#include "scenes/builtin.h"
#include "tests/render/form_factors_kit.h"
#include "tests/render/radiosity_kit.h"
#include <fmt/format.h>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

// A lit room with a block on its floor, neither bound to the other's vertices, turned so that no cut runs along its foot.
SceneDesc blockOnFloor(double turn) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.7f)));
    shapes::add(d, "room", shapes::insideOut(shapes::box({.5, .5, .5})), grey);
    shapes::add(d, "block", shapes::box({.13, .1, .13}), grey, shapes::translation({.07, -.4, .03}) * rotation({0, 1, 0}, turn));
    const int lamp = shapes::add(d, shapes::lamp("lamp", Spectrum(8)));
    shapes::add(d, "lamp", plate({0, .4999, 0}, {0, -1, 0}, .1), lamp);
    return d;
}

// A closed room of unit size, five thin walls and a floor that goes on beyond them, with a dim lamp within and a bright one outside.
SceneDesc roomOnWideFloor(float outside) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
    shapes::add(d, "floor", plate({0, -.5, 0}, {0, 1, 0}, .83), grey);
    shapes::add(d, "ceiling", unitFace(1, 1), grey);
    for (const int axis : {0, 2})
        for (const int side : {-1, 1}) shapes::add(d, "wall", unitFace(axis, side), grey);
    shapes::add(d, "lamp", plate({0, .499, 0}, {0, -1, 0}, .1), shapes::add(d, shapes::lamp("lamp", Spectrum(8))));
    if (outside > 0) shapes::add(d, "sky", plate({0, 2, 0}, {0, -1, 0}, 2), shapes::add(d, shapes::lamp("sky", Spectrum(outside))));
    return d;
}

// A lamp in a black-backed tube that hangs in a grey room: the light that the tube sends on leaves it from near the lamp for the most part,
// and little of that comes out.
SceneDesc lampInTube() {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
    shapes::add(d, "room", shapes::insideOut(shapes::box({1, 1, 1})), grey);
    PrimitiveDesc tube;
    constexpr int sides = 16;
    for (int k = 0; k < sides; ++k) {
        const double a = 2 * pi64 * k / sides, b = 2 * pi64 * (k + 1) / sides, r = .1;
        const Vec3d p{r * std::cos(a), 0, r * std::sin(a)}, q{r * std::cos(b), 0, r * std::sin(b)}, up{0, .4, 0};
        PrimitiveDesc face = shapes::quad(p, q, q + up, p + up);
        tube = k == 0 ? face : shapes::joined(std::move(tube), face);
    }
    shapes::add(d, "tube", std::move(tube), grey, shapes::translation({.1, .2, 0}));
    shapes::add(d, "lid", plate({.1, .599, 0}, {0, -1, 0}, .12), shapes::add(d, shapes::diffuse("black", Spectrum(0))));
    shapes::add(d, "lamp", plate({.1, .55, 0}, {0, -1, 0}, .05), shapes::add(d, shapes::lamp("lamp", Spectrum(100))));
    return d;
}

// A closed cylinder of radius and height 1, seen from inside; parts: foot, lid, side.
SceneDesc cylinder(int corners) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
    shapes::add(d, "foot", shapes::disc(1, corners), grey);
    shapes::add(d, "lid", shapes::insideOut(shapes::disc(1, corners)), grey, shapes::translation({0, 1, 0}));
    PrimitiveDesc side;
    for (int k = 0; k < corners; ++k) {
        const double a = 2 * pi64 * k / corners, b = 2 * pi64 * (k + 1) / corners;
        const Vec3d p{std::cos(a), 0, std::sin(a)}, q{std::cos(b), 0, std::sin(b)}, up{0, 1, 0};
        PrimitiveDesc face = shapes::quad(p, q, q + up, p + up);
        side = k == 0 ? face : shapes::joined(std::move(side), face);
    }
    shapes::add(d, "side", std::move(side), grey);
    return d;
}

} // namespace

TEST_SUITE("radiosity-limit") {
    TEST_CASE("what stands on a surface takes its place: area, centre, and no patch within") {
        for (const double turn : {0.0, .4}) {
            CAPTURE(turn);
            const auto scene = compiled(blockOnFloor(turn));
            const Bare bare(*scene);
            const Patches p = patchesOf(bare, .101f);
            double floor = 0, ceiling = 0;
            uint32_t partly = 0, closed = 0, ofBlock = 0;
            for (const Patch& x : p.all()) {
                if (x.part == 0 && x.normal.y > .9f) floor += double(x.area);
                if (x.part == 0 && x.normal.y < -.9f) ceiling += double(x.area);
                if (x.part == 0) partly += x.open < 1 && x.open > .01f, closed += x.open <= .01f;
                if (x.part == 1) ofBlock += x.other != ~0u;
            }
            CHECK(floor == near(1 - .26 * .26, 3e-3));
            CHECK(ceiling == near(1 - .2 * .2, 3e-3)); // the lamp a tenth of a millimetre below it
            CHECK(partly > 3);
            CHECK(closed > 0);
            CHECK(ofBlock == 0); // no backs
            // Rows count what leaves the open part: of a closed room all of it arrives, whatever the method.
            std::vector<Factor> row;
            for (const FormFactorMethod method : {FormFactorMethod::hemisphere, FormFactorMethod::hemicube}) {
                FormFactorSettings s = by(method);
                s.resolution = 64;
                s.points = 16;
                const FormFactors f(bare.work, p, s);
                for (uint32_t i = 0; i < p.size(); i += 7) {
                    if (p[i].open < .1f || (p[i].part == 1 && p[i].normal.y < -.9f)) continue; // the foot of the block
                    f.row(i, row);
                    CHECK(sumOf(row) == near(1, 2e-3));
                }
            }
        }
    }

    TEST_CASE("a block that stands on a floor costs no light, by any solver") {
        const auto scene = compiled(blockOnFloor(.4));
        const RadiosityBench bench(*scene);
        const auto arrived = [&](const std::string& text) {
            const Options o = Options::parse(solveOptions, text, "radiosity");
            const Solved s = bench.solve(patchSettings(o), solveSettings(o));
            return meanOver(
                s.patches, [](const Patch&) { return true; }, [&](uint32_t i) { return luminance(s.solution.irradiance(i)); });
        };
        const double fine = arrived("size=.026,rays=512,light-rays=256");
        CHECK(arrived("size=.101,rays=4096,light-rays=512") == near(fine, 6e-3));
        for (const char* solver :
             {"direct", "shoot,direct=rays,factors=hemisphere", "shoot,direct=rays", "hierarchical", "stochastic,shots=2048"}) {
            CAPTURE(std::string(solver));
            CHECK(arrived(fmt::format("size=.101,rays=4096,light-rays=512,solver={}", solver)) == near(fine, 5e-3));
        }
    }

    TEST_CASE("a wall that stands in the midst of patches keeps the light outside") {
        const auto arrived = [&](const Scene& scene, const std::string& text) {
            const Options o = Options::parse(solveOptions, text, "radiosity");
            const Solved s = RadiosityBench(scene).solve(patchSettings(o), solveSettings(o));
            return meanOver(
                s.patches, [](const Patch& p) { return p.part == 1 && p.normal.y < 0; },
                [&](uint32_t i) { return luminance(s.solution.irradiance(i)); });
        };
        const auto alone = compiled(roomOnWideFloor(0)), lit = compiled(roomOnWideFloor(100));
        // Near the bright outside patches are smaller, so that the room by itself is measured in small ones.
        const double within = arrived(*alone, "size=.05,light-rays=256,solver=stochastic,shots=512");
        double first = 0;
        for (const char* solver : {"gauss-seidel,rays=2048", "stochastic,shots=2048", "hierarchical"}) {
            const double beside = arrived(*lit, fmt::format("size=.24,light-rays=512,solver={}", solver));
            INFO(std::string(solver) << ": " << 100 * (beside / within - 1) << " % more");
            CHECK(std::fabs(beside / within - 1) < .025); // outside it is five hundred times as bright
            if (first == 0) first = beside;
            CHECK(std::fabs(beside / first - 1) < .015);
        }
    }

    TEST_CASE("in the housing of a lamp patches are smaller") {
        const auto scene = compiled(lampInTube());
        const RadiosityBench bench(*scene);
        const auto solved = [&](const char* text) {
            const Options o = Options::parse(solveOptions, text, "radiosity");
            return bench.solve(patchSettings(o), solveSettings(o));
        };
        const auto onFloor = [](const Solved& s, std::size_t term) {
            return meanOver(
                s.patches, [](const Patch& p) { return p.part == 0 && p.normal.y > .9f; },
                [&](uint32_t i) { return luminance(s.solution.terms[term][i]); });
        };
        const Solved coarse = solved("size=.5,rays=2048,light-rays=512"), fine = solved("size=.1,rays=512,light-rays=256");
        double inTube = 0, onWalls = 0;
        for (const Patch& p : coarse.patches.all()) {
            double& longest = p.part == 0 ? onWalls : inTube;
            if (p.part > 1) continue;
            for (uint32_t k = 0; k < p.corners; ++k)
                longest = std::max(longest, double(length(p.corner[(k + 1) % p.corners] - p.corner[k])));
        }
        CHECK(inTube < .09);
        CHECK(onWalls == near(.5, 1e-3));
        for (const std::size_t term : {0u, 1u}) CHECK(std::fabs(onFloor(coarse, term) / onFloor(fine, term) - 1) < .02);
    }

    TEST_CASE("patches that a wall cuts: no area is lost, and every point finds its own") {
        const auto scene = compiled(roomOnWideFloor(100));
        const RadiosityBench bench(*scene);
        const Patches p = patchesOf(bench, .24f);
        double floor = 0, room = 0;
        for (const Patch& x : p.all()) {
            if (x.part != 0 || x.normal.y < 0) continue;
            floor += double(x.area);
            if (const Vec3 c = x.centre - local(*scene, {0, 0, 0}); std::fabs(c.x) < .5f && std::fabs(c.z) < .5f) room += double(x.area);
        }
        CHECK(floor == near(1.66 * 1.66, 1e-4));
        CHECK(room == near(1, 1e-4));
        for (uint32_t k = 0; k < 256; ++k) {
            const Point2 u = sobolPair(k, 1, 2);
            const Vec3d from{1.66 * double(u.x) - .83, -.45, 1.66 * double(u.y) - .83};
            if (std::fabs(std::fabs(from.x) - .5) < 1e-3 || std::fabs(std::fabs(from.z) - .5) < 1e-3) continue;
            const Vec3 down{0, -1, 0};
            const Hit hit = scene->intersect(rayFrom(local(*scene, from), down));
            const auto place = p.at(hit, true);
            REQUIRE(place);
            CHECK(place->patch == p.seen(hit, down));
            const Patch& x = p[place->patch];
            const Vec3 here = x.at(place->s, place->t), there = local(*scene, from), middle = local(*scene, {0, 0, 0});
            CHECK(length(Vec3{here.x - there.x, 0, here.z - there.z}) < 1e-4f);
            const auto inRoom = [&](const Vec3& v) { return std::fabs(v.x - middle.x) < .5f && std::fabs(v.z - middle.z) < .5f; };
            CHECK(inRoom(x.centre) == inRoom(there));
            if (x.other == ~0u) continue;
            const auto below = p.at(hit, false);
            REQUIRE(below);
            const Patch& y = p[below->patch];
            CHECK(y.other == place->patch);
            CHECK(length(y.at(below->s, below->t) - here) < 1e-4f);
        }
    }

    TEST_CASE("@cornell, bounce by bounce, few patches and many") {
        const auto scene = compiled(findBuiltin("@cornell")->make());
        const CameraDesc camera = scene->cameras()[0];
        constexpr uint32_t most = 4;
        const std::vector<double> path = byBounce(*scene, camera, {32, 32, 2048, {}, 2}, most, "path");
        for (const char* show : {"gather", "interpolated", "patch"})
            for (const int patches : {500, 2000}) {
                const std::vector<double> seen =
                    byBounce(*scene, camera, {32, 32, 64, {}, 2}, most,
                             fmt::format("radiosity:patches={},light-rays=512,rays=2048,show={}", patches, show));
                for (uint32_t k = 1; k <= most; ++k) {
                    INFO(std::string(show) << ", " << patches << " patches, bounce " << k << ": " << 100 * (seen[k] / path[k] - 1) << " %");
                    // Two per mille are noise of the fourth bounce; of a hundredth part were the losses under the blocks.
                    CHECK(seen[k] == near(path[k], patches == 500 ? .012 : .006));
                }
            }
    }

    TEST_CASE("bounces= counts the scattering that a final gather adds") {
        const auto scene = compiled(findBuiltin("@cornell")->make());
        const CameraDesc camera = scene->cameras()[0];
        for (const char* show : {"gather", "interpolated"}) {
            const std::vector<double> all =
                byBounce(*scene, camera, {32, 32, 16, {}, 2}, 3, fmt::format("radiosity:patches=300,show={}", show));
            for (const uint32_t bounces : {0u, 1u, 2u}) {
                const std::vector<double> seen = byBounce(*scene, camera, {32, 32, 16, {}, 2}, 3,
                                                          fmt::format("radiosity:patches=300,show={},bounces={}", show, bounces));
                for (uint32_t k = 1; k <= 3; ++k) {
                    INFO(std::string(show) << ", bounces=" << bounces << ", bounce " << k);
                    if (k > bounces)
                        CHECK(seen[k] == 0);
                    else
                        CHECK(std::fabs(seen[k] / all[k] - 1) < .01);
                }
            }
        }
    }

    TEST_CASE("parallel plates, patch by patch, towards endless ones (A18)") {
        double lastError = 2;
        for (const double gap : {.1, .01, .001}) {
            CAPTURE(gap);
            SceneDesc d;
            const int lower = shapes::add(d, shapes::lamp("lower", Spectrum(float(1 / pi64)), Spectrum(.5f))),
                      upper = shapes::add(d, shapes::diffuse("upper", Spectrum(.8f)));
            shapes::add(d, "lower", shapes::quad({0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}), lower);
            shapes::add(d, "upper", shapes::quad({0, gap, 0}, {1, gap, 0}, {1, gap, 1}, {0, gap, 1}), upper);
            const auto scene = compiled(std::move(d));
            const Options o = Options::parse(
                solveOptions, "size=1,direct=factors,factors=analytic,shadow-rays=0,solver=direct,tolerance=1e-9", "radiosity");
            const Solved s = RadiosityBench(*scene).solve(patchSettings(o), solveSettings(o));
            REQUIRE(s.patches.size() == 2);
            const double f = parallel(1, 1, gap), known = 1 / (1 - .5 * .8 * f * f); // A12 with this factor
            CHECK(radiosityOf(s, 0) == near(known, 1e-4));
            CHECK(radiosityOf(s, 1) == near(.8 * f * known, 1e-4));
            const double error = 5. / 3 - radiosityOf(s, 0);
            CHECK(error > 0);
            CHECK(error < .25 * lastError); // nearly in proportion to the gap
            lastError = error;
        }
        CHECK(lastError < 5e-3);
    }

    TEST_CASE("a closed cylinder, tessellated: the limit of its factors (A5)") {
        double last[2] = {1, 1};
        for (const int corners : {16, 32}) {
            CAPTURE(corners);
            const auto scene = compiled(cylinder(corners));
            const Bare bare(*scene);
            const Patches p = patchesOf(bare, .7f);
            const FormFactors f(bare.work, p, exact());
            const double across = std::fabs(betweenParts(f, 0, 1) / .3819660113 - 1),
                         aside = std::fabs(betweenParts(f, 2, 0) / .3090169944 - 1);
            const double slack = 2.5 * std::pow(2 * pi64 / corners, 2) / 6;
            CHECK(across < slack);
            CHECK(aside < slack);
            // With the square of the edge: a quarter of the error from twice the corners.
            if (corners > 16) CHECK((across < .3 * last[0] && aside < .3 * last[1]));
            last[0] = across, last[1] = aside;
        }
    }

    TEST_CASE("strips and wedges of growing length: the limit of their factors (A8)") {
        double last[2] = {1, 1};
        for (const double length : {10., 40.}) {
            CAPTURE(length);
            const auto factor = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& e) {
                SceneDesc d;
                const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
                shapes::add(d, "floor", shapes::quad({0, 0, 0}, {0, 0, length}, {1, 0, length}, {1, 0, 0}), grey);
                shapes::add(d, "other", shapes::quad(a, b, c, e), grey);
                const auto scene = compiled(std::move(d));
                const Bare bare(*scene);
                const Patches p = patchesOf(bare, 2.01f);
                return betweenParts(FormFactors(bare.work, p, exact()), 0, 1);
            };
            const double strips = std::fabs(factor({0, 1, 0}, {1, 1, 0}, {1, 1, length}, {0, 1, length}) / .4142135624 - 1),
                         wedge = std::fabs(factor({0, 0, 0}, {0, 1, 0}, {0, 1, length}, {0, 0, length}) / .2928932188 - 1);
            CHECK(strips < .9 / length);
            CHECK(wedge < .9 / length);
            if (length > 10) CHECK((strips < .3 * last[0] && wedge < .3 * last[1])); // in proportion to 1 / length
            last[0] = strips, last[1] = wedge;
        }
    }
} // TEST_SUITE
