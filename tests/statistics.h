// Statistics for tests: p-values, the false-alarm budget, Pearson's chi-square with pooling, and repeatable random numbers.
// Sources: Numerical Recipes, 3rd edition, sections 6.2 (incomplete gamma) and 6.4 (incomplete beta, Student's t).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace chiaro::stats {

// Q(a, x), the upper regularised incomplete gamma function: a series below the bend, a continued fraction (Lentz) above it.
inline double gammaQ(double a, double x) {
    if (x <= 0) return 1;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; std::fabs(term) > std::fabs(sum) * 1e-16; ++n) sum += term *= x / n;
        return 1 - front * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = an * d + b;
        d = 1 / (std::fabs(d) < 1e-300 ? 1e-300 : d);
        c = b + an / c;
        if (std::fabs(c) < 1e-300) c = 1e-300;
        h *= d * c;
        if (std::fabs(d * c - 1) < 1e-15) break;
    }
    return front * h;
}
// P(chi-square with so many degrees of freedom > x).
inline double chiSquareP(double x, double dof) { return gammaQ(dof / 2, x / 2); }
// P(|Z| > |z|) of the normal distribution.
inline double normalP(double z) { return std::erfc(std::fabs(z) / std::sqrt(2.0)); }

// I_x(a, b), the regularised incomplete beta function.
inline double betaI(double a, double b, double x) {
    if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
    if (x > (a + 1) / (a + b + 2)) return 1 - betaI(b, a, 1 - x);
    double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 100000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / (1 + even * d), c = 1 + even / c, h *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / (1 + odd * d), c = 1 + odd / c, h *= d * c;
        if (std::fabs(d * c - 1) < 1e-15) break;
    }
    return std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x)) * h / a;
}
// P(|T| > |t|) of Student's distribution.
inline double studentP(double t, double dof) { return betaI(dof / 2, 0.5, dof / (dof + t * t)); }

// The level of one of m tests so that all of them together raise a false alarm once in a thousand runs (Sidak).
inline double sidak(double m, double family = 1e-3) { return -std::expm1(std::log1p(-family) / m); }

struct ChiSquare {
    double statistic = 0, p = 1;
    int dof = 0;
};
// Pearson's test of counts against expectations. Cells that expect fewer than 5 are pooled, smallest first.
inline ChiSquare chiSquare(std::span<const double> observed, std::span<const double> expected) {
    std::vector<std::size_t> order(expected.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    ChiSquare r;
    double o = 0, e = 0;
    int cells = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        o += observed[order[k]];
        e += expected[order[k]];
        if (e < 5 && k + 1 < order.size()) continue;
        if (e > 0 || o > 0) {
            r.statistic += (o - e) * (o - e) / std::max(e, 1e-9);
            ++cells;
        }
        o = e = 0;
    }
    r.dof = std::max(cells - 1, 0);
    r.p = r.dof == 0 ? 1 : chiSquareP(r.statistic, r.dof);
    return r;
}

// Mean and variance in one pass (Welford).
struct Moments {
    double n = 0, mean = 0, m2 = 0;
    void add(double x) {
        const double d = x - mean;
        mean += d / ++n;
        m2 += d * (x - mean);
    }
    double variance() const { return n > 1 ? m2 / (n - 1) : 0; }
    double error() const { return std::sqrt(variance() / n); } // standard error of the mean
};

// Uniform floats in [0, 1), a multiple of 2^-24 (SplitMix64; Steele et al. 2014): the same numbers on every machine.
class Random {
public:
    explicit Random(uint64_t seed = 1) : state_(seed) {}
    float operator()() { return float(next() >> 40) * 0x1p-24f; }
    uint64_t next() {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }

private:
    uint64_t state_;
};

} // namespace chiaro::stats
