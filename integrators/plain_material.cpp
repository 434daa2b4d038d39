#include "integrators/plain_material.h"
#include "materials/bsdf.h"
#include "materials/surface_parameters.h"

namespace chiaro {
namespace {

bool textured(const MaterialDesc& m) noexcept {
    for (const TextureSlot* slot : {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture, &m.specularTexture,
                                    &m.specularColorTexture, &m.transmissionTexture})
        if (slot->texture >= 0) return true;
    return false;
}

// The closure itself is asked, once: one lobe that answers the same in all directions and sends on no ray.
PlainMaterial plainMaterial(const Scene& scene, uint32_t id) {
    PlainMaterial plain;
    SurfacePoint at;
    at.material = id;
    at.ng = at.ns = {0, 0, 1};
    const BsdfParameters p = surfaceParameters(scene, at);
    plain.plain =
        !textured(scene.material(id)) && !hasFurtherLobes(scene.material(id)) && p.metallic <= 0 && p.transmission <= 0 && p.specular <= 0;
    if (!plain.plain) return plain;
    const Bsdf bsdf(p, at.ng, at.ns, at.ng);
    plain.f = bsdf.evaluate(at.ng).f();
    plain.smooth = bsdf.smooth() && !black(plain.f);
    plain.albedo = bsdf.albedo();
    plain.diffuseAlbedo = bsdf.diffuseAlbedo();
    return plain;
}

} // namespace

std::vector<PlainMaterial> plainMaterials(const Scene& scene) {
    std::vector<PlainMaterial> all;
    for (uint32_t i = 0; i < scene.materials().size(); ++i) all.push_back(plainMaterial(scene, i));
    return all;
}

} // namespace chiaro
