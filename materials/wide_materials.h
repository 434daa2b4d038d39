// WideMaterials: the materials of a scene as loops over lanes want them: what a closure is made from, one record of 128 bytes each, and the
// coats' albedos as tables over the cosine alone. Made once before a render, read by all threads. Materials that need more than lanes do
// (rough transmission, normal maps, textures other than the base colour's, the further lobes) are marked: a scalar closure answers for
// them.
#pragma once
#include "core/math/vec.h"
#include "materials/albedo_columns.h"
#include <cstdint>
#include <vector>

namespace chiaro {

class Scene;

struct alignas(64) WideMaterial {
    enum Flag : uint32_t {
        scalar = 1,   // ask the closure
        textured = 2, // the base colour is that of the record times the texture's
        rough = 4,    // its reflection is a lobe, not a mirror
        reflects = 8,
        straight = 16,    // transmits straight on
        refracted = 32,   // transmits by Snell's law
        thin = 64,        // a pane: all orders of reflection between its faces
        dielectric = 128, // with a Fresnel curve
        emits = 256,
        askEmission = 512, // its emission varies: ask the lights
        doubleSided = 1024,
        volume = 2048,                                        // it has an inside that light crosses
        absorbs = 4096,                                       // which attenuates
        compensated = 8192,                                   // rough metal: what its facets send to each other leaves at last
        lobes = reflects | straight | refracted | dielectric, // other than diffuse
    };
    float baseColor[3];
    uint32_t flags;
    float alpha, ior, metallic, f90;
    float f0[3], coat;
    float glass, openAverage[3]; // openAverage: what the coat leaves to the base, mean over the hemisphere
    float emission[3];           // cd/m2
    uint32_t columns;            // where its albedo begins in the table, in floats
    float laterAverage;          // mean albedo of a white facet
    float squaredIndex;          // squaredIndexInside()
    float unused[10];
};

class WideMaterials {
public:
    explicit WideMaterials(const Scene&);
    const WideMaterial* records() const noexcept { return records_.data(); }
    bool volumes() const noexcept { return volumes_; } // is there an inside that light crosses?
    const float* columns() const noexcept { return &columns_[0].cells[0][0]; }

private:
    std::vector<WideMaterial> records_;
    bool volumes_ = false;
    std::vector<AlbedoColumns> columns_; // the first is that of no material
};

} // namespace chiaro
