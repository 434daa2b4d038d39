// Estimates, tests and bounds as verification asks for them: pure functions of numbers, no allocation in the single tests.
// Conventions: p-values are two-sided unless said; a test whose two errors are both zero has p = 1 for equal means, else 0.
// Sources: Welch, Biometrika 34 (1947); Sidak, JASA 62 (1967); Simes, Biometrika 73 (1986); Benjamini and Hochberg, JRSS B 57 (1995);
// Schuirmann, J. Pharmacokinet. Biopharm. 15 (1987) for two one-sided tests; for Kolmogorov-Smirnov: Durbin (1973) as Marsaglia, Tsang,
// Wang, J. Stat. Softw. 8(18) (2003) evaluate him, and Stephens, JASA 69 (1974);
// Pebay, Sandia report SAND2008-6212 (2008) for the moments.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro::judge {

// Running mean and central sums (Welford), mergeable.
class Moments {
public:
    void add(double x) noexcept;
    void merge(const Moments& other) noexcept;
    uint64_t count() const noexcept { return n_; }
    double mean() const noexcept { return mean_; } // 0 while empty
    double variance() const noexcept;              // of the samples, divisor n - 1; 0 below two
    double standardError() const noexcept;         // of the mean
    double skewness() const noexcept;              // sqrt(n) m3 / m2^1.5; 0 without spread

private:
    uint64_t n_ = 0;
    double mean_ = 0, m2_ = 0, m3_ = 0;
};

// A mean with what is known of its error; dof = inf: the error is taken as exact (normal).
struct Estimate {
    double mean = 0, error = 0, dof = 0;
};
Estimate estimate(const Moments&) noexcept;

struct Test {
    double difference = 0, error = 0; // a - b and its standard error
    double statistic = 0, dof = 0, p = 1;
};
// t = (a - b)/sqrt(ea^2 + eb^2), nu = (ea^2 + eb^2)^2/(ea^4/nua + eb^4/nub). `floor`: a further error of the difference, such as rounding.
Test welch(const Estimate& a, const Estimate& b, double floor = 0) noexcept;
Test oneSample(const Estimate& a, double expected, double floor = 0) noexcept;

struct Interval {
    double low = 0, high = 0;
};
Interval confidenceInterval(const Test&, double alpha) noexcept; // of the difference, coverage 1 - alpha
// Equivalence by two one-sided tests: the larger of both p-values; below alpha, the difference lies inside (-margin, margin).
double equivalence(const Test&, double margin) noexcept;

double sidak(double family, double tests) noexcept;      // 1 - (1 - family)^(1/tests): the alpha of one test
double bonferroni(double family, double tests) noexcept; // family/tests: safe whatever the tests share
double sidakFamily(double p, double tests) noexcept;     // 1 - (1 - p)^tests: smallest p of a family as the family's p
double simes(std::vector<double> p) noexcept; // min m p_(k)/k: the family's p; exact for independent tests, safe for positively dependent
// The largest p that is rejected at false-discovery rate q, or -1 when none is.
double benjaminiHochberg(std::vector<double> p, double q) noexcept;

double binomialTail(uint64_t atLeast, uint64_t n, double p) noexcept; // P(X >= atLeast)
struct CountBounds {
    uint64_t low = 0, high = 0; // P(X < low) and P(X > high) are each at most alpha/2
};
CountBounds binomialBounds(uint64_t n, double p, double alpha) noexcept;

struct KolmogorovSmirnov {
    double distance = 0, p = 1;
};
// P(D > distance) of n values: exact up to 400 of them, beyond by the limit law with Stephens' correction (to 1e-3).
double kolmogorovTail(std::size_t n, double distance);
KolmogorovSmirnov uniformity(std::vector<double> values); // of values that should be uniform on [0, 1]

// The difference seen with probability `power` by a two-sided test at alpha, and the samples of standard deviation sigma that see d.
double minimalDetectable(double error, double dof, double alpha, double power) noexcept;
double neededSamples(double sigma, double d, double alpha, double power) noexcept; // ((z_{alpha/2} + z_power) sigma/d)^2

} // namespace chiaro::judge
