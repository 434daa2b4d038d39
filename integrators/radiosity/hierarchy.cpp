#include "integrators/radiosity/hierarchy.h"
#include "core/render/fault.h"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace chiaro::radiosity {
namespace {

constexpr float normalWeight = 0.5f; // of opposite directions against places that lie as far apart as the scene reaches
constexpr int mostMiddles = 48;      // splits in the middle before the rest is halved by number

double coordinate(const Patch& p, int axis, double radius) noexcept {
    switch (axis) {
    case 0: return double(p.centre.x) / radius;
    case 1: return double(p.centre.y) / radius;
    case 2: return double(p.centre.z) / radius;
    case 3: return double(p.normal.x * normalWeight);
    case 4: return double(p.normal.y * normalWeight);
    default: return double(p.normal.z * normalWeight);
    }
}

} // namespace

Hierarchy::Hierarchy(const Patches& patches) : patches_(patches), order_(patches.size()), areas_(patches.size() + 1) {
    if (patches.size() == 0) return;
    std::iota(order_.begin(), order_.end(), 0u);
    Vec3 lo{infinity, infinity, infinity}, hi{-infinity, -infinity, -infinity};
    for (const Patch& p : patches.all()) {
        lo = {min(lo.x, p.centre.x), min(lo.y, p.centre.y), min(lo.z, p.centre.z)};
        hi = {max(hi.x, p.centre.x), max(hi.y, p.centre.y), max(hi.z, p.centre.z)};
    }
    radius_ = std::max(length(hi - lo) / 2, std::numeric_limits<float>::min());
    nodes_.reserve(2 * patches.size());
    build(0, uint32_t(patches.size()), 0);
    for (std::size_t i = 0; i < order_.size(); ++i) areas_[i + 1] = areas_[i] + double(patches[order_[i]].area);
    for (Node& n : nodes_) describe(n);
}

void Hierarchy::build(uint32_t first, uint32_t count, int depth) {
    const uint32_t me = uint32_t(nodes_.size());
    nodes_.push_back({});
    nodes_[me].first = first;
    nodes_[me].count = count;
    if (count == 1) return;
    const auto begin = order_.begin() + first, end = begin + count;
    int axis = 0;
    double widest = -1, middle = 0;
    for (int a = 0; a < 6; ++a) {
        double lo = 1e300, hi = -1e300;
        for (auto i = begin; i != end; ++i) {
            const double c = coordinate(patches_[*i], a, double(radius_));
            lo = std::min(lo, c);
            hi = std::max(hi, c);
        }
        if (hi - lo > widest) {
            widest = hi - lo;
            axis = a;
            middle = (lo + hi) / 2;
        }
    }
    const auto at = [&](uint32_t i) { return coordinate(patches_[i], axis, double(radius_)); };
    auto cut = std::partition(begin, end, [&](uint32_t i) { return at(i) < middle; });
    if (cut == begin || cut == end || depth > mostMiddles) {
        cut = begin + count / 2;
        std::nth_element(begin, cut, end, [&](uint32_t a, uint32_t b) { return at(a) != at(b) ? at(a) < at(b) : a < b; });
    }
    const uint32_t left = uint32_t(cut - begin);
    build(first, left, depth + 1);
    nodes_[me].right = uint32_t(nodes_.size());
    build(first + left, count - left, depth + 1);
}

void Hierarchy::describe(Node& n) const {
    Vec3d centre, axis;
    for (uint32_t i = n.first; i < n.first + n.count; ++i) {
        const Patch& p = patches_[order_[i]];
        n.area += double(p.area);
        centre = centre + cast<double>(p.centre) * double(p.area);
        axis = axis + cast<double>(p.normal) * double(p.area);
    }
    n.centre = cast<float>(centre * (1 / n.area));
    const double long_ = length(axis);
    n.axis = long_ > 1e-3 * n.area ? cast<float>(axis * (1 / long_)) : patches_[order_[n.first]].normal;
    for (uint32_t i = n.first; i < n.first + n.count; ++i) {
        const Patch& p = patches_[order_[i]];
        n.error = max(n.error, p.error);
        n.spread = max(n.spread, 2 * std::asin(min(length(p.normal - n.axis) / 2, 1.f))); // exact for small angles
        for (uint32_t c = 0; c < p.corners; ++c) {
            n.radius = max(n.radius, length(p.corner[c] - n.centre));
            n.depth = max(n.depth, std::fabs(dot(p.corner[c] - n.centre, n.axis)));
        }
    }
    n.flat = n.spread < 1e-4f && n.depth <= max(1e-4f * n.radius, 4 * n.error);
}

uint32_t Hierarchy::pick(uint32_t node, float u) const noexcept {
    const Node& n = nodes_[node];
    if (n.count == 1) return order_[n.first];
    const auto begin = areas_.begin() + n.first, end = begin + n.count;
    const double at = *begin + double(u) * (*end - *begin);
    const auto above = std::upper_bound(begin + 1, end, at); // the patch whose running sum passes it
    return order_[n.first + uint32_t(above - begin) - 1];
}

void Hierarchy::pull(std::span<const Light> patches, std::span<Light> nodes) const noexcept {
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        const Node& n = nodes_[i];
        if (n.leaf()) {
            nodes[i] = patches[order_[n.first]];
            continue;
        }
        const std::size_t a = i + 1, b = n.right;
        nodes[i] = fault(Fault::pullWithoutArea) ? (nodes[a] + nodes[b]) * 0.5
                                                 : (nodes[a] * nodes_[a].area + nodes[b] * nodes_[b].area) * (1 / n.area);
    }
}

void Hierarchy::push(std::span<const Light> nodes, std::span<Light> patches) const noexcept {
    Lights3 down(nodes.begin(), nodes.end());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& n = nodes_[i];
        if (n.leaf()) {
            patches[order_[n.first]] = down[i];
        } else {
            down[i + 1] += down[i];
            down[n.right] += down[i];
        }
    }
}

} // namespace chiaro::radiosity
