// Lobes: the mixture of scattering lobes of one hit in its local frame, z the shading normal on the side of wo. What Bsdf is without the
// world around it: no geometric normal, no adjoint correction for shading normals.
//
// The model is glTF's metallic-roughness, with weights metallic, (1 - metallic)(1 - transmission) and (1 - metallic) transmission:
//   metal       GGX with Schlick's Fresnel from baseColor to 1
//   dielectric  diffuse baseColor under a GGX coat with the exact Fresnel curve, scaled from F0 to F90 by KHR_materials_specular;
//               f = coat + baseColor/pi (1 - E(wo)) (1 - E(wi)) / (1 - Eavg), E the coat's directional albedo (Kelemen and
//               Szirmay-Kalos 2001): reciprocal, and a white base loses nothing
//   glass       solid: GGX reflection F and refraction baseColor (1 - F), Walter et al. 2007; pane: all orders between its faces,
//               R = 2F/(1+F), and (1 - R) baseColor straight on, spread by the mirrored reflection lobe where it is rough
// All reflections share alpha and half vector, so they are one lobe with the sum of their Fresnel terms. Below roughness 0.0316 (alpha
// 1e-3) the lobe is a mirror, a delta lobe. Masking is height-correlated Smith throughout.
//
// Choice: diffuse or not by the estimated energies at wo; then, for a rough lobe, a visible normal, and reflection or transmission by
// what each returns there. One random number decides both choices, undisturbed.
#pragma once
#include "core/render/events.h"
#include "materials/albedo_tables.h"
#include "materials/lobe_weights.h"
#include "materials/microfacet.h"
#include "materials/parameters.h"
#include <optional>

namespace chiaro {

// Smooth lobes towards one direction. glossy is a reflection or a transmission by the side of wi.
struct LobeValue {
    Spectrum diffuse{0}, glossy{0};
    float pdfW = 0, pdfReverseW = 0;
};
struct LobeSample {
    Vec3 wi;
    Event event = Event::DR; // S: a delta lobe; weight and pmfs below
    Spectrum weight{0};
    float pmf = 0, pmfReverse = 0;
};

class Lobes {
public:
    static constexpr float smallestAlpha = 1e-3f;

    Lobes() = default; // scatters nothing
    // outside: wo is on the front side of the surface.
    Lobes(const BsdfParameters&, const Vec3& wo, bool outside, Transport) noexcept;

    LobeValue evaluate(const Vec3& wi) const noexcept;
    // A direction of one of the lobes; for a smooth one only wi and event are set, evaluate() says the rest.
    std::optional<LobeSample> sample(float uLobe, Point2 u) const noexcept;
    // The mirror and the transmitted direction, weighted by reflectance; no dice. Black where there is no such lobe.
    LobeSample mirror() const noexcept;
    LobeSample passed() const noexcept;

    bool smooth() const noexcept { return diffuseLobe_ || (rough_ && (reflects_ || passes_ == Passes::rough)); }
    Spectrum albedo() const noexcept;
    Spectrum diffuseAlbedo() const noexcept { return diffuseColor_ * openO_; }
    const Vec3& wo() const noexcept { return wo_; }

private:
    using Passes = LobeWeights::Passes;
    // Fresnel-weighted colours of reflection and transmission at one cosine.
    struct Split {
        Spectrum r, t;
    };
    Spectrum dielectric(float shape) const noexcept;
    Spectrum open(const LayerAlbedo&) const noexcept;
    Split split(float cosTheta, bool outside) const noexcept;
    float diffuseChance(float mu, bool outside, const Spectrum& open) const noexcept;
    float reflectionChance(const Split&) const noexcept;
    void addReflection(const Vec3& wi, float diffuseI, LobeValue&) const noexcept;
    void addPane(const Vec3& wi, float diffuseI, LobeValue&) const noexcept;
    void addRefraction(const Vec3& wi, float diffuseI, LobeValue&) const noexcept;
    float etaO() const noexcept { return outside_ ? 1 : ior_; }
    float etaI() const noexcept { return outside_ ? ior_ : 1; }

    Vec3 wo_{0, 0, 1};
    float alpha_ = 0, ior_ = 1.5f;
    float metallic_ = 0, coat_ = 0, glass_ = 0; // weights of the three materials
    Spectrum metalColor_{0};                    // times its weight
    Spectrum f0_{0};                            // of the dielectric
    float f90_ = 0;
    Spectrum diffuseColor_{0}; // times its weight
    Spectrum tint_{0};         // of the glass, times its weight
    Spectrum openO_{1};        // 1 - E(wo)
    Spectrum openAverage_{1};  // 1 - Eavg
    float diffuseO_ = 0;       // chance of the diffuse lobe, seen from wo
    AlbedoSlice slice_;
    Passes passes_ = Passes::none;
    Transport transport_ = Transport::radiance;
    bool outside_ = true, thin_ = true, rough_ = false, reflects_ = false, coated_ = false, diffuseLobe_ = false;
};

} // namespace chiaro
