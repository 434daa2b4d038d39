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
void Lobes::addReflection(const Mixture& m, const Vec3& wi, const Facing& i, Densities densities, LobeValue& v) const noexcept {
    const Ggx<float> g = m.ggx();
    const Vec3 h = normalize(wo_ + wi);
    const float c = dot(wo_, h), d = g.d(h);
    const Split s = m.split(c, outside_);
    float chanceO = 1, chanceI = 1;
    if (m.passes_ == Passes::rough) chanceO = chanceI = m.reflectionChance(s);
    if (m.passes_ == Passes::straight) {
        chanceO = m.reflectionChance(m.split(wo_.z, outside_));
        if (densities == Densities::both) chanceI = m.reflectionChance(m.split(wi.z, outside_));
    }
    v.glossy += s.r * (d * g.visibility(wo_, wi) * (fault(Fault::glossyBias) ? 1.01f : 1.f));
    v.pdfW += (1 - o_.spread) * chanceO * (fault(Fault::visiblePdfByNormals) ? d * h.z / (4 * c) : reflectionPdfW(g, wo_, d));
    if (densities == Densities::both) v.pdfReverseW += (1 - i.spread) * chanceI * reflectionPdfW(g, wi, d);
}

// The rough pane's transmission is its reflection lobe seen from behind.
void Lobes::addPane(const Mixture& m, const Vec3& wi, const Facing& i, LobeValue& v) const noexcept {
    const Ggx<float> g = m.ggx();
    const Vec3 back = mirrored(wi), h = normalize(wo_ + back);
    const float d = g.d(h);
    const Split s = m.split(dot(wo_, h), outside_);
    const float chance = 1 - m.reflectionChance(s);
    v.glossy += s.t * (d * g.visibility(wo_, back));
    v.pdfW += (1 - o_.spread) * chance * reflectionPdfW(g, wo_, d);
    v.pdfReverseW += (1 - i.spread) * chance * reflectionPdfW(g, back, d);
}

// Walter et al. 2007, equations 16, 17 and 21: h is along -(eta_o wo + eta_i wi), whose length is the Jacobian's denominator;
// f_t = (1 - F) D G2 |o.h| |i.h| eta^2 / (cos_o cos_i length^2), eta that of the side where the camera is.
void Lobes::addRefraction(const Mixture& m, const Vec3& wi, const Facing& i, Densities densities, LobeValue& v) const noexcept {
    const Ggx<float> g = m.ggx();
    const Vec3 back = mirrored(wi);
    const int parts = m.passages();
    for (int part = 0; part < parts; ++part) {
        const float ior = parts > 1 ? m.iors_[std::size_t(part)] : m.ior_, etaO = outside_ ? 1 : ior, etaI = outside_ ? ior : 1;
        const Vec3 sum = wo_ * etaO + wi * etaI;
        const float length2 = lengthSquared(sum);
        if (!(length2 > 0)) continue;
        const Vec3 h = sum * (std::copysign(1.f, sum.z) / std::sqrt(length2));
        const float oh = dot(wo_, h), ih = -dot(wi, h);
        if (oh <= 0 || ih <= 0) continue;
        const Split s = m.split(oh, outside_);
        const float d = g.d(h), common = d * oh * ih / length2, camera = transport_ == Transport::radiance ? etaO : etaI;
        const float scale = 4 * common * sqr(camera) * g.visibility(wo_, back), share = 1 / float(parts);
        v.glossy += (parts > 1 ? only(s.t, part) : s.t) * scale;
        v.pdfW += (1 - o_.spread) * share * (1 - m.reflectionChance(s)) * g.visible(wo_) * common * sqr(etaI);
        if (densities == Densities::both)
            v.pdfReverseW +=
                (1 - i.spread) * share * (1 - m.reflectionChance(m.split(ih, !outside_))) * g.visible(back) * common * sqr(etaO);
    }
}

void Lobes::addDiffuse(const Mixture& m, const Facing& i, bool reflection, LobeValue& v) const noexcept {
    const Spectrum& color = reflection ? m.diffuseColor_ : m.x_.throughColor;
    // Between two media, that solid glass parts, light thins out as it does by refraction.
    const bool parted = !reflection && !m.thin_ && m.glass_ > 0 && m.ior_ > 0;
    Spectrum scale((fault(Fault::diffuseBias) ? 1.01f : 1.f) / pi);
    if (parted && (transport_ == Transport::radiance) == outside_)
        for (std::size_t k = 0; k < 3; ++k) scale[k] /= m.squaredIors(false)[k];
    for (std::size_t k = 0; k < 3; ++k)
        v.diffuse[k] =
            color[k] * scale[k] * (m.coated_ && !fault(Fault::coatAdded) ? o_.open[k] * i.open[k] / std::max(m.openAverage_[k], 1e-6f) : 1);
}

