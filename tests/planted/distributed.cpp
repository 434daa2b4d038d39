// Planted faults of distributed ray tracing and ambient occlusion.
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr float rho = 0.8f;

void manyLightSamples(Trial& t) {
    SceneDesc s;
    const int wall = shapes::add(s, shapes::diffuse("receiver", Spectrum(rho))), lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "receiver", plate({0, 0, 0}, {0, 1, 0}, 0.01), wall);
    shapes::add(s, "lamp", plate({0, 1, 0}, {0, -1, 0}, 0.5), lamp);
    const auto scene = compiled(std::move(s));
    for (const char* how : {"distributed:light-samples=1", "distributed:light-samples=16"})
        t.equal(*scene, probe({0, 0, 0}, {0, -1, 0}), {16, 16}, rho * .7522746885 / std::numbers::pi, how);
}
void wallWithinReach(Trial& t) { // a = d / R = .5; all directions alike would give .75
    SceneDesc s;
    const int matt = shapes::add(s, shapes::diffuse("matt", Spectrum(rho)));
    shapes::add(s, "floor", plate({0, 0, 0}, {0, 1, 0}, 0.05), matt);
    shapes::add(s, "wall", plate({-.5, 0, 0}, {1, 0, 0}, huge), matt);
    t.equal(*compiled(std::move(s)), probe({0, 0, 0}, {0, -1, 0}), {16, 16}, .8044989, "ao:distance=1");
}

const Check lightCheck{"square lamp by 1 and 16 samples (B1)", manyLightSamples, 64},
    wallCheck{"occlusion beside a wall within reach (H13)", wallWithinReach, 64};

const PlantedRow rows[] = {
    {Fault::splitUnweighted, 0, "samples of a split summed, not averaged", lightCheck},
    {Fault::occlusionUniform, 0, "occlusion rays uniform where the cosine is meant", wallCheck},
};

} // namespace

std::span<const PlantedRow> plantedDistributed() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-distributed") {
    TEST_CASE("each planted fault of ray trees and occlusion is caught") { chiaro::test::catchAll(chiaro::test::plantedDistributed()); }
} // TEST_SUITE
