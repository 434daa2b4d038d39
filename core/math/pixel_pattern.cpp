#include "core/math/pixel_pattern.h"
#include "core/math/sampler.h"
#include "core/render/error.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro {
namespace {

double toroidalSquared(Point2 a, Point2 b) noexcept {
    const double x = std::fabs(double(a.x) - double(b.x)), y = std::fabs(double(a.y) - double(b.y));
    return sqr(min(x, 1 - x)) + sqr(min(y, 1 - y));
}

void checkSize(uint64_t points) {
    if (points == 0 || points > mostPatternPoints)
        throw Error(Exit::usage, fmt::format("a pixel pattern has 1 to {} points, not {}", mostPatternPoints, points));
}

// Dart throwing (Cook 1986). Where no more darts fit in reasonable time the distance gives way a little (McCool and Fiume, Hierarchical
// Poisson Disk Sampling Distributions, 1992): a pattern must have just so many points. Plain darts jam near 0.777 of the densest distance.
std::vector<Point2> throwDarts(uint32_t count, uint64_t seed) {
    const uint64_t patience = 1024 + 64 * uint64_t(count);
    double distance = 0.75 * densestDistance(count);
    std::vector<Point2> points;
    points.reserve(count);
    for (uint64_t dart = 1; points.size() < count; ++dart) {
        const uint64_t bits = hashCombine(seed, dart);
        const Point2 p{float(bits >> 40) * 0x1p-24f, float(bits & 0xffffff) * 0x1p-24f};
        const auto near = [p, limit = distance * distance](Point2 q) { return toroidalSquared(p, q) < limit; };
        if (std::none_of(points.begin(), points.end(), near)) points.push_back(p);
        if (dart % patience == 0) distance *= 0.98;
    }
    return points;
}

// Farthest point first (Gonzalez 1985): the next is the one that is farthest from all before it.
void spreadPrefixes(std::vector<Point2>& points) {
    std::vector<double> nearest(points.size(), 2);
    for (std::size_t i = 1; i < points.size(); ++i) {
        std::size_t best = i;
        for (std::size_t k = i; k < points.size(); ++k) {
            nearest[k] = min(nearest[k], toroidalSquared(points[k], points[i - 1]));
            if (nearest[k] > nearest[best]) best = k;
        }
        std::swap(points[i], points[best]);
        std::swap(nearest[i], nearest[best]);
    }
}

} // namespace

std::vector<Point2> gridPattern(uint32_t n) {
    checkSize(uint64_t(n) * n);
    std::vector<Point2> points;
    points.reserve(std::size_t(n) * n);
    for (uint32_t y = 0; y < n; ++y)
        for (uint32_t x = 0; x < n; ++x) points.push_back({(float(x) + 0.5f) / float(n), (float(y) + 0.5f) / float(n)});
    return points;
}

std::vector<Point2> poissonPattern(uint32_t count, uint64_t seed) {
    checkSize(count);
    std::vector<Point2> points = throwDarts(count, seed);
    spreadPrefixes(points);
    return points;
}

double minimumDistance(std::span<const Point2> pattern) noexcept {
    double least = 1;
    for (std::size_t i = 0; i < pattern.size(); ++i)
        for (std::size_t k = i + 1; k < pattern.size(); ++k) least = min(least, toroidalSquared(pattern[i], pattern[k]));
    return std::sqrt(least);
}

double densestDistance(std::size_t points) noexcept { return std::sqrt(2 / (std::sqrt(3.0) * double(points))); }

} // namespace chiaro
