// One sample again, exactly: chiaro render --pixel x,y --sample n prints its value, chiaro trace its path.
#pragma once
#include "tools/cli/settings.h"

namespace chiaro::cli {

struct Replayed {
    PathStart start;
    Spectrum value;
    uint32_t rays = 0, depth = 0; // traced, the camera's own included; scatterings of the longest path
};
// log: told what the sample did; may be null.
Replayed replay(const Job&, const CameraIntegrator&, Pixel, uint32_t sample, PathLog* log = nullptr);

// The value on stdout; no file is touched.
int replaySample(const RenderSettings&, const LoadedScene&, const View&, const Executor&, Diagnostics&, Console&);

} // namespace chiaro::cli
