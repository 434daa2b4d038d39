#include "tools/bake/sites.h"
#include "core/math/warp.h"
#include <algorithm>
#include <cmath>

namespace chiaro::bake {
namespace {

using Triangle2 = std::array<Point2, 3>;

// Do a triangle and the square of a texel share more than a border? Separating axes: those of the square and the normals of the edges.
bool meets(const Triangle2& t, double x, double y) noexcept {
    const double area = cross2(t[0], t[1], t[2]);
    for (int k = 0; k < 3; ++k) {
        const Point2 a = t[k], b = t[(k + 1) % 3];
        const double nx = (double(a.y) - b.y) * (area < 0 ? -1 : 1), ny = (double(b.x) - a.x) * (area < 0 ? -1 : 1); // inwards
        // The corner of the square that lies farthest inwards.
        if (nx * (x + (nx > 0) - a.x) + ny * (y + (ny > 0) - a.y) <= 0) return false;
    }
    return true;
}

template <class F> void forTexels(const Triangle2& t, uint32_t size, F&& f) {
    if (cross2(t[0], t[1], t[2]) == 0) return;
    const auto cell = [&](float v) { return uint32_t(std::clamp(std::floor(v), 0.f, float(size - 1))); };
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (uint32_t y = cell(low); y <= cell(high); ++y)
        for (uint32_t x = cell(left); x <= cell(right); ++x)
            if (meets(t, x, y)) f(x, y);
}

// The point of a triangle that is nearest to (x, y), as weights of its corners.
std::array<double, 3> nearestOn(const Triangle2& t, double x, double y, double& distance2) noexcept {
    std::array<double, 3> best{1, 0, 0};
    distance2 = 1e300;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point2 a = t[k], b = t[(k + 1) % 3];
        const double ex = double(b.x) - a.x, ey = double(b.y) - a.y, l = ex * ex + ey * ey;
        const double s = l > 0 ? std::clamp(((x - a.x) * ex + (y - a.y) * ey) / l, 0.0, 1.0) : 0.0;
        const double dx = a.x + s * ex - x, dy = a.y + s * ey - y, d = dx * dx + dy * dy;
        if (d >= distance2) continue;
        distance2 = d;
        best = {0, 0, 0};
        best[k] = 1 - s;
        best[(k + 1) % 3] = s;
    }
    return best;
}

Hit hitOn(const DrawnPart& part, uint32_t triangle, double u, double v) noexcept {
    u = std::clamp(u, 0.0, 1.0);
    return {part.geometry, triangle, part.instance, float(u), float(std::clamp(v, 0.0, 1 - u)), 0};
}

} // namespace

TexelSites::TexelSites(const Scene& scene, const Layout& layout) : scene_(scene), layout_(layout) {
    const std::size_t texels = std::size_t(layout.size) * layout.size;
    std::vector<uint32_t> count(texels + 1, 0);
    const auto forAll = [&](auto&& f) {
        for (uint32_t l = 0; l < layout.parts.size(); ++l)
            for (uint32_t t = 0; t < layout.parts[l].corners.size(); ++t)
                if (layout.parts[l].chart[t] != noChart)
                    forTexels(layout.parts[l].corners[t], layout.size, [&](uint32_t x, uint32_t y) {
                        f(std::size_t(y) * layout.size + x, Corner{l, t});
                    });
    };
    forAll([&](std::size_t texel, Corner) { ++count[texel]; });
    std::vector<uint32_t> place(texels);
    for (std::size_t i = 0; i < texels; ++i) {
        if (count[i] == 0) continue;
        texels_.push_back(uint32_t(i));
        begin_.push_back(begin_.empty() ? 0 : begin_.back() + place[texels_[texels_.size() - 2]]);
        place[i] = count[i];
    }
    begin_.push_back(begin_.empty() ? 0 : begin_.back() + place[texels_.back()]);
    triangles_.resize(begin_.back());
    for (std::size_t s = 0; s < texels_.size(); ++s) place[texels_[s]] = begin_[s];
    forAll([&](std::size_t texel, Corner c) { triangles_[place[texel]++] = c; });
    constexpr double inside = 1e-4;
    for (std::size_t s = 0; s < texels_.size(); ++s) {
        int claims = 0;
        for (uint32_t i = begin_[s]; i < begin_[s + 1]; ++i) {
            const auto b = barycentric(cornersOf(triangles_[i]), texels_[s] % layout.size + 0.5, texels_[s] / layout.size + 0.5);
            claims += b[0] > inside && b[1] > inside && b[2] > inside;
        }
        overlapping_ += claims > 1;
    }
}

Hit TexelSites::hit(std::size_t site, uint32_t, Point2 u) const noexcept {
    const double x = texels_[site] % layout_.size + double(u.x), y = texels_[site] / layout_.size + double(u.y);
    double least = 1e300;
    Corner on;
    std::array<double, 3> weights{1, 0, 0};
    for (uint32_t i = begin_[site]; i < begin_[site + 1]; ++i) {
        const Triangle2& t = cornersOf(triangles_[i]);
        const auto b = barycentric(t, x, y);
        double distance2 = 0;
        const bool within = b[0] >= 0 && b[1] >= 0 && b[2] >= 0;
        const auto candidate = within ? b : nearestOn(t, x, y, distance2);
        if (distance2 >= least) continue;
        least = distance2;
        on = triangles_[i];
        weights = candidate;
        if (within) break;
    }
    return hitOn(scene_.parts()[layout_.parts[on.layout].part], on.triangle, weights[1], weights[2]);
}

Hit VertexSites::hit(std::size_t site, uint32_t sample, Point2 u) const noexcept {
    const uint32_t n = begin_[site + 1] - begin_[site];
    const VertexCorner& c = corners_[begin_[site] + sample % n]; // in turn
    // Uniform on the piece (Turk, Generating Random Points in Triangles, 1990), then half way to the vertex.
    const float root = std::sqrt(u.x);
    std::array<float, 3> w{1 - root, root * (1 - u.y), root * u.y};
    for (float& v : w) v /= 2;
    w[c.corner] += 0.5f;
    float weight[3] = {};
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) weight[j] += w[k] * c.corners[k][j];
    return hitOn(scene_.parts()[c.on.part], c.on.triangle, weight[1], weight[2]);
}

} // namespace chiaro::bake
