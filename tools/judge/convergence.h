// Consistent but biased methods (photon maps, radiosity meshes): their answer L(h) at a radius or mesh size h carries a bias that vanishes
// with h. Several independent answers are extrapolated to h = 0 by a weighted fit L = L0 + c h^k + ..., and L0 is what must agree with the
// path tracer. Jensen, Realistic Image Synthesis Using Photon Mapping (2001), ch. 7 for the order 2 in the radius; Richardson (1911).
#pragma once
#include "tools/judge/statistics.h"
#include <array>
#include <optional>

namespace chiaro::judge {

inline constexpr std::size_t maxFitTerms = 4;

// y = sum of c_k x^(exponent_k), weights 1/error^2, errors known: covariance = (A^T W A)^-1.
struct Fit {
    std::size_t terms = 0;
    std::array<double, maxFitTerms> coefficient{};
    std::array<std::array<double, maxFitTerms>, maxFitTerms> covariance{};
    double chiSquare = 0, dof = 0; // of the residuals
    double p = 1;                  // that residuals so large arise by chance; 1 without degrees of freedom
};
struct FitPoint {
    double x = 0, y = 0, error = 0;
};
// Empty where there are fewer points than terms, an error that is not positive, or exponents that the points cannot tell apart.
std::optional<Fit> fitPowers(std::span<const FitPoint> points, std::span<const double> exponents);

struct Convergence {
    Fit fit;             // exponents 0 and those given
    Test limit;          // L0 - reference; normal, as the errors of the fit are taken as known
    double relative = 0; // of the reference
    Interval interval;   // of `relative`
    bool fits = false;   // residual p >= alpha/2
    bool agrees = false; // fits, and the limit's p >= alpha/2
};
// exponents: {2} for a photon radius, {1, 2} where the pixel lies within the radius of an edge.
std::optional<Convergence> convergesTo(const Estimate& reference, std::span<const FitPoint> points, std::span<const double> exponents,
                                       double alpha, double confidence = 0.95);

// From answers at h, h/2, h/4: the observed order log2((L0 - L1)/(L1 - L2)) and the limit L2 + (L2 - L1)/(2^order - 1). Empty where the
// differences vanish or alternate.
struct Richardson {
    double order = 0, limit = 0;
};
std::optional<Richardson> richardson(double coarse, double middle, double fine) noexcept;

} // namespace chiaro::judge
