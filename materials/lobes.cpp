#include "materials/lobes.h"
#include "core/render/fault.h"
#include "materials/fresnel.h"

namespace chiaro {
namespace {

// Nearer to 1 than this the two sides of a surface are one medium: the half vector of a refraction would be noise.
constexpr float matchedIor = 1e-3f;
// However bright the base, a rough coat keeps this chance: its estimate at the macro normal may miss what its tails do.
constexpr float mostDiffuse = 0.95f;

Spectrum lerp(const Spectrum& a, float b, float t) noexcept { return a + (Spectrum(b) - a) * t; }
Spectrum atLeast0(const Spectrum& s) noexcept { return {std::max(s[0], 0.f), std::max(s[1], 0.f), std::max(s[2], 0.f)}; }
Vec3 mirrored(const Vec3& w) noexcept { return {w.x, w.y, -w.z}; }

} // namespace

LobeWeights lobeWeights(const BsdfParameters& p) noexcept {
    LobeWeights w;
    const float roughness = clamp01(p.roughness), transmission = clamp01(p.transmission);
    w.alpha = roughness * roughness < Lobes::smallestAlpha ? 0 : roughness * roughness;
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
    w.dielectric = w.f90 > 0 && !matched;
    if (matched) w.ior = 1, w.f0 = Spectrum(0), w.f90 = 0;
    w.reflects = !black(p.baseColor * w.metallic) || w.metallic > 0 || (w.dielectric && w.coat + w.glass > 0);
    if (!black(p.baseColor * w.glass) && !(w.ior == 0 && !p.thin))
        w.passes = matched || (p.thin && !w.rough) ? LobeWeights::Passes::straight
                   : w.rough                       ? LobeWeights::Passes::rough
                                                   : LobeWeights::Passes::refracted;
    w.diffuse = !black(p.baseColor * w.coat);
    w.coated = w.diffuse && w.dielectric;
    return w;
}

Lobes::Lobes(const BsdfParameters& p, const Vec3& wo, bool outside, Transport transport) noexcept
    : wo_{wo.x, wo.y, std::max(wo.z, 1e-7f)}, transport_(transport), outside_(outside), thin_(p.thin) {
    const LobeWeights w = lobeWeights(p);
    alpha_ = w.alpha;
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
    diffuseLobe_ = w.diffuse;
    coated_ = w.coated;
    if (coated_) {
        slice_ = AlbedoSlice(alpha_, ior_);
        openO_ = open(slice_.at(wo_.z));
        openAverage_ = open(slice_.average());
    }
    diffuseO_ = diffuseChance(wo_.z, outside_, openO_);
}

// F of the dielectric where the curve's shape has this value: KHR_materials_specular.
Spectrum Lobes::dielectric(float shape) const noexcept { return atLeast0(lerp(f0_, f90_, shape)); }

// What the coat leaves to the base.
Spectrum Lobes::open(const LayerAlbedo& e) const noexcept {
    return atLeast0(Spectrum(1) - (f0_ * (e.one - e.shape) + Spectrum(f90_ * e.shape)));
}

Lobes::Split Lobes::split(float cosTheta, bool outside) const noexcept {
    const float schlick = schlickShape(cosTheta);
    Split s{lerp(metalColor_, metallic_, schlick), Spectrum(0)};
    if (coat_ + glass_ == 0) return s;
    const float normal = fresnelNormal(ior_);
    const auto shape = [&](float exact) { return ior_ == 0 ? schlick : (exact - normal) / (1 - normal); };
    const Spectrum front = dielectric(f90_ == 0 ? 0 : shape(fresnelDielectric(cosTheta, ior_)));
    s.r += front * coat_;
    if (glass_ == 0) return s;
    Spectrum f = front;
    if (thin_) {
        for (float& x : f.c) x = paneReflectance(x);
    } else if (ior_ == 0) {
        f = Spectrum(1);
    } else if (!outside) {
        const float exact = fresnelDielectric(cosTheta, fault(Fault::totalReflectionMissing) ? ior_ : 1 / ior_);
        f = exact == 1 ? Spectrum(1) : dielectric(f90_ == 0 ? 0 : shape(exact));
    }
    s.r += f * glass_;
    s.t = tint_ * (Spectrum(1) - f);
    return s;
}

float Lobes::diffuseChance(float mu, bool outside, const Spectrum& openAtMu) const noexcept {
    if (!diffuseLobe_) return 0;
    if (!reflects_ && passes_ == Passes::none) return 1;
    const Split s = split(mu, outside);
    const float diffuse = average(diffuseColor_ * openAtMu), rest = average(s.r + s.t), chance = diffuse / (diffuse + rest);
    if (!(diffuse + rest > 0)) return 1;
    return rough_ ? std::min(chance, mostDiffuse) : chance;
}

// Of reflection against transmission, once the choice has fallen on either.
float Lobes::reflectionChance(const Split& s) const noexcept {
    if (passes_ == Passes::none) return 1;
    if (!reflects_) return 0;
    const float r = average(s.r), t = average(s.t);
    return r + t > 0 ? r / (r + t) : 1;
}

// f_r = F D G2 / (4 cos_o cos_i); pdf = D_o(h) / (4 o.h).
void Lobes::addReflection(const Vec3& wi, float diffuseI, LobeValue& v) const noexcept {
    const Ggx<float> ggx{alpha_, alpha_};
    const Vec3 h = normalize(wo_ + wi);
    const float c = dot(wo_, h), d = ggx.d(h);
    const Split s = split(c, outside_);
    float chanceO = 1, chanceI = 1;
    if (passes_ == Passes::rough) chanceO = chanceI = reflectionChance(s);
    if (passes_ == Passes::straight) {
        chanceO = reflectionChance(split(wo_.z, outside_));
        chanceI = reflectionChance(split(wi.z, outside_));
    }
    v.glossy = s.r * (d * ggx.visibility(wo_, wi) * (fault(Fault::glossyBias) ? 1.01f : 1.f));
    v.pdfW += (1 - diffuseO_) * chanceO * (fault(Fault::visiblePdfByNormals) ? d * h.z / (4 * c) : reflectionPdfW(ggx, wo_, d));
    v.pdfReverseW += (1 - diffuseI) * chanceI * reflectionPdfW(ggx, wi, d);
}

// The rough pane's transmission is its reflection lobe seen from behind.
void Lobes::addPane(const Vec3& wi, float diffuseI, LobeValue& v) const noexcept {
    const Ggx<float> ggx{alpha_, alpha_};
    const Vec3 m = mirrored(wi), h = normalize(wo_ + m);
    const float d = ggx.d(h);
    const Split s = split(dot(wo_, h), outside_);
    const float chance = 1 - reflectionChance(s);
    v.glossy = s.t * (d * ggx.visibility(wo_, m));
    v.pdfW += (1 - diffuseO_) * chance * reflectionPdfW(ggx, wo_, d);
    v.pdfReverseW += (1 - diffuseI) * chance * reflectionPdfW(ggx, m, d);
}

// Walter et al. 2007, equations 16, 17 and 21: h is along -(eta_o wo + eta_i wi), whose length is the Jacobian's denominator;
// f_t = (1 - F) D G2 |o.h| |i.h| eta^2 / (cos_o cos_i length^2), eta that of the side where the camera is.
void Lobes::addRefraction(const Vec3& wi, float diffuseI, LobeValue& v) const noexcept {
    const Ggx<float> ggx{alpha_, alpha_};
    const Vec3 sum = wo_ * etaO() + wi * etaI();
    const float length2 = lengthSquared(sum);
    if (!(length2 > 0)) return;
    const Vec3 h = sum * (std::copysign(1.f, sum.z) / std::sqrt(length2));
    const float oh = dot(wo_, h), ih = -dot(wi, h);
    if (oh <= 0 || ih <= 0) return;
    const Vec3 m = mirrored(wi);
    const Split s = split(oh, outside_);
    const float d = ggx.d(h), common = d * oh * ih / length2, towardsCamera = transport_ == Transport::radiance ? etaO() : etaI();
    v.glossy = s.t * (4 * common * sqr(towardsCamera) * ggx.visibility(wo_, m));
    v.pdfW += (1 - diffuseO_) * (1 - reflectionChance(s)) * ggx.visible(wo_) * common * sqr(etaI());
    v.pdfReverseW += (1 - diffuseI) * (1 - reflectionChance(split(ih, !outside_))) * ggx.visible(m) * common * sqr(etaO());
}

LobeValue Lobes::evaluate(const Vec3& wi) const noexcept {
    LobeValue v;
    const bool reflection = wi.z > 0;
    const float mu = std::fabs(wi.z);
    if (mu == 0 || !(reflection ? smooth() : rough_ && passes_ == Passes::rough)) return v;
    const Spectrum openI = coated_ ? open(slice_.at(mu)) : Spectrum(1);
    const float diffuseI = diffuseChance(mu, reflection || thin_ ? outside_ : !outside_, openI);
    if (!reflection) {
        thin_ ? addPane(wi, diffuseI, v) : addRefraction(wi, diffuseI, v);
        return v;
    }
    if (diffuseLobe_) {
        for (std::size_t i = 0; i < 3; ++i)
            v.diffuse[i] = diffuseColor_[i] * ((fault(Fault::diffuseBias) ? 1.01f : 1.f) / pi) *
                           (coated_ && !fault(Fault::coatAdded) ? openO_[i] * openI[i] / std::max(openAverage_[i], 1e-6f) : 1);
        v.pdfW = diffuseO_ * cosineHemispherePdfW(mu);
        v.pdfReverseW = diffuseI * cosineHemispherePdfW(wo_.z);
    }
    if (rough_ && reflects_) addReflection(wi, diffuseI, v);
    return v;
}

LobeSample Lobes::mirror() const noexcept {
    LobeSample m{{-wo_.x, -wo_.y, wo_.z}, Event::SR};
    if (rough_ || !reflects_) return m;
    const Split s = split(wo_.z, outside_);
    m.weight = s.r;
    m.pmf = m.pmfReverse = (1 - diffuseO_) * reflectionChance(s);
    return m;
}

LobeSample Lobes::passed() const noexcept {
    LobeSample m{-wo_, Event::ST};
    if (passes_ != Passes::straight && passes_ != Passes::refracted) return m;
    const bool refracted = passes_ == Passes::refracted, beyond = refracted ? !outside_ : outside_;
    if (refracted) m.wi = refract(wo_, Vec3{0, 0, 1}, fault(Fault::etaRatioWhenLeaving) ? ior_ : etaI() / etaO());
    if (m.wi.z >= 0) return m;
    const Split s = split(wo_.z, outside_);
    m.weight = s.t * (refracted && transport_ == Transport::radiance && !fault(Fault::etaSquaredMissing) ? sqr(etaO() / etaI()) : 1);
    m.pmf = (1 - diffuseO_) * (1 - reflectionChance(s));
    const float mu = -m.wi.z;
    const float diffuseI = diffuseChance(mu, beyond, coated_ ? open(slice_.at(mu)) : Spectrum(1));
    m.pmfReverse = (1 - diffuseI) * (1 - reflectionChance(split(mu, beyond)));
    return m;
}

std::optional<LobeSample> Lobes::sample(float uLobe, Point2 u) const noexcept {
    if (diffuseLobe_ && uLobe < diffuseO_) return LobeSample{cosineHemisphere(u), Event::DR};
    if (!reflects_ && passes_ == Passes::none) return {};
    const Ggx<float> ggx{alpha_, alpha_};
    const bool byMicrofacet = rough_ && passes_ != Passes::straight;
    const Vec3 h = rough_ ? ggx.sampleVisible(wo_, u) : Vec3{0, 0, 1};
    const float c = dot(wo_, h), chance = reflectionChance(split(byMicrofacet ? c : wo_.z, outside_));
    LobeSample s;
    if (uLobe < diffuseO_ + (1 - diffuseO_) * chance) {
        if (!rough_) s = mirror();
        if (rough_) s = {reflect(wo_, h), Event::GR};
        if (s.wi.z <= 0) return {};
    } else {
        if (passes_ != Passes::rough) s = passed();
        if (passes_ == Passes::rough) s = {thin_ ? mirrored(reflect(wo_, h)) : refract(wo_, h, etaI() / etaO()), Event::GT};
        if (s.wi.z >= 0) return {};
    }
    if ((s.event == Event::SR || s.event == Event::ST) && !(s.pmf > 0)) return {};
    return s;
}

Spectrum Lobes::albedo() const noexcept {
    if (!reflects_ && passes_ == Passes::none) return diffuseAlbedo();
    if (!rough_) return diffuseAlbedo() + split(wo_.z, outside_).r + split(wo_.z, outside_).t;
    const LayerAlbedo e = (coated_ ? slice_ : AlbedoSlice(alpha_, ior_)).at(wo_.z);
    const Spectrum layer = atLeast0(Spectrum(1) - open(e)), metal = metalColor_ * (e.one - e.shape) + Spectrum(metallic_ * e.shape);
    return diffuseAlbedo() + metal + layer * (coat_ + glass_) + tint_ * (Spectrum(1) - layer);
}

} // namespace chiaro
