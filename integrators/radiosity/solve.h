// Radiosity from patches to solution: direct light, form factors, one of the solvers. Everything that wants a solution comes through here:
// the integrator, the pre-pass, the benchmark. A pure function of the work and the settings, for any number of threads; ends early, with
// Solution::complete false, when the stop token says so. Throws Error(Exit::resources) with what to do where memory would not do.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

enum class Solver : uint8_t { gaussSeidel, jacobi, direct, shoot, hierarchical, stochastic, automatic };
// automatic: the matrix as long as it is cheap, else rays alone.
Solver solverFor(Solver, std::size_t patches) noexcept;
struct SolveSettings {
    Solver solver = Solver::gaussSeidel;
    FormFactorSettings factors;
    bool emissionByFactors = false; // else by shadow rays, as all direct light
    uint32_t lightRays = 64;        // to the lights, of each patch
    Limits limits;
    uint32_t steps = 0; // of shooting; 0: until the limits are met
    bool overshoot = false, ambient = false;
    double linkError = 5e-3;  // hierarchical: of the power of a mean patch
    double raysPerPatch = 64; // stochastic: of the first bounce
    bool rowSums = false;     // find them even where the solver needs none
};
Solution solve(const Work&, const Patches&, const SolveSettings&);

// The numbers of the problem: what of the light arrives by rays is in `received`.
System systemOf(const Patches&, Lights3 received, bool emissionByFactors);

// What was cut and solved, in lines for Diagnostics::tell.
// typed: what the user writes before an option of it, "-i radiosity".
void tell(const Work&, const Patches&, const PatchSettings&, const SolveSettings&, const Solution&, std::string_view typed);

} // namespace chiaro::radiosity
