// Replicates made in pairs: what both sides have drawn alike is gone from their difference, the rule keeps its alpha and gains power, and a
// few bright events that one side has not met are no bias.
#include "tools/judge/agreement.h"
#include "tools/judge/special.h"
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace chiaro::judge;

namespace {
constexpr uint32_t side = 24, replicates = 16;

struct Pair {
    Replicates test{side, side}, reference{side, side};
};
struct Design {
    float shared = 0.5f, own = 0.05f; // relative, of a pixel: noise of both sides, of each
    float factor = 1;                 // of the test's expectation
    double events = 0;                // bright ones of the reference's, expected in all of its replicates; the test has their mean
    float height = 0;
};
Pair made(const Design& d, uint64_t seed) {
    std::mt19937_64 random(seed);
    std::exponential_distribution<float> skewed(1);
    std::bernoulli_distribution event(d.events / (double(side) * side * replicates));
    Pair pair;
    const auto noise = [&](float size) { return size * (skewed(random) - 1); };
    for (uint32_t r = 0; r < replicates; ++r) {
        Picture a{side, side, {}, {}, "test", {}}, b = a;
        for (uint32_t i = 0; i < side * side; ++i) {
            const float both = 1 + noise(d.shared), mean = float(event.p()) * d.height;
            a.rgb.insert(a.rgb.end(), 3, d.factor * both + noise(d.own) + mean);
            b.rgb.insert(b.rgb.end(), 3, both + noise(d.own) + (event(random) ? d.height : 0.f));
        }
        pair.test.add(a);
        pair.reference.add(b);
    }
    return pair;
}
AgreementSettings rule(bool paired, double alpha = 1e-3) {
    AgreementSettings s;
    s.paired = paired;
    s.alpha = alpha;
    return s;
}
bool alarm(const Agreement& a) { return a.verdict == Verdict::biased || a.verdict == Verdict::differs; }
Agreement judged(const Pair& p, const AgreementSettings& s) { return agree(p.test, p.reference, s); }
} // namespace

TEST_SUITE("paired") {
    TEST_CASE("false alarms follow alpha, and p is uniform: 400 comparisons") {
        int loose = 0, strict = 0;
        std::vector<double> p;
        for (uint64_t k = 0; k < 400; ++k) {
            const Pair pair = made({}, k);
            const Agreement a = judged(pair, rule(true, 0.05));
            loose += alarm(a);
            p.push_back(a.bias[0].test.p);
            strict += alarm(judged(pair, rule(true)));
        }
        MESSAGE("false alarms of 400: ", loose, " at 0.05, ", strict, " at 0.001; uniformity of p ", uniformity(p).p);
        CHECK(loose <= int(binomialBounds(400, 0.05, 0.002).high));
        CHECK(loose >= 4); // a quarter of alpha lies with the tiles, whose own errors are far too large for what is left
        CHECK(strict <= 2);
        CHECK(uniformity(p).p > 0.01);
    }

    TEST_CASE("power: a bias that own errors cannot resolve is found, with size and interval") {
        int found = 0, covered = 0, alone = 0;
        for (uint64_t k = 0; k < 40; ++k) {
            const Pair pair = made({.factor = 1.01f}, 5000 + k);
            const Agreement a = judged(pair, rule(true)), own = judged(pair, rule(false));
            found += a.verdict == Verdict::biased;
            alone += own.verdict == Verdict::biased;
            covered += a.bias[0].interval.low <= 0.01 && 0.01 <= a.bias[0].interval.high;
            CHECK(a.resolution < 0.01);
            CHECK(own.resolution > 0.01);
            CHECK(a.sharedNoise > 0.9);
        }
        MESSAGE("1 % found in ", found, " of 40, by own errors in ", alone);
        CHECK(found >= 38);
        CHECK(covered >= 33);
        CHECK(alone < 10);
    }

    TEST_CASE("what is equal draw by draw agrees, and says what would have been seen") {
        const Pair pair = made({.own = 0}, 3);
        const Agreement a = judged(pair, rule(true));
        CHECK(a.verdict == Verdict::agrees);
        CHECK(a.bias[0].test.p == 1);
        CHECK(a.sharedNoise == doctest::Approx(1));
        // Pixels of mean 1 and variance .25 in a replicate: events of height .25/16/576, of which 9 do not stay away by chance; 7 more for
        // the power.
        CHECK(a.resolution == doctest::Approx(16 * 0.25 / (replicates * side * side)).epsilon(0.3));
    }

    TEST_CASE("a few bright events that one side has not met are no bias") {
        int alarms = 0, naive = 0;
        for (uint64_t k = 0; k < 1000; ++k) {
            const Pair pair = made({.shared = 0.1f, .own = 0, .events = 6, .height = 200}, 9000 + k);
            const Agreement a = judged(pair, rule(true));
            alarms += a.verdict == Verdict::biased;
            const Estimate d = pairedDifferences(pair.test, pair.reference, std::vector<uint8_t>(9, 0))[0];
            naive += oneSample(d, 0).p <= 0.5e-3;
        }
        MESSAGE("6 events expected: of 1,000 comparisons ", alarms, " biased, ", naive, " by the spread of the differences alone");
        CHECK(alarms <= 10); // none of the events is met with a probability of exp(-6), and nothing then tells of their height
        CHECK(naive > 2 * alarms);
    }

    TEST_CASE("a pair needs its partner; tiles that are left out are out of the differences") {
        Pair pair = made({}, 1);
        Picture extra{side, side, std::vector<float>(side * side * 3, 1.f), {}, "extra", {}};
        const std::vector<uint8_t> none(9, 0);
        std::vector<uint8_t> first(9, 0);
        first[0] = 1;
        CHECK(pairedDifferences(pair.test, pair.reference, none)[0].mean != pairedDifferences(pair.test, pair.reference, first)[0].mean);
        pair.test.add(extra);
        CHECK_THROWS(judged(pair, rule(true)));
        CHECK_FALSE(alarm(judged(pair, rule(false))));
    }
} // TEST_SUITE
