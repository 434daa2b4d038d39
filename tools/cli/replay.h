// One sample again, exactly: chiaro render --pixel x,y --sample n prints its value and path, chiaro trace those of several.
#pragma once
#include "tools/cli/settings.h"

namespace chiaro::cli {

struct Replayed {
    PathStart start;
    Spectrum value;
    uint32_t rays = 0, depth = 0; // traced, the camera's own included; scatterings of the longest path
};
// The value is that of the sample in a picture, to the last bit; log: told what the sample did alone, which may round otherwise; may be
// null.
Replayed replay(const Job&, CameraIntegrator&, Pixel, uint32_t sample, PathLog* log = nullptr);

// The value and the path on stdout; no file is touched. camera: its name.
int replaySample(const RenderSettings&, const LoadedScene&, const View&, const std::string& camera, const Executor&, Diagnostics&,
                 Console&);

} // namespace chiaro::cli
