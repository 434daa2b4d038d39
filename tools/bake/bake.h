// Bake: samples of all sites until a budget ends, then values. The only loop of the baker; results do not depend on threads or on where
// passes are cut.
#pragma once
#include "core/render/render.h"
#include "tools/bake/fill.h"
#include "tools/bake/gather.h"

namespace chiaro::bake {

struct BakeResult {
    Ended ended = Ended::spp;
    uint32_t spp = 0; // complete at every site
    double seconds = 0;
    double noise = 0; // relative error of the irradiance of a site, from halves; NaN while there is none
    Spectrum mean{0}; // irradiance, over all sites with equal weight, lux
    uint64_t dropped = 0, leaks = 0;
};
// Passes of 1, 2, 4 ... samples. A stop request ends it at once, the clock not before every site has one sample.
BakeResult bake(const Job&, const Gather&, const Sites&, std::span<SiteSum>, const Budget&, StopToken&);

// A site of which most rays meet backs of surfaces lies inside of something: what it gathers leaks.
bool leaks(const SiteSum&) noexcept;
MapTexel valueOf(const SiteSum&) noexcept; // the means; unknown where it leaks or has no sample

} // namespace chiaro::bake
