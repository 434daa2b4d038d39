// Integrators that work by whole iterations (light tracing, progressive photon mapping): one sample index of every pixel at a time.
#pragma once
#include "core/render/integrator.h"
#include <algorithm>

namespace chiaro {

// The one that a pass begins with. After a stop, pixels are ahead of the film's own count.
inline uint32_t nextIteration(const Film& film, const Pass& pass) noexcept {
    const Rect& r = film.layout().crop;
    uint32_t next = pass.begin;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) next = std::max(next, film.next({x, y}));
    return next;
}

} // namespace chiaro
