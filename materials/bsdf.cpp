#include "materials/bsdf.h"
#include "core/render/fault.h"

namespace chiaro {
namespace {

// A shading normal that wo does not see is turned towards it until it does, as little as needed: no lobe is defined below its horizon, and
// black specks would mark the silhouettes of every smooth mesh. A geometric normal passes unchanged, however grazing.
Vec3 facing(const Vec3& ns, const Vec3& ng, const Vec3& wo) noexcept {
    const float have = dot(ns, wo), need = std::min(0.01f, dot(ng, wo));
    if (have >= need) return ns;
    const Vec3 across = ns - wo * have;
    const float l = length(across);
    if (!(l > 1e-6f)) return ng;
    return normalize(across * (std::sqrt(1 - need * need) / l) + wo * need);
}

} // namespace

Bsdf::Bsdf(const BsdfParameters& parameters, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport transport) noexcept {
    const bool outside = dot(ng, wo) >= 0 || fault(Fault::backNormalKept);
    ng_ = outside ? ng : -ng;
    Vec3 n = outside ? ns : -ns;
    const bool importance = transport == Transport::importance, bent = !(n == ng_);
    if (bent && !importance) n = facing(n, ng_, wo);
    frame_ = Frame::about(n);
    const Vec3 local = frame_.toLocal(wo);
    // Light that arrives from below the shading normal's horizon is what a camera path refuses to sample: nothing, so that both agree.
    if (bent && importance && local.z <= 0) return;
    lobes_ = Lobes(parameters, local, outside, transport);
    if (bent && importance) adjoint_ = lobes_.wo().z / std::max(dot(ng_, wo), 1e-7f);
}

// Reflection stays on the geometric side of wo and transmission leaves it: no light leaks through a smooth-shaded wall.
bool Bsdf::sides(const Vec3& wi, const Vec3& local) const noexcept {
    const float g = dot(wi, ng_);
    return local.z > 0 ? g > 0 : g < 0;
}

// Veach 1997, section 5.3: importance scatters by f |wo.ns| |wi.ng| / (|wo.ng| |wi.ns|), here wo is where the light comes from.
float Bsdf::correction(const Vec3& wi, float cosI) const noexcept {
    return adjoint_ == 0 ? 1 : adjoint_ * absDot(wi, ng_) / std::max(std::fabs(cosI), 1e-7f);
}

BsdfValue Bsdf::evaluate(const Vec3& wi, Terms terms) const noexcept {
    BsdfValue value;
    const Vec3 local = frame_.toLocal(wi);
    if (!sides(wi, local)) return value;
    const LobeValue v = lobes_.evaluate(local);
    if (v.pdfW == 0) return value;
    value.pdfW = v.pdfW;
    value.pdfReverseW = v.pdfReverseW;
    const float scale = correction(wi, local.z);
    const Spectrum d = v.diffuse * scale, g = v.glossy * scale;
    const Event glossy = local.z > 0 ? Event::GR : Event::GT;
    if (terms == Terms::together || black(g) || black(d)) {
        value.terms[value.n++] = {d + g, luminance(g) > luminance(d) ? glossy : Event::DR};
    } else {
        value.terms[value.n++] = {d, Event::DR};
        value.terms[value.n++] = {g, glossy};
    }
    return value;
}

std::optional<BsdfSample> Bsdf::sample(float uLobe, Point2 u) const noexcept {
    const std::optional<LobeSample> s = lobes_.sample(uLobe, u);
    if (!s) return {};
    BsdfSample r{frame_.toWorld(s->wi), s->weight, s->pmf, s->pmfReverse, true, s->event};
    if (!sides(r.wi, s->wi)) return {};
    const float scale = correction(r.wi, s->wi.z);
    if (s->event == Event::SR || s->event == Event::ST) {
        r.weight = r.weight * (scale / s->pmf);
        return r;
    }
    const LobeValue v = lobes_.evaluate(s->wi);
    if (!(v.pdfW > 0)) return {};
    r.weight = (v.diffuse + v.glossy) * (scale * std::fabs(s->wi.z) / v.pdfW);
    r.pdfW = v.pdfW;
    r.pdfReverseW = v.pdfReverseW;
    r.delta = false;
    return r;
}

DeltaBranches Bsdf::deltaSplit() const noexcept {
    DeltaBranches branches;
    for (const LobeSample& s : {lobes_.mirror(), lobes_.passed()}) {
        if (black(s.weight)) continue;
        const Vec3 wi = frame_.toWorld(s.wi);
        if (sides(wi, s.wi)) branches.b[branches.n++] = {wi, s.weight * correction(wi, s.wi.z), s.event};
    }
    return branches;
}

bool Bsdf::smooth() const noexcept { return lobes_.smooth(); }
Spectrum Bsdf::albedo() const noexcept { return lobes_.albedo(); }
Spectrum Bsdf::diffuseAlbedo() const noexcept { return lobes_.diffuseAlbedo(); }

static_assert(sizeof(Bsdf) <= 384);

} // namespace chiaro
