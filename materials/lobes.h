// Lobes: the mixture of scattering lobes of one hit in its local frame, z the shading normal on the side of wo, x along the brush where
// there is one. What Bsdf is without the world around it: no geometric normal, no adjoint correction for shading normals, nothing on top
// (materials/layers.h).
//
// The model is glTF's metallic-roughness, with weights metallic, (1 - metallic)(1 - transmission) and (1 - metallic) transmission:
//   metal       GGX with Schlick's Fresnel from baseColor to 1
//   dielectric  diffuse baseColor under a GGX coat with the exact Fresnel curve, scaled from F0 to F90 by KHR_materials_specular;
//               f = coat + baseColor/pi (1 - E(wo)) (1 - E(wi)) / (1 - Eavg), E the coat's directional albedo (Kelemen and
//               Szirmay-Kalos 2001): reciprocal, and a white base loses nothing. A share of the diffuse light leaves on the other side,
//               in a colour of its own (KHR_materials_diffuse_transmission), under the same coat
//   glass       solid: GGX reflection F and refraction baseColor (1 - F), Walter et al. 2007; pane: all orders between its faces,
//               R = 2F/(1+F), and (1 - R) baseColor straight on, spread by the mirrored reflection lobe where it is rough
// All reflections share alpha and half vector, so they are one lobe with the sum of their Fresnel terms; a thin film changes those
// (materials/thin_film.h), a brush the alphas. Below roughness 0.0316 (alpha 1e-3) the lobe is a mirror, a delta lobe. Masking is
// height-correlated Smith throughout.
//
// What single scattering loses in rough metal, panes and glass is given back by a lobe that knows no facets: with L(w) the loss seen
// from w, f = c L(wo) L(wi) on one side, c as materials/lobe_weights.h says; in solid glass over both sides at once,
// f = n_o^2 L(wo) L(wi) / (pi (mean L outside + n^2 mean L inside)), which loses nothing and is reciprocal as refraction is. What a coat
// loses has gone to its base already.
//
// Colours part (materials/dispersion.h) where solid glass disperses: rough refraction is evaluated for each channel and drawn from all
// three alike; a smooth one picks a channel and a wavelength of its band, and the sample says which.
//
// Choice: a cosine lobe (diffuse, and what later facets send) or not by the estimated energies at wo; then, for a rough lobe, a visible
// normal, and reflection or transmission by what each returns there. One random number decides both choices, undisturbed.
#pragma once
#include "core/render/events.h"
#include "materials/albedo_tables.h"
#include "materials/lobe_tables.h"
#include "materials/lobe_weights.h"
#include "materials/microfacet.h"
#include "materials/parameters.h"
#include "materials/thin_film.h"
#include <memory>
#include <optional>

namespace chiaro {

// Smooth lobes towards one direction. Each is a reflection or a transmission by the side of wi.
struct LobeValue {
    Spectrum diffuse{0}, glossy{0};
    float pdfW = 0, pdfReverseW = 0;
    float energyI = 0; // estimate of what is scattered of light from wi
};
struct LobeSample {
    Vec3 wi;
    Event event = Event::DR; // S: a delta lobe; weight and pmfs below
    Spectrum weight{0};
    float pmf = 0, pmfReverse = 0;
    float wavelength = 0; // nanometres, of the light that the weight has left; 0: all of RGB
    bool delta() const noexcept { return event == Event::SR || event == Event::ST; }
};

class Lobes {
public:
    static constexpr float smallestAlpha = 1e-3f;

    Lobes() noexcept {} // scatters nothing
    // outside: wo is on the front side of the surface.
    Lobes(const BsdfParameters&, const Vec3& wo, bool outside, Transport) noexcept;

    LobeValue evaluate(const Vec3& wi) const noexcept;
    // A direction of one of the lobes; for a smooth one only wi and event are set, evaluate() says the rest.
    std::optional<LobeSample> sample(float uLobe, Point2 u) const noexcept;
    // The mirror and the transmitted directions, weighted by reflectance; no dice. Black where there is no such lobe.
    LobeSample mirror() const noexcept;
    int passages() const noexcept { return dispersion_ > 0 ? 3 : 1; } // one for each channel
    LobeSample passed(int passage = 0) const noexcept;

