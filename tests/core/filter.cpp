// Reconstruction filters by importance sampling (row H4 of the verification table).
#include "core/render/view.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;

namespace {

constexpr FilterKind kinds[] = {FilterKind::box, FilterKind::gauss, FilterKind::blackmanHarris};

// The shape that the name promises, not normalised.
double shape(FilterKind kind, double x) {
    if (kind == FilterKind::box) return std::fabs(x) <= 0.5 ? 1 : 0;
    if (std::fabs(x) > 1.5) return 0;
    if (kind == FilterKind::gauss) return std::exp(-2 * x * x) - std::exp(-4.5);
    const double t = 2 * std::numbers::pi * (x / 3 + 0.5);
    return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
}
double integral(FilterKind kind, double a, double b) {
    constexpr int n = 2000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += shape(kind, a + (b - a) * (i + 0.5) / n);
    return sum * (b - a) / n;
}

} // namespace

TEST_SUITE("filter") {

    TEST_CASE("the density integrates to 1, is symmetrical and follows the shape") {
        for (const FilterKind kind : kinds) {
            const Filter f(kind);
            CAPTURE(int(kind));
            const double r = double(f.radius()), norm = integral(kind, -r, r);
            constexpr int n = 100'000;
            double sum = 0, away = 0, skew = 0;
            for (int i = 0; i < n; ++i) {
                const double x = -r + 2 * r * (i + 0.5) / n;
                sum += f.density(x) * 2 * r / n;
                skew = std::max(skew, std::fabs(f.density(x) - f.density(-x)));
                away += std::fabs(f.density(x) - shape(kind, x) / norm) * 2 * r / n;
            }
            CHECK(sum == doctest::Approx(1).epsilon(1e-4));
            CHECK(skew < 0.02);  // steps of the table do not lie in exact mirror places
            CHECK(away < 0.005); // a table of 1,024 equal shares: the outermost ones are wide
            CHECK(f.density(-r - 0.01) == 0);
            CHECK(f.density(r + 0.01) == 0);
            if (kind == FilterKind::box) CHECK(f.density(0.3) == doctest::Approx(1).epsilon(1e-4));
        }
    }

    TEST_CASE("samples follow the density: chi-square on a grid of both axes, mean offset 0") {
        for (const FilterKind kind : kinds) {
            const Filter f(kind);
            CAPTURE(int(kind));
            constexpr int side = 24, fine = 2000, n = 400'000;
            const double r = double(f.radius());
            std::vector<double> axis(side), observed(side * side), expected(side * side);
            for (int i = 0; i < side * fine; ++i)
                axis[std::size_t(i / fine)] += f.density(-r + 2 * r * (i + 0.5) / (side * fine)) * 2 * r / (side * fine);
            stats::Random u(11);
            stats::Moments x, y, product;
            int outside = 0;
            for (int i = 0; i < n; ++i) {
                const float u0 = u();
                const Point2 p = f.sample({u0, u()});
                x.add(double(p.x));
                y.add(double(p.y));
                product.add(double(p.x) * double(p.y));
                outside += std::fabs(p.x) > f.radius() || std::fabs(p.y) > f.radius();
                const auto cell = [&](float v) { return std::min(std::size_t((double(v) + r) / (2 * r) * side), std::size_t(side - 1)); };
                ++observed[cell(p.y) * side + cell(p.x)];
            }
            for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = n * axis[i / side] * axis[i % side];
            CHECK(outside == 0);
            CHECK(stats::chiSquare(observed, expected).p > stats::sidak(3));
            for (const stats::Moments* m : {&x, &y, &product}) CHECK(std::fabs(m->mean) < 4 * m->error());
        }
    }

    TEST_CASE("opposite numbers give opposite offsets, the middle gives none") {
        for (const FilterKind kind : kinds) {
            const Filter f(kind);
            CAPTURE(int(kind));
            CHECK(f.sample({0.5f, 0.5f}).x == doctest::Approx(0).epsilon(1e-5));
            CHECK(f.sample({0, 0}).x == -f.radius());
            CHECK(f.sample({oneMinusEpsilon, 0}).x <= f.radius());
            double worst = 0;
            for (int i = 1; i < 1024; ++i) {
                const float u = float(i) / 1024;
                worst = std::max(worst, std::fabs(double(f.sample({u, 0}).x) + double(f.sample({1 - u, 0}).x)));
            }
            CHECK(worst < 1e-5);
        }
    }

    TEST_CASE("a step edge through the pixel: what share of the samples lies beyond it") {
        // Row H4: the edge at 0.25 outside the pixel's centre line; a box of one pixel whose border it misses by a quarter sees nothing.
        const auto beyond = [](FilterKind kind, double edge) {
            const Filter f(kind);
            int n = 0;
            for (int i = 0; i < 1 << 16; ++i) n += double(f.sample({(float(i) + 0.5f) / 65536, 0.5f}).x) > edge;
            return n / 65536.0;
        };
        CHECK(beyond(FilterKind::box, 0.75) == 0);
        CHECK(beyond(FilterKind::box, 0.25) == doctest::Approx(0.25).epsilon(1e-4));
        CHECK(beyond(FilterKind::box, -0.2) == doctest::Approx(0.7).epsilon(1e-4));
        for (const FilterKind kind : {FilterKind::gauss, FilterKind::blackmanHarris}) {
            CHECK(beyond(kind, 0.75) == doctest::Approx(integral(kind, 0.75, 1.5) / integral(kind, -1.5, 1.5)).epsilon(2e-3));
            CHECK(beyond(kind, 0) == doctest::Approx(0.5).epsilon(1e-4));
        }
    }
}
