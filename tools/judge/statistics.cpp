#include "tools/judge/statistics.h"
#include "tools/judge/special.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace chiaro::judge {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();

Test compared(double difference, double error, double dof) noexcept {
    Test t{difference, error, 0, dof, 1};
    if (t.error > 0) {
        t.statistic = difference / t.error;
        t.p = tTwoSided(t.statistic, dof);
    } else if (difference != 0) {
        t.statistic = std::copysign(infinity, difference);
        t.p = 0;
    }
    return t;
}
} // namespace

void Moments::add(double x) noexcept {
    const double n1 = double(n_), n = double(++n_);
    const double delta = x - mean_, step = delta / n, term = delta * step * n1;
    mean_ += step;
    m3_ += term * step * (n - 2) - 3 * step * m2_;
    m2_ += term;
}

void Moments::merge(const Moments& o) noexcept {
    if (o.n_ == 0) return;
    const double a = double(n_), b = double(o.n_), n = a + b, delta = o.mean_ - mean_;
    m3_ += o.m3_ + delta * delta * delta * a * b * (a - b) / (n * n) + 3 * delta * (a * o.m2_ - b * m2_) / n;
    m2_ += o.m2_ + delta * delta * a * b / n;
    mean_ += delta * b / n;
    n_ += o.n_;
}

double Moments::variance() const noexcept { return n_ < 2 ? 0 : m2_ / double(n_ - 1); }
double Moments::standardError() const noexcept { return n_ < 2 ? 0 : std::sqrt(variance() / double(n_)); }
double Moments::skewness() const noexcept { return m2_ > 0 ? std::sqrt(double(n_)) * m3_ / std::pow(m2_, 1.5) : 0; }

Estimate estimate(const Moments& m) noexcept { return {m.mean(), m.standardError(), m.count() < 2 ? 0 : double(m.count() - 1)}; }

Test welch(const Estimate& a, const Estimate& b, double floor) noexcept {
    const double error = std::hypot(a.error, b.error);
    double dof = std::min(a.dof, b.dof);
    if (error > 0) { // by shares rather than by squares: no underflow where it is dark
        const double shareA = (a.error / error) * (a.error / error), shareB = (b.error / error) * (b.error / error);
        dof = 1 / ((shareA > 0 ? shareA * shareA / a.dof : 0) + (shareB > 0 ? shareB * shareB / b.dof : 0));
    }
    return compared(a.mean - b.mean, std::hypot(error, floor), dof);
}

Test oneSample(const Estimate& a, double expected, double floor) noexcept {
    return compared(a.mean - expected, std::hypot(a.error, floor), a.dof);
}

Interval confidenceInterval(const Test& t, double alpha) noexcept {
    const double half = t.error > 0 ? tQuantile(alpha / 2, t.dof) * t.error : 0;
    return {t.difference - half, t.difference + half};
}

double equivalence(const Test& t, double margin) noexcept {
    if (!(t.error > 0)) return std::abs(t.difference) < margin ? 0 : 1;
    return std::max(tTail((t.difference + margin) / t.error, t.dof), tTail((margin - t.difference) / t.error, t.dof));
}

double sidak(double family, double tests) noexcept { return -std::expm1(std::log1p(-family) / tests); }
double bonferroni(double family, double tests) noexcept { return family / tests; }
double sidakFamily(double p, double tests) noexcept { return p >= 1 ? 1 : -std::expm1(tests * std::log1p(-p)); }

double simes(std::vector<double> p) noexcept {
    std::sort(p.begin(), p.end());
    double best = 1;
    for (std::size_t k = 0; k < p.size(); ++k) best = std::min(best, p[k] * double(p.size()) / double(k + 1));
    return best;
}

double benjaminiHochberg(std::vector<double> p, double q) noexcept {
    std::sort(p.begin(), p.end());
    for (std::size_t k = p.size(); k > 0; --k)
        if (p[k - 1] <= q * double(k) / double(p.size())) return p[k - 1];
    return -1;
}

double binomialTail(uint64_t atLeast, uint64_t n, double p) noexcept {
    if (atLeast == 0) return 1;
    if (atLeast > n) return 0;
    return incompleteBeta(double(atLeast), double(n - atLeast + 1), p);
}

CountBounds binomialBounds(uint64_t n, double p, double alpha) noexcept {
    // First k of [0, n + 1] where the rising predicate holds.
    const auto first = [n](auto holds) {
        uint64_t low = 0, high = n + 1;
        while (low < high) {
            const uint64_t middle = low + (high - low) / 2;
            if (holds(middle))
                high = middle;
            else
                low = middle + 1;
        }
        return low;
    };
    const uint64_t high = first([&](uint64_t k) { return binomialTail(k + 1, n, p) <= alpha / 2; });
    const uint64_t above = first([&](uint64_t k) { return 1 - binomialTail(k, n, p) > alpha / 2; });
    return {above == 0 ? 0 : above - 1, std::min(high, n)};
}

KolmogorovSmirnov uniformity(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const double n = double(values.size());
    KolmogorovSmirnov ks;
    for (std::size_t i = 0; i < values.size(); ++i)
        ks.distance = std::max({ks.distance, double(i + 1) / n - values[i], values[i] - double(i) / n});
    ks.p = kolmogorovTail(values.size(), ks.distance);
    return ks;
}

double minimalDetectable(double error, double dof, double alpha, double power) noexcept {
    return error > 0 ? (tQuantile(alpha / 2, dof) + tQuantile(1 - power, dof)) * error : 0;
}

double neededSamples(double sigma, double d, double alpha, double power) noexcept {
    const double root = (normalQuantile(alpha / 2) + normalQuantile(1 - power)) * sigma / d;
    return root * root;
}

} // namespace chiaro::judge