    bool smooth() const noexcept { return cosines_ || (rough_ && (reflects_ || passes_ == Passes::rough)); }
    Spectrum albedo() const noexcept;
    Spectrum diffuseAlbedo() const noexcept { return diffuseColor_ * o_.open; } // of what stays on the side of wo
    Spectrum open(const Vec3& w) const noexcept;                                // what the coat leaves to the diffuse base
    bool diffuse() const noexcept { return diffuseLobe_ || through_; }
    float energyO() const noexcept { return o_.energy; }
    float energyFrom(const Vec3& wi) const noexcept { return facing(wi, wi.z > 0 || thin_ ? outside_ : !outside_).energy; }
    const Vec3& wo() const noexcept { return wo_; }

private:
    using Passes = LobeWeights::Passes;
    // Fresnel-weighted colours of reflection and transmission at one cosine.
    struct Split {
        Spectrum r, t;
    };
    // What the mixture is from one direction.
    struct Facing {
        float mu = 1;
        bool outside = true;
        Spectrum open{1};             // 1 - E of the coat
        float loss = 0;               // 1 - E of a white facet
        Spectrum glassLoss{0};        // of solid glass
        float spread = 0, beyond = 0; // chance of the cosine lobes; of the other side, given them
        float energy = 0;             // estimate of the albedo
    };
    Facing facing(const Vec3& w, bool outside) const noexcept;
    void weighChoices(Facing&) const noexcept;
    void addFurther(const BsdfParameters&, const LobeWeights&) noexcept;
    void addFilm(const BsdfParameters&) noexcept;
    void compensate(const BsdfParameters&) noexcept;
    void compensateGlass() noexcept;
    Spectrum dielectric(float shape) const noexcept;
    Spectrum openMean() const noexcept;
    float whiteAlbedo(const Vec3& w) const noexcept;
    float whiteAverage() const noexcept;
    Spectrum reflectedByCoat(const LayerAlbedo&, const Spectrum& underFilm) const noexcept;
    Spectrum squaredIors(bool outside) const noexcept;
    template <class Loss> Spectrum eachGlass(const Loss&) const noexcept;
    Split split(float cosTheta, bool outside) const noexcept { return split(cosTheta, outside, iors_); }
    Split split(float cosTheta, bool outside, const Spectrum& iors) const noexcept;
    Split splitAt(float cosTheta, bool outside, float ior) const noexcept;
    float reflectionChance(const Split&) const noexcept;
    void addReflection(const Vec3& wi, const Facing&, LobeValue&) const noexcept;
    void addPane(const Vec3& wi, const Facing&, LobeValue&) const noexcept;
    void addRefraction(const Vec3& wi, const Facing&, LobeValue&) const noexcept;
    void addLaterFacets(const Facing&, bool reflection, LobeValue&) const noexcept;
    void addDiffuse(const Facing&, bool reflection, LobeValue&) const noexcept;
    float deltaChance(const Split&) const noexcept;
    LobeSample parted(int channel, float place, const Split&) const noexcept;
    std::optional<LobeSample> sampleParted(float uLobe, Point2 u) const noexcept;
    Ggx<float> ggx() const noexcept { return {alphaX_, alphaY_}; }
    float etaO() const noexcept { return outside_ ? 1 : ior_; }
    float etaI() const noexcept { return outside_ ? ior_ : 1; }

    Vec3 wo_{0, 0, 1};
    float alphaX_ = 0, alphaY_ = 0, alpha_ = 0, ior_ = 1.5f;
    float metallic_ = 0, coat_ = 0, glass_ = 0; // weights of the three materials
    Spectrum metalColor_{0};                    // times its weight
    Spectrum f0_{0};                            // of the dielectric
    float f90_ = 0;
    Spectrum diffuseColor_{0}; // times its weight
    Spectrum tint_{0};         // of the glass, times its weight
    Spectrum openAverage_{1};  // 1 - Eavg
    Facing o_;
    AlbedoSlice slice_;
    Passes passes_ = Passes::none;
    Transport transport_ = Transport::radiance;
    bool outside_ = true, thin_ = true, rough_ = false, reflects_ = false, coated_ = false, diffuseLobe_ = false;
    bool cosines_ = false, through_ = false, compensated_ = false, losesGlass_ = false, brushed_ = false, film_ = false;
    float dispersion_ = 0;
    Spectrum iors_{1.5f};

    // Of the further lobes: begun only where there are any, so that plain ones need not clear it.
    struct Further {
        Spectrum throughColor;                // of the diffuse light that leaves on the other side, times its weight
        Spectrum laterReflected, laterPassed; // factors of L(wo) L(wi): metal and pane
        Spectrum laterGlass;                  // of solid glass, without n_o^2
        Spectrum glassF0;                     // of the curve that its losses are taken under
        float laterMean, glassOutside;        // pi times the mean loss; the share of the glass's later light that leaves it
        float glassBrush;                     // mean loss of the brush over that of the round lobe
        float filmWeight;
        Spectrum metalF0;
        ThinFilm film;
        CurveAlbedo curveAlbedo;
        CurveAlbedo::Curve coatCurve, metalCurve; // Fresnel terms under the film, at the nodes
        BrushedSlice brush;
        GlassLoss glassLoss[3]; // one for each channel where colours part, else the first
    };
    union {
        Further x_;
    };
    bool further_ = false; // x_ is begun
    void beginFurther() noexcept {
        if (!further_) std::construct_at(&x_);
        further_ = true;
    }
};

} // namespace chiaro
