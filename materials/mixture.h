// LobeMixture: what a mixture of lobes (materials/lobes.h) is whatever the directions: weights, colours, Fresnel ends, albedo slices, the
// losses of single scattering, and which lobes there are. Made once a material where its parameters are the same everywhere
// (materials/closure_table.h), else once a hit. It answers for what depends on one cosine; Lobes holds the direction.
#pragma once
#include "materials/albedo_tables.h"
#include "materials/lobe_tables.h"
#include "materials/lobe_weights.h"
#include "materials/microfacet.h"
#include "materials/thin_film.h"

namespace chiaro {

class LobeMixture {
public:
    static constexpr float smallestAlpha = 1e-3f; // below it a lobe is a mirror

    explicit LobeMixture(const BsdfParameters&) noexcept;

    bool smooth() const noexcept { return cosines_ || (rough_ && (reflects_ || passes_ == Passes::rough)); }
    bool hasDelta() const noexcept { return (!rough_ && reflects_) || passes_ == Passes::straight || passes_ == Passes::refracted; }
    bool diffuse() const noexcept { return diffuseLobe_ || through_; }
    Spectrum open(const Vec3& w) const noexcept; // what the coat leaves to the diffuse base

private:
    friend class Lobes;
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
    // Densities::forward: without the chances and the energy.
    Facing facing(const Vec3& w, bool outside, Densities) const noexcept;
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
    float reflectionChance(const Split&) const noexcept; // against transmission, once the choice has fallen on either
    Ggx<float> ggx() const noexcept { return {alphaX_, alphaY_}; }
    int passages() const noexcept { return dispersion_ > 0 ? 3 : 1; }

    bool matt_ = false; // diffuse and nothing else
    bool thin_ = true, rough_ = false, reflects_ = false, coated_ = false, diffuseLobe_ = false;
    bool cosines_ = false, through_ = false, compensated_ = false, losesGlass_ = false, brushed_ = false, film_ = false;
    Passes passes_ = Passes::none;
    Spectrum diffuseColor_{0}; // times its weight
    float mattEnergy_ = 0;     // its mean
    float alphaX_ = 0, alphaY_ = 0, alpha_ = 0, ior_ = 1.5f;
    float metallic_ = 0, coat_ = 0, glass_ = 0; // weights of the three materials
    Spectrum metalColor_{0};                    // times its weight
    Spectrum f0_{0};                            // of the dielectric
    float f90_ = 0;
    Spectrum tint_{0};        // of the glass, times its weight
    Spectrum openAverage_{1}; // 1 - Eavg
    AlbedoSlice slice_;
    float dispersion_ = 0;
    Spectrum iors_{1.5f};
    Spectrum laterReflected_{0}, laterPassed_{0}; // factors of L(wo) L(wi): metal and pane
    float laterMean_ = 0;                         // pi times the mean loss

    // The later light of solid rough glass.
    struct LaterGlass {
        Spectrum factor;   // without n_o^2
        Spectrum f0;       // of the curve that its losses are taken under
        float outside;     // the share of it that leaves the glass
        float brush;       // mean loss of the brush over that of the round lobe
        GlassLoss loss[3]; // one for each channel where colours part, else the first
    };
    // Of the further lobes.
    struct Further {
        Spectrum throughColor; // of the diffuse light that leaves on the other side, times its weight
        float filmWeight;
        Spectrum metalF0;
        ThinFilm film;
        CurveAlbedo curveAlbedo;
        CurveAlbedo::Curve coatCurve, metalCurve; // Fresnel terms under the film, at the nodes
        BrushedSlice brush;
    };
    // Begun only where there is such a lobe, so that plain mixtures need not clear them.
    union {
        LaterGlass y_;
    };
    union {
        Further x_;
    };
};

} // namespace chiaro
