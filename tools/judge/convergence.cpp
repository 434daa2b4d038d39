#include "tools/judge/convergence.h"
#include "tools/judge/special.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace chiaro::judge {

namespace {
using Matrix = std::array<std::array<double, maxFitTerms>, maxFitTerms>;

// Inverse of a symmetric positive definite matrix by Cholesky's factors; false where it is singular to working precision.
bool invert(Matrix& m, std::size_t n) noexcept {
    std::array<double, maxFitTerms> scale{};
    for (std::size_t i = 0; i < n; ++i) {
        if (!(m[i][i] > 0)) return false;
        scale[i] = 1 / std::sqrt(m[i][i]);
    }
    Matrix l{}, inverse{};
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = m[i][j] * scale[i] * scale[j];
            for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 1e-12)) return false;
            l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
        }
    for (std::size_t c = 0; c < n; ++c)
        for (std::size_t i = c; i < n; ++i) {
            double sum = i == c ? 1 : 0;
            for (std::size_t k = c; k < i; ++k) sum -= l[i][k] * inverse[k][c];
            inverse[i][c] = sum / l[i][i];
        }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            double sum = 0;
            for (std::size_t k = std::max(i, j); k < n; ++k) sum += inverse[k][i] * inverse[k][j];
            m[i][j] = sum * scale[i] * scale[j];
        }
    return true;
}
} // namespace

std::optional<Fit> fitPowers(std::span<const FitPoint> points, std::span<const double> exponents) {
    const std::size_t n = exponents.size();
    if (n == 0 || n > maxFitTerms || points.size() < n) return {};
    Fit fit;
    fit.terms = n;
    std::array<double, maxFitTerms> right{};
    for (const FitPoint& q : points) {
        if (!(q.error > 0)) return {};
        const double weight = 1 / (q.error * q.error);
        for (std::size_t i = 0; i < n; ++i) {
            const double xi = std::pow(q.x, exponents[i]);
            right[i] += weight * xi * q.y;
            for (std::size_t j = 0; j < n; ++j) fit.covariance[i][j] += weight * xi * std::pow(q.x, exponents[j]);
        }
    }
    if (!invert(fit.covariance, n)) return {};
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) fit.coefficient[i] += fit.covariance[i][j] * right[j];
    for (const FitPoint& q : points) {
        double residual = q.y;
        for (std::size_t i = 0; i < n; ++i) residual -= fit.coefficient[i] * std::pow(q.x, exponents[i]);
        fit.chiSquare += residual * residual / (q.error * q.error);
    }
    fit.dof = double(points.size() - n);
    if (fit.dof > 0) fit.p = chiSquareTail(fit.chiSquare, fit.dof);
    return fit;
}

std::optional<Convergence> convergesTo(const Estimate& reference, std::span<const FitPoint> points, std::span<const double> exponents,
                                       double alpha, double confidence) {
    std::vector<double> terms{0};
    terms.insert(terms.end(), exponents.begin(), exponents.end());
    const std::optional<Fit> fit = fitPowers(points, terms);
    if (!fit) return {};
    Convergence c;
    c.fit = *fit;
    c.limit = welch({fit->coefficient[0], std::sqrt(fit->covariance[0][0]), std::numeric_limits<double>::infinity()}, reference);
    const Interval absolute = confidenceInterval(c.limit, 1 - confidence);
    const double level = std::abs(reference.mean);
    c.relative = c.limit.difference / level;
    c.interval = {absolute.low / level, absolute.high / level};
    c.fits = fit->p >= alpha / 2;
    c.agrees = c.fits && c.limit.p >= alpha / 2;
    return c;
}

std::optional<Richardson> richardson(double coarse, double middle, double fine) noexcept {
    const double first = coarse - middle, second = middle - fine, ratio = first / second;
    if (!(ratio > 1)) return {};
    return Richardson{std::log2(ratio), fine - second / (ratio - 1)};
}

} // namespace chiaro::judge
