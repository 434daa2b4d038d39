// What the material says about one side of a patch: diffuse reflectance, own light and coverage, averaged over the patch where textures,
// vertex colours or alpha vary on it, and over directions where a coat lies on the diffuse base. The mean over directions is that of
// diffuse light from everywhere: 2 times the integral of the closure's diffuse albedo times the cosine, by Gauss' rule of 8 points.
#pragma once
#include "integrators/radiosity/patch_mesh.h"
#include <functional>
#include <span>

namespace chiaro::radiosity {

struct SideSurface {
    Spectrum reflectance{0}, radiance{0}; // means over matter
};
struct Surface {
    SideSurface front, back;
    float coverage = 1;
};

class SurfaceMeans {
public:
    SurfaceMeans(const Scene& scene, const DrawnPart& part, float time) noexcept : scene_(scene), part_(part), time_(time) {}
    // Of the triangles' own points, weights of corners as in Hit.
    struct Where {
        uint32_t triangle = 0;
        float u = 0, v = 0;
    };
    // Whether the material is the same all over these triangles: then one point tells.
    bool plain(std::span<const uint32_t> triangles) const noexcept;
    Surface mean(std::span<const Where>) noexcept;
    // Points that do justice to a piece of the surface: the texels of its largest texture on it (area: of the piece as a share of the
    // triangle), within bounds.
    uint32_t pointsFor(uint32_t triangle, float share) const noexcept;

private:
    Spectrum diffuse(const SurfacePoint&) noexcept;
    const Scene& scene_;
    const DrawnPart& part_;
    float time_;
    struct Coat { // the parameters beside the base colour of which the share below was made
        float metallic = -1, roughness = 0, specular = 0, transmission = 0;
        Spectrum specularColor;
        bool operator==(const Coat&) const = default;
    } coat_;
    Spectrum share_; // of the base colour that is reflected diffusely
};

// Warns of what radiosity leaves out: mirrors, metals and glass as blockers, glossy coats.
void tellMaterials(const Scene&, Diagnostics&);
// Whether a material may reflect light diffusely at all.
bool mayReflect(const MaterialDesc&) noexcept;

} // namespace chiaro::radiosity
