// The alias table: exact probabilities by enumeration, statistics, edge cases.
#include "core/math/distribution.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>
#include <functional>
#include <string>

using namespace chiaro;

namespace {

// Probability of each index when the cell is uniform and the test number one of the 2^24 that a sampler gives: exact, since inside a cell
// the choice changes at one place, which bisection finds.
std::vector<double> enumerated(const AliasTable& table) {
    const auto n = double(table.size());
    std::vector<double> p(table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double cell = (double(i) + 0.5) / n;
        const auto at = [&](uint32_t k) { return table.choose(cell, float(k) * 0x1p-24f).index; };
        uint32_t stays = 0, most = 1u << 24; // the first k that goes to the alias
        while (stays < most) {
            const uint32_t middle = stays + (most - stays) / 2;
            if (at(middle) == i)
                stays = middle + 1;
            else
                most = middle;
        }
        p[i] += double(stays) * 0x1p-24 / n;
        if (stays < 1u << 24) p[at(stays)] += (1 - double(stays) * 0x1p-24) / n;
    }
    return p;
}

struct Case {
    std::string name;
    std::vector<double> weights;
};
std::vector<double> made(std::size_t n, const std::function<double(std::size_t)>& f) {
    std::vector<double> w(n);
    for (std::size_t i = 0; i < n; ++i) w[i] = f(i);
    return w;
}
std::vector<Case> cases() {
    return {{"one", {3}},
            {"equal", {1, 1, 1, 1, 1}},
            {"two unequal", {1, 3}},
            {"zeros", {0, 5, 0, 0, 1, 0}},
            {"ramp", made(100, [](std::size_t i) { return double(i); })},
            {"one of many", made(1000, [](std::size_t i) { return i == 617 ? 1.0 : 0.0; })},
            {"powers", made(40, [](std::size_t i) { return std::ldexp(1.0, -int(i)); })},
            {"far apart", {1e-12, 1, 1e12}},
            {"tiny weights", {1e-300, 2e-300}},
            {"huge weights", {1e300, 2e300}},
            {"random", made(257, [](std::size_t i) { return double(stats::Random(i)()); })}};
}

} // namespace

TEST_SUITE("distribution") {

    TEST_CASE("the pmf is exactly the frequency with which the table chooses") {
        for (const Case& c : cases()) {
            CAPTURE(c.name);
            const AliasTable table(c.weights);
            REQUIRE(table.size() == c.weights.size());
            const std::vector<double> p = enumerated(table);
            double sum = 0, total = std::accumulate(c.weights.begin(), c.weights.end(), 0.0);
            for (std::size_t i = 0; i < p.size(); ++i) {
                CAPTURE(i);
                CHECK(double(table.pmf(uint32_t(i))) == doctest::Approx(p[i]).epsilon(1e-6));
                CHECK((c.weights[i] == 0) == (table.pmf(uint32_t(i)) == 0));
                // Rounding the test to 24 bits moves a probability by at most 2^-24 / n for each cell that shares in it.
                CHECK(std::fabs(p[i] - c.weights[i] / total) <= 0x1p-24);
                sum += double(table.pmf(uint32_t(i)));
            }
            CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        }
    }

    TEST_CASE("chi-square of choices") {
        const std::vector<Case> all = cases();
        for (const Case& c : all) {
            CAPTURE(c.name);
            const AliasTable table(c.weights);
            stats::Random u(17);
            constexpr int n = 200'000;
            std::vector<double> observed(c.weights.size()), expected(c.weights.size());
            for (int i = 0; i < n; ++i) {
                const double cell = double(u.next() >> 32) * 0x1p-32;
                ++observed[table.choose(cell, u()).index];
            }
            for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = n * double(table.pmf(uint32_t(i)));
            CHECK(stats::chiSquare(observed, expected).p > stats::sidak(double(all.size())));
        }
    }

    TEST_CASE("a weight of zero is never chosen, at no extreme of the numbers") {
        for (const Case& c : cases()) {
            const AliasTable table(c.weights);
            for (std::size_t i = 0; i <= 4 * c.weights.size(); ++i)
                for (const float test : {0.f, 0x1p-24f, 0.5f, oneMinusEpsilon}) {
                    const Choice choice = table.choose(std::min(double(i) / (4.0 * double(c.weights.size())), 1 - 0x1p-32), test);
                    REQUIRE(choice.index < c.weights.size());
                    REQUIRE(c.weights[choice.index] > 0);
                    REQUIRE(choice.pmf == table.pmf(choice.index));
                    REQUIRE(choice.u >= 0);
                    REQUIRE(choice.u < 1);
                }
        }
    }

    TEST_CASE("what is left of the test number is uniform") {
        const AliasTable table(std::vector<double>{0.3, 0.1, 0.05, 0.55});
        std::vector<double> bins(32), expected(32, 320'000.0 / 32);
        stats::Random u(3);
        for (int i = 0; i < 320'000; ++i) ++bins[std::size_t(table.choose(double(u.next() >> 32) * 0x1p-32, u()).u * 32)];
        CHECK(stats::chiSquare(bins, expected).p > 1e-4);
    }

    TEST_CASE("nothing to choose from") {
        const double inf = std::numeric_limits<double>::infinity();
        for (const std::vector<double>& w : {std::vector<double>{}, {0}, {0, 0, 0}, {1, inf}, {std::nan("")}}) {
            const AliasTable table(w);
            CHECK(table.empty());
            CHECK(table.sum() == 0);
        }
    }

    TEST_CASE("a table of a million cells with one heavy one") {
        constexpr std::size_t n = 1'000'000;
        const AliasTable table(made(n, [](std::size_t i) { return i == 123'456 ? double(n) : 1.0; }));
        CHECK(table.pmf(123'456) == doctest::Approx(n / (2.0 * n - 1)).epsilon(1e-6));
        stats::Random u(5);
        std::vector<double> observed(101), expected(101, 400'000 * (n - 1.0) / (2.0 * n - 1) / 100);
        expected[100] = 400'000 * double(table.pmf(123'456));
        for (int i = 0; i < 400'000; ++i) {
            const uint32_t k = table.choose(double(u.next() >> 32) * 0x1p-32, u()).index;
            ++observed[k == 123'456 ? 100 : k / (n / 100)];
        }
        CHECK(stats::chiSquare(observed, expected).p > 1e-4);
    }
}
