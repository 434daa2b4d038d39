// Tests, families and bounds against published examples (named at each) and SciPy 1.17.
#include "tools/judge/statistics.h"
#include "tests/judge/pictures.h"
#include "tools/judge/convergence.h"
#include "tools/judge/special.h"
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>

using namespace chiaro::judge;

namespace {
bool near(double value, double expected, double relative = 1e-12) { return std::abs(value - expected) <= relative * std::abs(expected); }
constexpr double infinity = std::numeric_limits<double>::infinity();

Moments momentsOf(std::span<const double> values) {
    Moments m;
    for (const double v : values) m.add(v);
    return m;
}
const std::vector<double> first{27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4};
const std::vector<double> second{27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 30.5, 24.4};
} // namespace

TEST_SUITE("statistics") {
    TEST_CASE("moments, whole and merged") {
        const Moments whole = momentsOf(first);
        CHECK(near(whole.mean(), 20.82));
        CHECK(near(whole.variance(), 7.867428571428571));
        CHECK(near(whole.skewness(), 0.6167332725696337, 1e-11));
        for (std::size_t cut = 0; cut <= first.size(); ++cut) {
            Moments left = momentsOf(std::span(first).first(cut));
            left.merge(momentsOf(std::span(first).subspan(cut)));
            CHECK(left.count() == 15);
            CHECK(near(left.mean(), whole.mean()));
            CHECK(near(left.variance(), whole.variance(), 1e-11));
            CHECK(near(left.skewness(), whole.skewness(), 1e-10));
        }
        Moments far; // a large offset loses no spread
        for (const double v : {1e9 + 4, 1e9 + 7, 1e9 + 13, 1e9 + 16}) far.add(v);
        CHECK(near(far.variance(), 30));
        CHECK(Moments{}.variance() == 0);
    }

    TEST_CASE("Welch and one-sample t") {
        const Test k9 = welch({1, 0.5 / std::sqrt(1000.0), 999}, {1.05, 0.6 / std::sqrt(1200.0), 1199}); // row K9
        CHECK(near(k9.statistic, -2.1320072, 1e-7));
        CHECK(std::abs(k9.dof - 2198.0) < 0.05);
        CHECK(near(k9.p, 0.0331168, 1e-5));
        const Test t = welch(estimate(momentsOf(first)), estimate(momentsOf(second)));
        CHECK(near(t.statistic, -2.8529548701715215));
        CHECK(near(t.dof, 27.88730398842012));
        CHECK(near(t.p, 0.008071938172194903, 1e-11));
        const Test one = oneSample(estimate(momentsOf(first)), 20);
        CHECK(near(one.statistic, 1.132251950739545, 1e-11));
        CHECK(near(one.p, 0.2765491746502415, 1e-11));
        CHECK(welch({1, 0, 15}, {1, 0, 15}).p == 1); // no spread
        CHECK(welch({1, 0, 15}, {2, 0, 15}).p == 0);
        CHECK(welch({1, 0, 15}, {1 + 1e-7, 0, 15}, 1e-6).p > 0.9);         // rounding is no difference
        CHECK(near(welch({1e-200, 1e-200, 15}, {0, 1e-200, 15}).dof, 30)); // no underflow in the squares
        const Test half = welch({3, 0.5, 15}, {1, 0, 15});                 // a constant side
        CHECK(half.dof == 15);
        CHECK(half.statistic == 4);
    }

    TEST_CASE("families of tests") {
        CHECK(near(sidak(1e-3, 200), 5.0025e-6, 1e-5)); // row K9
        CHECK(near(normalQuantile(sidak(1e-3, 200) / 2), 4.5647, 1e-5));
        CHECK(bonferroni(1e-3, 200) == 5e-6);
        CHECK(near(sidakFamily(sidak(0.05, 37), 37), 0.05));
        // Benjamini and Hochberg (1995), section 3: of 15 hypotheses Bonferroni rejects 3, the false-discovery rate at 0.05 the first 4.
        const std::vector<double> p{0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344,
                                    0.0459, 0.3240, 0.4262, 0.5719, 0.6528, 0.7590, 1.0000};
        CHECK(benjaminiHochberg(p, 0.05) == 0.0095);
        CHECK(std::count_if(p.begin(), p.end(), [](double v) { return v <= bonferroni(0.05, 15); }) == 3);
        CHECK(benjaminiHochberg({0.5, 0.9}, 0.05) == -1);
        CHECK(near(simes({0.9, 0.01, 0.02}), 0.03));
        CHECK(near(simes({0.04, 0.04, 0.04}), 0.04)); // fully dependent tests cost nothing
    }

    TEST_CASE("binomial tail and bounds") {
        CHECK(near(binomialTail(12, 4096, 0.001), 0.0011083733828628943, 1e-11));
        CHECK(near(binomialTail(3, 10, 0.1), 0.0701908264));
        CHECK(binomialTail(0, 10, 0.1) == 1);
        CHECK(binomialTail(11, 10, 0.1) == 0);
        for (const uint64_t n : {10u, 200u, 4096u}) {
            const CountBounds b = binomialBounds(n, 0.05, 0.01);
            CHECK(binomialTail(b.high + 1, n, 0.05) <= 0.005);
            CHECK(binomialTail(b.high, n, 0.05) > 0.005);
            CHECK(1 - binomialTail(b.low, n, 0.05) <= 0.005);
            CHECK(1 - binomialTail(b.low + 1, n, 0.05) > 0.005);
        }
        CHECK(binomialBounds(4096, 0.001, 0.0125).high == 10); // SciPy: binom.isf(0.00625, 4096, 0.001)
        CHECK(binomialBounds(4096, 0.001, 0.0125).low == 0);
    }

    TEST_CASE("Kolmogorov-Smirnov") {
        const KolmogorovSmirnov ks = uniformity({0.02, 0.11, 0.18, 0.33, 0.35, 0.47, 0.58, 0.61, 0.74, 0.96});
        CHECK(near(ks.distance, 0.19));
        CHECK(near(ks.p, 0.7994599807966072, 1e-9));                                       // SciPy, exact
        CHECK(near(kolmogorovTail(10, 0.274), 1 - 0.6284796154565, 1e-10));                // Marsaglia, Tsang, Wang (2003)
        CHECK(std::abs(kolmogorovTail(400, 0.0675) - kolmogorovTail(401, 0.0675)) < 2e-3); // exact meets limit law
        CHECK(kolmogorovTail(20, 0.5) > kolmogorovTail(20, 0.6));
        CHECK(kolmogorovTail(20, 0.9) < 1e-13);
        CHECK(kolmogorovTail(1, 0.75) == doctest::Approx(0.5)); // 2 (1 - d)
        CHECK(uniformity({}).p == 1);
        std::vector<double> even(100000), bent;
        for (std::size_t i = 0; i < even.size(); ++i) even[i] = (double(i) + 0.5) / double(even.size());
        CHECK(uniformity(even).p == 1);
        // Smirnov (1948): sqrt(n) D = 1.3581 is the 5 % point for large n.
        for (const double v : even) bent.push_back(std::min(1.0, v + (1.3581 / std::sqrt(1e5) - 0.5e-5) * (v > 0.4 && v < 0.6)));
        CHECK(std::abs(uniformity(bent).p - 0.05) < 3e-4);
    }

    TEST_CASE("power, intervals, equivalence") {
        const double alpha = sidak(1e-3, 200); // verification notes 3.3: N = (6.89 sigma/d)^2, 4.7e5 samples for 1 %
        CHECK(near(neededSamples(1, 0.01, alpha, 0.99), 4.7e5, 0.02));
        CHECK(near(neededSamples(1, 0.002, alpha, 0.99), 1.2e7, 0.02));
        CHECK(near(minimalDetectable(1 / std::sqrt(neededSamples(1, 0.01, alpha, 0.99)), infinity, alpha, 0.99), 0.01, 1e-9));
        const Interval i = confidenceInterval(Test{1, 0.5, 2, 31, 0}, 0.05);
        CHECK(near(i.high, 1 + 0.5 * 2.039513446396408, 1e-11));
        CHECK(near(i.low, 1 - 0.5 * 2.039513446396408, 1e-11));
        // Equivalence holds at alpha exactly when the 1 - 2 alpha interval lies inside the margin.
        const Test t{0.002, 0.001, 2, 40, 0};
        const double edge = confidenceInterval(t, 0.1).high;
        CHECK(near(equivalence(t, edge), 0.05, 1e-9));
        CHECK(equivalence(t, 1.01 * edge) < 0.05);
        CHECK(equivalence(t, 0.99 * edge) > 0.05);
        CHECK(equivalence(Test{0.5, 0, 0, 10, 0}, 1) == 0);
        CHECK(equivalence(Test{2, 0, 0, 10, 0}, 1) == 1);
    }
}

