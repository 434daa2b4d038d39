#include "materials/layers.h"
#include "core/math/warp.h"
#include "materials/gauss.h"

namespace chiaro {
namespace {

constexpr float coatIor = 1.5f, coatF0 = 0.04f;
// Each layer keeps this chance beside what its albedo earns: far from its peak it may be all that there is.
constexpr float leastChance = 0.05f;

float coatFresnel(float c) noexcept { return fresnelDielectric(c, coatIor); }

} // namespace

Layers::Layers(const BsdfParameters& p, const Lobes& base, const Vec3& coatNormal, bool outside, const Spectrum* scale) noexcept
    : coat_(clamp01(p.clearcoat)), outside_(outside), twoSided_(p.thin || (p.transmission <= 0 && p.diffuseTransmission <= 0)),
      aligned_(coat_ == 0 || coatNormal == Vec3{0, 0, 1}), coatFrame_(Frame::about(aligned_ ? Vec3{0, 0, 1} : coatNormal)) {
    if (coat_ > 0) {
        const float alpha = sqr(clamp01(p.clearcoatRoughness));
        coatRough_ = alpha >= Lobes::smallestAlpha;
        coatAlpha_ = coatRough_ ? alpha : 0;
        coatSlice_ = AlbedoSlice(coatAlpha_, coatIor);
    }
    sheenMost_ = clamp01(maxComponent(p.sheenColor));
    sheen_ = sheenMost_ > 0;
    if (sheen_) {
        for (std::size_t i = 0; i < 3; ++i) sheenColor_[i] = clamp01(p.sheenColor[i]);
        charlie_.alpha = std::max(sqr(clamp01(p.sheenRoughness)), Charlie::smallestAlpha);
        sheenSlice_ = SheenSlice(charlie_.alpha);
    }
    wo_ = base.wo();
    o_ = facing(wo_);
    chancesO_ = chances(o_, base.energyO());
    if (scale && aligned_)
        diffuseScale_ = *scale;
    else if (base.mixture().diffuse())
        balanceDiffuse(base);
}

Layers::Facing Layers::facing(const Vec3& w) const noexcept {
    Facing f;
    f.covered = twoSided_ || (w.z > 0) == outside_;
    if (!f.covered) return f;
    if (coat_ > 0) {
        f.coatCosine = dot(coatFrame_.z, w) * (w.z > 0 ? 1.f : -1.f);
        const LayerAlbedo e = f.coatCosine > 0 ? coatSlice_.at(std::min(f.coatCosine, 1.f)) : LayerAlbedo{1, 1};
        f.coatOpen = std::max(1 - coat_ * (coatF0 * (e.one - e.shape) + e.shape), 0.f);
    }
    if (sheen_) {
        const float e = sheenSlice_.at(std::fabs(w.z));
        f.sheenAlbedo = sheenMost_ * std::min(e, 1.f);
        f.sheenScale = 1 / std::max(e, 1.f);
    }
    f.open = f.coatOpen * (1 - f.sheenAlbedo);
    return f;
}

Layers::Chances Layers::chances(const Facing& f, float baseEnergy) const noexcept {
    Chances c;
    const float coat = f.coatCosine > 0 ? (1 - f.coatOpen) + leastChance * coat_ : 0,
                sheen = f.covered && sheen_ ? f.coatOpen * f.sheenAlbedo + leastChance * sheenMost_ : 0;
    const float base = baseEnergy > 0 ? f.open * baseEnergy + leastChance : 0, sum = coat + sheen + base;
    if (!(sum > 0)) return c;
    return {coat / sum, sheen / sum, base / sum};
}

// The mean of t over the light that the coat of the base itself lets in, each channel's own.
void Layers::balanceDiffuse(const Lobes& base) noexcept {
    if (!aligned_) return;
    static const Gauss nodes(6);
    Spectrum both(0), own(0);
    for (std::size_t i = 0; i < nodes.x.size(); ++i) {
        const float mu = nodes.x[i], weight = 2 * mu * nodes.w[i];
        const Vec3 w{std::sqrt(1 - mu * mu), 0, outside_ || twoSided_ ? mu : -mu};
        const Spectrum open = base.mixture().open(w) * weight;
        own += open;
        both += open * facing(w).open;
    }
    for (std::size_t i = 0; i < 3; ++i) diffuseScale_[i] = own[i] / std::max(both[i], 1e-6f);
}

void Layers::addCoat(const Vec3& wi, const Chances& chancesI, LobeValue& v) const noexcept {
    const Ggx<float> g{coatAlpha_, coatAlpha_};
    const Vec3 o = coatFrame_.toLocal(wo_), in = coatFrame_.toLocal(wi), h = normalize(o + in);
    const float d = g.d(h);
    const float tilt = std::min(1.f, o.z / wo_.z) * std::min(1.f, in.z / wi.z);
    v.glossy += Spectrum(coat_ * coatFresnel(dot(o, h)) * d * g.visibility(o, in) * tilt);
    v.pdfW += chancesO_.coat * reflectionPdfW(g, o, d);
    v.pdfReverseW += chancesI.coat * reflectionPdfW(g, in, d);
}

void Layers::addSheen(const Vec3& wi, const Facing& i, const Chances& chancesI, LobeValue& v) const noexcept {
    v.glossy += sheenColor_ * (charlie_.value(wo_, wi) * std::min(o_.sheenScale, i.sheenScale) * std::min(o_.coatOpen, i.coatOpen));
    v.pdfW += chancesO_.sheen * uniformHemispherePdfW<float>();
    v.pdfReverseW += chancesI.sheen * uniformHemispherePdfW<float>();
}

LobeValue Layers::evaluate(const Lobes& base, const Vec3& wi, Densities densities) const noexcept {
    if (wi.z == 0) return {};
    LobeValue v = base.evaluate(wi, densities);
    const Facing i = facing(wi);
    const Chances chancesI = densities == Densities::both ? chances(i, v.energyI > 0 ? v.energyI : base.energyFrom(wi)) : Chances{};
    const bool bothCovered = o_.covered && i.covered;
    v.diffuse *= bothCovered && aligned_ ? diffuseScale_ * (o_.open * i.open) : Spectrum(between(i));
    v.glossy *= between(i);
    v.pdfW *= chancesO_.base;
    v.pdfReverseW *= chancesI.base;
    if (wi.z < 0 || !bothCovered) return v;
    if (coatRough_ && o_.coatCosine > 0 && i.coatCosine > 0) addCoat(wi, chancesI, v);
    if (sheen_) addSheen(wi, i, chancesI, v);
    return v;
}

// The share of the light that the coat's mirror returns, tilted normals included.
Spectrum Layers::coatMirror() const noexcept {
    if (coat_ == 0 || coatRough_ || !o_.covered || o_.coatCosine <= 0) return Spectrum(0);
    const Vec3 wi = reflect(wo_, coatFrame_.z);
    if (wi.z <= 0) return Spectrum(0);
    const float c = o_.coatCosine;
    return Spectrum(coat_ * coatFresnel(c) * std::min(1.f, wi.z / c) * std::min(1.f, c / wo_.z));
}

LobeSample Layers::under(const Lobes& base, const LobeSample& s, Densities densities) const noexcept {
    LobeSample r = s;
    const Facing i = facing(s.wi);
    const Chances chancesI = densities == Densities::both ? chances(i, base.energyFrom(s.wi)) : Chances{};
    r.weight *= between(i);
    r.pmf *= chancesO_.base;
    r.pmfReverse *= chancesI.base;
    if (s.event == Event::SR && aligned_)
        if (const Spectrum own = coatMirror(); !black(own)) {
            r.weight += own;
            r.pmf += chancesO_.coat;
            r.pmfReverse += chancesI.coat;
        }
    return r;
}

LobeSample Layers::mirror(const Lobes& base, Densities densities) const noexcept {
    LobeSample m{reflect(wo_, coatFrame_.z), Event::SR};
    if (aligned_) return m; // with that of the base
    m.weight = coatMirror();
    m.pmf = chancesO_.coat;
    if (densities == Densities::both) m.pmfReverse = chances(facing(m.wi), base.energyFrom(m.wi)).coat;
    return m;
}

std::optional<LobeSample> Layers::sample(const Lobes& base, float uLobe, Point2 u, Densities densities) const noexcept {
    const Chances& c = chancesO_;
    if (uLobe < c.coat) {
        if (!coatRough_) {
            const LobeSample m = aligned_ ? under(base, base.mirror(), densities) : mirror(base, densities);
            return black(m.weight) ? std::nullopt : std::optional(m);
        }
        const Ggx<float> g{coatAlpha_, coatAlpha_};
        const Vec3 o = coatFrame_.toLocal(wo_), local = reflect(o, g.sampleVisible(o, u)), wi = coatFrame_.toWorld(local);
        if (local.z <= 0 || wi.z <= 0) return {};
        return LobeSample{wi, Event::GR};
    }
    if (uLobe < c.coat + c.sheen) return LobeSample{uniformHemisphere(u), Event::GR};
    if (!(c.base > 0)) return {};
    const std::optional<LobeSample> s = base.sample(std::min((uLobe - c.coat - c.sheen) / c.base, oneMinusEpsilon), u, densities);
    return s && s->delta() ? std::optional(under(base, *s, densities)) : s;
}

Spectrum Layers::albedo(const Lobes& base) const noexcept {
    const Spectrum sheen = sheen_ ? sheenColor_ * (o_.sheenAlbedo / sheenMost_ * o_.coatOpen) : Spectrum(0);
    return Spectrum(o_.covered ? 1 - o_.coatOpen : 0) + sheen + base.albedo() * o_.open;
}

} // namespace chiaro