void Lobes::addLaterFacets(const Mixture& m, const Facing& i, bool reflection, LobeValue& v) const noexcept {
    if (m.compensated_) v.glossy += (reflection ? m.laterReflected_ : m.laterPassed_) * (o_.loss * i.loss);
    if (m.losesGlass_) {
        const bool camera = transport_ == Transport::radiance ? outside_ : i.outside;
        v.glossy += m.y_.factor * o_.glassLoss * i.glassLoss * m.squaredIors(camera);
    }
}

LobeValue Lobes::evaluate(const Vec3& wi, Densities densities) const noexcept {
    const Mixture& m = mixture();
    LobeValue v;
    if (m.matt_) {
        if (!(wi.z > 0)) return v;
        v.energyI = m.mattEnergy_;
        addDiffuse(m, o_, true, v);
        v.pdfW = cosineHemispherePdfW(wi.z);
        v.pdfReverseW = cosineHemispherePdfW(wo_.z);
        return v;
    }
    const bool reflection = wi.z > 0, microfacet = m.rough_ && m.passes_ == Passes::rough;
    if (wi.z == 0 || !(reflection ? m.smooth() : m.through_ || microfacet)) return v;
    const Facing i = m.facing(wi, reflection || m.thin_ ? outside_ : !outside_, densities);
    v.energyI = i.energy;
    if (reflection ? m.diffuseLobe_ : m.through_) addDiffuse(m, i, reflection, v);
    if (m.cosines_) {
        if (m.compensated_ || m.losesGlass_) addLaterFacets(m, i, reflection, v);
        v.pdfW = o_.spread * (reflection ? 1 - o_.beyond : o_.beyond) * cosineHemispherePdfW(i.mu);
        v.pdfReverseW = i.spread * (reflection ? 1 - i.beyond : i.beyond) * cosineHemispherePdfW(wo_.z);
    }
    if (!reflection && microfacet) m.thin_ ? addPane(m, wi, i, v) : addRefraction(m, wi, i, densities, v);
    if (reflection && m.rough_ && m.reflects_) addReflection(m, wi, i, densities, v);
    return v;
}

LobeSample Lobes::mirror() const noexcept {
    const Mixture& m = mixture();
    LobeSample r{{-wo_.x, -wo_.y, wo_.z}, Event::SR};
    if (m.rough_ || !m.reflects_) return r;
    const Split s = m.split(wo_.z, outside_);
    r.weight = s.r;
    r.pmf = r.pmfReverse = (1 - o_.spread) * deltaChance(m, s);
    return r;
}

float Lobes::deltaChance(const Mixture& m, const Split& s) const noexcept {
    const float chance = m.reflectionChance(s);
    return m.dispersion_ > 0 && !m.rough_ ? std::clamp(chance, leastParted, 1 - leastParted) : chance;
}

LobeSample Lobes::passed(Densities densities, int passage) const noexcept {
    const Mixture& m = mixture();
    LobeSample r{-wo_, Event::ST};
    if (m.passes_ != Passes::straight && m.passes_ != Passes::refracted) return r;
    if (m.dispersion_ > 0) return parted(passage, Dispersion::middle[passage], m.split(wo_.z, outside_), densities);
    const bool refracted = m.passes_ == Passes::refracted, beyond = refracted ? !outside_ : outside_;
    if (refracted) r.wi = refract(wo_, Vec3{0, 0, 1}, fault(Fault::etaRatioWhenLeaving) ? m.ior_ : etaI() / etaO());
    if (r.wi.z >= 0) return r;
    const Split s = m.split(wo_.z, outside_);
    r.weight = s.t * (refracted && transport_ == Transport::radiance && !fault(Fault::etaSquaredMissing) ? sqr(etaO() / etaI()) : 1);
    r.pmf = (1 - o_.spread) * (1 - m.reflectionChance(s));
    if (densities == Densities::forward) return r;
    const Facing i = m.facing(r.wi, beyond, densities);
    r.pmfReverse = (1 - i.spread) * (1 - m.reflectionChance(m.split(i.mu, beyond)));
    return r;
}

// Refraction of one channel at one place of its band; s: at the wavelength.
LobeSample Lobes::parted(int channel, float place, const Split& s, Densities densities) const noexcept {
    const Mixture& m = mixture();
    const float ior = Dispersion::ior(m.ior_, m.dispersion_, place), eta = outside_ ? ior : 1 / ior;
    LobeSample r{refract(wo_, Vec3{0, 0, 1}, eta), Event::ST};
    if (r.wi.z >= 0 || s.t[std::size_t(channel)] <= 0) return r;
    r.weight = only(s.t, channel) * (transport_ == Transport::radiance ? 1 / sqr(eta) : 1);
    r.wavelength = Dispersion::wavelength(place);
    r.pmf = (1 - o_.spread) * (1 - deltaChance(m, m.split(wo_.z, outside_))) / 3;
    if (densities == Densities::forward) return r;
    const Facing i = m.facing(r.wi, !outside_, densities);
    r.pmfReverse = (1 - i.spread) * (1 - deltaChance(m, m.split(i.mu, !outside_))) / 3;
    return r;
}

