#include "materials/surface_parameters.h"
#include "core/render/fault.h"
#include "materials/normal_map.h"
#include "materials/slot_reader.h"

namespace chiaro {
namespace {

Spectrum rgb(const Vec4& v) noexcept { return {v.x, v.y, v.z}; }
Spectrum clamped(const Spectrum& s) noexcept { return {clamp01(s[0]), clamp01(s[1]), clamp01(s[2])}; }

bool sheen(const MaterialDesc& m) noexcept { return maxComponent(m.sheenColor) > 0; }

// KHR_materials_anisotropy: red and green turn the tangent, blue scales the strength.
void readBrush(const SlotReader& read, const MaterialDesc& m, const SurfacePoint& s, BsdfParameters& p) noexcept {
    const TangentFrame frame = tangentFrame(s);
    if (!frame) return;
    Point2 along{1, 0};
    p.anisotropy = m.anisotropy;
    if (m.anisotropyTexture.texture >= 0) {
        const Vec4 c = read(m.anisotropyTexture, Transfer::linear);
        along = {2 * c.x - 1, 2 * c.y - 1};
        p.anisotropy *= c.z;
    }
    const float cosine = std::cos(m.anisotropyRotation), sine = std::sin(m.anisotropyRotation);
    p.tangent = frame.t * (along.x * cosine - along.y * sine) + frame.b * (along.x * sine + along.y * cosine);
    if (!(lengthSquared(p.tangent) > 1e-8f)) p.tangent = frame.t;
}

void readFurther(const SlotReader& read, const MaterialDesc& m, const SurfacePoint& s, BsdfParameters& p) noexcept {
    p.dispersion = p.thin ? 0 : m.dispersion;
    if (m.clearcoat > 0) {
        p.clearcoat = m.clearcoat * read(m.clearcoatTexture, Transfer::linear).x;
        p.clearcoatRoughness = m.clearcoatRoughness * read(m.clearcoatRoughnessTexture, Transfer::linear).y;
        if (m.clearcoatNormalTexture.texture >= 0 || m.normalTexture.texture >= 0)
            p.clearcoatNormal = mappedNormal(read, m.clearcoatNormalTexture, m.clearcoatNormalScale, s);
    }
    if (sheen(m)) {
        p.sheenColor = clamped(m.sheenColor * rgb(read(m.sheenColorTexture, Transfer::srgb)));
        p.sheenRoughness = m.sheenRoughness * read(m.sheenRoughnessTexture, Transfer::linear).w;
    }
    if (m.anisotropy > 0) readBrush(read, m, s, p);
    if (m.iridescence > 0) {
        p.iridescence = m.iridescence * read(m.iridescenceTexture, Transfer::linear).x;
        p.filmIor = m.iridescenceIor;
        const float share = read(m.iridescenceThicknessTexture, Transfer::linear).y; // 1 without a texture: the maximum
        p.filmThickness = m.iridescenceMin + (m.iridescenceMax - m.iridescenceMin) * share;
        if (!(p.filmThickness > 0)) p.iridescence = 0;
    }
    if (m.diffuseTransmission > 0) {
        p.diffuseTransmission = m.diffuseTransmission * read(m.diffuseTransmissionTexture, Transfer::linear).w;
        p.diffuseTransmissionColor = clamped(m.diffuseTransmissionColor * rgb(read(m.diffuseTransmissionColorTexture, Transfer::srgb)));
    }
}

// KHR_materials_pbrSpecularGlossiness: a dielectric whose F0 is given and rises to 1 as Schlick's; the diffuse colour makes room for its
// strongest channel. An infinite index stands for it: F0 is then the specular colour itself.
void readSpecularGlossiness(const SlotReader& read, const MaterialDesc& m, BsdfParameters& p) noexcept {
    const Vec4 color = read(m.specularGlossinessTexture, Transfer::srgb), plain = read(m.specularGlossinessTexture, Transfer::linear);
    p.specularColor = clamped(m.specularColor * rgb(color));
    p.baseColor *= 1 - maxComponent(p.specularColor);
    p.roughness = 1 - clamp01(m.glossiness * plain.w);
    p.metallic = p.transmission = 0;
    p.ior = 0;
    p.specular = 1;
}

} // namespace

bool hasFurtherLobes(const MaterialDesc& m) noexcept {
    return m.clearcoat > 0 || sheen(m) || m.anisotropy > 0 || m.iridescence > 0 || m.dispersion > 0 || m.diffuseTransmission > 0 ||
           m.specularGlossiness;
}

bool hasInside(const MaterialDesc& m) noexcept { return m.volume && (m.transmission > 0 || m.diffuseTransmission > 0) && m.metallic < 1; }

float squaredIndexInside(const MaterialDesc& m) noexcept { return hasInside(m) && m.transmission > 0 && m.ior > 0 ? m.ior * m.ior : 1; }

BsdfParameters surfaceParameters(const SlotReader& read, const MaterialDesc& m, const SurfacePoint& s) noexcept {
    BsdfParameters p;
    if (m.unlit) {
        p.baseColor = Spectrum(0);
        p.specular = 0;
        return p;
    }
    p.baseColor = clamped(
        m.baseColor * rgb(read(m.baseColorTexture, fault(Fault::baseColorNotDecoded) ? Transfer::linear : Transfer::srgb)) * rgb(s.color));
    p.thin = !m.volume;
    p.compensated = m.compensated;
    if (m.specularGlossiness) [[unlikely]] {
        readSpecularGlossiness(read, m, p);
    } else {
        const Vec4 mr = read(m.metallicRoughnessTexture, Transfer::linear);
        p.metallic = m.metallic * mr.z;
        p.roughness = m.roughness * mr.y;
        p.ior = m.ior;
        p.specular = m.specular * read(m.specularTexture, Transfer::linear).w;
        p.specularColor = m.specularColor * rgb(read(m.specularColorTexture, Transfer::srgb));
        p.transmission = m.transmission * read(m.transmissionTexture, Transfer::linear).x;
    }
    if (hasFurtherLobes(m)) readFurther(read, m, s, p);
    return p;
}

BsdfParameters surfaceParameters(const Scene& scene, const SurfacePoint& s) noexcept {
    return surfaceParameters(SlotReader(scene, s), scene.material(s.material), s);
}

} // namespace chiaro
