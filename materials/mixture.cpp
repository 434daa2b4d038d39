#include "materials/mixture.h"
#include "core/render/fault.h"
#include "materials/dispersion.h"
#include <memory>

namespace chiaro {
namespace {

// Nearer to 1 than this the two sides of a surface are one medium: the half vector of a refraction would be noise.
constexpr float matchedIor = 1e-3f;
// However bright the base, a rough coat keeps this chance: its estimate at the macro normal may miss what its tails do.
constexpr float mostSpread = 0.95f;

Spectrum lerp(const Spectrum& a, float b, float t) noexcept { return a + (Spectrum(b) - a) * t; }
Spectrum mix(const Spectrum& a, const Spectrum& b, float t) noexcept { return a + (b - a) * t; }
Spectrum atLeast0(const Spectrum& s) noexcept { return {std::max(s[0], 0.f), std::max(s[1], 0.f), std::max(s[2], 0.f)}; }
Spectrum divided(const Spectrum& a, const Spectrum& b) noexcept { return {a[0] / b[0], a[1] / b[1], a[2] / b[2]}; }

} // namespace

LobeWeights lobeWeights(const BsdfParameters& p) noexcept {
    LobeWeights w;
    const float roughness = clamp01(p.roughness), transmission = clamp01(p.transmission);
    w.alpha = roughness * roughness < LobeMixture::smallestAlpha ? 0 : roughness * roughness;
    if (fault(Fault::alphaIsRoughness)) w.alpha = roughness;
    w.rough = w.alpha > 0;
    w.ior = p.ior == 0 ? 0 : std::max(p.ior, 1.f);
    w.metallic = clamp01(p.metallic);
    w.coat = (1 - w.metallic) * (1 - transmission);
    w.glass = (1 - w.metallic) * transmission;
    w.f90 = clamp01(p.specular);
    const float normal = w.ior == 0 ? 1 : fresnelNormal(w.ior);
    for (std::size_t i = 0; i < 3; ++i) w.f0[i] = std::min(normal * std::max(p.specularColor[i], 0.f), 1.f) * w.f90;

    const bool matched = w.ior > 0 && w.ior - 1 < matchedIor;
    w.dielectric = (w.f90 > 0 && !matched) || p.iridescence > 0;
    if (matched) w.ior = 1, w.f0 = Spectrum(0), w.f90 = 0;
    w.reflects = !black(p.baseColor * w.metallic) || w.metallic > 0 || (w.dielectric && w.coat + w.glass > 0);
    if (!black(p.baseColor * w.glass) && !(w.ior == 0 && !p.thin))
        w.passes = matched || (p.thin && !w.rough) ? LobeWeights::Passes::straight
                   : w.rough                       ? LobeWeights::Passes::rough
                                                   : LobeWeights::Passes::refracted;
    w.through = p.diffuseTransmission > 0 && !black(p.diffuseTransmissionColor * w.coat);
    w.diffuse = !black(p.baseColor * w.coat) && p.diffuseTransmission < 1;
    w.coated = (w.diffuse || w.through) && w.dielectric;
    return w;
}

LobeMixture::LobeMixture(const BsdfParameters& p) noexcept : thin_(p.thin) {
    const LobeWeights w = lobeWeights(p);
    alpha_ = alphaX_ = alphaY_ = w.alpha;
    rough_ = w.rough;
    ior_ = w.ior;
    metallic_ = w.metallic;
    coat_ = w.coat;
    glass_ = w.glass;
    metalColor_ = p.baseColor * metallic_;
    tint_ = p.baseColor * glass_;
    diffuseColor_ = p.baseColor * coat_;
    f0_ = w.f0;
    f90_ = w.f90;
    reflects_ = w.reflects;
    passes_ = w.passes;
    cosines_ = diffuseLobe_ = w.diffuse;
    coated_ = w.coated;
    if (p.anisotropy > 0 || p.iridescence > 0 || p.dispersion > 0 || p.diffuseTransmission > 0) [[unlikely]]
        addFurther(p, w);
    if (coated_) slice_ = AlbedoSlice(alpha_, ior_);
    if (alpha_ >= leastCompensated && p.compensated && (metallic_ > 0 || glass_ > 0)) compensate(p);
    if (coated_) openAverage_ = openMean();
    matt_ = diffuseLobe_ && !coated_ && !through_ && !reflects_ && passes_ == Passes::none;
    if (matt_) mattEnergy_ = average(diffuseColor_);
}

void LobeMixture::addFurther(const BsdfParameters& p, const LobeWeights& w) noexcept {
    std::construct_at(&x_);
    if (p.diffuseTransmission > 0) {
        const float share = clamp01(p.diffuseTransmission);
        diffuseColor_ *= 1 - share;
        through_ = w.through;
        x_.throughColor = p.diffuseTransmissionColor * (coat_ * share);
        cosines_ = cosines_ || through_;
    }
    if (rough_ && p.anisotropy > 0) {
        const float strength = clamp01(p.anisotropy);
        brushed_ = true;
        alphaX_ = BrushedSlice::along(alpha_, strength);
        x_.brush = BrushedSlice(alpha_, strength);
        alpha_ = std::sqrt(alphaX_ * alphaY_); // of the round lobe that stands for it in the tables
    }
    if (p.dispersion > 0 && !thin_ && ior_ > 1 && (passes_ == Passes::rough || passes_ == Passes::refracted)) {
        dispersion_ = p.dispersion;
        iors_ = Dispersion::iors(ior_, dispersion_);
    }
    if (p.iridescence > 0) addFilm(p);
}

void LobeMixture::addFilm(const BsdfParameters& p) noexcept {
    film_ = true;
    x_.filmWeight = clamp01(p.iridescence);
    x_.film = ThinFilm(p.filmIor, p.filmThickness);
    x_.metalF0 = p.baseColor;
    for (int k = 0; k < CurveAlbedo::nodes; ++k) {
        const float c = CurveAlbedo::cosine(k);
        if (coat_ + glass_ > 0) x_.coatCurve[k] = x_.film.overDielectric(f0_, c);
        if (metallic_ > 0) x_.metalCurve[k] = x_.film.overMetal(x_.metalF0, c);
    }
    if (rough_) x_.curveAlbedo = CurveAlbedo(alpha_);
}

// ---- one cosine

// F of the dielectric where the curve's shape has this value: KHR_materials_specular.
Spectrum LobeMixture::dielectric(float shape) const noexcept { return atLeast0(lerp(f0_, f90_, shape)); }

LobeMixture::Split LobeMixture::split(float cosTheta, bool outside, const Spectrum& iors) const noexcept {
    if (dispersion_ == 0) return splitAt(cosTheta, outside, ior_);
    Split s;
    for (std::size_t i = 0; i < 3; ++i) {
        const Split channel = splitAt(cosTheta, outside, iors[i]);
        s.r[i] = channel.r[i];
        s.t[i] = channel.t[i];
    }
    return s;
}

LobeMixture::Split LobeMixture::splitAt(float cosTheta, bool outside, float ior) const noexcept {
    const float schlick = schlickShape(cosTheta);
    Split s{lerp(metalColor_, metallic_, schlick), Spectrum(0)};
    if (film_ && metallic_ > 0) s.r = mix(s.r, x_.film.overMetal(x_.metalF0, cosTheta) * metallic_, x_.filmWeight);
    if (coat_ + glass_ == 0) return s;
    const float normal = fresnelNormal(ior);
    const auto shape = [&](float exact) { return ior == 0 ? schlick : (exact - normal) / (1 - normal); };
    Spectrum front = dielectric(f90_ == 0 ? 0 : shape(fresnelDielectric(cosTheta, ior)));
    if (film_) front = mix(front, x_.film.overDielectric(f0_, cosTheta), x_.filmWeight);
    s.r += front * coat_;
    if (glass_ == 0) return s;
    Spectrum f = front;
    if (thin_) {
        for (float& x : f.c) x = paneReflectance(x);
    } else if (ior == 0) {
        f = Spectrum(1);
    } else if (!outside) {
        const float exact = fresnelDielectric(cosTheta, fault(Fault::totalReflectionMissing) ? ior : 1 / ior);
        f = exact == 1 ? Spectrum(1) : dielectric(f90_ == 0 ? 0 : shape(exact));
        if (film_ && exact < 1) // the film lies outside, where the cosine is that of the refracted way
            f = mix(f, x_.film.overDielectric(f0_, safeSqrt(1 - sqr(ior) * (1 - sqr(cosTheta)))), x_.filmWeight);
    }
    s.r += f * glass_;
    s.t = tint_ * (Spectrum(1) - f);
    return s;
}

// Of reflection against transmission, once the choice has fallen on either.
float LobeMixture::reflectionChance(const Split& s) const noexcept {
    if (passes_ == Passes::none) return 1;
    if (!reflects_) return 0;
    const float r = average(s.r), t = average(s.t);
    return r + t > 0 ? r / (r + t) : 1;
}

// ---- all cosines

float LobeMixture::whiteAlbedo(const Vec3& w) const noexcept { return brushed_ ? x_.brush.at(w) : slice_.one(std::fabs(w.z)); }
float LobeMixture::whiteAverage() const noexcept { return brushed_ ? x_.brush.average() : slice_.average().one; }

Spectrum LobeMixture::reflectedByCoat(const LayerAlbedo& e, const Spectrum& underFilm) const noexcept {
    const Spectrum plain = f0_ * (e.one - e.shape) + Spectrum(f90_ * e.shape);
    return film_ ? mix(plain, underFilm, x_.filmWeight) : plain;
}

Spectrum LobeMixture::open(const Vec3& w) const noexcept {
    if (!coated_) return Spectrum(1);
    const float mu = std::fabs(w.z);
    LayerAlbedo e = slice_.at(mu);
    Spectrum film(0);
    if (film_) film = rough_ ? x_.curveAlbedo.at(mu, x_.coatCurve) : x_.film.overDielectric(f0_, mu);
    if (brushed_) {
        const float ratio = x_.brush.at(w) / e.one;
        e.one *= ratio, e.shape *= ratio, film *= ratio;
    }
    return atLeast0(Spectrum(1) - reflectedByCoat(e, film));
}

Spectrum LobeMixture::openMean() const noexcept {
    LayerAlbedo e = slice_.average();
    Spectrum film(0);
    if (film_) film = rough_ ? x_.curveAlbedo.average(x_.coatCurve) : CurveAlbedo::mean(x_.coatCurve);
    if (brushed_) {
        const float ratio = x_.brush.average() / e.one;
        e.one *= ratio, e.shape *= ratio, film *= ratio;
    }
    return atLeast0(Spectrum(1) - reflectedByCoat(e, film));
}

void LobeMixture::compensate(const BsdfParameters& p) noexcept {
    if (!coated_) slice_ = AlbedoSlice(alpha_, ior_);
    const float average = whiteAverage(), factor = 1 / (pi * std::max(1 - average, leastLoss));
    laterMean_ = pi * (1 - average);
    if (metallic_ > 0) {
        Spectrum mean = p.baseColor + (Spectrum(1) - p.baseColor) * (1 / 21.f);
        if (film_) mean = mix(mean, CurveAlbedo::mean(x_.metalCurve), x_.filmWeight);
        for (std::size_t i = 0; i < 3; ++i) laterReflected_[i] = metallic_ * laterFacets(std::min(mean[i], 1.f), average);
    }
    if (glass_ > 0 && ior_ == 0 && !thin_) laterReflected_ += Spectrum(glass_ * factor);
    if (passes_ == Passes::rough && thin_) {
        Spectrum r = dielectric(AlbedoSlice(0, ior_).average().shape);
        if (film_) r = mix(r, CurveAlbedo::mean(x_.coatCurve), x_.filmWeight);
        for (float& x : r.c) x = paneReflectance(x);
        laterReflected_ += r * (glass_ * factor);
        laterPassed_ = tint_ * (Spectrum(1) - r) * factor;
    }
    compensated_ = !black(laterReflected_) || !black(laterPassed_);
    if (passes_ == Passes::rough && !thin_) compensateGlass();
    cosines_ = cosines_ || compensated_ || losesGlass_;
}

// Each channel's own.
template <class Loss> Spectrum LobeMixture::eachGlass(const Loss& loss) const noexcept {
    Spectrum s = loss(y_.loss[0]);
    if (dispersion_ > 0)
        for (std::size_t i = 1; i < 3; ++i) s[i] = loss(y_.loss[i])[i];
    return s;
}

void LobeMixture::compensateGlass() noexcept {
    losesGlass_ = true;
    std::construct_at(&y_);
    for (std::size_t i = 0; i < std::size_t(passages()); ++i) y_.loss[i] = GlassLoss(alpha_, dispersion_ > 0 ? iors_[i] : ior_);
    y_.f0 = film_ ? mix(f0_, CurveAlbedo::mean(x_.coatCurve), x_.filmWeight) : f0_;
    y_.brush = brushed_ ? (1 - x_.brush.average()) / std::max(1 - slice_.average().one, 1e-4f) : 1;
    const auto mean = [&](bool outside) {
        return eachGlass([&](const GlassLoss& g) { return g.average(outside, y_.f0, f90_); }) * y_.brush;
    };
    const Spectrum outside = mean(true), within = mean(false) * squaredIors(false), both = outside + within + Spectrum(1e-6f);
    // Brush and film change the losses by factors that are estimates: a part is left out so that they never give more than is lost.
    y_.factor = divided(tint_, both) * ((brushed_ ? 0.85f : film_ ? 0.97f : 1.f) / pi);
    y_.outside = average(outside) / average(both);
}

Spectrum LobeMixture::squaredIors(bool outside) const noexcept {
    if (outside) return Spectrum(1);
    return dispersion_ > 0 ? iors_ * iors_ : Spectrum(sqr(ior_));
}

LobeMixture::Facing LobeMixture::facing(const Vec3& w, bool outside, Densities densities) const noexcept {
    Facing f;
    f.mu = std::fabs(w.z);
    f.outside = outside;
    if (matt_) {
        f.spread = 1;
        f.energy = mattEnergy_;
        return f;
    }
    if (coated_) f.open = open(w);
    if (compensated_) f.loss = std::max(1 - whiteAlbedo(w), 0.f);
    if (losesGlass_) {
        f.glassLoss = eachGlass([&](const GlassLoss& g) { return g.at(f.mu, outside, y_.f0, f90_); });
        if (brushed_) f.glassLoss *= (1 - x_.brush.at(w)) / std::max(1 - slice_.one(f.mu), 1e-4f);
    }
    if (densities == Densities::both) weighChoices(f);
    return f;
}

void LobeMixture::weighChoices(Facing& f) const noexcept {
    float here = diffuseLobe_ ? average(diffuseColor_ * f.open) : 0, there = through_ ? average(x_.throughColor * f.open) : 0;
    if (!reflects_ && passes_ == Passes::none) {
        f.energy = here + there;
        f.spread = cosines_ ? 1 : 0;
        f.beyond = there > 0 ? there / (here + there) : 0;
        return;
    }
    if (compensated_) {
        here += average(laterReflected_) * (f.loss * laterMean_);
        there += average(laterPassed_) * (f.loss * laterMean_);
    }
    if (losesGlass_) {
        const float lost = average(tint_ * f.glassLoss), out = y_.outside;
        here += lost * (f.outside ? out : 1 - out);
        there += lost * (f.outside ? 1 - out : out);
    }
    const Split s = split(f.mu, f.outside);
    const float cosines = here + there, rest = average(s.r + s.t), chance = cosines / (cosines + rest);
    f.energy = cosines + rest;
    f.beyond = there > 0 ? there / cosines : 0;
    f.spread = !cosines_ ? 0 : !(cosines + rest > 0) ? 1 : rough_ ? std::min(chance, mostSpread) : chance;
}

} // namespace chiaro
