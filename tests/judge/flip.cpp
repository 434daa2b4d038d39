// FLIP against its authors' program (flip-evaluator 1.7 from PyPI, NVIDIA) on five pairs given by formulas: the means of its error maps, in
// double, and the value of one pixel. (The mean that the program prints is summed in float and differs by up to 4e-5 on constant pictures.)
#include "tools/judge/flip.h"
#include "core/render/error.h"
#include "tests/judge/pictures.h"
#include "tools/judge/flip_filters.h"
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numeric>
#include <string>

using namespace chiaro::judge;
using chiaro::judge::tests::constant, chiaro::judge::tests::make, chiaro::judge::tests::uniformAt;

namespace {
constexpr uint32_t width = 96, height = 64;
double u(uint32_t x) { return (x + 0.5) / width; }
double v(uint32_t y) { return (y + 0.5) / height; }
uint32_t at(uint32_t x, uint32_t y) { return y * width + x; }
double three(uint32_t c, double r, double g, double b) { return c == 0 ? r : c == 1 ? g : b; }

struct Pair {
    const char* name;
    Picture test, reference;
    double ldr, ldrPixel, hdr, hdrPixel, start, stop; // pixel: (40, 30)
    int exposures;
};

double checker(uint32_t x, uint32_t y, uint32_t c) {
    const double k = (x / 8 + y / 8) % 2;
    return three(c, 0.1 + 0.8 * k, 0.2 + 0.5 * k, 0.7 - 0.6 * k);
}
double ramp(uint32_t x, uint32_t y, uint32_t c) { return three(c, 0.3 * u(x) + 0.1, 0.25 * v(y) + 0.1, 0.2); }
double bright(uint32_t x, uint32_t y, uint32_t c) {
    const double g = 0.02 + 40 * std::pow(u(x), 8);
    return three(c, g, g * (0.5 + 0.5 * v(y)), g * 0.25);
}

std::vector<Pair> pairs() {
    std::vector<Pair> out;
    out.push_back({"gradient", make(width, height, [](auto x, auto y, auto c) { return three(c, 0.9 * u(x), v(y) * v(y), 1 - u(x)); }),
                   make(width, height, [](auto x, auto y, auto c) { return three(c, u(x), v(y), 1 - u(x)); }), 0.5564667, 0.6922195,
                   0.5643817, 0.6674163, 1.2012706, 2.0831349, 2});
    out.push_back({"noise", make(width, height, [](auto x, auto y, auto c) { return 0.25 + 0.5 * uniformAt(3 * at(x, y) + c); }),
                   constant(width, height, 0.5, 0.5, 0.5), 0.2109395, 0.2073895, 0.1084400, 0.1278879, 2.0832973, 2.0832973, 2});
    out.push_back({"checkers", make(width, height, [](auto x, auto y, auto c) { return checker(x + 1, y, c); }),
                   make(width, height, checker), 0.2825079, 0.4599414, 0.2136481, 0.3184676, 1.5995203, 1.5995203, 2});
    out.push_back({"fireflies",
                   make(width, height, [](auto x, auto y, auto c) { return uniformAt(at(x, y) + 100000) < 0.01 ? 1.0 : ramp(x, y, c); }),
                   make(width, height, ramp), 0.0570973, 0.0084899, 0.0198877, 0.0035726, 2.6058440, 3.2129147, 2});
    out.push_back({"hdr",
                   make(width, height,
                        [](auto x, auto y, auto c) {
                            const double n = 0.7 + 0.6 * uniformAt(at(x, y) + 777);
                            return bright(x, y, c) * three(c, n, n, 1.1);
                        }),
                   make(width, height, bright), 0.0684330, 0.0571219, 0.1616281, 0.1628856, -4.0945292, 3.9899096, 9});
    return out;
}
double decoded(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
} // namespace

TEST_SUITE("flip") {
    TEST_CASE("five pairs agree with the authors' program") {
        for (const Pair& p : pairs()) {
            CAPTURE(std::string(p.name));
            const FlipResult ldr = flipLdr(p.test, p.reference), hdr = flipHdr(p.test, p.reference);
            MESSAGE(std::string(p.name), ": LDR off by ", ldr.mean - p.ldr, ", HDR off by ", hdr.mean - p.hdr);
            CHECK(std::abs(ldr.mean - p.ldr) < 1e-4);
            CHECK(std::abs(ldr.map[at(40, 30)] - p.ldrPixel) < 1e-4);
            CHECK(std::abs(hdr.mean - p.hdr) < 1e-4);
            CHECK(std::abs(hdr.map[at(40, 30)] - p.hdrPixel) < 1e-4);
            CHECK(std::abs(hdr.startExposure - p.start) < 1e-5);
            CHECK(std::abs(hdr.stopExposure - p.stop) < 1e-5);
            CHECK(hdr.exposures == p.exposures);
        }
    }

    TEST_CASE("constant pictures: row K8") {
        const auto flip = [](double r0, double g0, double b0, double r1, double g1, double b1) {
            return flipLdr(constant(40, 30, decoded(r0), decoded(g0), decoded(b0)), constant(40, 30, decoded(r1), decoded(g1), decoded(b1)))
                .mean;
        };
        CHECK(std::abs(flip(0, 0, 0, 1, 1, 1) - 0.9673798) < 1e-6);
        CHECK(std::abs(flip(1, 0, 0, 0, 1, 0) - 0.9866623) < 1e-6);
        CHECK(std::abs(flip(0, 0, 0, 0.5, 0.5, 0.5) - 0.9314961) < 1e-6);
        CHECK(std::abs(flip(0.5, 0.5, 0.5, 0.55, 0.55, 0.55) - 0.1764611) < 1e-6);
        CHECK(std::abs(flip(0, 1, 0, 0, 0, 1) - 1) < 1e-6);
        CHECK(flip(0.3, 0.4, 0.5, 0.3, 0.4, 0.5) == 0);
    }

    TEST_CASE("filters: sizes, sums, separability") {
        const ContrastKernels c = contrastKernels(67.0206);
        const FeatureKernels f = featureKernels(67.0206);
        const auto sum = [](const Kernel& k) { return std::accumulate(k.begin(), k.end(), 0.0); };
        CHECK(c.achromatic.size() == 21); // radius ceil(3 sqrt(0.04/(2 pi^2)) 67) = 10 of the verification notes, 3.7
        CHECK(f.edge.size() == 19);       // radius ceil(3 0.5 0.082 67) = 9
        CHECK(std::abs(sum(c.achromatic) - 1) < 1e-6);
        CHECK(std::abs(sum(c.redGreen) - 1) < 1e-6);
        CHECK(std::abs(std::pow(sum(c.blueYellow[0]), 2) + std::pow(sum(c.blueYellow[1]), 2) - 1) < 1e-6);
        CHECK(std::abs(sum(f.edge)) < 1e-6);
        CHECK(std::abs(sum(f.point)) < 1e-6);
        double positive = 0;
        for (const float w : f.point) positive += std::max(0.0f, w);
        CHECK(std::abs(positive - 1) < 1e-6);
        Plane one(31 * 31, 0.0f);
        one[15 * 31 + 15] = 1;
        const Plane spread = filterColumns(filterRows(one, 31, 31, f.gauss), 31, 31, f.gauss);
        CHECK(std::abs(spread[15 * 31 + 18] - f.gauss[9] * f.gauss[12]) < 1e-8);
        CHECK(std::abs(std::accumulate(spread.begin(), spread.end(), 0.0) - 1) < 1e-6);
        const Plane flat(7 * 5, 0.25f); // smaller than the filter: the border repeats
        for (const float x : filterColumns(filterRows(flat, 7, 5, f.gauss), 7, 5, f.gauss)) CHECK(std::abs(x - 0.25f) < 1e-6f);
    }

    TEST_CASE("defined answers") {
        const Picture black = constant(20, 10, 0, 0, 0), lamp = make(20, 10, [](auto x, auto, auto) { return x == 3 ? 5.0 : 0.0; });
        CHECK(flipHdr(black, black).mean == 0);
        CHECK(flipHdr(lamp, lamp).mean == 0);
        const double missing = flipHdr(black, lamp).mean, added = flipHdr(lamp, black).mean; // a median of 0, and a black reference
        CHECK(missing > 0.05);
        CHECK(missing < 1);
        CHECK(added > 0.05);
        Picture broken = lamp;
        broken.rgb[0] = std::numeric_limits<float>::quiet_NaN();
        broken.rgb[1] = std::numeric_limits<float>::infinity();
        broken.rgb[2] = -7;
        CHECK(std::isfinite(flipHdr(broken, lamp).mean));
        CHECK(std::isfinite(flipLdr(broken, lamp).mean));
        CHECK(flipLdr(black, lamp, std::vector<uint8_t>(200, 1)).mean == flipLdr(black, lamp).mean);
        CHECK(std::isnan(flipLdr(black, lamp, std::vector<uint8_t>(200, 0)).mean));
        CHECK(std::isnan(flipHdr(constant(0, 0, 0, 0, 0), constant(0, 0, 0, 0, 0)).mean));
        CHECK(flipLdr(constant(1, 1, 0, 0, 0), constant(1, 1, 1, 1, 1)).mean > 0.9);
        CHECK_THROWS_AS(flipLdr(black, constant(10, 20, 0, 0, 0)), chiaro::Error);
        FlipSettings odd;
        odd.startExposure = 3;
        odd.stopExposure = 1;
        CHECK_THROWS_AS(flipHdr(lamp, lamp, {}, odd), chiaro::Error);
        odd = {};
        odd.pixelsPerDegree = 0;
        CHECK_THROWS_AS(flipLdr(lamp, lamp, {}, odd), chiaro::Error);
        odd = {};
        odd.startExposure = -2;
        odd.stopExposure = 2;
        odd.exposures = 3;
        const FlipResult given = flipHdr(black, lamp, {}, odd);
        CHECK(given.exposures == 3);
        for (const float e : given.exposureMap) CHECK((e == -2 || e == 0 || e == 2));
    }
}
