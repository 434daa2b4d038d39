#include "tools/judge/special.h"
#include <cmath>
#include <limits>
#include <numbers>

namespace chiaro::judge {

namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
constexpr double tiny = 1e-300, epsilon = 3e-16;
constexpr int maxTerms = 200000;
constexpr double normalFrom = 1e8; // degrees of freedom from which t is the normal distribution to double precision

// A continued fraction b0 + a1/(b1 + a2/(b2 + ...)) by the modified Lentz method (Thompson and Barnett, J. Comput. Phys. 64, 1986).
class Lentz {
public:
    explicit Lentz(double b0) noexcept : value(b0 == 0 ? tiny : b0), c_(value) {}
    bool step(double a, double b) noexcept {
        d_ = b + a * d_;
        c_ = b + a / c_;
        if (std::abs(d_) < tiny) d_ = tiny;
        if (std::abs(c_) < tiny) c_ = tiny;
        d_ = 1 / d_;
        const double factor = c_ * d_;
        value *= factor;
        return std::abs(factor - 1) > epsilon;
    }
    double value;

private:
    double c_, d_ = 0;
};

double gammaScale(double a, double x) noexcept { return std::exp(a * std::log(x) - x - logGamma(a)); }

double gammaSeries(double a, double x) noexcept {
    double term = 1 / a, sum = term;
    for (int n = 1; n < maxTerms && term > sum * epsilon; ++n) sum += term *= x / (a + n);
    return sum * gammaScale(a, x);
}

double gammaFraction(double a, double x) noexcept {
    Lentz f(x + 1 - a);
    for (int n = 1; n < maxTerms && f.step(-n * (n - a), x + 2 * n + 1 - a);) ++n;
    return gammaScale(a, x) / f.value;
}

double betaFraction(double a, double b, double x) noexcept {
    Lentz f(1);
    for (int m = 0; m < maxTerms; ++m) {
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        const double even = (m + 1) * (b - m - 1) * x / ((a + 2 * m + 1) * (a + 2 * m + 2));
        f.step(odd, 1);
        if (!f.step(even, 1)) break;
    }
    const double scale = std::exp(a * std::log(x) + b * std::log1p(-x) + logGamma(a + b) - logGamma(a) - logGamma(b));
    return scale / (a * f.value);
}

// The root of a falling tail: brackets by doubling from [low, high], then halves until neighbouring doubles.
template <class Tail> double invertTail(const Tail& tail, double p, double low, double high) noexcept {
    for (int i = 0; i < 1100 && tail(high) > p; ++i) low = high, high *= 2;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        (tail(middle) > p ? low : high) = middle;
    }
    return 0.5 * (low + high);
}
} // namespace

double logGamma(double x) noexcept {
    if (!(x > 0)) return nan;
    if (x == infinity) return infinity;
    double shift = 0;
    if (x < 16) {
        double product = 1;
        for (; x < 16; ++x) product *= x;
        shift = std::log(product);
    }
    const double r = 1 / (x * x);
    const double series =
        (1.0 / 12 - r * (1.0 / 360 - r * (1.0 / 1260 - r * (1.0 / 1680 - r * (1.0 / 1188 - r * (691.0 / 360360 - r / 156)))))) / x;
    return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2 * std::numbers::pi) + series - shift;
}

double gammaP(double a, double x) noexcept {
    if (!(a > 0) || !(x >= 0)) return nan;
    if (x == 0) return 0;
    if (x == infinity) return 1;
    return x < a + 1 ? gammaSeries(a, x) : 1 - gammaFraction(a, x);
}

double gammaQ(double a, double x) noexcept {
    if (!(a > 0) || !(x >= 0)) return nan;
    if (x == 0) return 1;
    if (x == infinity) return 0;
    return x < a + 1 ? 1 - gammaSeries(a, x) : gammaFraction(a, x);
}

double incompleteBeta(double a, double b, double x) noexcept {
    if (!(a > 0) || !(b > 0) || !(x >= 0) || !(x <= 1)) return nan;
    if (x == 0 || x == 1) return x;
    return x < (a + 1) / (a + b + 2) ? betaFraction(a, b, x) : 1 - betaFraction(b, a, 1 - x);
}

double normalTail(double z) noexcept { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

double tTwoSided(double t, double dof) noexcept {
    if (std::isnan(t) || !(dof > 0)) return nan;
    if (std::isinf(t)) return 0;
    if (dof > normalFrom) return 2 * normalTail(std::abs(t));
    const double square = t * t;
    // I_x(nu/2, 1/2) with x = nu/(nu + t^2): near t = 0 by its complement, as 1 - x has more digits than x there.
    if (square < 1) return 1 - incompleteBeta(0.5, dof / 2, square / (dof + square));
    return incompleteBeta(dof / 2, 0.5, dof / (dof + square));
}

double tTail(double t, double dof) noexcept {
    const double half = 0.5 * tTwoSided(t, dof);
    return t > 0 ? half : 1 - half;
}

double chiSquareTail(double x, double dof) noexcept { return x <= 0 && dof > 0 ? 1 : gammaQ(dof / 2, x / 2); }

double fTail(double f, double dof1, double dof2) noexcept {
    if (!(dof1 > 0) || !(dof2 > 0) || std::isnan(f)) return nan;
    if (f <= 0) return 1;
    return incompleteBeta(dof2 / 2, dof1 / 2, dof2 / (dof2 + dof1 * f));
}

double normalQuantile(double p) noexcept {
    if (!(p >= 0) || !(p <= 1)) return nan;
    if (p > 0.5) return -normalQuantile(1 - p);
    if (p == 0) return infinity;
    // Newton on ln tail, which is nearly a parabola, from the leading term of its asymptotic series (A&S 26.2.12).
    double z = p > 0.1 ? (0.5 - p) * std::sqrt(2 * std::numbers::pi) : std::sqrt(-2 * std::log(p * 3));
    for (int i = 0; i < 60; ++i) {
        const double tail = normalTail(z);
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        const double step = std::log(tail / p) * tail / density;
        if (!std::isfinite(step)) break;
        z += step;
        if (std::abs(step) < 1e-15 * (1 + z)) break;
    }
    return z;
}

double tQuantile(double p, double dof) noexcept {
    if (!(p >= 0) || !(p <= 1) || !(dof > 0)) return nan;
    if (p > 0.5) return -tQuantile(1 - p, dof);
    if (p == 0) return infinity;
    if (dof > normalFrom) return normalQuantile(p);
    return invertTail([&](double t) { return tTail(t, dof); }, p, 0, 1);
}

double chiSquareQuantile(double p, double dof) noexcept {
    if (!(p >= 0) || !(p <= 1) || !(dof > 0)) return nan;
    if (p == 0) return infinity;
    return p == 1 ? 0 : invertTail([&](double x) { return chiSquareTail(x, dof); }, p, 0, 1);
}

double fQuantile(double p, double dof1, double dof2) noexcept {
    if (!(p >= 0) || !(p <= 1) || !(dof1 > 0) || !(dof2 > 0)) return nan;
    if (p == 0) return infinity;
    return p == 1 ? 0 : invertTail([&](double f) { return fTail(f, dof1, dof2); }, p, 0, 1);
}

} // namespace chiaro::judge
