#include "materials/surface_parameters.h"
#include "core/render/fault.h"
#include "materials/slot_reader.h"

namespace chiaro {
namespace {

Spectrum rgb(const Vec4& v) noexcept { return {v.x, v.y, v.z}; }
float clamped(float x) noexcept { return clamp01(x); }

} // namespace

BsdfParameters surfaceParameters(const SlotReader& read, const MaterialDesc& m, const SurfacePoint& s) noexcept {
    BsdfParameters p;
    if (m.unlit) {
        p.baseColor = Spectrum(0);
        p.specular = 0;
        return p;
    }
    const Spectrum base =
        m.baseColor * rgb(read(m.baseColorTexture, fault(Fault::baseColorNotDecoded) ? Transfer::linear : Transfer::srgb)) * rgb(s.color);
    p.baseColor = {clamped(base[0]), clamped(base[1]), clamped(base[2])};
    const Vec4 mr = read(m.metallicRoughnessTexture, Transfer::linear);
    p.metallic = m.metallic * mr.z;
    p.roughness = m.roughness * mr.y;
    p.ior = m.ior;
    p.specular = m.specular * read(m.specularTexture, Transfer::linear).w;
    p.specularColor = m.specularColor * rgb(read(m.specularColorTexture, Transfer::srgb));
    p.transmission = m.transmission * read(m.transmissionTexture, Transfer::linear).x;
    p.thin = !m.volume;
    return p;
}

BsdfParameters surfaceParameters(const Scene& scene, const SurfacePoint& s) noexcept {
    return surfaceParameters(SlotReader(scene, s), scene.material(s.material), s);
}

} // namespace chiaro
