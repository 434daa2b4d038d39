// LobeStack: a mixture of lobes with what lies on top of it, fibres (KHR_materials_sheen) and over them a clear coat
// (KHR_materials_clearcoat), in the local frame of the hit. Plain materials have no layers and pay one branch.
//
// With E the directional albedo of a layer and t(w) = (1 - E_coat(w)) (1 - E_sheen(w)), what lies below is scaled
//   for the diffuse lobe   by t(wo) t(wi) / mean of t over what arrives there (Kelemen and Szirmay-Kalos 2001): it loses nothing
//   for all others         by min(t(wo), t(wi)) (Estevez and Kulla 2017): a mirror loses nothing, a wide lobe a little
// so that no stack returns more than it receives and each is reciprocal. On solid glass the layers lie on the outside alone; light that
// crosses is scaled by t of the outer direction, and what the coat sends back inwards is lost. Elsewhere both sides have them.
//
// The sheen's own albedo passes 1 towards grazing: its lobe is scaled by min(1, 1 / E(wo), 1 / E(wi)).
// The coat is a dielectric of index 1.5, GGX of its own roughness about its own normal nc. Where that is not the normal n of the surface,
// its lobe is scaled by min(1, nc.wo / n.wo) min(1, nc.wi / n.wi): no more light leaves than arrives.
#pragma once
#include "materials/lobes.h"
#include "materials/sheen.h"

namespace chiaro {

// What closures share that are made from the same parameters, wherever they look: it lives longer than they do.
struct SharedClosure {
    const LobeMixture* mixture = nullptr;   // null: to be made
    const Spectrum* diffuseScale = nullptr; // Layers::diffuseScale() of a coat about the surface's own normal; null: to be found
};

class Layers {
public:
    // coatNormal: in the local frame, on the side of wo.
    Layers(const BsdfParameters&, const Lobes& base, const Vec3& coatNormal, bool outside, const Spectrum* diffuseScale) noexcept;

    LobeValue evaluate(const Lobes& base, const Vec3& wi, Densities) const noexcept;
    std::optional<LobeSample> sample(const Lobes& base, float uLobe, Point2 u, Densities) const noexcept;
    // A delta lobe of the base as the layers leave it; with the coat's own mirror where they are one.
    LobeSample under(const Lobes& base, const LobeSample&, Densities) const noexcept;
    // The coat's mirror where it is one of its own.
    LobeSample mirror(const Lobes& base, Densities) const noexcept;
    // Of t(wo) t(wi) over a diffuse base; the same from all directions.
    const Spectrum& diffuseScale() const noexcept { return diffuseScale_; }
    bool aligned() const noexcept { return aligned_; }
    bool smooth() const noexcept { return sheen_ || (coat_ > 0 && coatRough_); }
    Spectrum albedo(const Lobes& base) const noexcept;
    float open() const noexcept { return o_.open; } // t(wo)

private:
    // The layers from one direction.
    struct Facing {
        bool covered = true;
        float coatCosine = 0, coatOpen = 1, sheenAlbedo = 0, sheenScale = 1, open = 1;
    };
    struct Chances {
        float coat = 0, sheen = 0, base = 1;
    };
    Facing facing(const Vec3& w) const noexcept;
    Chances chances(const Facing&, float baseEnergy) const noexcept;
    float between(const Facing& i) const noexcept { return o_.covered && i.covered ? std::min(o_.open, i.open) : o_.open * i.open; }
    Spectrum coatMirror() const noexcept;
    void balanceDiffuse(const Lobes& base) noexcept;
    void addCoat(const Vec3& wi, const Chances&, LobeValue&) const noexcept;
    void addSheen(const Vec3& wi, const Facing&, const Chances&, LobeValue&) const noexcept;

    float coat_ = 0, coatAlpha_ = 0;
    bool outside_ = true, twoSided_ = true, coatRough_ = false, sheen_ = false, aligned_ = true;
    Frame coatFrame_;
    AlbedoSlice coatSlice_;
    Spectrum sheenColor_{0};
    float sheenMost_ = 0;
    Charlie charlie_;
    SheenSlice sheenSlice_;
    Spectrum diffuseScale_{1}; // of t(wo) t(wi)
    Vec3 wo_;
    Facing o_;
    Chances chancesO_;
};

class LobeStack {
public:
    LobeStack(const BsdfParameters& p, const Vec3& wo, const Vec3& coatNormal, bool outside, Transport transport,
              const SharedClosure& shared = {}) noexcept
        : lobes_(shared.mixture ? Lobes(*shared.mixture, wo, outside, transport) : Lobes(p, wo, outside, transport)) {
        if (p.layered()) [[unlikely]]
            layers_.emplace(p, lobes_, coatNormal, outside, shared.diffuseScale);
    }
    LobeValue evaluate(const Vec3& wi, Densities d) const noexcept {
        return layers_ ? layers_->evaluate(lobes_, wi, d) : lobes_.evaluate(wi, d);
    }
    std::optional<LobeSample> sample(float uLobe, Point2 u, Densities d) const noexcept {
        return layers_ ? layers_->sample(lobes_, uLobe, u, d) : lobes_.sample(uLobe, u, d);
    }
    const LobeMixture& mixture() const noexcept { return lobes_.mixture(); }
    // Of layers about the surface's own normal; null: there are none.
    const Spectrum* diffuseScale() const noexcept { return layers_ && layers_->aligned() ? &layers_->diffuseScale() : nullptr; }
    bool matt() const noexcept { return lobes_.matt() && !layers_; } // diffuse and nothing else
    Spectrum mattF() const noexcept { return lobes_.mattF(); }
    const Vec3& wo() const noexcept { return lobes_.wo(); }
    bool smooth() const noexcept { return lobes_.smooth() || (layers_ && layers_->smooth()); }
    Spectrum albedo() const noexcept { return layers_ ? layers_->albedo(lobes_) : lobes_.albedo(); }
    Spectrum diffuseAlbedo() const noexcept { return layers_ ? lobes_.diffuseAlbedo() * layers_->open() : lobes_.diffuseAlbedo(); }
    // visit(LobeSample) for every delta lobe that is not black; without the densities of the reverse.
    template <class Visit> void forEachDelta(const Visit& visit) const {
        if (!lobes_.mixture().hasDelta() && !layers_) return;
        constexpr Densities forward = Densities::forward;
        const auto give = [&](const LobeSample& s) {
            if (const LobeSample d = layers_ ? layers_->under(lobes_, s, forward) : s; !black(d.weight)) visit(d);
        };
        give(lobes_.mirror());
        if (layers_)
            if (const LobeSample coat = layers_->mirror(lobes_, forward); !black(coat.weight)) visit(coat);
        for (int k = 0; k < lobes_.passages(); ++k) give(lobes_.passed(forward, k));
    }

private:
    Lobes lobes_;
    std::optional<Layers> layers_;
};

} // namespace chiaro
