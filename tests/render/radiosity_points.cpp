// Interpolated radiosity: no light through what stands between patches, none made or lost at the rim of a shadow, and no seams without
// need.
#include "core/math/sobol.h"
#include "integrators/radiosity/solve_options.h"
#include "tests/render/patches_kit.h"
#include "tests/render/radiosity_kit.h"
#include <fmt/format.h>
#include <set>

using namespace chiaro;
using namespace chiaro::test;
using namespace chiaro::radiosity;

namespace {

// A floor of two metres that is cut every quarter of one, and a closed unit room of thin walls on the midst of it: the walls stand on the
// edges of patches. A dim lamp within, a bright one outside.
SceneDesc roomOnEdges(float outside) {
    SceneDesc d;
    const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
    shapes::add(d, "floor", plate({0, -.5, 0}, {0, 1, 0}, 1), grey);
    shapes::add(d, "ceiling", unitFace(1, 1), grey);
    for (const int axis : {0, 2})
        for (const int side : {-1, 1}) shapes::add(d, "wall", unitFace(axis, side), grey);
    shapes::add(d, "lamp", plate({0, .499, 0}, {0, -1, 0}, .1), shapes::add(d, shapes::lamp("lamp", Spectrum(8))));
    shapes::add(d, "sky", plate({0, 2, 0}, {0, -1, 0}, 2), shapes::add(d, shapes::lamp("sky", Spectrum(outside))));
    return d;
}

Solved solvedBy(const RadiosityBench& bench, const std::string& text) {
    const Options o = Options::parse(solveOptions, text, "radiosity");
    return bench.solve(patchSettings(o), solveSettings(o));
}

// Means of a term over points of the floor below y = 0 within |x|, |z| < reach: as it is interpolated, and of the patches there.
struct Means {
    double interpolated = 0, ofPatches = 0, darkest = 1e30;
};
Means onFloor(const Scene& scene, const Solved& s, const Field& field, uint32_t term, double reach, uint32_t points = 4096) {
    Means m;
    for (uint32_t k = 0; k < points; ++k) {
        const Point2 u = sobolPair(k, 1, 2);
        const Vec3d from{(2 * double(u.x) - 1) * reach, -.48, (2 * double(u.y) - 1) * reach};
        const Hit hit = scene.intersect(rayFrom(local(scene, from), {0, -1, 0}));
        const auto place = s.patches.at(hit, true);
        REQUIRE(place);
        const double here = luminance(field.interpolated(s.patches, term, *place));
        m.interpolated += here / points;
        m.darkest = std::min(m.darkest, here);
        m.ofPatches += luminance(field.onPatch(term, place->patch)) / points;
    }
    return m;
}

std::size_t pointsOfFront(const Patches& patches, uint32_t part, const Vec3& up) {
    std::set<uint32_t> numbers;
    for (const Patch& p : patches.all())
        if (p.part == part && dot(p.normal, up) > .9f) numbers.insert(p.vertex.begin(), p.vertex.begin() + p.corners);
    return numbers.size();
}

} // namespace

TEST_SUITE("radiosity-points") {
    TEST_CASE("a wall along the edges of patches: what is interpolated within is the light within") {
        for (const float outside : {0.f, 100.f}) {
            CAPTURE(outside);
            const auto scene = compiled(roomOnEdges(outside));
            const RadiosityBench bench(*scene);
            const Solved s = solvedBy(bench, "size=.2501,direct=factors,factors=analytic,shadow-rays=64");
            const Field field(bench.run, s.patches, s.solution);
            for (uint32_t term = 0; term < field.terms(); ++term) {
                CAPTURE(term);
                const Means m = onFloor(*scene, s, field, term, .5);
                CHECK(std::fabs(m.interpolated / m.ofPatches - 1) < .01);
                CHECK(m.darkest > .3 * m.ofPatches); // nor is the light of one side taken from the other
            }
            // Four corners and sixteen points along the walls are two each; beyond the sky nothing is parted.
            CHECK(pointsOfFront(s.patches, 0, {0, 1, 0}) == 81 + 16);
        }
    }

    TEST_CASE("at the rim of a sharp shadow nothing is made or lost, and nothing is darker than it was") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "floor", plate({0, -.5, 0}, {0, 1, 0}, 1), grey);
        for (const auto& [power, cone] : {std::pair{1.f, 1.2}, {2000.f, .12}}) {
            PunctualDesc spot;
            spot.kind = PunctualKind::spot;
            spot.intensity = Spectrum(power);
            spot.innerCone = cone * .98, spot.outerCone = cone;
            spot.toWorld = shapes::lookAt({0, 1.5, 0}, {.11, -.5, .07});
            d.lights.push_back(spot);
        }
        const auto scene = compiled(d);
        const RadiosityBench bench(*scene);
        const Solved s = solvedBy(bench, "size=.101,light-rays=512");
        const Field field(bench.run, s.patches, s.solution);
        const Means m = onFloor(*scene, s, field, 0, 1, 16384);
        CHECK(std::fabs(m.interpolated / m.ofPatches - 1) < .003);
        const double dim = luminance(field.onPatch(0, 0)); // in a corner, where the wide cone alone arrives
        CHECK(dim > 0);
        CHECK(m.darkest > .4 * dim);
    }

    TEST_CASE("a thin leg, the end of a wall and the curve of a surface part nothing") {
        SceneDesc d;
        const int grey = shapes::add(d, shapes::diffuse("grey", Spectrum(.5f)));
        shapes::add(d, "floor", plate({0, -.5, 0}, {0, 1, 0}, 1), grey);
        shapes::add(d, "leg", shapes::box({.01, .2, .01}), grey, shapes::translation({.25, -.3, .125})); // on an edge
        shapes::add(d, "wall", shapes::quad({-.5, -.5, .06}, {-.5, -.5, -.06}, {-.5, -.1, -.06}, {-.5, -.1, .06}), grey);
        shapes::add(d, "ball", shapes::sphere(.2, 2), grey, shapes::translation({-.3, 0, .5}));
        shapes::add(d, "bowl", shapes::insideOut(shapes::sphere(4, 2)),
                    shapes::add(d, shapes::lamp("shining", Spectrum(1), Spectrum(.5f))));
        const auto lit = compiled(d);
        const Bare b(*lit);
        const Patches after = patchesOf(b, .2501f);
        CHECK(pointsOfFront(after, 0, {0, 1, 0}) == 81);
        for (const uint32_t ball : {3u, 4u}) {
            std::set<uint32_t> outside;
            uint32_t patches = 0;
            for (const Patch& p : after.all())
                if (p.part == ball) ++patches, outside.insert(p.vertex.begin(), p.vertex.begin() + p.corners);
            CHECK(outside.size() == patches / 2 + 2); // Euler: triangles of one closed surface
        }
    }
} // TEST_SUITE
