// The distribution of Kolmogorov's distance: the exact one for few values, the limit law for many.
#include "tools/judge/statistics.h"
#include <algorithm>
#include <cmath>

namespace chiaro::judge {

namespace {
constexpr std::size_t exactUpTo = 400;

// A square matrix times 10^exponent, so that powers neither overflow nor vanish.
struct Scaled {
    std::size_t size;
    std::vector<double> m;
    int exponent = 0;
    double& at(std::size_t i, std::size_t j) noexcept { return m[i * size + j]; }
    double at(std::size_t i, std::size_t j) const noexcept { return m[i * size + j]; }
};

Scaled product(const Scaled& a, const Scaled& b) {
    Scaled c{a.size, std::vector<double>(a.m.size(), 0.0), a.exponent + b.exponent};
    for (std::size_t i = 0; i < a.size; ++i)
        for (std::size_t k = 0; k < a.size; ++k)
            for (std::size_t j = 0; j < a.size; ++j) c.at(i, j) += a.at(i, k) * b.at(k, j);
    const std::size_t middle = a.size / 2;
    if (c.at(middle, middle) > 1e140) {
        for (double& v : c.m) v *= 1e-140;
        c.exponent += 140;
    }
    return c;
}

// Durbin's matrix for n d = k - h, 0 <= h < 1.
Scaled durbin(std::size_t k, double h) {
    const std::size_t size = 2 * k - 1;
    Scaled m{size, std::vector<double>(size * size, 0.0)};
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < std::min(size, i + 2); ++j) m.at(i, j) = 1;
    for (std::size_t i = 0; i < size; ++i) {
        m.at(i, 0) -= std::pow(h, double(i + 1));
        m.at(size - 1, i) -= std::pow(h, double(size - i));
    }
    if (2 * h > 1) m.at(size - 1, 0) += std::pow(2 * h - 1, double(size));
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < std::min(size, i + 1); ++j)
            for (std::size_t g = 2; g <= i + 1 - j; ++g) m.at(i, j) /= double(g); // 1/(i - j + 1)!
    return m;
}

// P(D < distance) = n!/n^n times the middle element of the matrix to the power n.
double exactBelow(std::size_t n, double distance) {
    const double scaled = double(n) * distance;
    const std::size_t k = std::size_t(scaled) + 1;
    Scaled base = durbin(k, double(k) - scaled), power = base;
    bool started = false;
    for (std::size_t left = n; left > 0; left /= 2) {
        if (left % 2 == 1) power = started ? product(power, base) : base, started = true;
        if (left > 1) base = product(base, base);
    }
    double value = power.at(k - 1, k - 1);
    int exponent = power.exponent;
    for (std::size_t i = 1; i <= n; ++i) {
        value *= double(i) / double(n);
        if (value < 1e-140) value *= 1e140, exponent -= 140;
    }
    return value * std::pow(10.0, exponent);
}
} // namespace

double kolmogorovTail(std::size_t n, double distance) {
    const double root = std::sqrt(double(n));
    if (n == 0 || distance <= 0.5 / double(n)) return 1;
    if (distance >= 1) return 0;
    const double lambda = (root + 0.12 + 0.11 / root) * distance;
    // Far out the complement of the exact form has no digits left, and the first term of the limit law is enough.
    if (n <= exactUpTo && lambda < 2.5) return std::clamp(1 - exactBelow(n, distance), 0.0, 1.0);
    if (lambda < 0.3) return 1; // to 9 digits; the series is slow there
    double sum = 0, sign = 1;
    for (int j = 1; j <= 100; ++j, sign = -sign) sum += sign * std::exp(-2 * lambda * lambda * j * j);
    return std::clamp(2 * sum, 0.0, 1.0);
}

} // namespace chiaro::judge