// A smooth lobe that parts colours. The same number places the wavelength in all three bands, so that for each of them reflection and
// refraction together return what arrived.
std::optional<LobeSample> Lobes::sampleParted(float uLobe, Point2 u, Densities densities) const noexcept {
    const Mixture& m = mixture();
    const std::size_t channel = std::min(std::size_t(u.y * 3), std::size_t(2));
    Spectrum iors;
    float places[3];
    for (std::size_t i = 0; i < 3; ++i) {
        places[i] = Dispersion::draw(i, u.x);
        iors[i] = Dispersion::ior(m.ior_, m.dispersion_, places[i]);
    }
    const Split s = m.split(wo_.z, outside_, iors);
    LobeSample r = mirror();
    if (uLobe < o_.spread + r.pmf) {
        r.weight = s.r;
    } else {
        r = parted(int(channel), places[channel], s, densities);
        if (r.wi.z >= 0) return {};
    }
    if (!(r.pmf > 0)) return {};
    return r;
}

std::optional<LobeSample> Lobes::sample(float uLobe, Point2 u, Densities densities) const noexcept {
    const Mixture& m = mixture();
    if (m.cosines_ && uLobe < o_.spread) {
        const Vec3 wi = cosineHemisphere(u);
        if (uLobe < o_.spread * o_.beyond) return LobeSample{mirrored(wi), m.through_ ? Event::DT : Event::GT};
        return LobeSample{wi, m.diffuseLobe_ ? Event::DR : Event::GR};
    }
    if (!m.reflects_ && m.passes_ == Passes::none) return {};
    if (m.dispersion_ > 0 && !m.rough_) return sampleParted(uLobe, u, densities);
    const Ggx<float> g = m.ggx();
    const bool byMicrofacet = m.rough_ && m.passes_ != Passes::straight;
    const Vec3 h = m.rough_ ? g.sampleVisible(wo_, u) : Vec3{0, 0, 1};
    const float c = dot(wo_, h);
    const Split at = m.split(byMicrofacet ? c : wo_.z, outside_);
    const float chance = m.reflectionChance(at);
    const float edge = o_.spread + (1 - o_.spread) * chance;
    LobeSample s;
    if (uLobe < edge) {
        if (!m.rough_) s = mirror();
        if (m.rough_) s = {reflect(wo_, h), Event::GR};
        if (s.wi.z <= 0) return {};
    } else {
        if (m.passes_ != Passes::rough) s = passed(densities);
        if (m.passes_ == Passes::rough) {
            const std::size_t channel = std::min(std::size_t((uLobe - edge) / (1 - edge) * 3), std::size_t(2));
            const float ior = m.dispersion_ > 0 ? m.iors_[channel] : m.ior_;
            if (m.dispersion_ > 0 && at.t[channel] <= 0) return {}; // of this channel all is reflected
            s = {m.thin_ ? mirrored(reflect(wo_, h)) : refract(wo_, h, outside_ ? ior : 1 / ior), Event::GT};
        }
        if (s.wi.z >= 0) return {};
    }
    if (s.delta() && !(s.pmf > 0)) return {};
    return s;
}

Spectrum Lobes::albedo() const noexcept {
    const Mixture& m = mixture();
    Spectrum sum = diffuseAlbedo();
    if (m.through_) sum += m.x_.throughColor * o_.open;
    if (!m.reflects_ && m.passes_ == Passes::none) return sum;
    if (!m.rough_) {
        const Split s = m.split(wo_.z, outside_);
        return sum + s.r + s.t;
    }
    const LayerAlbedo e = (m.coated_ || m.compensated_ ? m.slice_ : AlbedoSlice(m.alpha_, m.ior_)).at(wo_.z);
    Spectrum metal = m.metalColor_ * (e.one - e.shape) + Spectrum(m.metallic_ * e.shape), film(0);
    if (m.film_) {
        film = m.x_.curveAlbedo.at(wo_.z, m.x_.coatCurve);
        if (m.metallic_ > 0) metal += (m.x_.curveAlbedo.at(wo_.z, m.x_.metalCurve) * m.metallic_ - metal) * m.x_.filmWeight;
    }
    if (m.compensated_) metal += m.laterReflected_ * (o_.loss * m.laterMean_);
    const Spectrum layer = m.reflectedByCoat(e, film);
    return sum + metal + layer * (m.coat_ + m.glass_) + m.tint_ * (Spectrum(1) - layer);
}

} // namespace chiaro
