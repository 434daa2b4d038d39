// Charts: pieces of surface that lie flat in a light map. A chart is grown over neighbouring triangles as long as they face within a cone
// about the first one's normal, then projected along it: nothing flips, and nothing shrinks below the cosine of the cone. What overlaps
// itself all the same (a folded band) is cut again at every crease, at last into single triangles. Plane pieces are charts without any
// distortion. Lengths in metres, in the plane of the chart, its corner at (0, 0).
#pragma once
#include "core/scene/scene.h"
#include <array>
#include <vector>

namespace chiaro::bake {

struct Chart {
    uint32_t part = 0;                          // of Scene::parts()
    std::vector<uint32_t> triangles;            // of the part
    std::vector<std::array<Point2, 3>> corners; // of each of them
    float width = 0, height = 0;                // of all corners
    uint32_t x = 0, y = 0, w = 0, h = 0;        // its place in the map, texels; set by the packer
};

// Triangles without area are in no chart: nobody sees them.
std::vector<Chart> growCharts(const Scene&, uint32_t part, float time);

// A layout that exists, as one chart: corners of every triangle in any unit, moved to (0, 0).
Chart chartOf(uint32_t part, std::vector<uint32_t> triangles, std::vector<std::array<Point2, 3>> corners);

// How many of so many cells along the longer side are covered by two triangles at their centre; edges that triangles share do not count.
uint64_t overlaps(std::span<const std::array<Point2, 3>> triangles, uint32_t cells);

// Twice the signed area of a triangle.
inline double cross2(Point2 a, Point2 b, Point2 c) noexcept {
    return (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
}
// Weights of the corners at p; of a triangle without area, those of its first corner.
std::array<double, 3> barycentric(const std::array<Point2, 3>&, double x, double y) noexcept;

} // namespace chiaro::bake
