// Radiosity against closed forms: rooms whose light is known, patch by patch and as it is seen.
#include "integrators/radiosity/solve_options.h"
#include "tests/render/radiosity_kit.h"
#include <fmt/format.h>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

constexpr double pi64 = std::numbers::pi;

struct Asked {
    PatchSettings cut;
    SolveSettings how;
};
Asked asked(const std::string& text) {
    const Options o = Options::parse(solveOptions, text, "radiosity");
    return {patchSettings(o), solveSettings(o)};
}
Solved solved(const Scene& scene, const std::string& text, uint32_t apart = 1, unsigned threads = 2) {
    Asked a = asked(text);
    a.how.limits.apart = apart;
    return RadiosityBench(scene, threads).solve(a.cut, a.how);
}
auto facing(const Vec3& n) {
    return [n](const Patch& p) { return dot(p.normal, n) > 0.9f; };
}

} // namespace

TEST_SUITE("radiosity-closed-forms") {
    TEST_CASE("a closed cube, mesh after mesh (A16): means of the faces, and the order of their errors") {
        const auto scene = compiled(emittingCube(.5f));
        const double mean[] = {1.1044, .1712, .1811};               // ceiling, floor, sides
        const double errorOfFloor[] = {.062, 0, .011, .003, .0008}; // of two patches along an edge there is no figure
        const int edges[] = {1, 2, 4, 8, 16};
        double floors[5];
        for (int m = 0; m < 5; ++m) {
            CAPTURE(m);
            // Lambert's formula, but for the finest mesh: there are too many pairs.
            const Solved s = solved(*scene, fmt::format("size={},direct=factors,{}", 1.0001 / edges[m],
                                                        m < 4 ? "factors=analytic,shadow-rays=0" : "rays=2048"));
            CHECK(s.patches.size() == std::size_t(6 * edges[m] * edges[m]));
            const auto value = [&](uint32_t i) { return radiosityOf(s, i); };
            floors[m] = meanOver(s.patches, facing({0, 1, 0}), value);
            // The figures are of collocation at the centres of patches; factors from area to area are at least as good.
            if (m == 0) CHECK(floors[m] == doctest::Approx(mean[1] * 1.062).epsilon(1e-3));
            if (m > 1) CHECK(floors[m] == doctest::Approx(mean[1]).epsilon(errorOfFloor[m] + 5e-4));
            if (m < 4) continue;
            CHECK(meanOver(s.patches, facing({0, -1, 0}), value) == doctest::Approx(mean[0]).epsilon(5e-4));
            CHECK(meanOver(s.patches, facing({1, 0, 0}), value) == doctest::Approx(mean[2]).epsilon(1e-3));
        }
        const double order = std::log2((floors[1] - floors[2]) / (floors[2] - floors[3]));
        const double limit = floors[3] - (floors[2] - floors[3]) / (std::exp2(1.9) - 1);
        INFO("order " << order << ", limit " << limit);
        CHECK(std::fabs(order - 1.9) < .4);
        CHECK(limit == doctest::Approx(mean[1]).epsilon(1e-3));
    }

    TEST_CASE("the middle of the floor and of a side, as seen (A16)") {
        for (const float rho : {.5f, .8f}) {
            CAPTURE(rho);
            const auto scene = compiled(emittingCube(rho));
            const double floor = rho == .5f ? .1976 : .7131, side = rho == .5f ? .17765 : .6837;
            for (const char* show : {"interpolated", "gather"}) {
                CAPTURE(show);
                const std::string i = fmt::format("radiosity:size=0.06251,light-rays=256,show={}", show);
                const auto at = [&](const Vec3d& place, const Vec3d& way) {
                    return double(luminance(rendered(*scene, recentred(*scene, probe(place, way)), {8, 8, 64, {}, 2}, i).mean)) * pi64;
                };
                CHECK(at({.012, -.5, .01}, {0, -1, 0}) == doctest::Approx(floor).epsilon(6e-3));
                if (rho == .5f) CHECK(at({.5, 0, .012}, {1, 0, 0}) == doctest::Approx(side).epsilon(6e-3));
            }
        }
    }

    TEST_CASE("its bounces one by one (A17)") {
        const auto scene = compiled(emittingCube(.5f));
        const Solved s = solved(*scene, "size=0.1001,direct=factors,factors=analytic,shadow-rays=0", 6);
        const RadiosityBench b(*scene);
        // Eleven patches along an edge: one has the middle of the face in its own middle.
        const uint32_t floor = b.seen(s.patches, {0, 0, 0}, {.001, -1, .001}), side = b.seen(s.patches, {0, 0, 0}, {1, .001, .001}),
                       ceiling = b.seen(s.patches, {0, 0, 0}, {.001, 1, .001});
        const double expected[3][5] = {
            {.119728, .03469, .02253, .01017, .00528}, {.095068, .04081, .02094, .01041, .00521}, {0, .0521, .0187, .0107, .0051}};
        REQUIRE(s.solution.terms.size() == 7);
        for (std::size_t k = 0; k < 5; ++k) {
            CAPTURE(k);
            CHECK(.5 * s.solution.terms[k][floor][0] == doctest::Approx(expected[0][k]).epsilon(.01));
            CHECK(.5 * s.solution.terms[k][side][0] == doctest::Approx(expected[1][k]).epsilon(.01));
            if (k > 0) CHECK(.5 * s.solution.terms[k][ceiling][0] == doctest::Approx(expected[2][k]).epsilon(.012));
        }
    }

    TEST_CASE("infinite parallel plates (A18): each sees the other alone") {
        System system;
        system.areas = {1, 1};
        system.reflectance = {Spectrum(.5f), Spectrum(.8f)};
        system.emission = {Light(1), Light(0)};
        system.received = {Light(0), Light(0)};
        Executor run(1);
        StopToken stop;
        const auto across = [](std::span<const Light> from, std::span<Light> to) {
            to[0] = from[1];
            to[1] = from[0];
        };
        Limits tight;
        tight.tolerance = 1e-14;
        const Solution s = neumann(system, across, tight, {run, stop});
        CHECK(1 + .5 * s.irradiance(0)[0] == doctest::Approx(5. / 3).epsilon(1e-6));
        CHECK(.8 * s.irradiance(1)[0] == doctest::Approx(4. / 3).epsilon(1e-6));
    }

    TEST_CASE("concentric spheres (A19)") {
        for (const float rho : {0.f, .5f}) {
            SceneDesc s;
            const int lamp = shapes::add(s, shapes::lamp("inner", Spectrum(float(1 / pi64)), Spectrum(rho)));
            const int wall = shapes::add(s, shapes::diffuse("outer", Spectrum(.5f)));
            shapes::add(s, "inner", shapes::sphere(.5, 3), lamp);
            shapes::add(s, "outer", shapes::insideOut(shapes::sphere(1, 3)), wall);
            const auto scene = compiled(std::move(s));
            CAPTURE(rho);
            const double facets = shapes::area(shapes::sphere(.5, 3)) / shapes::area(shapes::sphere(1, 3)); // 1/4, exactly as cut
            CHECK(facets == doctest::Approx(.25).epsilon(1e-6));
            const Solved r = solved(*scene, "patches=1,direct=factors,rays=1024");
            const auto mean = [&](bool inner) {
                return meanOver(
                    r.patches,
                    [&](const Patch& p) {
                        return (length(p.centre) < .75f) == inner && dot(p.normal, p.centre) * (inner ? 1.f : -1.f) > 0;
                    },
                    [&](uint32_t i) { return radiosityOf(r, i); });
            };
            // Facets of the outer sphere see a little less of the inner one than a sphere would: 0.5 % here.
            CHECK(mean(true) == doctest::Approx(rho == 0 ? 1 : 10. / 9).epsilon(2e-3));
            CHECK(mean(false) == doctest::Approx(rho == 0 ? .2 : 2. / 9).epsilon(1e-2));
        }
    }

    TEST_CASE("a hemisphere under an emissive lid (A20)") {
        SceneDesc s;
        const int lamp = shapes::add(s, shapes::lamp("lid", Spectrum(float(1 / pi64)), Spectrum(.5f))),
                  wall = shapes::add(s, shapes::diffuse("dome", Spectrum(.5f)));
        PrimitiveDesc dome = shapes::insideOut(shapes::sphere(1, 4)), half = dome;
        half.indices.clear();
        for (std::size_t i = 0; i < dome.indices.size(); i += 3) {
            const float y =
                dome.positions[dome.indices[i]].y + dome.positions[dome.indices[i + 1]].y + dome.positions[dome.indices[i + 2]].y;
            if (y > 0)
                half.indices.insert(half.indices.end(), dome.indices.begin() + std::ptrdiff_t(i),
                                    dome.indices.begin() + std::ptrdiff_t(i) + 3);
        }
        half.normals.clear();
        shapes::add(s, "dome", std::move(half), wall);
        shapes::add(s, "lid", shapes::disc(1, 64), lamp);
        const auto scene = compiled(std::move(s));
        const Solved r = solved(*scene, "patches=1500,direct=factors,rays=1024");
        const auto value = [&](uint32_t i) { return radiosityOf(r, i); };
        CHECK(meanOver(
                  r.patches, [](const Patch& p) { return p.emission[0] > 0; }, value) == doctest::Approx(1.2).epsilon(5e-3));
        CHECK(meanOver(
                  r.patches, [](const Patch& p) { return p.emission[0] == 0 && p.centre.y * p.normal.y < 0; }, value) ==
              doctest::Approx(.4).epsilon(1e-2));
    }

    TEST_CASE("inside a shining sphere: E / (1 - rho), by every solver") {
        for (const float rho : {.5f, .8f, .9f}) {
            SceneDesc s;
            const int wall = shapes::add(s, shapes::lamp("wall", Spectrum(float(1 / pi64)), Spectrum(rho)));
            shapes::add(s, "wall", shapes::insideOut(shapes::sphere(1, 2)), wall);
            const auto scene = compiled(std::move(s));
            CAPTURE(rho);
            for (const char* solver : {"gauss-seidel,rays=4096", "jacobi", "direct", "shoot", "hierarchical", "stochastic"}) {
                CAPTURE(solver);
                const Solved r = solved(*scene, fmt::format("solver={},patches=1,direct=factors,tolerance=1e-6", solver));
                const double mean = meanOver(
                    r.patches, [](const Patch& p) { return p.emission[0] > 0; }, [&](uint32_t i) { return radiosityOf(r, i); });
                CHECK(mean == doctest::Approx(1 / (1 - double(rho))).epsilon(5e-3));
            }
        }
    }
} // TEST_SUITE
