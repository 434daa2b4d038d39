// Where one sheet of matter runs through a patch, and light reaches both of its sides, the patch is two: a floor that goes on beyond a wall
// is lit by the sky out there, and in one patch across the wall half of that light would be in the room. What leaks so falls with the edge
// of a patch alone, not with its square, and is multiplied by how much brighter it is outside. So such a patch is cut along the line where
// the sheet crosses it, into triangles, as meshes of radiosity are cut where surfaces touch (Baum, Mann, Smith, Winget, Making Radiosity
// Usable, 1991). What the sheet hides from light altogether is no matter of this: patch_open.h. The sheets are found by rays that run along
// the edges and diagonals of a patch, just off it.
#pragma once
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

struct Crossings {
    // A cut through a cell: distance from its plane at the cell's corners. Negative children: ~piece.
    struct Node {
        std::array<float, 4> side{};
        std::array<int32_t, 2> child{}; // below and above 0
    };
    struct Piece {
        uint32_t front = ~0u, back = ~0u; // patches
        std::array<Point2, 3> at;         // corners, in the coordinates of the cell
    };
    std::vector<Node> nodes;
    std::vector<Piece> pieces;
    std::vector<int32_t> root; // of each patch before the cuts; -1: whole. Empty: all are whole
    uint32_t cut = 0;          // patches

    // The piece of a cell at its bilinear (4 corners) or barycentric (3) coordinates; null: the cell is whole. patch: the front of the
    // cell.
    const Piece* find(uint32_t patch, bool quadrilateral, float s, float t) const noexcept {
        if (root.empty() || root[patch] < 0) return nullptr;
        int32_t at = root[patch];
        while (at >= 0) {
            const Node& n = nodes[std::size_t(at)];
            const float d = quadrilateral ? (n.side[0] * (1 - s) + n.side[1] * s) * (1 - t) + (n.side[3] * (1 - s) + n.side[2] * s) * t
                                          : n.side[0] * (1 - s - t) + n.side[1] * s + n.side[2] * t;
            at = n.child[d > 0 ? 1 : 0];
        }
        return &pieces[std::size_t(~at)];
    }
};
// Barycentric coordinates in a piece (of corners 1 and 2) of a point of its cell.
Point2 within(const Crossings::Piece&, float s, float t) noexcept;

// Cuts them in place, further pieces at the end; `points` counts the numbers of points in use. seen: how those patches are found.
// The same for every seed. Nothing is cut in a scene without lights.
Crossings cutCrossed(const Work&, const Patches& seen, std::vector<Patch>& patches, uint32_t& points);

} // namespace chiaro::radiosity
