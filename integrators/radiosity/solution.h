// What the radiosity method solves, in numbers alone, and what comes out of it. Every patch i has a radiosity
//   B_i = E_i + rho_i H_i,   H_i = h_i + sum_j F_ij B_j        (Goral, Torrance, Greenberg, Battaile 1984)
// with E its own light as far as form factors carry it, h the irradiance from lights that are no patches (or whose light was carried by
// shadow rays), H the irradiance from everywhere, lm/m2. The solution is the Neumann series of H: term k is the light that has been
// scattered k times before it arrives. Red, green and blue share the form factors. Sums are doubles.
#pragma once
#include "core/math/vec.h"
#include "core/render/executor.h"
#include "core/render/progress.h"
#include <span>
#include <string>
#include <vector>

namespace chiaro::radiosity {

using Light = Rgb<double>; // irradiance or radiosity
using Lights3 = std::vector<Light>;

struct System {
    std::vector<float> areas;
    std::vector<Spectrum> reflectance;
    Lights3 emission; // E
    Lights3 received; // h
    std::size_t size() const noexcept { return areas.size(); }
};

// How far to go, and how finely to tell the bounces apart.
struct Limits {
    static constexpr uint32_t converged = ~0u;
    uint32_t bounces = converged; // scatterings of light: 0 emission, 1 direct light, 2 one indirect bounce
    uint32_t apart = 1;           // so many terms one by one; what comes after them in one sum
    double tolerance = 1e-6;      // of the power that is still under way, relative to all that was sent
    // Terms that are kept: those apart, and the sum of the later ones where there are any.
    uint32_t levels() const noexcept { return bounces <= apart ? bounces : apart + 1; }
};

struct Solution {
    std::vector<Lights3> terms;    // H by scatterings before: 0, 1, ...; the last holds its own and all later ones
    Lights3 unshot;                // of progressive shooting: radiosity that has not been sent on; empty: none
    std::vector<double> residuals; // after each iteration: power still under way, relative to all that was sent
    std::vector<float> rowSums;    // of the form factors, where there is a matrix
    uint64_t factors = 0, links = 0, rays = 0;
    std::size_t bytes = 0; // at the peak, patches not counted
    double factorSeconds = 0, directSeconds = 0, solveSeconds = 0;
    bool complete = false; // false: the stop token ended it, it is of no use

    Light irradiance(std::size_t patch) const noexcept { // of all terms
        Light sum(0);
        for (const Lights3& t : terms) sum += t[patch];
        return sum;
    }
};

inline Light widened(const Spectrum& s) noexcept { return {double(s[0]), double(s[1]), double(s[2])}; }
// Luminous power of radiosities, lumen.
double power(std::span<const Light> radiosity, std::span<const float> areas) noexcept;

// What a solver shares with its caller.
struct Run {
    const Executor& run;
    const StopToken& stop;
    uint64_t seed = 0;
    std::size_t memoryLimit = ~std::size_t(0);
};

// One bounce of a method: the irradiance that the radiosities send. Sets every entry of the answer.
using Bounce = FunctionRef<void(std::span<const Light> radiosity, std::span<Light> irradiance)>;
// The series by one bounce after the other (Jacobi's iteration). from: the series so far; it goes on until the limits are met.
Solution neumann(const System&, Bounce, const Limits&, const Run&);

} // namespace chiaro::radiosity
