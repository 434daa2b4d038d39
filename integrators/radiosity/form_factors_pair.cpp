#include "integrators/radiosity/form_factors_pair.h"
#include "core/render/fault.h"
#include "integrators/radiosity/form_factors_polygon.h"
#include <numbers>
#include <tuple>

namespace chiaro::radiosity {
namespace {

// Distances over the longest edge from which the rules err by less than 1e-6: those of quadrilaterals are symmetric and gain two orders.
constexpr double farEnough = 5, farTriangle = 7, veryFar = 20, veryFarTriangle = 60;

Polygon polygonOf(const Patch& p) noexcept {
    Polygon q;
    for (uint32_t k = 0; k < p.corners; ++k) q.add(cast<double>(p.corner[k]));
    return q;
}

enum class Position : uint8_t { behind, across, before };
// Of the corners of p, against the plane of another.
Position positionOf(const Patch& p, const Patch& plane) noexcept {
    uint32_t before = 0;
    bool clear = true;
    for (uint32_t k = 0; k < p.corners; ++k) {
        const float height = dot(p.corner[k] - plane.corner[0], plane.normal);
        before += height > plane.error;
        clear = clear && height > 0;
    }
    return before == 0 ? Position::behind : before == p.corners && clear ? Position::before : Position::across;
}

// Points of a patch with their shares of its area.
struct Nodes {
    std::array<double, 9> x, y, z, weight;
    uint32_t n = 0;
    void add(const Vec3d& p, double w) noexcept { x[n] = p.x, y[n] = p.y, z[n] = p.z, weight[n++] = w; }
};

Nodes ofQuadrilateral(const Patch& p, bool few) noexcept {
    const Vec3d o = cast<double>(p.corner[0]), s = cast<double>(p.corner[1]) - o, t = cast<double>(p.corner[3]) - o,
                twist = cast<double>(p.corner[2]) - o - s - t;
    const double two = 0.5 / std::sqrt(3), three = 0.5 * std::sqrt(0.6);
    const std::array<double, 3> at = few ? std::array{0.5 - two, 0.5 + two, 0.0} : std::array{0.5 - three, 0.5, 0.5 + three};
    const std::array<double, 3> share = few ? std::array{0.5, 0.5, 0.0} : std::array{5 / 18.0, 8 / 18.0, 5 / 18.0};
    Nodes nodes;
    for (std::size_t j = 0; j < (few ? 2u : 3u); ++j)
        for (std::size_t i = 0; i < (few ? 2u : 3u); ++i) {
            const Vec3d alongS = s + twist * at[j], alongT = t + twist * at[i];
            nodes.add(o + alongS * at[i] + t * at[j], share[i] * share[j] * length(cross(alongS, alongT)));
        }
    return nodes;
}

// Exact to degree 2 with three points, to degree 4 with six (Dunavant 1985).
Nodes ofTriangle(const Patch& p, bool few) noexcept {
    const Vec3d a = cast<double>(p.corner[0]), b = cast<double>(p.corner[1]), c = cast<double>(p.corner[2]);
    const double area = length(cross(b - a, c - a)) / 2;
    Nodes nodes;
    const auto orbit = [&](double first, double share) {
        const double rest = (1 - first) / 2;
        nodes.add(a * first + (b + c) * rest, share * area);
        nodes.add(b * first + (c + a) * rest, share * area);
        nodes.add(c * first + (a + b) * rest, share * area);
    };
    if (few) {
        orbit(2 / 3.0, 1 / 3.0);
    } else {
        orbit(0.108103018168070, 0.223381589678011);
        orbit(0.816847572980459, 0.109951743655322);
    }
    return nodes;
}
Nodes nodesOf(const Patch& p, bool few) noexcept { return p.corners == 3 ? ofTriangle(p, few) : ofQuadrilateral(p, few); }

double meanKernel(const Nodes& a, const Vec3d& na, const Nodes& b, const Vec3d& nb) noexcept {
    double sum = 0;
    for (uint32_t i = 0; i < a.n; ++i) {
        double from = 0;
        for (uint32_t j = 0; j < b.n; ++j) {
            const double x = b.x[j] - a.x[i], y = b.y[j] - a.y[i], z = b.z[j] - a.z[i], r2 = x * x + y * y + z * z;
            const double cosines = -(x * na.x + y * na.y + z * na.z) * (x * nb.x + y * nb.y + z * nb.z);
            from += b.weight[j] * cosines / (r2 * r2);
        }
        sum += a.weight[i] * from;
    }
    return sum / std::numbers::pi;
}

// From its corners: a float normal is off by enough to matter at grazing angles.
Vec3d normalOf(const Patch& p) noexcept {
    const Vec3d a = cast<double>(p.corner[0]), b = cast<double>(p.corner[1]), c = cast<double>(p.corner[2]);
    return normalize(p.corners == 3 ? cross(b - a, c - a) : cross(c - a, cast<double>(p.corner[3]) - b));
}

double longestEdge2(const Patch& p) noexcept {
    float l = 0;
    for (uint32_t k = 0; k < p.corners; ++k) l = max(l, lengthSquared(p.corner[(k + 1) % p.corners] - p.corner[k]));
    return double(l);
}

} // namespace

double polygonExchange(const Patch& p, const Patch& q) noexcept {
    const auto order = [](const Patch& x) { return std::tuple(x.centre.x, x.centre.y, x.centre.z, x.normal.x, x.normal.y, x.normal.z); };
    const bool swapped = order(q) < order(p);
    const Patch &a = swapped ? q : p, &b = swapped ? p : q;
    const Position ab = positionOf(a, b), ba = positionOf(b, a);
    const bool whole = ab == Position::before && ba == Position::before;
    if ((ab == Position::behind || ba == Position::behind) && !fault(Fault::formFactorHorizon)) return 0;
    const Vec3d na = normalOf(a), nb = normalOf(b);
    const double edge2 = std::max(longestEdge2(a), longestEdge2(b)), distance2 = double(lengthSquared(b.centre - a.centre));
    const bool triangle = a.corners == 3 || b.corners == 3;
    const auto beyond = [&](double edges) { return distance2 > edge2 * (edges * edges); };
    if (whole && beyond(triangle ? farTriangle : farEnough)) {
        const bool few = beyond(triangle ? veryFarTriangle : veryFar);
        return std::max(meanKernel(nodesOf(a, few), na, nodesOf(b, few), nb), 0.0);
    }
    return exchangeArea(polygonOf(a).all(), na, polygonOf(b).all(), nb);
}

} // namespace chiaro::radiosity
