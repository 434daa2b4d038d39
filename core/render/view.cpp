#include "core/render/view.h"
#include <vector>

namespace chiaro {
namespace {

constexpr double tau = 6.283185307179586;

double shape(FilterKind kind, double x, double radius) noexcept {
    if (std::fabs(x) > radius) return 0;
    switch (kind) {
    case FilterKind::box: return 1;
    case FilterKind::gauss: return std::exp(-2 * x * x) - std::exp(-2 * radius * radius); // sigma 0.5, cut to reach zero
    case FilterKind::blackmanHarris: {                                                    // Harris 1978, four terms
        const double t = tau * (x + radius) / (2 * radius);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
    }
    }
    return 0;
}
float radiusOf(FilterKind kind) noexcept { return kind == FilterKind::box ? 0.5f : 1.5f; }

// Integral of the shape from -radius to x by Simpson's rule on a fine grid.
std::vector<double> cumulative(FilterKind kind, double radius, int steps) {
    std::vector<double> sum(std::size_t(steps) + 1, 0.0);
    const double h = 2 * radius / steps;
    for (int i = 0; i < steps; ++i) {
        const double a = -radius + i * h;
        sum[std::size_t(i) + 1] =
            sum[i] + h / 6 * (shape(kind, a, radius) + 4 * shape(kind, a + h / 2, radius) + shape(kind, std::min(a + h, radius), radius));
    }
    return sum;
}

} // namespace

Filter::Filter(FilterKind kind) : kind_(kind), radius_(radiusOf(kind)) {
    constexpr int steps = 8192;
    const std::vector<double> sum = cumulative(kind, radius_, steps);
    std::size_t j = 0;
    for (int i = 0; i <= cells; ++i) {
        const double target = sum.back() * i / cells;
        while (j + 2 < sum.size() && sum[j + 1] < target) ++j;
        const double fraction = sum[j + 1] > sum[j] ? (target - sum[j]) / (sum[j + 1] - sum[j]) : 0;
        inverse_[std::size_t(i)] = float(-double(radius_) + 2.0 * radius_ * (double(j) + std::clamp(fraction, 0.0, 1.0)) / steps);
    }
    inverse_.front() = -radius_;
    inverse_.back() = radius_;
}

Point2 Filter::sample(Point2 u) const noexcept { return {offset(u.x), offset(u.y)}; }

double Filter::density(double x) const noexcept {
    // Of the piecewise constant density that sample() draws from.
    for (int i = 0; i < cells; ++i) {
        const double a = inverse_[std::size_t(i)], b = inverse_[std::size_t(i) + 1];
        if (x >= a && x < b) return 1.0 / cells / (b - a);
    }
    return 0;
}

} // namespace chiaro
