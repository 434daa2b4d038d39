#include "core/render/fault.h"
#include "materials/bsdf.h"
#include "materials/slot_reader.h"
#include "materials/surface_parameters.h"

namespace chiaro {
namespace {

// The tangent frame of the file where there is one (KHR: bitangent = cross(n, t) * w), else that of the UVs, made orthogonal to the normal.
struct Tangents {
    Vec3 t, b;
    explicit operator bool() const noexcept { return lengthSquared(t) > 0; }
};
Tangents tangents(const SurfacePoint& s) noexcept {
    const bool given = lengthSquared(s.tangent) > 0;
    const Vec3 along = given ? s.tangent : s.dpdu, t = along - s.ns * dot(along, s.ns);
    const float l = length(t);
    if (!(l > 0) || !std::isfinite(1 / l)) return {};
    const Vec3 unit = t * (1 / l), b = cross(s.ns, unit);
    // glTF's V runs down the picture; a normal map's green points up it: the bitangent is against dp/dv.
    const float sign = given ? s.tangentSign : dot(b, s.dpdv) > 0 ? -1.f : 1.f;
    return {unit, b * sign};
}

// A bent normal below the geometric horizon is brought back onto it: it would see nothing of what the surface sees.
Vec3 above(const Vec3& n, const Vec3& ng) noexcept {
    const float c = dot(n, ng), least = 1e-3f;
    if (c >= least) return n;
    const Vec3 raised = n + ng * (least - c);
    const float l = length(raised);
    return l > 1e-6f ? raised * (1 / l) : ng;
}

// glTF 2.0, 3.9.3: c 2 - 1 in each channel, the scale on x and y before normalising.
Vec3 shadingNormal(const SlotReader& read, const MaterialDesc& m, const SurfacePoint& s) noexcept {
    if (m.normalTexture.texture < 0) return s.ns;
    const Tangents frame = tangents(s);
    if (!frame) return s.ns;
    Vec4 c = read(m.normalTexture, Transfer::linear);
    if (fault(Fault::normalGreenFlipped)) c.y = 1 - c.y;
    const Vec3 n = frame.t * ((2 * c.x - 1) * m.normalScale) + frame.b * ((2 * c.y - 1) * m.normalScale) + s.ns * (2 * c.z - 1);
    const float l = length(n);
    return l > 1e-6f ? above(n * (1 / l), s.ng) : s.ns;
}

// The volume material behind the back face at s, where a segment along w (leaving s) runs on that side; null: outside, or no volume.
const MaterialDesc* inside(const Scene& scene, const SurfacePoint* s, const Vec3& w) noexcept {
    if (s == nullptr || dot(s->ng, w) >= 0) return nullptr;
    const MaterialDesc& m = scene.material(s->material);
    return m.volume && m.transmission > 0 && m.metallic < 1 ? &m : nullptr;
}

} // namespace

Bsdf shade(const Scene& scene, const SurfacePoint& s, const Vec3& wo, const Footprint&, Wavelengths&, Transport transport) noexcept {
    const MaterialDesc& m = scene.material(s.material);
    const SlotReader read(scene, s);
    return Bsdf(surfaceParameters(read, m, s), s.ng, shadingNormal(read, m, s), wo, transport);
}

Spectrum segmentTransmittance(const Scene& scene, const SurfacePoint* from, const Vec3& wi, const SurfacePoint* to,
                              float distance) noexcept {
    const MaterialDesc* m = inside(scene, from, wi);
    if (m == nullptr) m = inside(scene, to, -wi);
    if (m == nullptr || !std::isfinite(m->attenuationDistance) || !(m->attenuationDistance > 0)) return Spectrum(1);
    Spectrum t;
    for (std::size_t i = 0; i < 3; ++i)
        t[i] = std::pow(clamp01(m->attenuationColor[i]), fault(Fault::absorptionPerBounce) ? 1 : distance / m->attenuationDistance);
    return t;
}

} // namespace chiaro
