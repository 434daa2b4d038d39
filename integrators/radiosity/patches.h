// Patches: the surfaces of a scene cut into flat pieces of constant radiosity, the elements of the radiosity method (Goral, Torrance,
// Greenberg, Battaile 1984). Every surface has two sides, each with the material's answer there: the front is always a patch, the back
// where light can reach it (a flood of rays from the lights finds out; in a scene without any light: where the
// material is double-sided and the back sees something).
// Cuts are conforming: surfaces that share an edge share the points on it (no T-junctions), whether or not their vertices are shared, so
// that radiosity can be interpolated without seams. Pairs of triangles that form a flat quadrilateral with nearly equal opposite edges stay
// together as one. Where another body stands on a surface, or runs through it, light reaches a part of a patch alone: what lies against the
// body, or inside it, does not count; area and all means are those of the open part, as if the patch ended at the line of contact. Only
// diffuse reflection takes part: reflectance is the diffuse part of the closure, averaged over the patch (textures
// included) and over directions; what else a surface does, it does as a blocker. What an alpha mask cuts away is not there: area is that of
// the matter, and reflectance and emission are means over it; so form factors stay reciprocal.
// Units: metres, square metres, lux and lumen per square metre.
#pragma once
#include "core/render/integrator.h"

namespace chiaro::radiosity {

struct Patch {
    std::array<Vec3, 4> corner;       // counter-clockwise seen from the front of the patch
    std::array<uint32_t, 4> vertex{}; // their numbers among the points of the mesh of patches, shared by smooth neighbours of one material
    uint32_t corners = 3;             // 3, or 4 of a convex quadrilateral
    Vec3 centre, normal;              // centre: of the corners, or of the open part; normal: towards the side that the patch is
    float area = 0;                   // of its matter, as far as it is open
    float coverage = 1;               // of its polygon by matter: below 1 under an alpha mask
    float open = 1;                   // share of its polygon that light can reach: below 1 where other bodies stand on it
    uint32_t part = 0;                // of Scene::parts()
    uint32_t other = ~0u;             // the patch on the back of it; ~0: none
    Spectrum reflectance{0};          // diffuse, [0, 1)
    Spectrum emission{0};             // radiosity of its own light, lm/m2: pi times the mean radiance
    float error = 0;                  // bound of the rounding error of a point on it, metres: rays leave from beyond

    // Where a ray from a point on it begins, and how far it must stay before one.
    Vec3 outside(const Vec3& p) const noexcept {
        return p + normal * (error * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z)));
    }
    // The point at bilinear (4 corners) or barycentric (3) coordinates.
    Vec3 at(float s, float t) const noexcept {
        if (corners == 3) return corner[0] + (corner[1] - corner[0]) * s + (corner[2] - corner[0]) * t;
        const Vec3 twist = corner[2] - corner[1] + (corner[0] - corner[3]);
        return corner[0] + (corner[1] - corner[0]) * s + (corner[3] - corner[0] + twist * s) * t;
    }
};

struct PatchSettings {
    float size = 0;            // longest edge of a patch, metres; 0: as many as `count` says
    uint32_t count = 2000;     // about so many, where no size is given
    uint32_t most = 4'000'000; // refused beyond
};

class Patches {
public:
    // Throws Error(Exit::resources) where there would be too many. Warns of things that move (taken where they are when the shutter opens)
    // and of surfaces whose mirror or glossy part takes no part.
    static Patches of(const Work&, const PatchSettings&);
    std::span<const Patch> all() const noexcept { return patches_; }
    std::size_t size() const noexcept { return patches_.size(); }
    const Patch& operator[](std::size_t i) const noexcept { return patches_[i]; }
    uint32_t points() const noexcept { return points_; } // of the mesh of patches
    float longestEdge() const noexcept { return longestEdge_; }
    float time() const noexcept { return time_; } // at which they lie where they are, seconds

    // Where a ray that arrived from the front (or the back) of a hit's surface stands: the patch, and its bilinear (4 corners) or
    // barycentric (3: of corners 1 and 2) coordinates. Empty: that side is no patch.
    struct Place {
        uint32_t patch = 0;
        float s = 0, t = 0;
    };
    std::optional<Place> at(const Hit&, bool front) const noexcept;
    // The patch that a ray of this direction meets there, ~0: none. What a loop over the hits of many rays needs, and no more.
    uint32_t seen(const Hit&, const Vec3& direction) const noexcept;
    // Whether a ray that met this, and seen() knew no patch there, met a side that light never reaches: then it left from where the patch
    // is not open, inside of something, and counts for nothing. (Of a scene without lights nobody knows.)
    bool unlit(const Hit& hit) const noexcept { return lit_ && bool(hit); }
    Vec3 point(uint32_t patch, Point2 uniform) const noexcept; // uniform over its polygon, clear of its edges by the rounding error

private:
    friend class PatchBuilder;
    struct Table;
    std::vector<Patch> patches_;
    std::shared_ptr<const Table> table_; // from hits to patches
    uint32_t points_ = 0;
    float longestEdge_ = 0, time_ = 0;
    bool lit_ = false; // the scene has lights: backs that are no patch are those that no light reaches
};

} // namespace chiaro::radiosity
