// The surfaces of a scene before they are cut: corners that lie at the same place are one point, whatever vertices, materials or nodes they
// belong to; triangles that form a flat quadrilateral are one facet. Edges between the same two points are one edge, and opposite edges of
// a quadrilateral are one strand: as many cuts for all edges of a strand leave no T-junction anywhere.
#pragma once
#include "core/scene/scene.h"

namespace chiaro::radiosity {

struct Facet {
    uint32_t part = 0;
    uint32_t corners = 3;
    std::array<uint32_t, 4> point{};            // corners, counter-clockwise seen from the front
    std::array<uint32_t, 4> edge{};             // from each corner to the next
    std::array<uint32_t, 2> triangle{~0u, ~0u}; // of the part
    // Which corner of the facet each vertex of a triangle is, in the order of Hit's weights.
    std::array<std::array<uint8_t, 3>, 2> cornerOf{};
    Vec3 normal;
    float twistS = 0, twistT = 0; // corner 2 = corner 0 + (1 + twistS) (corner 1 - corner 0) + (1 + twistT) (corner 3 - corner 0)
    float error = 0;              // of points on it, metres
    uint8_t smooth = 0;           // bit k: the shading normal goes on smoothly into the one neighbour across edge k
};

struct PatchMesh {
    std::vector<Vec3> points;
    std::vector<Facet> facets;
    struct Edge {
        uint32_t a = 0, b = 0; // points, a < b
        uint32_t strand = 0;
    };
    std::vector<Edge> edges;
    uint32_t strands = 0;
    std::vector<uint64_t> first;   // triangles before each part
    std::vector<uint32_t> facetOf; // of each triangle of each part: facet * 2 + which of its triangles; ~0: degenerate
    uint64_t degenerate = 0;
    std::vector<uint32_t> moving; // parts that move while the shutter is open
};

PatchMesh patchMesh(const Scene&, Interval shutter);

// Disjoint sets (Tarjan 1975); the representative of a set is its least member.
class Sets {
public:
    explicit Sets(std::size_t n);
    uint32_t find(uint32_t i) noexcept;
    void join(uint32_t i, uint32_t j) noexcept;

private:
    std::vector<uint32_t> parent_;
};

} // namespace chiaro::radiosity
