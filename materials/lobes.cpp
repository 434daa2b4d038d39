#include "materials/lobes.h"
#include "core/render/fault.h"
#include "materials/dispersion.h"

namespace chiaro {
namespace {

Vec3 mirrored(const Vec3& w) noexcept { return {w.x, w.y, -w.z}; }
// A direction that passes is drawn with at least this chance of either kind where some wavelengths are reflected totally and some are not.
constexpr float leastParted = 0.05f;
Spectrum only(const Spectrum& s, int channel) noexcept {
    Spectrum r(0);
    r[std::size_t(channel)] = s[std::size_t(channel)];
    return r;
}

} // namespace

// f_r = F D G2 / (4 cos_o cos_i); pdf = D_o(h) / (4 o.h).
void Lobes::addReflection(const Vec3& wi, const Facing& i, LobeValue& v) const noexcept {
    const Ggx<float> g = ggx();
    const Vec3 h = normalize(wo_ + wi);
    const float c = dot(wo_, h), d = g.d(h);
    const Split s = split(c, outside_);
    float chanceO = 1, chanceI = 1;
    if (passes_ == Passes::rough) chanceO = chanceI = reflectionChance(s);
    if (passes_ == Passes::straight) {
        chanceO = reflectionChance(split(wo_.z, outside_));
        chanceI = reflectionChance(split(wi.z, outside_));
    }
    v.glossy += s.r * (d * g.visibility(wo_, wi) * (fault(Fault::glossyBias) ? 1.01f : 1.f));
    v.pdfW += (1 - o_.spread) * chanceO * (fault(Fault::visiblePdfByNormals) ? d * h.z / (4 * c) : reflectionPdfW(g, wo_, d));
    v.pdfReverseW += (1 - i.spread) * chanceI * reflectionPdfW(g, wi, d);
}

// The rough pane's transmission is its reflection lobe seen from behind.
void Lobes::addPane(const Vec3& wi, const Facing& i, LobeValue& v) const noexcept {
    const Ggx<float> g = ggx();
    const Vec3 m = mirrored(wi), h = normalize(wo_ + m);
    const float d = g.d(h);
    const Split s = split(dot(wo_, h), outside_);
    const float chance = 1 - reflectionChance(s);
    v.glossy += s.t * (d * g.visibility(wo_, m));
    v.pdfW += (1 - o_.spread) * chance * reflectionPdfW(g, wo_, d);
    v.pdfReverseW += (1 - i.spread) * chance * reflectionPdfW(g, m, d);
}

// Walter et al. 2007, equations 16, 17 and 21: h is along -(eta_o wo + eta_i wi), whose length is the Jacobian's denominator;
// f_t = (1 - F) D G2 |o.h| |i.h| eta^2 / (cos_o cos_i length^2), eta that of the side where the camera is.
void Lobes::addRefraction(const Vec3& wi, const Facing& i, LobeValue& v) const noexcept {
    const Ggx<float> g = ggx();
    const Vec3 m = mirrored(wi);
    const int parts = passages();
    for (int part = 0; part < parts; ++part) {
        const float ior = parts > 1 ? iors_[std::size_t(part)] : ior_, etaO = outside_ ? 1 : ior, etaI = outside_ ? ior : 1;
        const Vec3 sum = wo_ * etaO + wi * etaI;
        const float length2 = lengthSquared(sum);
        if (!(length2 > 0)) continue;
        const Vec3 h = sum * (std::copysign(1.f, sum.z) / std::sqrt(length2));
        const float oh = dot(wo_, h), ih = -dot(wi, h);
        if (oh <= 0 || ih <= 0) continue;
        const Split s = split(oh, outside_);
        const float d = g.d(h), common = d * oh * ih / length2, camera = transport_ == Transport::radiance ? etaO : etaI;
        const float scale = 4 * common * sqr(camera) * g.visibility(wo_, m), share = 1 / float(parts);
        v.glossy += (parts > 1 ? only(s.t, part) : s.t) * scale;
        v.pdfW += (1 - o_.spread) * share * (1 - reflectionChance(s)) * g.visible(wo_) * common * sqr(etaI);
        v.pdfReverseW += (1 - i.spread) * share * (1 - reflectionChance(split(ih, !outside_))) * g.visible(m) * common * sqr(etaO);
    }
}

void Lobes::addDiffuse(const Facing& i, bool reflection, LobeValue& v) const noexcept {
    const Spectrum& color = reflection ? diffuseColor_ : x_.throughColor;
    // Between two media, that solid glass parts, light thins out as it does by refraction.
    const bool parted = !reflection && !thin_ && glass_ > 0 && ior_ > 0;
    Spectrum scale((fault(Fault::diffuseBias) ? 1.01f : 1.f) / pi);
    if (parted && (transport_ == Transport::radiance) == outside_)
        for (std::size_t k = 0; k < 3; ++k) scale[k] /= squaredIors(false)[k];
    for (std::size_t k = 0; k < 3; ++k)
        v.diffuse[k] =
            color[k] * scale[k] * (coated_ && !fault(Fault::coatAdded) ? o_.open[k] * i.open[k] / std::max(openAverage_[k], 1e-6f) : 1);
}

void Lobes::addLaterFacets(const Facing& i, bool reflection, LobeValue& v) const noexcept {
    if (compensated_) v.glossy += (reflection ? x_.laterReflected : x_.laterPassed) * (o_.loss * i.loss);
    if (losesGlass_) {
        const bool camera = transport_ == Transport::radiance ? outside_ : i.outside;
        v.glossy += x_.laterGlass * o_.glassLoss * i.glassLoss * squaredIors(camera);
    }
}

LobeValue Lobes::evaluate(const Vec3& wi) const noexcept {
    LobeValue v;
    const bool reflection = wi.z > 0, microfacet = rough_ && passes_ == Passes::rough;
    if (wi.z == 0 || !(reflection ? smooth() : through_ || microfacet)) return v;
    const Facing i = facing(wi, reflection || thin_ ? outside_ : !outside_);
    v.energyI = i.energy;
    if (reflection ? diffuseLobe_ : through_) addDiffuse(i, reflection, v);
    if (cosines_) {
        if (compensated_ || losesGlass_) addLaterFacets(i, reflection, v);
        v.pdfW = o_.spread * (reflection ? 1 - o_.beyond : o_.beyond) * cosineHemispherePdfW(i.mu);
        v.pdfReverseW = i.spread * (reflection ? 1 - i.beyond : i.beyond) * cosineHemispherePdfW(wo_.z);
    }
    if (!reflection && microfacet) thin_ ? addPane(wi, i, v) : addRefraction(wi, i, v);
    if (reflection && rough_ && reflects_) addReflection(wi, i, v);
    return v;
}

LobeSample Lobes::mirror() const noexcept {
    LobeSample m{{-wo_.x, -wo_.y, wo_.z}, Event::SR};
    if (rough_ || !reflects_) return m;
    const Split s = split(wo_.z, outside_);
    m.weight = s.r;
    m.pmf = m.pmfReverse = (1 - o_.spread) * deltaChance(s);
    return m;
}

float Lobes::deltaChance(const Split& s) const noexcept {
    const float chance = reflectionChance(s);
    return dispersion_ > 0 && !rough_ ? std::clamp(chance, leastParted, 1 - leastParted) : chance;
}

LobeSample Lobes::passed(int passage) const noexcept {
    LobeSample m{-wo_, Event::ST};
    if (passes_ != Passes::straight && passes_ != Passes::refracted) return m;
    if (dispersion_ > 0) return parted(passage, Dispersion::middle[passage], split(wo_.z, outside_));
    const bool refracted = passes_ == Passes::refracted, beyond = refracted ? !outside_ : outside_;
    if (refracted) m.wi = refract(wo_, Vec3{0, 0, 1}, fault(Fault::etaRatioWhenLeaving) ? ior_ : etaI() / etaO());
    if (m.wi.z >= 0) return m;
    const Split s = split(wo_.z, outside_);
    m.weight = s.t * (refracted && transport_ == Transport::radiance && !fault(Fault::etaSquaredMissing) ? sqr(etaO() / etaI()) : 1);
    m.pmf = (1 - o_.spread) * (1 - reflectionChance(s));
    const Facing i = facing(m.wi, beyond);
    m.pmfReverse = (1 - i.spread) * (1 - reflectionChance(split(i.mu, beyond)));
    return m;
}

// Refraction of one channel at one place of its band; s: at the wavelength.
LobeSample Lobes::parted(int channel, float place, const Split& s) const noexcept {
    const float ior = Dispersion::ior(ior_, dispersion_, place), eta = outside_ ? ior : 1 / ior;
    LobeSample m{refract(wo_, Vec3{0, 0, 1}, eta), Event::ST};
    if (m.wi.z >= 0 || s.t[std::size_t(channel)] <= 0) return m;
    m.weight = only(s.t, channel) * (transport_ == Transport::radiance ? 1 / sqr(eta) : 1);
    m.wavelength = Dispersion::wavelength(place);
    m.pmf = (1 - o_.spread) * (1 - deltaChance(split(wo_.z, outside_))) / 3;
    const Facing i = facing(m.wi, !outside_);
    m.pmfReverse = (1 - i.spread) * (1 - deltaChance(split(i.mu, !outside_))) / 3;
    return m;
}

// A smooth lobe that parts colours. The same number places the wavelength in all three bands, so that for each of them reflection and
// refraction together return what arrived.
std::optional<LobeSample> Lobes::sampleParted(float uLobe, Point2 u) const noexcept {
    const std::size_t channel = std::min(std::size_t(u.y * 3), std::size_t(2));
    Spectrum iors;
    float places[3];
    for (std::size_t i = 0; i < 3; ++i) {
        places[i] = Dispersion::draw(i, u.x);
        iors[i] = Dispersion::ior(ior_, dispersion_, places[i]);
    }
    const Split s = split(wo_.z, outside_, iors);
    LobeSample m = mirror();
    if (uLobe < o_.spread + m.pmf) {
        m.weight = s.r;
    } else {
        m = parted(int(channel), places[channel], s);
        if (m.wi.z >= 0) return {};
    }
    if (!(m.pmf > 0)) return {};
    return m;
}

std::optional<LobeSample> Lobes::sample(float uLobe, Point2 u) const noexcept {
    if (cosines_ && uLobe < o_.spread) {
        const Vec3 wi = cosineHemisphere(u);
        if (uLobe < o_.spread * o_.beyond) return LobeSample{mirrored(wi), through_ ? Event::DT : Event::GT};
        return LobeSample{wi, diffuseLobe_ ? Event::DR : Event::GR};
    }
    if (!reflects_ && passes_ == Passes::none) return {};
    if (dispersion_ > 0 && !rough_) return sampleParted(uLobe, u);
    const Ggx<float> g = ggx();
    const bool byMicrofacet = rough_ && passes_ != Passes::straight;
    const Vec3 h = rough_ ? g.sampleVisible(wo_, u) : Vec3{0, 0, 1};
    const float c = dot(wo_, h);
    const Split at = split(byMicrofacet ? c : wo_.z, outside_);
    const float chance = reflectionChance(at);
    const float edge = o_.spread + (1 - o_.spread) * chance;
    LobeSample s;
    if (uLobe < edge) {
        if (!rough_) s = mirror();
        if (rough_) s = {reflect(wo_, h), Event::GR};
        if (s.wi.z <= 0) return {};
    } else {
        if (passes_ != Passes::rough) s = passed();
        if (passes_ == Passes::rough) {
            const std::size_t channel = std::min(std::size_t((uLobe - edge) / (1 - edge) * 3), std::size_t(2));
            const float ior = dispersion_ > 0 ? iors_[channel] : ior_;
            if (dispersion_ > 0 && at.t[channel] <= 0) return {}; // of this channel all is reflected
            s = {thin_ ? mirrored(reflect(wo_, h)) : refract(wo_, h, outside_ ? ior : 1 / ior), Event::GT};
        }
        if (s.wi.z >= 0) return {};
    }
    if (s.delta() && !(s.pmf > 0)) return {};
    return s;
}

} // namespace chiaro
