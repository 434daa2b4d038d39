#include "io/gltf_winding.h"
#include <algorithm>
#include <numeric>
#include <tuple>

namespace chiaro::gltf {

namespace {

// Of each vertex, the number of the place where it is.
std::vector<uint32_t> places(const std::vector<Vec3>& positions) {
    const auto key = [&](uint32_t v) { return std::tuple(positions[v].x, positions[v].y, positions[v].z); };
    std::vector<uint32_t> order(positions.size()), place(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (std::size_t i = 1; i < order.size(); ++i) place[order[i]] = place[order[i - 1]] + (key(order[i]) == key(order[i - 1]) ? 0 : 1);
    return place;
}

} // namespace

std::size_t turnedEdges(const PrimitiveDesc& p) {
    const std::vector<uint32_t> place = places(p.positions);
    struct Edge {
        uint32_t low, high;
        bool up; // its triangle goes from low to high
    };
    std::vector<Edge> edges;
    edges.reserve(p.indices.size());
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const uint32_t v[3] = {place[p.indices[i]], place[p.indices[i + 1]], place[p.indices[i + 2]]};
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = v[k], b = v[(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    }
    const auto key = [](const Edge& e) { return std::pair(e.low, e.high); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
    std::size_t turned = 0;
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
        std::size_t up = 0;
        for (end = i; end < edges.size() && key(edges[end]) == key(edges[i]); ++end) up += edges[end].up;
        turned += end - i == 2 && up != 1;
    }
    return turned;
}

} // namespace chiaro::gltf
