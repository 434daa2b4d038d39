#include "materials/wide_materials.h"
#include "core/render/fault.h"
#include "core/scene/scene.h"
#include "materials/lobes.h"
#include "materials/surface_parameters.h"

namespace chiaro {
namespace {

bool inLanes(const MaterialDesc& m, const LobeWeights& w) noexcept {
    if (m.unlit || hasFurtherLobes(m) || w.ior == 0 || w.passes == LobeWeights::Passes::rough) return false;
    if (w.rough && w.glass > 0) return false;
    // An absorbing inside that other lobes than the refracting one look into.
    if (m.volume && std::isfinite(m.attenuationDistance) && (w.rough || w.diffuse)) return false;
    if (m.baseColorTexture.texture >= 0 && w.glass > 0) return false; // a black texel closes the glass
    for (const TextureSlot* slot :
         {&m.metallicRoughnessTexture, &m.normalTexture, &m.specularTexture, &m.specularColorTexture, &m.transmissionTexture})
        if (slot->texture >= 0) return false;
    return !fault(Fault::alphaIsRoughness);
}

void put(float (&to)[3], const Spectrum& s) noexcept { to[0] = s[0], to[1] = s[1], to[2] = s[2]; }

} // namespace

WideMaterials::WideMaterials(const Scene& scene) {
    columns_.emplace_back();
    for (uint32_t id = 0; id < scene.materials().size(); ++id) {
        const MaterialDesc& m = scene.material(id);
        BsdfParameters p;
        p.baseColor = {clamp01(m.baseColor[0]), clamp01(m.baseColor[1]), clamp01(m.baseColor[2])};
        p.metallic = m.metallic;
        p.roughness = m.roughness;
        p.ior = m.ior;
        p.specular = m.specular;
        p.specularColor = m.specularColor;
        p.transmission = m.transmission;
        p.thin = !m.volume;
        const LobeWeights w = lobeWeights(p);
        WideMaterial r{};
        const auto flag = [&r](WideMaterial::Flag f, bool on) { r.flags |= on ? f : 0u; };
        flag(WideMaterial::scalar, !inLanes(m, w));
        flag(WideMaterial::textured, m.baseColorTexture.texture >= 0);
        flag(WideMaterial::rough, w.rough);
        flag(WideMaterial::reflects, w.reflects);
        flag(WideMaterial::straight, w.passes == LobeWeights::Passes::straight);
        flag(WideMaterial::refracted, w.passes == LobeWeights::Passes::refracted);
        flag(WideMaterial::thin, p.thin);
        flag(WideMaterial::dielectric, w.dielectric);
        flag(WideMaterial::emits, m.unlit || !black(m.emission));
        flag(WideMaterial::askEmission, m.unlit || m.emissionTexture.texture >= 0);
        flag(WideMaterial::doubleSided, m.doubleSided || m.unlit || fault(Fault::lampTwoSided));
        const bool inside = hasInside(m);
        flag(WideMaterial::volume, inside);
        volumes_ |= inside;
        flag(WideMaterial::absorbs, inside && std::isfinite(m.attenuationDistance) && m.attenuationDistance > 0);
        // Under a texture the factor itself: the product is clamped at the hit.
        put(r.baseColor, m.baseColorTexture.texture >= 0 ? m.baseColor : p.baseColor);
        r.alpha = w.alpha, r.ior = w.ior, r.metallic = w.metallic, r.f90 = w.f90, r.coat = w.coat, r.glass = w.glass;
        put(r.f0, w.f0);
        r.laterAverage = 1;
        r.squaredIndex = squaredIndexInside(m);
        if (!(r.flags & WideMaterial::scalar) && w.metallic > 0 && w.alpha >= leastCompensated && m.compensated) {
            flag(WideMaterial::compensated, true);
            r.laterAverage = AlbedoSlice(w.alpha, w.ior).average().one;
        }
        put(r.emission, m.emission);
        Spectrum open(1);
        if (w.dielectric && w.coat > 0 && w.ior > 0) {
            const AlbedoSlice slice(w.alpha, w.ior);
            const LayerAlbedo e = slice.average();
            for (std::size_t i = 0; i < 3; ++i) open[i] = std::max(1 - (w.f0[i] * (e.one - e.shape) + w.f90 * e.shape), 0.f);
        }
        put(r.openAverage, open);
        if ((r.flags & WideMaterial::lobes) && w.alpha > 0 && w.ior > 0) {
            r.columns = uint32_t(columns_.size() * sizeof(AlbedoColumns) / sizeof(float));
            AlbedoSlice(w.alpha, w.ior).fill(columns_.emplace_back());
        }
        records_.push_back(r);
    }
}

} // namespace chiaro
