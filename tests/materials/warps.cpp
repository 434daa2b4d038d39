// Warps against their densities: chi-square on grids, first moments, inverses; densities converted between measures.
#include "core/math/warp.h"
#include "tests/statistics.h"
#include <doctest/doctest.h>

using namespace chiaro;
using doctest::Approx;

namespace {

constexpr int samples = 1'000'000;

// Samples by cos and phi against a density of the cosine alone, 20 x 40 cells.
template <class Warp, class Pdf> double sphereP(const Warp& warp, const Pdf& pdfOfCos, double lowest) {
    constexpr int rows = 20, columns = 40, sub = 64;
    std::vector<double> seen(rows * columns), due(rows * columns);
    stats::Random u(11);
    for (int i = 0; i < samples; ++i) {
        const float x = u(), y = u();
        const Vec3 w = warp(Point2{x, y});
        const double phi = std::atan2(double(w.y), double(w.x)) / (2 * std::numbers::pi), z = (double(w.z) - lowest) / (1 - lowest);
        seen[std::size_t(std::clamp(int(z * rows), 0, rows - 1) * columns +
                         std::clamp(int((phi < 0 ? phi + 1 : phi) * columns), 0, columns - 1))]++;
    }
    for (int r = 0; r < rows; ++r)
        for (int k = 0; k < sub; ++k) {
            const double z = lowest + (1 - lowest) * (r + (k + 0.5) / sub) / rows,
                         area = (1 - lowest) / rows / sub * 2 * std::numbers::pi / columns;
            for (int c = 0; c < columns; ++c) due[std::size_t(r * columns + c)] += samples * pdfOfCos(z) * area;
        }
    return stats::chiSquare(seen, due).p;
}

} // namespace

TEST_SUITE("warps") {
    TEST_CASE("the statistics' own numbers") {
        CHECK(stats::chiSquareP(18.307, 10) == Approx(.05).epsilon(1e-4));
        CHECK(stats::chiSquareP(3.841459, 1) == Approx(.05).epsilon(1e-6));
        CHECK(stats::chiSquareP(1000, 1000) == Approx(.494053).epsilon(1e-4));
        CHECK(stats::normalP(1.959964) == Approx(.05).epsilon(1e-6));
        CHECK(stats::studentP(2.228139, 10) == Approx(.05).epsilon(1e-6));
        CHECK(stats::studentP(5.51, 31) == Approx(5e-6).epsilon(.02));
        CHECK(stats::sidak(1000) == Approx(1.0005e-6).epsilon(1e-4));
    }
    TEST_CASE("chi-square of every warp") {
        const double level = stats::sidak(7);
        CHECK(sphereP([](Point2 u) { return cosineHemisphere(u); }, [](double z) { return cosineHemispherePdfW(z); }, 0) > level);
        CHECK(sphereP([](Point2 u) { return uniformHemisphere(u); }, [](double) { return uniformHemispherePdfW<double>(); }, 0) > level);
        CHECK(sphereP([](Point2 u) { return uniformSphere(u); }, [](double) { return uniformSpherePdfW<double>(); }, -1) > level);
        CHECK(sphereP([](Point2 u) { return uniformCone(u, 0.25f); }, [](double) { return uniformConePdfW(0.25); }, 0.75) > level);
        CHECK(sphereP( // the disk, its area spread over r^2 and phi
                  [](Point2 u) {
                      const Point2 d = concentricDisk(u);
                      return Vec3{d.x, d.y, d.x * d.x + d.y * d.y};
                  },
                  [](double) { return concentricDiskPdfA<double>() / 2; }, 0) > level);
        std::vector<double> seen(200), due(200);
        stats::Random u(3);
        constexpr int n = 10; // small triangles of equal area: (i, j) upright or inverted
        for (int i = 0; i < samples; ++i) {
            const float x = u(), y = u();
            const Point2 b = uniformTriangle(Point2{x, y});
            REQUIRE((b.x >= 0 && b.y >= 0 && b.x + b.y <= 1.000001f));
            const float p = b.x * n, q = b.y * n;
            const int k = std::min(int(p), n - 1), l = std::min(int(q), n - 1);
            seen[std::size_t((k * n + l) * 2 + (p - float(k) + q - float(l) > 1))]++;
        }
        for (int k = 0; k < n; ++k)
            for (int l = 0; l < n; ++l)
                for (int inverted = 0; inverted < 2; ++inverted)
                    due[std::size_t((k * n + l) * 2 + inverted)] = k + l + inverted < n ? samples / double(n * n) : 0;
        CHECK(stats::chiSquare(seen, due).p > level);
    }
    TEST_CASE("first moments") {
        stats::Random u(5);
        stats::Moments b1, b2, square, hemisphere, cosine, radius;
        for (int i = 0; i < samples; ++i) {
            const float x = u(), y = u();
            const Point2 p{x, y}, b = uniformTriangle(p), d = concentricDisk(p);
            b1.add(double(b.x)), b2.add(double(b.y)), square.add(double(b.x) * double(b.x));
            hemisphere.add(double(uniformHemisphere(p).z));
            cosine.add(double(cosineHemisphere(p).z));
            radius.add(std::hypot(double(d.x), double(d.y)));
        }
        const auto z = [](const stats::Moments& m, double truth) { return stats::normalP((m.mean - truth) / m.error()); };
        const double level = stats::sidak(6);
        CHECK(z(b1, 1.0 / 3) > level);
        CHECK(z(b2, 1.0 / 3) > level);
        CHECK(z(square, 1.0 / 6) > level);
        CHECK(z(hemisphere, 0.5) > level);
        CHECK(z(cosine, 2.0 / 3) > level);
        CHECK(z(radius, 2.0 / 3) > level);
    }
    TEST_CASE("inverses and corners") {
        stats::Random u(7);
        for (int i = 0; i < 20000; ++i) {
            const float x = u(), y = u();
            const Point2 a = concentricDiskInverse(concentricDisk(Point2{x, y}));
            const Point2 b = uniformConeInverse(uniformCone(Point2{x, y}, 0.3f), 0.3f);
            CHECK(double(a.x) == Approx(double(x)).epsilon(1e-5));
            CHECK(double(a.y) == Approx(double(y)).epsilon(1e-5));
            CHECK(double(b.x) == Approx(double(x)).epsilon(1e-4));
            CHECK(std::min(std::fabs(b.y - y), 1 - std::fabs(b.y - y)) < 1e-5f);
        }
        for (float x : {0.f, 0.5f, oneMinusEpsilon})
            for (float y : {0.f, 0.5f, oneMinusEpsilon}) {
                const Vec3 w = cosineHemisphere(Point2{x, y}), s = uniformSphere(Point2{x, y});
                CHECK((finite(w) && w.z >= 0 && std::fabs(length(w) - 1) < 1e-6f));
                CHECK((finite(s) && std::fabs(length(s) - 1) < 1e-6f));
            }
    }
    TEST_CASE("densities between measures") {
        CHECK(areaToSolidAngle(1 / .25, 4., .5) == Approx(32));
        CHECK(solidAngleToArea(32., 4., .5) == Approx(4));
        CHECK(uniformConePdfW(coneOfSphere(.25)) == Approx(1.187948668).epsilon(1e-9));
        CHECK(balanceHeuristic(2., .5) == Approx(.8));
        CHECK(powerHeuristic(2., .5) == Approx(16.0 / 17));
        CHECK(powerHeuristic(1e30f, 1.f) == 1);
        CHECK(powerHeuristic(1.f, 1e30f) == 0);
    }
}
