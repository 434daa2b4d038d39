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
#include "core/render/fault.h"
#include "materials/mixture.h"
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
    static constexpr float smallestAlpha = LobeMixture::smallestAlpha;

    // outside: wo is on the front side of the surface.
    Lobes(const BsdfParameters& p, const Vec3& wo, bool outside, Transport transport) noexcept : Lobes(wo, outside, transport) {
        face(own_.emplace(p));
    }
    // Of a mixture that lives longer.
    Lobes(const LobeMixture& mixture, const Vec3& wo, bool outside, Transport transport) noexcept : Lobes(wo, outside, transport) {
        shared_ = &mixture;
        face(mixture);
    }

    // Densities::forward: no pdfReverseW, pmfReverse and energyI.
    LobeValue evaluate(const Vec3& wi, Densities) const noexcept;
    // A direction of one of the lobes; for a smooth one only wi and event are set, evaluate() says the rest.
    std::optional<LobeSample> sample(float uLobe, Point2 u, Densities) const noexcept;
    // The mirror and the transmitted directions, weighted by reflectance; no dice. Black where there is no such lobe.
    LobeSample mirror() const noexcept;
    int passages() const noexcept { return mixture().passages(); } // one for each channel
    LobeSample passed(Densities, int passage = 0) const noexcept;

    const LobeMixture& mixture() const noexcept { return shared_ ? *shared_ : *own_; }
    bool matt() const noexcept { return mixture().matt_; } // diffuse and nothing else
    Spectrum mattF() const noexcept { return mixture().diffuseColor_ * ((fault(Fault::diffuseBias) ? 1.01f : 1.f) / pi); }
    bool smooth() const noexcept { return mixture().smooth(); }
    Spectrum albedo() const noexcept;
    Spectrum diffuseAlbedo() const noexcept { return mixture().diffuseColor_ * o_.open; } // of what stays on the side of wo
    float energyO() const noexcept { return o_.energy; }
    float energyFrom(const Vec3& wi) const noexcept {
        return mixture().facing(wi, wi.z > 0 || mixture().thin_ ? outside_ : !outside_, Densities::both).energy;
    }
    const Vec3& wo() const noexcept { return wo_; }

private:
    using Mixture = LobeMixture;
    using Passes = LobeMixture::Passes;
    using Facing = LobeMixture::Facing;
    using Split = LobeMixture::Split;
    Lobes(const Vec3& wo, bool outside, Transport transport) noexcept
        : wo_{wo.x, wo.y, std::max(wo.z, 1e-7f)}, transport_(transport), outside_(outside) {}
    void face(const Mixture& m) noexcept { o_ = m.facing(wo_, outside_, Densities::both); }
    void addReflection(const Mixture&, const Vec3& wi, const Facing&, Densities, LobeValue&) const noexcept;
    void addPane(const Mixture&, const Vec3& wi, const Facing&, LobeValue&) const noexcept;
    void addRefraction(const Mixture&, const Vec3& wi, const Facing&, Densities, LobeValue&) const noexcept;
    void addLaterFacets(const Mixture&, const Facing&, bool reflection, LobeValue&) const noexcept;
    void addDiffuse(const Mixture&, const Facing&, bool reflection, LobeValue&) const noexcept;
    float deltaChance(const Mixture&, const Split&) const noexcept;
    LobeSample parted(int channel, float place, const Split&, Densities) const noexcept;
    std::optional<LobeSample> sampleParted(float uLobe, Point2 u, Densities) const noexcept;
    float etaO() const noexcept { return outside_ ? 1 : mixture().ior_; }
    float etaI() const noexcept { return outside_ ? mixture().ior_ : 1; }

    const Mixture* shared_ = nullptr; // null: own_
    Vec3 wo_{0, 0, 1};
    Transport transport_ = Transport::radiance;
    bool outside_ = true;
    Facing o_;
    std::optional<Mixture> own_;
};

} // namespace chiaro
