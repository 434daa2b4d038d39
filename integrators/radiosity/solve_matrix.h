// The full-matrix solvers: what is left after the bounces that are told apart, by repeated products (Jacobi), by sweeps that use what they
// have just found (Gauss-Seidel: Cohen and Greenberg 1985), or exactly (Cholesky's factorisation). With A_i F_ij = A_j F_ji the unknowns
// v = sqrt(A rho) H give a symmetric positive definite matrix, I - sqrt(rho) G sqrt(rho) with G_ij = sqrt(A_i / A_j) F_ij, of which a
// factor in single precision and a few refinements in double give all digits (Wilkinson 1963).
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

Solution solveJacobi(const System&, const FormFactorMatrix&, const Limits&, const Run&);
Solution solveGaussSeidel(const System&, const FormFactorMatrix&, const Limits&, const Run&);
// Throws Error(Exit::resources) beyond the memory limit.
Solution solveDirect(const System&, const FormFactorMatrix&, const Limits&, const Run&);

// One bounce over the matrix.
void gather(const Executor&, const FormFactorMatrix&, std::span<const Light> radiosity, std::span<Light> irradiance);

} // namespace chiaro::radiosity
