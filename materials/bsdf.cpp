#include "materials/bsdf.h"
#include "core/render/fault.h"
#include "materials/closure_table.h"

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

// Exact where it is the frame's own normal: such a coat mirrors where its base does.
Vec3 coatIn(const Frame& frame, const Vec3& coat) noexcept { return coat == frame.z ? Vec3{0, 0, 1} : frame.toLocal(coat); }

} // namespace

Bsdf::Pose::Pose(const BsdfParameters& p, const Vec3& geometric, const Vec3& shading, const Vec3& wo, Transport transport) noexcept
    : outside(dot(geometric, wo) >= 0 || fault(Fault::backNormalKept)) {
    const float side = outside ? 1.f : -1.f;
    ng = outside ? geometric : -geometric;
    n = ns = outside ? shading : -shading;
    const bool ownCoat = p.clearcoat > 0 && lengthSquared(p.clearcoatNormal) > 0;
    if (ownCoat) coat = p.clearcoatNormal * side;
    if (!(n == ng)) {
        adjoint = transport == Transport::importance;
        if (adjoint) {
            if (dot(n, wo) <= 0) n = ng; // light from below the horizon of ns is seen only where a camera path bends ns
        } else {
            n = facing(n, ng, wo);
            if (ownCoat) coat = facing(coat, ng, wo);
        }
    }
    if (!ownCoat) coat = n;
}

Bsdf::Bsdf(const BsdfParameters& parameters, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport transport,
           Densities densities) noexcept
    : Bsdf(parameters, {}, Pose(parameters, ng, ns, wo, transport), wo, transport, densities) {}

Bsdf::Bsdf(const ClosureRecord& r, const Vec3& ng, const Vec3& ns, const Vec3& wo, Transport transport, Densities densities) noexcept
    : Bsdf(r.parameters, r.shared(), Pose(r.parameters, ng, ns, wo, transport), wo, transport, densities) {}

Bsdf::Bsdf(const BsdfParameters& parameters, const SharedClosure& shared, const Pose& pose, const Vec3& wo, Transport transport,
           Densities densities) noexcept
    : frame_(frameAbout(pose.n, parameters)), ng_(pose.ng), densities_(densities),
      lobes_(parameters, frame_.toLocal(wo), coatIn(frame_, pose.coat), pose.outside, transport, shared) {
    if (pose.adjoint) adjoint_ = Adjoint{parameters, pose.ns, pose.coat, wo, pose.outside};
}

// x along the brush where there is one.
Frame Bsdf::frameAbout(const Vec3& n, const BsdfParameters& p) noexcept {
    if (p.anisotropy > 0) [[unlikely]] {
        const Vec3 t = p.tangent - n * dot(n, p.tangent);
        if (const float l = length(t); l > 1e-6f) {
            const Vec3 x = t * (1 / l);
            return {x, cross(n, x), n};
        }
    }
    return Frame::about(n);
}

// Reflection stays on the geometric side of wo and transmission leaves it: no light leaks through a smooth-shaded wall.
bool Bsdf::sides(const Vec3& wi, const Vec3& local) const noexcept {
    const float g = dot(wi, ng_);
    return local.z > 0 ? g > 0 : g < 0;
}

namespace {

BsdfValue valueOf(const LobeValue& v, float scale, bool reflected, Terms terms) noexcept {
    BsdfValue value;
    value.pdfW = v.pdfW;
    value.pdfReverseW = v.pdfReverseW;
    const Spectrum d = v.diffuse * scale, g = v.glossy * scale;
    const Event diffuse = reflected ? Event::DR : Event::DT, glossy = reflected ? Event::GR : Event::GT;
    if (terms == Terms::together || black(g) || black(d)) {
        value.terms[value.n++] = {d + g, luminance(g) > luminance(d) ? glossy : diffuse};
    } else {
        value.terms[value.n++] = {d, diffuse};
        value.terms[value.n++] = {g, glossy};
    }
    return value;
}

} // namespace

// The reflection that swaps ns and ng: what a lobe about ns sends below the surface returns to where its horizon hides the surface.
Vec3 Bsdf::swapped(const Vec3& w) const noexcept {
    const Vec3 m = frame_.z - ng_;
    const float l = lengthSquared(m);
    return l > 0 ? w - m * (2 * dot(w, m) / l) : w;
}

// Veach 1997, section 5.3: importance scatters by f |wo.ns| |wi.ng| / (|wo.ng| |wi.ns|), here wo is where the light comes from.
float Bsdf::correction(const Vec3& wi) const noexcept {
    if (!adjoint_ || fault(Fault::adjointMissing)) return 1;
    return absDot(adjoint_->wo, frame_.z) * absDot(wi, ng_) /
           (std::max(dot(adjoint_->wo, ng_), 1e-7f) * std::max(absDot(wi, frame_.z), 1e-7f));
}

