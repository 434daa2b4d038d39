// The decision rule under simulated renders: replicates with skewed noise (sums of exponentials, as a path tracer's pixels), seeded.
#include "tools/judge/agreement.h"
#include "core/render/error.h"
#include "tests/judge/pictures.h"
#include "tools/judge/special.h"
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace chiaro::judge;
using chiaro::Rect, chiaro::judge::tests::constant, chiaro::judge::tests::make;

namespace {
// SplitMix64 (Steele et al. 2014), started at a mixed seed: neighbouring seeds must not be one stream, shifted.
class Random {
public:
    explicit Random(uint64_t seed) : state_(mixed(seed + 0x9e3779b97f4a7c15ull)) {}
    double uniform() { return (double(mixed(state_ += 0x9e3779b97f4a7c15ull) >> 11) + 0.5) * 0x1p-53; }

private:
    static uint64_t mixed(uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    uint64_t state_;
};

// One low-sample render: a lamp-lit ramp; each pixel the mean of two exponential samples (skewness 1.4), its channels sharing most of it.
// noise: relative standard deviation of a pixel; factor(x, y): what a faulty integrator multiplies by.
using Factor = double (*)(uint32_t x, uint32_t y);
double honest(uint32_t, uint32_t) { return 1; }

struct Design {
    uint32_t width = 48, height = 48, replicates = 16;
    double noise = 0.5;
};
Picture render(const Design& d, uint64_t seed, Factor factor) {
    Random random(seed);
    Picture p{d.width, d.height, {}, {}, "replicate", {}};
    p.rgb.reserve(p.pixels() * 3);
    const double scale = d.noise * std::sqrt(2.0);
    for (uint32_t y = 0; y < d.height; ++y)
        for (uint32_t x = 0; x < d.width; ++x) {
            const double level = (0.2 + 0.8 * x / d.width) * factor(x, y),
                         shared = -std::log(random.uniform()) - std::log(random.uniform());
            const double tint = 0.1 * d.noise * (random.uniform() - 0.5);
            const double noisy = 1 + scale * (shared / 2 - 1);
            p.rgb.push_back(float(level * (noisy + tint)));
            p.rgb.push_back(float(0.8 * level * noisy));
            p.rgb.push_back(float(0.5 * level * (noisy - tint)));
        }
    return p;
}
Replicates replicates(const Design& d, uint64_t seed, Factor factor = honest) {
    Replicates out(d.width, d.height);
    for (uint32_t r = 0; r < d.replicates; ++r) out.add(render(d, seed * 1000 + r, factor));
    return out;
}
AgreementSettings at(double alpha) {
    AgreementSettings s;
    s.alpha = alpha;
    return s;
}
bool alarm(const Agreement& a) { return a.verdict == Verdict::biased || a.verdict == Verdict::differs; }
} // namespace

TEST_SUITE("agreement") {
    TEST_CASE("path against path: 200 seeded comparisons") {
        const Design d;
        int alarms = 0, strict = 0;
        std::vector<double> luminanceP, red, tileP;
        for (uint64_t k = 0; k < 200; ++k) {
            const Replicates a = replicates(d, 2 * k), b = replicates(d, 2 * k + 1);
            const Agreement loose = agree(a, b, at(0.05));
            alarms += alarm(loose);
            strict += alarm(agree(a, b));
            luminanceP.push_back(loose.bias[0].test.p);
            red.push_back(loose.bias[1].test.p);
            tileP.push_back(loose.tiles.p);
            CHECK(loose.outliers <= 3 * loose.outlierBounds.high);
        }
        MESSAGE("false alarms at alpha 0.05: ", alarms, " of 200; at the default 1e-3: ", strict);
        MESSAGE("uniformity of p: luminance ", uniformity(luminanceP).p, ", red ", uniformity(red).p, ", tiles ", uniformity(tileP).p);
        CHECK(alarms >= 3);
        CHECK(alarms <= 19);
        CHECK(strict <= 2);
        CHECK(uniformity(luminanceP).p > 0.01);
        CHECK(uniformity(red).p > 0.01);
        CHECK(uniformity(tileP).p > 0.01);
    }

    TEST_CASE("power: a bias of the stated resolution is found, with sign and size") {
        Design d;
        d.replicates = 32;
        d.noise = 0.2;
        int found = 0, covered = 0;
        double resolution = 0;
        for (uint64_t k = 0; k < 40; ++k) {
            const Agreement a = agree(replicates(d, 7000 + 2 * k, [](uint32_t, uint32_t) { return 1.01; }), replicates(d, 7001 + 2 * k));
            found += a.verdict == Verdict::biased;
            covered += a.bias[0].interval.low <= 0.01 && 0.01 <= a.bias[0].interval.high;
            resolution = std::max(resolution, a.resolution);
            if (a.verdict == Verdict::biased) CHECK(a.bias[0].relative > 0);
        }
        MESSAGE("1 % bias found in ", found, " of 40, worst stated resolution ", resolution, ", interval holds it in ", covered);
        CHECK(resolution < 0.01);
        CHECK(found >= 39);   // power 0.99 at the resolution, more above it
        CHECK(covered >= 33); // 95 % of 40 is 38; P(< 33) = 1e-3
    }

    TEST_CASE("differences that cancel over the image are seen by the tiles, and where") {
        const Agreement a =
            agree(replicates(Design{}, 91, [](uint32_t x, uint32_t y) { return y < 8 && x < 16 ? (x < 8 ? 1.75 : 0.5) : 1.0; }),
                  replicates(Design{}, 92));
        CHECK(a.verdict == Verdict::differs);
        CHECK(a.tiles.rejected == 2);
        CHECK(a.tileZ[0] > 5);
        CHECK(a.tileZ[1] < -5);
        CHECK(std::abs(a.tileZ[6]) < 5);
        CHECK(describe(a).substr(0, 8) == "differs:");
    }

    TEST_CASE("a few wrong pixels are seen by the pixels") {
        Design d;
        d.noise = 0.1;
        const Agreement a =
            agree(replicates(d, 93, [](uint32_t x, uint32_t y) { return x % 8 == 4 && y == 20 ? (x < 24 ? 1.5 : 0.68) : 1.0; }),
                  replicates(d, 94));
        CHECK(alarm(a));
        CHECK(a.pixels.rejected >= 5);
        CHECK(a.outliers >= 6);
        CHECK(a.pixelZ[20 * 48 + 4] > 5);
    }

    TEST_CASE("one channel alone is enough") {
        const Design d;
        Replicates a(d.width, d.height);
        for (uint32_t r = 0; r < d.replicates; ++r) {
            Picture p = render(d, 95000 + r, honest);
            for (std::size_t i = 2; i < p.rgb.size(); i += 3) p.rgb[i] *= 1.15f;
            a.add(p);
        }
        const Agreement out = agree(a, replicates(d, 96));
        CHECK(out.verdict == Verdict::biased);
        CHECK(out.strongest == Mean::blue);
        CHECK(describe(out).find("(B,") != std::string::npos);
    }

    TEST_CASE("cannot tell yet: the stated number of samples is enough") {
        Design d;
        d.replicates = 8;
        d.noise = 2;
        AgreementSettings s;
        s.samplesPerReplicate = 4;
        const Agreement few = agree(replicates(d, 51), replicates(d, 52), s);
        CHECK(few.verdict == Verdict::cannotTell);
        CHECK(few.resolution > s.margin);
        REQUIRE(few.neededReplicates > 8);
        REQUIRE(few.neededReplicates < 4000);
        CHECK(std::abs(few.moreSamples - 4 * (few.neededReplicates - 8)) <= 4);
        CHECK(describe(few, s).substr(0, 15) == "cannot tell yet");
        d.replicates = uint32_t(std::ceil(1.3 * few.neededReplicates)); // 8 replicates know their own spread to 20 %
        const Agreement enough = agree(replicates(d, 53), replicates(d, 54), s);
        MESSAGE("8 replicates resolve ", few.resolution, ", ", d.replicates, " resolve ", enough.resolution);
        CHECK(enough.verdict == Verdict::agrees);
        CHECK(enough.moreSamples == 0);
        CHECK(enough.equivalenceP < 0.01);
        CHECK(describe(enough, s).substr(0, 7) == "agrees:");
    }

    TEST_CASE("deterministic and dark pictures") {
        Replicates fixed(16, 16), same(16, 16), off(16, 16), black(16, 16), light(16, 16);
        for (int r = 0; r < 4; ++r) {
            fixed.add(constant(16, 16, 0.3, 0.4, 0.5));
            same.add(constant(16, 16, 0.3 * (1 + 1e-7), 0.4, 0.5 * (1 - 1e-7)));
            off.add(constant(16, 16, 0.3, 0.4 * 1.0001, 0.5));
            black.add(constant(16, 16, 0, 0, 0));
            light.add(make(16, 16, [&](uint32_t x, uint32_t y, uint32_t) { return (x + y + uint32_t(r)) % 5 * 0.1; }));
        }
        CHECK(agree(fixed, same).verdict == Verdict::agrees);
        CHECK(agree(fixed, off).verdict == Verdict::biased);
        CHECK(agree(black, black).verdict == Verdict::agrees);
        CHECK(agree(black, black).tiles.tests == 0);
        const Agreement lit = agree(light, black);
        CHECK(lit.verdict == Verdict::biased);
        CHECK(std::isinf(lit.bias[0].relative));
        CHECK(describe(lit).find("the reference is black") != std::string::npos);
        const Agreement dark = agree(black, light);
        CHECK(dark.verdict == Verdict::biased);
        CHECK(std::abs(dark.bias[0].relative + 1) < 1e-9);
    }

    TEST_CASE("non-finite pixels leave their tile out, on both sides, and are counted") {
        const Design d;
        Replicates a(d.width, d.height), b = replicates(d, 62);
        for (uint32_t r = 0; r < d.replicates; ++r) {
            Picture p = render(d, 61000 + r, honest);
            if (r == 3) p.rgb[3 * (9 * 48 + 20)] = std::numeric_limits<float>::quiet_NaN();
            a.add(p);
        }
        const Agreement out = agree(a, b);
        CHECK(out.nonFinitePixels == 1);
        CHECK(out.tilesLeftOut == 1);
        CHECK(out.compared == 48 * 48 - 64);
        CHECK(std::isnan(out.tileZ[1 * 6 + 2]));
        CHECK(std::isnan(out.pixelZ[9 * 48 + 20]));
        CHECK_FALSE(alarm(out));
        CHECK(out.bias[0].test.p > 0);
    }

    TEST_CASE("regions, odd sizes, refusals") {
        Region left;
        left.crop = Rect{0, 0, 13, 11};
        Design d;
        d.width = 29;
        d.height = 19;
        Replicates a(29, 19, left), b(29, 19, left), all(29, 19);
        for (uint32_t r = 0; r < 8; ++r) {
            a.add(render(d, 700 + r, [](uint32_t x, uint32_t) { return x < 13 ? 1.0 : 3.0; })); // wrong only outside of the crop
            b.add(render(d, 800 + r, honest));
            all.add(render(d, 800 + r, honest));
        }
        const Agreement out = agree(a, b);
        CHECK_FALSE(alarm(out));
        CHECK(out.compared == 13 * 11);
        CHECK(out.tilesX == 4);
        CHECK(out.tilesY == 3);
        CHECK(std::isnan(out.tileZ[2]));
        CHECK(agree(all, all).tiles.tests == 12);
        Region none;
        none.mask.assign(29 * 19, 0);
        Replicates nothing(29, 19, none);
        nothing.add(render(d, 1, honest));
        nothing.add(render(d, 2, honest));
        CHECK(describe(agree(nothing, nothing)) == "cannot tell: no pixel to compare");
        Replicates single(29, 19), small(8, 8);
        single.add(render(d, 1, honest));
        CHECK_THROWS_AS(agree(single, all), chiaro::Error);
        CHECK_THROWS_AS(agree(small, all), chiaro::Error);
        CHECK_THROWS_AS(small.add(render(d, 1, honest)), chiaro::Error);
    }

    TEST_CASE("two pictures with error layers") {
        const auto picture = [](uint64_t seed, double bias) {
            Random random(seed);
            Picture p{64, 64, {}, {}, "picture", {}};
            for (std::size_t i = 0; i < p.pixels(); ++i) {
                const double z = normalQuantile(random.uniform());
                for (int c = 0; c < 3; ++c) {
                    p.rgb.push_back(float(bias * (1 + 0.05 * z)));
                    p.error.push_back(float(bias * 0.05));
                }
            }
            return p;
        };
        int alarms = 0;
        std::vector<double> p;
        for (uint64_t k = 0; k < 200; ++k) {
            const Agreement a = agree(picture(2 * k + 1, 1), picture(2 * k + 2, 1), {}, at(0.05));
            alarms += alarm(a);
            p.push_back(a.bias[0].test.p);
        }
        MESSAGE("two pictures: ", alarms, " false alarms of 200, uniformity ", uniformity(p).p);
        CHECK(alarms >= 3);
        CHECK(alarms <= 19);
        CHECK(uniformity(p).p > 0.01);
        const Agreement good = agree(picture(903, 1), picture(904, 1)), biased = agree(picture(903, 1.01), picture(904, 1));
        CHECK(good.verdict == Verdict::agrees);
        CHECK(biased.verdict == Verdict::biased);
        CHECK(std::abs(biased.bias[0].relative - 0.01) < 0.004);
        CHECK(describe(biased).substr(0, 10) == "biased by ");
        Picture bare = picture(1, 1), spoiled = picture(1, 1);
        bare.error.clear();
        spoiled.error[0] = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_AS(agree(bare, picture(2, 1)), chiaro::Error);
        CHECK(agree(spoiled, picture(2, 1)).tilesLeftOut == 1);
    }

    TEST_CASE("rare bright samples are no difference between two pictures with pooled errors") {
        // 16 samples a pixel, one in 300 of them 300 times as bright; errors as a film gives them: half-films, pooled over 8 x 8 pixels.
        const auto picture = [](uint64_t seed) {
            constexpr uint32_t size = 48, block = 8;
            Random random(seed);
            Picture p{size, size, {}, {}, "picture", {}};
            std::vector<double> squares(36, 0);
            for (uint32_t i = 0; i < size * size; ++i) {
                double half[2] = {};
                for (int n = 0; n < 16; ++n) half[n % 2] += -std::log(random.uniform()) * (random.uniform() < 1 / 300. ? 300 : 1) / 8;
                squares[i / size / block * 6 + i % size / block] += (half[0] - half[1]) * (half[0] - half[1]) / 4;
                for (int c = 0; c < 3; ++c) p.rgb.push_back(float((half[0] + half[1]) / 2));
            }
            for (uint32_t i = 0; i < size * size; ++i)
                for (int c = 0; c < 3; ++c)
                    p.error.push_back(float(std::sqrt(squares[i / size / block * 6 + i % size / block] / (block * block))));
            return p;
        };
        int alarms = 0;
        for (uint64_t k = 0; k < 200; ++k) alarms += alarm(agree(picture(5000 + 2 * k), picture(5001 + 2 * k), {}, at(0.05)));
        MESSAGE("rare bright samples: ", alarms, " false alarms of 200");
        CHECK(alarms <= 19);
    }

    TEST_CASE("false alarms follow alpha, down to the default: 3,000 comparisons") {
        int at5 = 0, at1000 = 0;
        std::vector<double> image;
        for (uint64_t k = 0; k < 3000; ++k) {
            Picture pair[2];
            for (uint64_t side = 0; side < 2; ++side) {
                Random random(40000 + 2 * k + side);
                Picture& p = pair[side] = Picture{24, 24, {}, {}, "picture", {}};
                for (std::size_t i = 0; i < p.pixels(); ++i)
                    for (int c = 0; c < 3; ++c) p.rgb.push_back(float(2 + normalQuantile(random.uniform())));
                p.error.assign(p.rgb.size(), 1.0f);
            }
            // Channels drawn apart: the luminance's own error is the root of the squares, not the sum that evidenceOf bounds it with.
            Evidence e[2];
            for (int side = 0; side < 2; ++side) {
                e[side] = evidenceOf(pair[side], {}, std::vector<uint8_t>(9, 0));
                const double share = std::sqrt(0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722);
                for (Estimate& v : e[side].pixels) v.error *= share;
                for (Estimate& v : e[side].tiles) v.error *= share;
                e[side].image[0].error *= share;
            }
            const Agreement loose = decide(e[0], e[1], at(0.05));
            at5 += alarm(loose);
            at1000 += alarm(decide(e[0], e[1], at(1e-3)));
        }
        MESSAGE("of 3,000: ", at5, " alarms at 0.05 (150 allowed on average), ", at1000, " at 1e-3 (3)");
        CHECK(at5 <= int(binomialBounds(3000, 0.05, 0.002).high));
        CHECK(at5 >= 90); // the split over three scales costs little
        CHECK(at1000 <= int(binomialBounds(3000, 1e-3, 0.002).high));
    }
}
