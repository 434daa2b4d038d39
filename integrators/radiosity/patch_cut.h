// One facet cut into cells. The number of segments along each of its edges is given (that of the edge's strand), so that neighbours agree:
//   quadrilaterals   a grid
//   triangles        n^2 equal triangles where all edges have n segments; otherwise bisected, at the edge with the most segments first,
//                    until no edge has any left (after Rivara 1984); the tree of these cuts finds the cell of a point again
#pragma once
#include "integrators/radiosity/patch_mesh.h"
#include <algorithm>

namespace chiaro::radiosity {

// A bisection: the edge `corner` -> next is cut at `share` of it; child 0 keeps its first end, child 1 its second. Negative: ~cell.
struct CutNode {
    float share = 0.5f;
    std::array<int32_t, 2> child{};
    uint8_t corner = 0;
};

enum class CutKind : uint8_t { grid, uniform, bisected };
struct Cut {
    CutKind kind = CutKind::uniform;
    std::array<uint32_t, 4> segments{1, 1, 1, 1}; // along each edge
    // A point of the cells, in the coordinates of the facet: bilinear, or barycentric (of corners 1 and 2).
    struct Point {
        float s = 0, t = 0;
        uint8_t edge = 255;    // that it lies on, 255: inside; a corner lies on the edge that begins there
        uint32_t position = 0; // along it, in segments
    };
    std::vector<Point> points; // corners first
    std::vector<std::array<uint32_t, 4>> cells;
    std::vector<CutNode> nodes; // the first is the root
    uint32_t corners = 3;       // of a cell
};

// The cells of a facet whose edges have so many segments; no cell has an edge longer than `size`, as far as the segments allow.
// corner: of the facet. With cells null only the number of cells is found.
uint64_t cellsOf(const Facet&, const std::array<Vec3, 4>& corner, const std::array<uint32_t, 4>& segments, float size, Cut* cells);

// Where a point of the facet lies: its cell, and its coordinates in it. s, t: in the coordinates of the facet.
struct CellPlace {
    uint32_t cell = 0;
    float s = 0, t = 0;
};
inline CellPlace placeInGrid(uint32_t columns, uint32_t rows, float s, float t) noexcept {
    const float x = clamp01(s) * float(columns), y = clamp01(t) * float(rows);
    const uint32_t i = std::min(uint32_t(x), columns - 1), j = std::min(uint32_t(y), rows - 1);
    return {j * columns + i, x - float(i), y - float(j)};
}

inline CellPlace placeInUniform(uint32_t n, float s, float t) noexcept {
    const float x = clamp01(s) * float(n), y = clamp01(t) * float(n);
    const uint32_t j = std::min(uint32_t(y), n - 1), i = std::min(uint32_t(x), n - 1 - j);
    const float fx = min(x - float(i), 1.f), fy = min(y - float(j), 1.f);
    const uint32_t cell = 2 * n * j - j * j + 2 * i;
    if (fx + fy <= 1 || i + j + 1 >= n) return {cell, fx, fy};
    return {cell + 1, 1 - fx, 1 - fy};
}
CellPlace placeInBisected(const CutNode* nodes, float s, float t) noexcept;

// Segments of an edge of a length, so that none is longer than size.
uint32_t segmentsOf(float length, float size) noexcept;

} // namespace chiaro::radiosity
