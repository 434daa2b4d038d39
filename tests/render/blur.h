// The blur of lamps and things that move or bend, of a stage seen from one place: light samples alone, both strategies and particles have
// one mean, and it is that of many still frames.
#pragma once
#include "tests/render/measure.h"

namespace chiaro::test {

// frozen(desc, time): the stage as it stands at a time of its shutter, [0, 1].
template <class Frozen> void checkBlur(const SceneDesc& desc, const Frozen& frozen) {
    const auto scene = compiled(desc);
    const CameraDesc view = perspective({0, 3, 4}, {0, 0.5, 0}, 0.7);
    const Settings how{.width = 16, .height = 16, .spp = 1024, .maxDepth = 2};
    const Measured both = measure(*scene, view, how), lights = measure(*scene, view, how, "path:mis=off");
    INFO("weighted " << both.value << " +- " << both.error << ", light samples alone " << lights.value << " +- " << lights.error);
    CHECK(std::fabs(both.value - lights.value) <= criticalT * std::hypot(both.error, lights.error));
    const Measured particles = measure(*scene, view, how, "light");
    INFO("from the lights " << particles.value << " +- " << particles.error);
    CHECK(std::fabs(both.value - particles.value) <= criticalT * std::hypot(both.error, particles.error));
    constexpr int frames = 64;
    double sum = 0, squares = 0;
    for (int i = 0; i < frames; ++i) {
        Settings still = how;
        still.spp = 32;
        still.seed = 100 + uint64_t(i);
        const Measured m = measure(*compiled(frozen(desc, (i + 0.5) / frames)), view, still);
        sum += m.value;
        squares += m.error * m.error;
    }
    const double mean = sum / frames, error = std::sqrt(squares) / frames;
    INFO("still frames " << mean << " +- " << error);
    CHECK(std::fabs(both.value - mean) <= criticalT * std::hypot(both.error, error) + 1e-3 * mean);
    CHECK(criticalT * std::hypot(both.error, error) < 0.025 * mean);
}

} // namespace chiaro::test
