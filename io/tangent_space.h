// TangentSpace: tangents for a mesh that has texture coordinates but no tangents, as normal maps are baked for: at a corner the mean of the
// directions of growing u of the triangles around it, in the plane of the corner's normal, weighted by their angles there. Triangles count
// together where they share an edge, and the position, normal and texture coordinate of the corner, and map with the same handedness: where
// a texture is mirrored a vertex has two tangents. Triangles whose texture coordinates span no area join their neighbours and add nothing.
// Source: Mikkelsen, Simulation of Wrinkled Surfaces Revisited (2008), and the rules of his "MikkTSpace", which glTF 2.0.1 names
// in 3.7.2.1.
#pragma once
#include "core/math/vec.h"
#include "core/math/warp.h"
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro {

class TangentSpace {
public:
    // A list of triangles. Without normals those of the triangles stand in.
    TangentSpace(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Point2> uv,
                 std::span<const uint32_t> indices);
    uint32_t groups() const noexcept { return uint32_t(mirrored_.size()); }
    uint32_t group(size_t corner) const noexcept { return group_[corner]; } // corner: a place in the indices
    // One a group: unit vectors, and in w glTF's sign of the bitangent, cross(n, t) * w, which is against growing v. For the mesh itself or
    // another shape of it.
    std::vector<Vec4> tangents(std::span<const Vec3> positions, std::span<const Vec3> normals) const;

    // The same corners name other vertices now.
    void renumber(std::span<const uint32_t> indices) { indices_.assign(indices.begin(), indices.end()); }

private:
    struct Face {
        float du1 = 0, dv1 = 0, du2 = 0, dv2 = 0;
        bool flat = true;       // spans no area in the texture
        bool degenerate = true; // two corners in one place
        bool mirrored = false;
    };
    void weld(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Point2> uv);
    void join();
    void gather();
    void adopt();

    std::vector<uint32_t> indices_;
    std::vector<Face> faces_;
    std::vector<uint32_t> welded_;    // of each corner: the number of its position, normal and texture coordinate
    std::vector<uint32_t> neighbour_; // of each edge, from its corner to the next one: the face beyond
    std::vector<uint32_t> group_;     // of each corner
    std::vector<bool> counts_;        // of each corner: its face has a say in the group
    std::vector<bool> mirrored_;      // of each group
};

} // namespace chiaro
