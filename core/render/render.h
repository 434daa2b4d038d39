// render(): the one driver. Passes of 1, 2, 4 ... samples until a budget ends them.
#pragma once
#include "core/render/integrator.h"

namespace chiaro {

struct Budget {
    uint32_t spp = 256;        // samples a pixel, at most
    double seconds = infinity; // of rendering, prepare() included
};
enum class Ended : uint8_t { spp, time, stopped };
struct RenderResult {
    Ended ended = Ended::spp;
    uint32_t spp = 0;   // complete passes; single pixels may have more
    double seconds = 0; // wall time, prepare() included
};
// Goes on where the film stands. At least one complete sample a pixel is taken before the clock may end it; a stop request ends it at once.
RenderResult render(const Job&, Integrator&, Film&, const Budget&, StopToken&);

} // namespace chiaro
