#include "tools/bake/chart.h"
#include "core/math/sampler.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace chiaro::bake {
namespace {

using Triangle2 = std::array<Point2, 3>;
constexpr float cone = 0.766f;     // cosine of 40 degrees
constexpr float crease = 0.99985f; // of 1 degree
constexpr uint32_t noNeighbour = ~0u;

// Along a chart of so many triangles, to see whether it overlaps itself.
uint32_t foldCells(std::size_t triangles) { return uint32_t(std::min(256.0, 32 + 8 * std::sqrt(double(triangles)))); }

struct PositionHash {
    std::size_t operator()(const std::array<uint32_t, 3>& p) const noexcept { return hashCombine(hashCombine(p[0], p[1]), p[2]); }
};
// Corners at the same place are one, whatever their normals and texture coordinates.
class Welder {
public:
    uint32_t number(const Vec3& p) {
        std::array<uint32_t, 3> bits;
        const float clean[3] = {p.x + 0.f, p.y + 0.f, p.z + 0.f}; // -0 is 0
        std::memcpy(bits.data(), clean, sizeof bits);
        return numbers_.try_emplace(bits, uint32_t(numbers_.size())).first->second;
    }

private:
    std::unordered_map<std::array<uint32_t, 3>, uint32_t, PositionHash> numbers_;
};

struct Surface {
    std::vector<std::array<Vec3, 3>> corners;
    std::vector<Vec3> normals; // zero: without area
    std::vector<std::array<uint32_t, 3>> neighbours;
};

Surface surfaceOf(const Scene& scene, const DrawnPart& part, float time) {
    Surface s;
    Welder welder;
    struct Edge {
        uint32_t from, to, triangle, side;
    };
    std::vector<Edge> edges;
    for (uint32_t t = 0; t < part.triangles; ++t) {
        const auto c = scene.corners(part, t, time);
        const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
        const float twice = length(n);
        s.corners.push_back(c);
        s.normals.push_back(twice > 0 && std::isfinite(1 / twice) ? n * (1 / twice) : Vec3{});
        s.neighbours.push_back({noNeighbour, noNeighbour, noNeighbour});
        if (s.normals.back() == Vec3{}) continue;
        const uint32_t v[3] = {welder.number(c[0]), welder.number(c[1]), welder.number(c[2])};
        for (uint32_t k = 0; k < 3; ++k) edges.push_back({std::min(v[k], v[(k + 1) % 3]), std::max(v[k], v[(k + 1) % 3]), t, k});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.from, a.to, a.triangle, a.side) < std::tie(b.from, b.to, b.triangle, b.side);
    });
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) { // an edge of more than two triangles joins them in pairs
        const Edge &a = edges[i], &b = edges[i + 1];
        if (a.from != b.from || a.to != b.to || a.triangle == b.triangle) continue;
        s.neighbours[a.triangle][a.side] = b.triangle;
        s.neighbours[b.triangle][b.side] = a.triangle;
        ++i;
    }
    return s;
}

// The rotation of points in the plane whose bounding box is smallest: one side of it lies along an edge of the hull (Freeman and Shapira
// 1975); the edges of the outline are enough here, 16 of them, the longest.
void turnUpright(std::vector<Triangle2>& triangles) {
    struct Side {
        float length, x, y;
    };
    std::vector<Side> sides;
    for (const Triangle2& t : triangles)
        for (int k = 0; k < 3; ++k) {
            const float dx = t[(k + 1) % 3].x - t[k].x, dy = t[(k + 1) % 3].y - t[k].y, l = std::hypot(dx, dy);
            if (l > 0) sides.push_back({l, dx / l, dy / l});
        }
    const std::size_t tried = std::min<std::size_t>(16, sides.size());
    std::partial_sort(sides.begin(), sides.begin() + std::ptrdiff_t(tried), sides.end(),
                      [](const Side& a, const Side& b) { return std::tie(b.length, a.x, a.y) < std::tie(a.length, b.x, b.y); });
    const auto box = [&](const Side& s) {
        float x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity;
        for (const Triangle2& t : triangles)
            for (const Point2& p : t) {
                const float x = p.x * s.x + p.y * s.y, y = p.y * s.x - p.x * s.y;
                x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
            }
        return std::pair{x1 - x0, y1 - y0};
    };
    Side best{0, 1, 0};
    float least = infinity;
    for (std::size_t i = 0; i < tried; ++i) {
        const auto [w, h] = box(sides[i]);
        if (w * h < least * 0.999f) least = w * h, best = sides[i];
    }
    const auto [w, h] = box(best);
    if (h > w) best = {0, -best.y, best.x}; // lying: rows of equal height pack well
    for (Triangle2& t : triangles)
        for (Point2& p : t) p = {p.x * best.x + p.y * best.y, p.y * best.x - p.x * best.y};
}

