// One hit as a ray tree of the classics sees it: how it answers the lamps, which rays it sends on, and how much of a shadow ray it lets
// pass. The material's own closure is asked wherever the user has not chosen one of the older models:
//   fresnel=schlick   F0 + (F90 - F0) (1 - cos)^5 in the place of the exact curve of smooth dielectrics, cos on the thin side, total
//                     internal reflection kept (Schlick, An Inexpensive BRDF Model, 1994)
//   transparency      k_t = transmission, straight on (Foley, van Dam, Feiner, Hughes 1990, equations 16.25 and 16.26)
//     filtered        I = I_1 + k_t O_t I_2, O_t the base colour
//     interpolated    I = (1 - k_t) I_1 + k_t I_2; specular-added: highlights and mirrors of I_1 are not dimmed
//   glossy=mirror     a rough lobe also sends the ray that it would send if it were smooth
#pragma once
#include "integrators/whitted_settings.h"
#include "materials/bsdf.h"

namespace chiaro {

struct TreeBranch {
    Vec3 wi;
    Spectrum weight;
    Event event = Event::SR;
    bool glossy = false; // of a rough lobe: the lamps have been answered for it already
};
struct TreeBranches {
    static constexpr int most = 6;
    union { // the first n are begun
        TreeBranch b[most];
    };
    int n = 0;
    TreeBranches() noexcept {}
    void add(const TreeBranch& branch) noexcept {
        if (n < most && !black(branch.weight)) b[n++] = branch;
    }
    TreeBranch* begin() noexcept { return b; }
    TreeBranch* end() noexcept { return b + n; }
};

class WhittedSurface {
public:
    WhittedSurface(const WhittedSettings&, const Scene&, const SurfacePoint&, const Vec3& wo, const Footprint&, Wavelengths&) noexcept;

    const Bsdf& bsdf() const noexcept { return bsdf_; }
    BsdfValue evaluate(const Vec3& wi, Terms) const noexcept;
    Spectrum diffuseAlbedo() const noexcept { return bsdf_.diffuseAlbedo() * diffuse_; }
    TreeBranches branches(const WhittedSettings&, const Scene&, const SurfacePoint&, const Vec3& wo, const Footprint&) const noexcept;

private:
    Bsdf bsdf_;                        // of the surface without its transparency, where that is one of the older models
    float diffuse_ = 1, specular_ = 1; // what they leave of it
    Spectrum straight_{0};             // what goes straight on
};

// k_t of a surface times its colour, without Fresnel: what it leaves of a shadow ray; black where it is opaque.
struct Passage {
    Spectrum factor{0};
    Event event = Event::ST;
};
Passage shadowPassage(const Scene&, const SurfacePoint&) noexcept;
// Is there anything in the scene that lets shadow rays pass by its transmission, or by its alpha?
bool anyTransparent(const Scene&) noexcept;
bool anyBlended(const Scene&) noexcept;

} // namespace chiaro
