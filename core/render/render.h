// render(): the one driver. Passes of 1, 2, 4 ... samples until a budget ends them.
#pragma once
#include "core/render/integrator.h"
#include <functional>

namespace chiaro {

struct Budget {
    uint32_t spp = 256;        // samples a pixel, at most
    double seconds = infinity; // of rendering, prepare() included
    double noise = 0;          // ends when Film::noise() is below it with 95 % confidence; 0: never
};
// What is asked of the caller every so often, between passes: to keep the film. It must not throw.
struct Keeping {
    double every = infinity; // seconds
    std::function<void()> keep = {};
};
enum class Ended : uint8_t { spp, time, noise, stopped };
struct RenderResult {
    Ended ended = Ended::spp;
    uint32_t spp = 0;   // complete passes; single pixels may have more
    double seconds = 0; // wall time, prepare() included
};
// Goes on where the film stands. At least one complete sample a pixel is taken before the clock may end it; a stop request ends it at once.
// Budget::spp counts from sample 0 on, whatever the film begins with.
//
// Noise is looked at where the number of samples is a power of two, from 16 on, and from there extrapolated to the number that will be
// enough (error falls at least by n^-1/2): few looks, so that luck at one of them does not end a render early, and no more samples than
// asked for.
RenderResult render(const Job&, Integrator&, Film&, const Budget&, StopToken&, const Keeping& = {});

} // namespace chiaro
