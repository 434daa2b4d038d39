// One method meets rare bright events, the other gives their mean with hardly any noise: sound methods both. Where the first has met none
// its pixels are zero without any spread, and only what is known around them tells that this is chance.
#include "tools/judge/rare_events.h"
#include "tools/judge/agreement.h"
#include <cmath>
#include <doctest/doctest.h>
#include <random>

using namespace chiaro::judge;

namespace {
constexpr uint32_t side = 48, replicates = 16;
constexpr double height = 10, rate = 0.01; // of an event in one pixel of one replicate

// Events of this height at this rate.
Replicates rare(uint64_t seed, double chance) {
    std::mt19937_64 random(seed);
    std::bernoulli_distribution event(chance);
    Replicates out(side, side);
    for (uint32_t r = 0; r < replicates; ++r) {
        Picture p{side, side, {}, {}, "rare", {}};
        for (uint32_t i = 0; i < side * side; ++i) p.rgb.insert(p.rgb.end(), 3, event(random) ? float(height) : 0.f);
        out.add(p);
    }
    return out;
}
// Their mean, times `factor` in one corner of 16 x 16 pixels, with 1 % of noise.
Replicates even(uint64_t seed, float factor = 1) {
    std::mt19937_64 random(seed);
    std::normal_distribution<float> noise(1, 0.01f);
    Replicates out(side, side);
    for (uint32_t r = 0; r < replicates; ++r) {
        Picture p{side, side, {}, {}, "even", {}};
        for (uint32_t i = 0; i < side * side; ++i) {
            const bool corner = i % side < 16 && i / side < 16;
            p.rgb.insert(p.rgb.end(), 3, float(height * rate) * noise(random) * (corner ? factor : 1));
        }
        out.add(p);
    }
    return out;
}
bool wrong(const Replicates& a, const Replicates& b) {
    const Agreement found = agree(a, b);
    return found.verdict == Verdict::biased || found.verdict == Verdict::differs;
}
} // namespace

TEST_SUITE("rare-events") {
    TEST_CASE("without the floor pixels that no event has hit would be called wrong") {
        const std::vector<uint8_t> none(36, 0);
        const Evidence e = rare(1, rate).evidence(none);
        std::size_t silent = 0;
        for (const Estimate& p : e.pixels) silent += p.mean == 0 && p.error == 0;
        CHECK(silent > side * side / 2); // exp(-0.16) of them
    }
    TEST_CASE("chance is not called a difference, whichever side has it") {
        int alarms = 0;
        for (uint64_t seed = 1; seed <= 100; ++seed)
            alarms += wrong(rare(seed, rate), even(1000 + seed)) + wrong(even(2000 + seed), rare(3000 + seed, rate));
        CHECK(alarms <= 2); // of 200 at 0.001
    }
    TEST_CASE("a rate that is wrong by half, and a corner that is wrong, are found") {
        int halved = 0, corner = 0;
        for (uint64_t seed = 1; seed <= 20; ++seed) {
            halved += wrong(rare(seed, rate / 2), even(1000 + seed));
            corner += wrong(rare(3000 + seed, rate), even(2000 + seed, 8));
        }
        CHECK(halved == 20);
        CHECK(corner == 20);
    }
    TEST_CASE("rare events on much ordinary light: pixels that have met too few look well known, and are no difference") {
        // Light of 1 with 1 % of noise; on it three events of 1/32 a pixel, in the mean of all replicates, or their expectation.
        const auto lit = [](uint64_t seed, double chance, float rest) {
            std::mt19937_64 random(seed);
            std::bernoulli_distribution event(chance);
            std::normal_distribution<float> noise(1, 0.01f);
            Replicates out(side, side);
            for (uint32_t r = 0; r < replicates; ++r) {
                Picture p{side, side, {}, {}, "lit", {}};
                for (uint32_t i = 0; i < side * side; ++i)
                    p.rgb.insert(p.rgb.end(), 3, noise(random) + rest + (event(random) ? 0.5f : 0.f));
                out.add(p);
            }
            return out;
        };
        constexpr double chance = 3. / replicates;
        int alarms = 0, blind = 0, halved = 0;
        const std::vector<uint8_t> none(36, 0);
        for (uint64_t seed = 1; seed <= 50; ++seed) {
            const Replicates rare = lit(seed, chance, 0), even = lit(1000 + seed, 0, float(0.5 * chance));
            alarms += wrong(rare, even) + wrong(even, rare);
            Evidence a = rare.evidence(none), b = even.evidence(none);
            a.events.clear();
            b.events.clear();
            blind += decide(a, b, {}).pixels.significant();
            halved += wrong(lit(2000 + seed, chance / 2, 0), even);
        }
        CHECK(alarms <= 1); // of 100 at 0.001
        CHECK(blind == 50); // without the height of events
        CHECK(halved == 50);
        const std::vector<double> heights = lit(1, chance, 0).evidence(none).events;
        for (const double h : heights) CHECK(h == doctest::Approx(0.5 / replicates * (1 - 2 * chance)).epsilon(0.3));
    }
    TEST_CASE("the floor is the height of an event times the mean") {
        Evidence a = rare(7, rate).evidence(std::vector<uint8_t>(36, 0)), b = even(8).evidence(std::vector<uint8_t>(36, 0));
        floorRareEvents(a, b);
        const double expected = std::sqrt(height / replicates * height * rate); // of a mean of 16 replicates
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            if (a.pixels[i].mean == 0) CHECK(a.pixels[i].error == doctest::Approx(expected).epsilon(0.15));
    }
} // TEST_SUITE
