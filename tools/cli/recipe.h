// The recipe of a picture: everything needed to make it again, as attributes of its files; and the command that replays one sample.
#pragma once
#include "io/color.h"
#include "io/picture.h"
#include "tools/cli/settings.h"

namespace chiaro::cli {

struct Rendered {
    RenderResult result;
    double noise = 0, noiseBound = 0; // Film::noise, Film::noiseBound
    Film::Mean mean;
    double exposure = 0;
    bool automaticExposure = false;
    std::string camera;
    double prepassSeconds = 0;                 // that the pre-pass took when it was solved
    std::vector<Diagnostics::Fact> facts = {}; // automatic choices
    std::filesystem::path checkpoint = {};     // that was written; empty: none
    double secondsBefore = 0;                  // of result.seconds: spent by earlier runs
};
// seconds: whether the time is told; without it equal renders have equal recipes.
Metadata recipe(const RenderSettings&, const LoadedScene&, const View&, const DisplayTransform&, const Film&, const Rendered&);

// "chiaro render SCENE" with the options on which the value of a sample depends, but for its seed.
std::string sameSamples(const RenderSettings&);
std::string replayCommand(const RenderSettings&, const DroppedSample&);
// "chiaro trace SCENE ...": a path of light by its number.
std::string tracePathCommand(const RenderSettings&, Pixel, uint64_t path);

} // namespace chiaro::cli
