// Faults of the transport of light: weights, depth, roulette, rays that start or end in the wrong place.
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;
constexpr float rho = 0.8f;

// The lamp of B1, all lengths times k.
SceneDesc lampOver(double k) {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho)));
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "receiver", plate({0, 0, 0}, {0, 1, 0}, 0.01 * k), wall);
    shapes::add(s, "lamp", shapes::quad({-.5 * k, k, -.5 * k}, {.5 * k, k, -.5 * k}, {.5 * k, k, .5 * k}, {-.5 * k, k, .5 * k}), lamp);
    return s;
}
void scales(Trial& t) {
    for (const double k : {1., 1e-3, 1e3}) {
        const auto scene = compiled(lampOver(k));
        t.equal(*scene, probe({0, 0, 0}, {0, -1, 0}, 1e-2 * k, 1e-4 * k), {16, 16}, rho * .7522746885 / pi64, "path:nee=off");
    }
}
void hiddenLamp(Trial& t) { // a screen just below the lamp
    SceneDesc s = lampOver(1);
    const int black = shapes::add(s, shapes::diffuse("screen", Spectrum(0)));
    shapes::add(s, "screen", plate({0, 0.97, 0}, {0, -1, 0}, 20), black);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {16, 16}, 0);
}
void bothStrategies(Trial& t) {
    const auto scene = compiled(lampOver(1));
    for (const char* how : {"path", "path:mis=off", "path:nee=off"})
        t.equal(*scene, probe({0, 0, 0}, {0, -1, 0}), {16, 16}, rho * .7522746885 / pi64, how);
}

std::unique_ptr<const Scene> integratingSphere(float reflectance) {
    SceneDesc s;
    PrimitiveDesc shell = shapes::insideOut(shapes::sphere(1, 3));
    shell.normals.clear(); // facets: the prediction is exact for any polyhedron
    const int wall = shapes::add(s, shapes::lamp("wall", Spectrum(1), Spectrum(reflectance)));
    shapes::add(s, "wall", std::move(shell), wall);
    return compiled(std::move(s));
}
CameraDesc inside() { return perspective({.1, .2, .3}, {-.4, .1, -.5}, 1.2); }
void depths(Trial& t) {
    const auto scene = integratingSphere(rho);
    for (const uint32_t depth : {0u, 1u, 2u, 3u}) {
        Settings how{16, 16};
        how.maxDepth = depth;
        t.equal(*scene, inside(), how, (1 - std::pow(double(rho), depth + 1.)) / (1 - double(rho)));
    }
}
void roulette(Trial& t) { t.equal(*integratingSphere(0.9f), inside(), {16, 16}, 10, "path:rr-depth=0"); }

void mirrorLamp(Trial& t) { // a perfect mirror shows its lamp with exactly the lamp's radiance
    SceneDesc s;
    const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(1), 0)), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(3)));
    shapes::add(s, "mirror", plate({0, 0, 0}, {0, 1, 0}, 0.1), mirror);
    shapes::add(s, "lamp", plate({0, 1, 0}, {0, -1, 0}, 1), lamp);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0.3, -1, 0.1}), {16, 16}, 3);
}

const Check scalesCheck{"square lamp at three scales (M6)", scales, 1024}, hiddenCheck{"lamp behind a screen (M10)", hiddenLamp, 64},
    strategiesCheck{"light, BSDF and both samples (B13)", bothStrategies, 1024},
    depthCheck{"integrating sphere by depth (F1)", depths, 512}, rouletteCheck{"integrating sphere, roulette (F1, F7)", roulette, 256},
    mirrorCheck{"lamp in a mirror (J5)", mirrorLamp, 64};

const PlantedRow rows[] = {
    {Fault::offsetAbsolute, 7, "rays start 0.1 mm off the surface at every scale", scalesCheck},
    {Fault::shadowRayShort, 8, "shadow rays end at 90 % of the way", hiddenCheck},
    {Fault::emissionTwice, 9, "emission counted by light sample and again on a hit", depthCheck},
    {Fault::deltaWeighted, 10, "light behind a mirror weighted below 1", mirrorCheck},
    {Fault::misOtherMeasure, 11, "weights mix a density per area with one per angle", strategiesCheck},
    {Fault::rouletteUnweighted, 27, "survivors of the roulette not divided", rouletteCheck},
    {Fault::depthOffByOne, 28, "one bounce too many", depthCheck},
    {Fault::bounceDropped, 0, "no light sample at the second vertex", depthCheck},
};

} // namespace

std::span<const PlantedRow> plantedTransport() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-transport") {
    TEST_CASE("each planted fault of transport is caught") { chiaro::test::catchAll(chiaro::test::plantedTransport()); }
} // TEST_SUITE
