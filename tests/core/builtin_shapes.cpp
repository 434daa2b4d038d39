// The shapes of which the built-in scenes are made: counts, areas, sides, and how far a tessellated sphere is from the true one.
#include "scenes/shapes.h"
#include <cmath>
#include <doctest/doctest.h>
#include <numbers>

using namespace chiaro;
using namespace chiaro::shapes;

namespace {

double volume(const PrimitiveDesc& p) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return cast<double>(p.positions[p.indices[i + k]]); };
        sum += dot(at(0), cross(at(1), at(2)));
    }
    return sum / 6;
}

} // namespace

TEST_SUITE("builtin shapes") {

    TEST_CASE("spheres: Euler's formula, exact normals, inscribed within the bound") {
        for (int level = 0; level <= 5; ++level) {
            CAPTURE(level);
            const PrimitiveDesc p = sphere(2, level);
            const std::size_t faces = 20u << (2 * level);
            CHECK(p.indices.size() == 3 * faces);
            CHECK(p.positions.size() == faces / 2 + 2); // V - E + F = 2 with E = 3 F / 2
            double depth = 0;
            for (std::size_t i = 0; i < p.positions.size(); ++i) CHECK(length(p.positions[i] - p.normals[i] * 2) < 1e-6f);
            for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
                const auto at = [&](std::size_t k) { return cast<double>(p.positions[p.indices[i + k]]); };
                const Vec3d n = normalize(cross(at(1) - at(0), at(2) - at(0)));
                depth = std::max(depth, 1 - dot(n, at(0)) / 2);
            }
            CHECK(depth < 0.3 / double(1 << (2 * level)));
            CHECK(depth > 0.2 / double(1 << (2 * level)));
        }
        CHECK(area(sphere(1, 5)) == doctest::Approx(4 * std::numbers::pi).epsilon(1e-3));
    }

    TEST_CASE("areas and volumes") {
        CHECK(area(quad({0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0})) == doctest::Approx(6));
        CHECK(area(box({1, 2, 3})) == doctest::Approx(88));
        CHECK(volume(box({1, 2, 3})) == doctest::Approx(48));
        CHECK(volume(insideOut(box({1, 2, 3}))) == doctest::Approx(-48));
        CHECK(volume(insideOut(sphere(1, 2))) < 0);
        // A regular polygon: n r^2 sin(2 pi / n) / 2.
        CHECK(area(disc(3, 12)) == doctest::Approx(12 * 9 * std::sin(std::numbers::pi / 6) / 2));
    }

    TEST_CASE("fronts look where the comments say") {
        const auto front = [](const PrimitiveDesc& p) {
            const auto at = [&](std::size_t k) { return cast<double>(p.positions[p.indices[k]]); };
            return normalize(cross(at(1) - at(0), at(2) - at(0)));
        };
        CHECK(length(front(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0})) - Vec3d{0, 0, 1}) < 1e-12);
        CHECK(length(front(disc(1, 7)) - Vec3d{0, 1, 0}) < 1e-12);
        CHECK(length(front(insideOut(disc(1, 7))) - Vec3d{0, -1, 0}) < 1e-12);
        const PrimitiveDesc ball = insideOut(sphere(1, 1));
        CHECK(dot(front(ball), cast<double>(ball.normals[ball.indices[0]])) > 0);
        const PrimitiveDesc both = joined(box({1, 1, 1}), disc(1, 5));
        CHECK(both.positions.size() == 24 + 6);
        CHECK(both.indices.back() < both.positions.size());
    }

    TEST_CASE("lookAt: a rigid frame that looks along -Z") {
        const Vec3d eye{1, 2, 3}, target{-4, 0, 2};
        const Affine m = lookAt(eye, target);
        CHECK(m.determinant() == doctest::Approx(1).epsilon(1e-14));
        CHECK(length(m.vector({0, 0, -1}) - normalize(target - eye)) < 1e-14);
        CHECK(length(m.point({0, 0, 0}) - eye) < 1e-14);
        CHECK(m.vector({0, 1, 0}).y > 0);
        CHECK(m.vector({1, 0, 0}).y == doctest::Approx(0));
    }

} // TEST_SUITE
