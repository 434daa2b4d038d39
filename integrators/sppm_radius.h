// How the radius of progressive photon mapping shrinks. After N iterations of radii r_1 ... r_N
//   r_(i+1)^2 = r_i^2 (i + alpha) / (i + 1),   r_N^2 / r_1^2 = Gamma(N + alpha) / (Gamma(1 + alpha) Gamma(N + 1)) ~ N^(alpha - 1)
// so that bias and variance of the mean of the iterations both vanish (Knaus and Zwicker, Progressive Photon Mapping: A Probabilistic
// Approach, 2011, eq. 20). With statistics of its own a pixel shrinks by the photons that it has found, from none on (Hachisuka and Jensen,
// Stochastic Progressive Photon Mapping, 2009, eq. 6 and 7): of N kept and M new ones, N + alpha M are kept and the area falls in that
// ratio to N + M.
#pragma once
#include "core/render/fault.h"
#include <cmath>
#include <cstdint>

namespace chiaro {

// r_N^2 / r_1^2 in iteration N - 1, counted from 0.
inline double progressiveArea(uint64_t iteration, double alpha) noexcept {
    if (fault(Fault::photonRadiusFixed)) return 1;
    const double n = double(iteration) + 1;
    return std::exp(std::lgamma(n + alpha) - std::lgamma(1 + alpha) - std::lgamma(n + 1));
}

struct PixelStatistics {
    float radius2 = 0; // square metres
    float kept = 0;    // photons
    void add(float found, float alpha) noexcept {
        if (found <= 0 || fault(Fault::photonRadiusFixed)) return;
        const float now = kept + alpha * found;
        radius2 *= now / (kept + found);
        kept = now;
    }
};

} // namespace chiaro