// f of the closure that the camera path has here: about the normal that it turns towards wi where wi does not see ns. The density is that
// of sampleAdjoint().
BsdfValue Bsdf::evaluateAdjoint(const Vec3& wi, Terms terms) const noexcept {
    const Adjoint& a = *adjoint_;
    const float g = dot(wi, ng_), side = g > 0 ? 1.f : -1.f;
    if (g == 0) return {};
    const Vec3 n = facing(a.ns * side, ng_ * side, wi) * side;
    const float o = dot(a.wo, n);
    if (!(o > 0)) return {};
    const Vec3 local = frame_.toLocal(wi);
    const bool ownCoat = a.parameters.clearcoat > 0 && lengthSquared(a.parameters.clearcoatNormal) > 0;
    const Vec3 coat = ownCoat ? facing(a.coat * side, ng_ * side, wi) * side : n;
    const bool same = n == frame_.z && (!ownCoat || coat == a.coat), drawn = local.z * side > 0;
    LobeValue v = lobes_.evaluate(drawn ? local : frame_.toLocal(swapped(wi)), densities_);
    if (!same) {
        const Frame frame = frameAbout(n, a.parameters);
        const float pdfW = v.pdfW;
        const SharedClosure shared{&lobes_.mixture(), lobes_.diffuseScale()};
        v = LobeStack(a.parameters, frame.toLocal(a.wo), coatIn(frame, coat), a.outside, Transport::importance, shared)
                .evaluate(frame.toLocal(wi), densities_);
        v.pdfW = pdfW;
    }
    const float scale =
        fault(Fault::adjointMissing) ? 1 : o * std::fabs(g) / (std::max(dot(a.wo, ng_), 1e-7f) * std::max(std::fabs(local.z), 1e-7f));
    return valueOf(v, scale, side > 0, terms);
}

BsdfValue Bsdf::evaluate(const Vec3& wi, Terms terms) const noexcept {
    if (adjoint_) return evaluateAdjoint(wi, terms);
    if (lobes_.matt()) return matt(wi, dot(wi, frame_.z));
    const Vec3 local = frame_.toLocal(wi);
    if (!sides(wi, local)) return {};
    const LobeValue v = lobes_.evaluate(local, densities_);
    return v.pdfW == 0 ? BsdfValue{} : valueOf(v, 1, local.z > 0, terms);
}

// The same of a diffuse lobe alone.
BsdfValue Bsdf::matt(const Vec3& wi, float cosine) const noexcept {
    BsdfValue value;
    const float pdfW = cosineHemispherePdfW(cosine);
    if (!(pdfW > 0) || !(dot(wi, ng_) > 0)) return value;
    value.terms[0] = {lobes_.mattF(), Event::DR};
    value.n = 1;
    value.pdfW = pdfW;
    value.pdfReverseW = cosineHemispherePdfW(lobes_.wo().z);
    return value;
}

// A direction on the wrong side of the surface is swapped to the right one, so that every direction that scatters light can be drawn.
std::optional<BsdfSample> Bsdf::sampleAdjoint(const LobeSample& s) const noexcept {
    BsdfSample r{frame_.toWorld(s.wi), Spectrum(0), 0, 0, false, s.event};
    if (!sides(r.wi, s.wi)) r.wi = swapped(r.wi);
    const BsdfValue v = evaluateAdjoint(r.wi, Terms::together);
    if (!(v.pdfW > 0)) return {};
    r.weight = v.f() * (absDot(r.wi, frame_.z) / v.pdfW);
    r.pdfW = v.pdfW;
    r.pdfReverseW = v.pdfReverseW;
    return r;
}

std::optional<BsdfSample> Bsdf::sample(float uLobe, Point2 u) const noexcept {
    if (lobes_.matt() && !adjoint_) {
        const Vec3 local = cosineHemisphere(u), wi = frame_.toWorld(local);
        const BsdfValue v = matt(wi, local.z);
        if (v.n == 0) return {};
        return BsdfSample{wi, v.terms[0].f * (local.z / v.pdfW), v.pdfW, v.pdfReverseW, false, Event::DR};
    }
    const std::optional<LobeSample> s = lobes_.sample(uLobe, u, densities_);
    if (!s) return {};
    const bool delta = s->delta();
    if (adjoint_ && !delta) return sampleAdjoint(*s);
    BsdfSample r{frame_.toWorld(s->wi), s->weight, s->pmf, s->pmfReverse, true, s->event, {s->wavelength}};
    if (!sides(r.wi, s->wi)) return {};
    if (delta) {
        if (adjoint_ && !(adjoint_->ns == frame_.z)) return {};
        r.weight = r.weight * (correction(r.wi) / s->pmf);
        return r;
    }
    const LobeValue v = lobes_.evaluate(s->wi, densities_);
    if (!(v.pdfW > 0)) return {};
    r.weight = (v.diffuse + v.glossy) * (std::fabs(s->wi.z) / v.pdfW);
    r.pdfW = v.pdfW;
    r.pdfReverseW = v.pdfReverseW;
    r.delta = false;
    return r;
}

DeltaBranches Bsdf::deltaSplit() const noexcept {
    DeltaBranches branches;
    if (adjoint_ && !(adjoint_->ns == frame_.z)) return branches;
    lobes_.forEachDelta([&](const LobeSample& s) {
        const Vec3 wi = frame_.toWorld(s.wi);
        if (sides(wi, s.wi)) branches.b[branches.n++] = {wi, s.weight * correction(wi), s.event};
    });
    return branches;
}

bool Bsdf::smooth() const noexcept { return lobes_.smooth(); }
Spectrum Bsdf::albedo() const noexcept { return lobes_.albedo(); }
Spectrum Bsdf::diffuseAlbedo() const noexcept { return lobes_.diffuseAlbedo(); }

static_assert(sizeof(Bsdf) <= 1536); // on the stack; plain closures touch little of it

} // namespace chiaro