TEST_SUITE("convergence") {
    TEST_CASE("weighted fit: Anscombe's first set") {
        // Anscombe, Graphs in Statistical Analysis (1973): y = 3.00 + 0.500 x, residual sum of squares 13.75 (13.7627 from the data).
        const double x[] = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5},
                     y[] = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
        std::vector<FitPoint> points;
        for (int i = 0; i < 11; ++i) points.push_back({x[i], y[i], 1});
        const double line[] = {0, 1};
        const auto fit = fitPowers(points, line);
        REQUIRE(fit);
        CHECK(near(fit->coefficient[0], 3.0000909, 1e-7));
        CHECK(near(fit->coefficient[1], 0.5000909, 1e-7));
        CHECK(near(fit->chiSquare, 13.76269, 1e-6));
        CHECK(fit->dof == 9);
        CHECK(near(fit->covariance[1][1], 1 / 110.0)); // 1/Sxx
        CHECK(near(fit->covariance[0][0], 1 / 11.0 + 81 / 110.0));
        CHECK(near(fit->covariance[0][1], -9 / 110.0));
    }

    TEST_CASE("fits that cannot be made are refused") {
        const double line[] = {0, 1}, twice[] = {2, 2};
        CHECK_FALSE(fitPowers(std::vector<FitPoint>{{1, 2, 0.1}}, line));
        CHECK_FALSE(fitPowers(std::vector<FitPoint>{{1, 2, 0.1}, {2, 3, 0}}, line));
        CHECK_FALSE(fitPowers(std::vector<FitPoint>{{1, 2, 0.1}, {2, 3, 0.1}}, twice));
        CHECK_FALSE(fitPowers(std::vector<FitPoint>{{1, 2, 0.1}, {1, 3, 0.1}}, line));
    }

    TEST_CASE("a bias of order r^2 is extrapolated away, a constant one is not") {
        const double radii[] = {0.2, 0.2 / std::numbers::sqrt2, 0.1}, order[] = {2};
        const auto answer = [&](double limit) {
            std::vector<FitPoint> points;
            for (const double r : radii) points.push_back({r, limit + 1.5 * r * r, 0.001});
            return convergesTo({0.5, 0.0005, 31}, points, order, 0.01);
        };
        const auto right = answer(0.5), wrong = answer(0.52);
        REQUIRE(right);
        REQUIRE(wrong);
        CHECK(right->agrees);
        CHECK(near(right->fit.coefficient[1], 1.5, 1e-9));
        CHECK(right->limit.p > 0.99);
        CHECK(wrong->fits);
        CHECK_FALSE(wrong->agrees);
        CHECK(near(wrong->relative, 0.04, 1e-9));
        CHECK(wrong->interval.low > 0.02);
        // Richardson over two radii, (4 L(r/2) - L(r))/3: sd grows by sqrt(17)/3 = 1.374 (verification notes 3.5).
        const auto two = fitPowers(std::vector<FitPoint>{{0.2, 0.56, 0.001}, {0.1, 0.515, 0.001}}, std::vector<double>{0, 2});
        REQUIRE(two);
        CHECK(near(two->coefficient[0], (4 * 0.515 - 0.56) / 3, 1e-9));
        CHECK(near(std::sqrt(two->covariance[0][0]), 0.001 * std::sqrt(17.0) / 3, 1e-9));
        // A linear term at an edge, left out of the model, shows in the residual.
        std::vector<FitPoint> edge;
        for (const double r : radii) edge.push_back({r, 0.5 + 0.8 * r, 0.0002});
        CHECK_FALSE(convergesTo({0.5, 0.0005, 31}, edge, order, 0.01)->fits);
    }

    TEST_CASE("the fit's errors are right: 2,000 noisy fits") {
        const double order[] = {0, 2};
        uint32_t next = 0;
        const auto normal = [&] {
            const double u = chiaro::judge::tests::uniformAt(next++) + 0x1p-25;
            return normalQuantile(u);
        };
        std::vector<double> residualP, limitP;
        for (int k = 0; k < 2000; ++k) {
            std::vector<FitPoint> points;
            for (const double r : {0.2, 0.15, 0.1, 0.07}) {
                const double error = 0.001 / r;
                points.push_back({r, 2 - 3 * r * r + error * normal(), error});
            }
            const auto fit = fitPowers(points, order);
            REQUIRE(fit);
            residualP.push_back(fit->p);
            limitP.push_back(2 * normalTail(std::abs(fit->coefficient[0] - 2) / std::sqrt(fit->covariance[0][0])));
        }
        CHECK(uniformity(residualP).p > 0.01);
        CHECK(uniformity(limitP).p > 0.01);
    }

    TEST_CASE("observed order of meshes h, h/2, h/4") {
        const auto r = richardson(1 + 0.3, 1 + 0.3 / 4, 1 + 0.3 / 16);
        REQUIRE(r);
        CHECK(near(r->order, 2));
        CHECK(near(r->limit, 1));
        CHECK_FALSE(richardson(1, 1, 1));
        CHECK_FALSE(richardson(1, 2, 1));
    }
}
