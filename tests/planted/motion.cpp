// Faults of motion over the shutter, against the shares of time in closed form (H12).
#include "tests/planted/trial.h"
#include <numbers>

namespace chiaro::test {

namespace {

constexpr double pi64 = std::numbers::pi;

SceneDesc moving(PrimitiveDesc shape, MotionDesc motion) {
    SceneDesc s;
    s.shutter = {0, 1};
    const int lamp = shapes::add(s, shapes::lamp("lamp", Spectrum(1)));
    shapes::add(s, "moving", std::move(shape), lamp);
    s.instances.back().motion = std::move(motion);
    return s;
}
// Two wide, five along x: the share of the time in which it covers x.
void bar(Trial& t) {
    const auto scene = compiled(moving(shapes::quad({0, -50, 0}, {2, -50, 0}, {2, 50, 0}, {0, 50, 0}),
                                       {shapes::translation({0, 0, 0}), shapes::translation({5, 0, 0})}));
    for (const auto& [x, share] : {std::pair{1., .2}, {2.5, .4}, {6., .2}})
        t.equal(*scene, probe({x, 0, 0}, {0, 0, -1}), {.width = 4, .height = 4}, share, "path", 1e-4);
}
// A plate from radius 0.8 to 1 that makes a quarter turn: entry by entry it would pass nearer to the centre.
void quarterTurn(Trial& t) {
    const auto scene =
        compiled(moving(shapes::quad({0.8, -0.1, 0}, {1, -0.1, 0}, {1, 0.1, 0}, {0.8, 0.1, 0}), {{}, rotation({0, 0, 1}, pi64 / 2)}));
    const double r = 0.9, crossing = 2 * std::asin(0.1 / r) / (pi64 / 2);
    t.equal(*scene, probe(Vec3d{r, r, 0} * std::sqrt(0.5), {0, 0, -1}), {.width = 4, .height = 4}, crossing, "path", 1e-3);
}

const Check barCheck{"bar that moves (H12)", bar, 1024}, turnCheck{"quarter turn (H12)", quarterTurn, 1024};

const PlantedRow rows[] = {
    {Fault::shutterStuck, 42, "every ray at the opening of the shutter", barCheck},
    {Fault::motionByMatrix, 42, "matrices interpolated entry by entry", turnCheck},
};

} // namespace

std::span<const PlantedRow> plantedMotion() { return rows; }

} // namespace chiaro::test

TEST_SUITE("planted-motion") {
    TEST_CASE("each planted fault of motion is caught") { chiaro::test::catchAll(chiaro::test::plantedMotion()); }
} // TEST_SUITE
