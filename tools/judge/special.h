// The special functions that statistical verdicts rest on, in double, with the tails of the distributions: every probability is returned as
// the tail itself, never as 1 - cdf, so that p-values of 1e-30 keep their digits. Relative accuracy about 1e-13 (1e-10 for parameters
// beyond 1e5). Arguments outside of a function's domain give NaN.
// Sources: Abramowitz and Stegun, Handbook of Mathematical Functions (1964); NIST Digital Library of Mathematical Functions (DLMF).
#pragma once

namespace chiaro::judge {

double logGamma(double x) noexcept;                           // ln Gamma(x), x > 0: Stirling's series after a shift (A&S 6.1.41)
double gammaP(double a, double x) noexcept;                   // lower regularised incomplete gamma (A&S 6.5.29)
double gammaQ(double a, double x) noexcept;                   // upper one, 1 - P (A&S 6.5.31)
double incompleteBeta(double a, double b, double x) noexcept; // regularised I_x(a, b) (DLMF 8.17.22)

double normalTail(double z) noexcept;                      // P(Z > z)
double tTail(double t, double dof) noexcept;               // P(T > t); dof = inf: normal (A&S 26.7.1)
double tTwoSided(double t, double dof) noexcept;           // P(|T| > |t|)
double chiSquareTail(double x, double dof) noexcept;       // P(X > x) (A&S 26.4.19)
double fTail(double f, double dof1, double dof2) noexcept; // P(F > f) (A&S 26.6.2)

// The value whose upper tail is p.
double normalQuantile(double p) noexcept;
double tQuantile(double p, double dof) noexcept;
double chiSquareQuantile(double p, double dof) noexcept;
double fQuantile(double p, double dof1, double dof2) noexcept;

} // namespace chiaro::judge
