// Faults of radiosity: form factors the wrong way round, light from below the horizon, the sides of a sheet mixed up; energy lost or
// counted twice by a solver.
#include "core/render/prepass.h"
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/hierarchy.h"
#include "integrators/radiosity/solve_options.h"
#include "tests/planted/trial.h"
#include "tests/render/patches_kit.h"
#include "tests/render/radiosity_kit.h"

namespace chiaro::test {

namespace {

using namespace radiosity;

// A floor of 1 x 1 and a wall of 1 x 2 on its edge: F12 is not F21.
void unequalAreas(Trial& t) {
    const auto scene = compiled(twoPlates({0, 0, 0}, {0, 2, 0}, {0, 2, 1}, {0, 0, 1}));
    const Bare bare(*scene);
    const Patches p = patchesOf(bare, 2);
    FormFactorSettings s;
    s.rays = 1024 * t.spp();
    const FormFactorMatrix m = formFactorMatrix(bare.work, FormFactors(bare.work, p, s));
    t.exact(double(m.row(0)[0].factor), .2328526028, .002);
    t.exact(double(m.row(1)[0].factor), .2328526028 / 2, .002);
}

// A lamp half of which lies below the horizon of an upright element; a wall half of which lies under the floor.
void horizon(Trial& t) {
    const auto scene = compiled(twoPlates({0, -1, 0}, {0, 1, 0}, {0, 1, 1}, {0, -1, 1}));
    const Bare bare(*scene);
    const Patches p = patchesOf(bare, 2);
    const FormFactors f(bare.work, p, {});
    const Vec3 lamp[] = {{-.5, -.5, 1}, {-.5, .5, 1}, {.5, .5, 1}, {.5, -.5, 1}};
    t.exact(f.unoccluded({0, 0, 0}, {1, 0, 0}, lamp), .0875102648 / std::numbers::pi, 1e-8);
    t.exact(f.unoccluded(ofPart(p, 0)[0], ofPart(p, 1)[0]), .2000437761, 1e-7);
}

// A sheet under a lamp, lit by the sky from both sides: what the lamp sends reaches its upper side, and that alone.
void sides(Trial& t) {
    SceneDesc d = twoPlates({0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1});
    d.environment = uniformSky(1);
    const auto scene = compiled(d);
    const Bare bare(*scene);
    const Patches p = patchesOf(bare, 2);
    FormFactorSettings s;
    s.rays = 1024 * t.spp();
    const FormFactors f(bare.work, p, s);
    std::vector<Factor> row;
    const auto down = [&](uint32_t part) {
        for (const uint32_t i : ofPart(p, part))
            if (p[i].normal.y < 0) return i;
        return ~0u;
    };
    f.row(down(1), row);
    const uint32_t upper = p[down(0)].other;
    double reached = 0;
    for (const Factor& x : row)
        if (x.patch == upper) reached = double(x.factor);
    t.exact(reached, .1998248957, .002);
}

// Six patches of a closed cube whose ceiling shines: what arrives is reflected and shot again.
void shooting(Trial& t) {
    const auto scene = compiled(emittingCube(.5f));
    const Options o = Options::parse(solveOptions, "size=1.0001,solver=shoot,shadow-rays=0", "radiosity");
    const Solved s = RadiosityBench(*scene).solve(patchSettings(o), solveSettings(o));
    const auto floor = [](const Patch& p) { return p.normal.y > .9f; };
    t.exact(meanOver(s.patches, floor, [&](uint32_t i) { return radiosityOf(s, i); }), .1817458261, 1e-4);
}

// A plate of 1 m2 that sends 1, a wall of 2 m2 that sends nothing: together a third.
void meanOfUnequal(Trial& t) {
    const auto scene = compiled(twoPlates({0, 0, 0}, {0, 2, 0}, {0, 2, 1}, {0, 0, 1}));
    const Bare bare(*scene);
    const Patches p = patchesOf(bare, 2);
    const Hierarchy tree(p);
    Lights3 ofPatches(p.size(), Light(0)), ofNodes(tree.nodes().size());
    double lit = 0, all = 0;
    for (uint32_t i = 0; i < p.size(); ++i) {
        all += double(p[i].area);
        if (p[i].part != 0) continue;
        ofPatches[i] = Light(1);
        lit += double(p[i].area);
    }
    tree.pull(ofPatches, ofNodes);
    t.exact(ofNodes[0][0], lit / all, 1e-6);
}

// The middle of the floor of that cube (A16), direct light by rays and the rest from the pre-pass.
void twoPass(Trial& t) {
    const auto scene = compiled(emittingCube(.5f));
    Bench bench(*scene, recentred(*scene, probe({.01, -.5, .012}, {0, -1, 0})), {8, 8, 256});
    const PrepassChoice choice = choosePrepass("radiosity:size=0.1251");
    const std::unique_ptr<Prepass> prepass = choice.entry->make(choice.options);
    prepass->solve(bench.job);
    Film film(bench.layout());
    const Job job{static_cast<const Work&>(bench.job), bench.view, prepass.get()};
    const IntegratorChoice viewer = chooseIntegrator("distributed");
    chiaro::render(job, *viewer.entry->make(viewer.options), film, {256, infinity}, bench.stop);
    t.exact(double(luminance(meanOf(film))) * std::numbers::pi, .1976, .003);
}

const Check shootCheck{"shooting in a closed cube (A13)", shooting, 1}, pullCheck{"means of nodes with unequal areas", meanOfUnequal, 1},
    twoPassCheck{"distributed with the pre-pass in a closed cube (A16)", twoPass, 1};
const Check unequalCheck{"floor and wall of unequal areas (A2, reciprocity)", unequalAreas, 64},
    horizonCheck{"half below the horizon (B2)", horizon, 16}, sidesCheck{"a sheet under a lamp, both sides lit", sides, 64};

const PlantedRow rows[] = {
    {Fault::formFactorTransposed, 37, "F_ji in the place of F_ij", unequalCheck},
    {Fault::formFactorHorizon, 37, "polygons not clipped at the horizon", horizonCheck},
    {Fault::reflectanceOfOtherSide, 0, "light that reaches one side of a sheet counts for the other", sidesCheck},
    {Fault::unshotForgotten, 0, "what a shot brings is not shot again", shootCheck},
    {Fault::pullWithoutArea, 0, "a node's radiosity is the plain mean of its children's", pullCheck},
    {Fault::radiosityDirectTwice, 0, "the pre-pass adds direct light that the view has already", twoPassCheck},
};

} // namespace

std::span<const PlantedRow> plantedRadiosity() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-radiosity") {
    TEST_CASE("each planted fault of radiosity is caught") { chiaro::test::catchAll(chiaro::test::plantedRadiosity()); }
} // TEST_SUITE
