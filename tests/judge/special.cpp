// Special functions and tails against tables: Abramowitz and Stegun (1964), row K9 of the verification notes, and values of SciPy 1.17
// (scipy.special, scipy.stats), which rests on Cephes and Boost.
#include "tools/judge/special.h"
#include <cmath>
#include <doctest/doctest.h>
#include <initializer_list>
#include <limits>

using namespace chiaro::judge;

namespace {
bool near(double value, double expected, double relative = 1e-12) { return std::abs(value - expected) <= relative * std::abs(expected); }
constexpr double infinity = std::numeric_limits<double>::infinity();
} // namespace

TEST_SUITE("special") {
    TEST_CASE("log-gamma") {
        CHECK(near(logGamma(1e-3), 6.907178885383853));
        CHECK(near(logGamma(0.5), 0.5723649429247)); // ln sqrt(pi)
        CHECK(near(logGamma(3.7), 1.428072326665388));
        CHECK(near(logGamma(15.5), 26.536914491115613));
        CHECK(near(logGamma(100.25), 360.28455963776423));
        CHECK(near(logGamma(1e6), 12815504.569147611));
        CHECK(std::abs(logGamma(1)) < 1e-14);
        CHECK(std::abs(logGamma(2)) < 1e-14);
        CHECK(std::isnan(logGamma(0)));
        CHECK(std::isnan(logGamma(-1)));
    }

    TEST_CASE("incomplete gamma") {
        CHECK(near(gammaQ(0.5, 0.25), 0.47950012218695337));
        CHECK(near(gammaQ(10, 3), 0.9988975118698845));
        CHECK(near(gammaQ(100, 130), 0.002750408367306518, 1e-11));
        CHECK(near(gammaQ(1000, 900), 0.9994500977342882));
        CHECK(near(gammaQ(2.5, 60), 3.1385797727553017e-24));
        CHECK(near(gammaP(3, 2) + gammaQ(3, 2), 1));
        CHECK(gammaQ(3, 0) == 1);
        CHECK(gammaQ(3, infinity) == 0);
        CHECK(std::isnan(gammaQ(-1, 2)));
    }

    TEST_CASE("incomplete beta") {
        CHECK(near(incompleteBeta(0.5, 0.5, 0.3), 0.36901011956554536));
        CHECK(near(incompleteBeta(2, 3, 0.4), 0.5248));
        CHECK(near(incompleteBeta(10, 0.5, 0.97), 0.4408041535957583));
        CHECK(near(incompleteBeta(100, 200, 0.3), 0.10884306564490986));
        CHECK(near(incompleteBeta(7.5, 0.5, 0.05), 3.620255093637657e-11));
        CHECK(near(incompleteBeta(5e4, 6e4, 0.45), 0.0012259837783829837, 1e-8));
        CHECK(incompleteBeta(2, 3, 0) == 0);
        CHECK(incompleteBeta(2, 3, 1) == 1);
        CHECK(std::isnan(incompleteBeta(2, 3, 1.1)));
    }

    TEST_CASE("tails") {
        CHECK(std::abs(chiSquareTail(18.307, 10) - 0.05) < 5e-6); // A&S table 26.8; row K9
        CHECK(std::abs(tTwoSided(2.1314, 15) - 0.05) < 5e-6);     // row K9
        CHECK(near(tTwoSided(2.1314, 15), 0.050004682924598955));
        CHECK(near(tTwoSided(6.91, 15), 4.97669465599664e-06));
        CHECK(near(tTwoSided(5.51, 31), 4.975550995190282e-06));
        CHECK(near(tTwoSided(12.706, 1), 0.05000080235813319));
        CHECK(near(tTwoSided(0.001, 7), 0.9992300172449988));
        CHECK(near(tTwoSided(40, 9), 1.8982998449339822e-11));
        CHECK(tTwoSided(0, 7) == 1);
        CHECK(tTwoSided(infinity, 7) == 0);
        CHECK(near(tTail(-1.5, 6) + tTail(1.5, 6), 1));
        CHECK(near(fTail(4.9646, 1, 10), 0.050000052192913744)); // A&S table 26.9: 4.96
        CHECK(near(fTail(3.3258, 5, 10), 0.05000140148269154));  // 3.33
        CHECK(near(fTail(10, 3, 7), 0.006331603506624043));
        CHECK(near(normalTail(1.959963984540054), 0.025));
        CHECK(near(normalTail(5), 2.866515718791933e-07));
        CHECK(near(normalTail(10), 7.61985302416047e-24));
        CHECK(near(normalTail(30), 4.906713927147908e-198));
        CHECK(near(tTwoSided(3, infinity), 2 * normalTail(3)));
        CHECK(near(tTwoSided(3, 9e7), 2 * normalTail(3), 1e-6));
    }

    TEST_CASE("quantiles invert the tails") {
        CHECK(near(normalQuantile(0.3), 0.5244005127080409));
        CHECK(near(normalQuantile(0.025), 1.9599639845400545));
        CHECK(near(normalQuantile(5e-6), 4.417173413469023));
        CHECK(near(normalQuantile(1e-30), 11.464024688443613));
        CHECK(near(normalQuantile(0.7), -0.5244005127080409));
        CHECK(std::abs(normalQuantile(0.5)) < 1e-15);
        CHECK(near(tQuantile(0.3, 31), 0.5298363166782539, 1e-11));
        CHECK(near(tQuantile(0.025, 31), 2.039513446396408, 1e-11));
        CHECK(near(tQuantile(2.5e-7, 31), 6.316643823795692, 1e-11));
        CHECK(near(tQuantile(1e-30, 31), 47.14824645410026, 1e-11));
        CHECK(near(chiSquareQuantile(0.05, 10), 18.30703805327515, 1e-11));
        CHECK(near(fQuantile(0.05, 5, 10), 3.3258345304130104, 1e-11));
        for (const double p : {0.9, 0.5, 0.1, 1e-3, 1e-9, 1e-200}) {
            CHECK(near(normalTail(normalQuantile(p)), p, 1e-9));
            CHECK(near(tTail(tQuantile(p, 4), 4), p, 1e-9));
        }
        CHECK(std::isinf(normalQuantile(0)));
        CHECK(std::isnan(normalQuantile(1.5)));
    }
}
