// Stochastic radiosity: no form factors are kept; in every bounce rays leave the patches in proportion to the power that is under way and
// count where they arrive (stochastic Jacobi by shooting: Neumann, Feda, Kopp, Purgathofer 1995; Bekaert, Hierarchical and Stochastic
// Algorithms for Radiosity, 1999, chapter 6). The later bounces carry less and get fewer rays. Memory and time grow with the number of
// patches alone. Rays are numbered: number s starts at the patch where the running sum of power passes (s + u) / M of the whole, and takes
// the s-th point of one low-discrepancy sequence. Arrivals are counted as whole numbers, so that any number of threads gives the same bits.
#pragma once
#include "integrators/radiosity/patches.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

// raysPerPatch: on average, of the first bounce.
Solution solveStochastic(const Work&, const Patches&, const System&, const Limits&, double raysPerPatch);

} // namespace chiaro::radiosity