std::vector<Triangle2> projected(const Surface& s, const std::vector<uint32_t>& triangles, const Vec3& axis) {
    const Frame frame = Frame::about(axis);
    const Vec3 origin = s.corners[triangles.front()][0];
    std::vector<Triangle2> flat;
    for (const uint32_t t : triangles) {
        Triangle2 c;
        for (int k = 0; k < 3; ++k) {
            const Vec3 d = s.corners[t][k] - origin;
            c[k] = {dot(d, frame.x), dot(d, frame.y)};
        }
        flat.push_back(c);
    }
    return flat;
}

class Grower {
public:
    Grower(const Surface& s, uint32_t part) : s_(s), part_(part), group_(s.normals.size(), 0) {}
    void grow(const std::vector<uint32_t>& among, float limit, std::vector<Chart>& to) {
        const uint32_t open = ++groups_;
        for (const uint32_t t : among) group_[t] = open;
        for (const uint32_t seed : among) {
            if (group_[seed] != open) continue;
            const uint32_t own = ++groups_;
            std::vector<uint32_t> found{seed};
            group_[seed] = own;
            for (std::size_t i = 0; i < found.size() && limit < 1; ++i)
                for (const uint32_t next : s_.neighbours[found[i]])
                    if (next != noNeighbour && group_[next] == open && dot(s_.normals[next], s_.normals[seed]) >= limit) {
                        group_[next] = own;
                        found.push_back(next);
                    }
            std::sort(found.begin(), found.end());
            std::vector<Triangle2> flat = projected(s_, found, s_.normals[seed]);
            if (found.size() > 1 && overlaps(flat, foldCells(found.size())) > 0) {
                folded_.push_back(std::move(found));
                continue;
            }
            turnUpright(flat);
            to.push_back(chartOf(part_, std::move(found), std::move(flat)));
        }
    }
    std::vector<std::vector<uint32_t>> takeFolded() { return std::exchange(folded_, {}); }

private:
    const Surface& s_;
    uint32_t part_;
    std::vector<uint32_t> group_;
    uint32_t groups_ = 0;
    std::vector<std::vector<uint32_t>> folded_;
};

} // namespace

std::array<double, 3> barycentric(const Triangle2& t, double x, double y) noexcept {
    const double ax = double(t[1].x) - t[0].x, ay = double(t[1].y) - t[0].y, bx = double(t[2].x) - t[0].x, by = double(t[2].y) - t[0].y;
    const double px = x - t[0].x, py = y - t[0].y, det = ax * by - ay * bx;
    if (det == 0) return {1, 0, 0};
    const double u = (px * by - py * bx) / det, v = (ax * py - ay * px) / det;
    return {1 - u - v, u, v};
}

Chart chartOf(uint32_t part, std::vector<uint32_t> triangles, std::vector<Triangle2> corners) {
    float x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity;
    for (const Triangle2& t : corners)
        for (const Point2& p : t) x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    for (Triangle2& t : corners)
        for (Point2& p : t) p = {p.x - x0, p.y - y0};
    Chart c;
    c.part = part;
    c.triangles = std::move(triangles);
    c.corners = std::move(corners);
    c.width = x1 - x0;
    c.height = y1 - y0;
    return c;
}

uint64_t overlaps(std::span<const Triangle2> triangles, uint32_t cells) {
    float x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity;
    for (const Triangle2& t : triangles)
        for (const Point2& p : t) x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    const float side = std::max(x1 - x0, y1 - y0);
    if (!(side > 0)) return 0;
    const double scale = cells / double(side);
    std::vector<uint8_t> seen(std::size_t(cells) * cells);
    uint64_t twice = 0;
    constexpr double edge = 1e-4;
    for (const Triangle2& t : triangles) {
        Triangle2 s;
        for (int k = 0; k < 3; ++k) s[k] = {float((t[k].x - x0) * scale), float((t[k].y - y0) * scale)};
        if (cross2(s[0], s[1], s[2]) == 0) continue;
        const auto cell = [&](float v) { return uint32_t(std::clamp(v, 0.f, float(cells - 1))); };
        const auto [left, right] = std::minmax({s[0].x, s[1].x, s[2].x});
        const auto [low, high] = std::minmax({s[0].y, s[1].y, s[2].y});
        for (uint32_t y = cell(low); y <= cell(high); ++y)
            for (uint32_t x = cell(left); x <= cell(right); ++x) {
                const auto b = barycentric(s, x + 0.5, y + 0.5);
                if (!(b[0] > edge && b[1] > edge && b[2] > edge)) continue;
                uint8_t& n = seen[std::size_t(y) * cells + x];
                twice += n == 1;
                n = std::min(n + 1, 2);
            }
    }
    return twice;
}

std::vector<Chart> growCharts(const Scene& scene, uint32_t part, float time) {
    const Surface s = surfaceOf(scene, scene.parts()[part], time);
    std::vector<uint32_t> all;
    for (uint32_t t = 0; t < s.normals.size(); ++t)
        if (!(s.normals[t] == Vec3{})) all.push_back(t);
    std::vector<Chart> charts;
    Grower grower(s, part);
    grower.grow(all, cone, charts);
    for (const float limit : {crease, 2.f}) // 2: nothing joins
        for (const std::vector<uint32_t>& piece : grower.takeFolded()) grower.grow(piece, limit, charts);
    return charts;
}

} // namespace chiaro::bake
