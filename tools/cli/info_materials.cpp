#include "tools/cli/info_materials.h"

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Slot {
    const char* name;
    TextureSlot MaterialDesc::*slot;
};
constexpr Slot slots[] = {{"baseColor", &MaterialDesc::baseColorTexture},
                          {"metallicRoughness", &MaterialDesc::metallicRoughnessTexture},
                          {"specularGlossiness", &MaterialDesc::specularGlossinessTexture},
                          {"normal", &MaterialDesc::normalTexture},
                          {"emission", &MaterialDesc::emissionTexture},
                          {"specular", &MaterialDesc::specularTexture},
                          {"specularColor", &MaterialDesc::specularColorTexture},
                          {"transmission", &MaterialDesc::transmissionTexture},
                          {"clearcoat", &MaterialDesc::clearcoatTexture},
                          {"clearcoatRoughness", &MaterialDesc::clearcoatRoughnessTexture},
                          {"clearcoatNormal", &MaterialDesc::clearcoatNormalTexture},
                          {"sheenColor", &MaterialDesc::sheenColorTexture},
                          {"sheenRoughness", &MaterialDesc::sheenRoughnessTexture},
                          {"anisotropy", &MaterialDesc::anisotropyTexture},
                          {"iridescence", &MaterialDesc::iridescenceTexture},
                          {"iridescenceThickness", &MaterialDesc::iridescenceThicknessTexture},
                          {"diffuseTransmission", &MaterialDesc::diffuseTransmissionTexture},
                          {"diffuseTransmissionColor", &MaterialDesc::diffuseTransmissionColorTexture}};

Json lobesOf(const MaterialDesc& m) {
    Json all = Json::array();
    if (m.unlit) return {"unlit"};
    const auto add = [&](bool there, const char* name) {
        if (there) all.push_back(name);
    };
    const bool mixed = m.metallicRoughnessTexture.texture >= 0, metal = !m.specularGlossiness && m.metallic > 0;
    const bool dielectric = m.specularGlossiness || m.metallic < 1 || mixed;
    const bool through = dielectric && m.transmission > 0;
    add(dielectric && (m.transmission < 1 || m.transmissionTexture.texture >= 0), "diffuse");
    add(dielectric && (m.specularGlossiness ? !black(m.specularColor) : m.specular > 0), "dielectric");
    add(metal, "metal");
    add(through && m.volume, "refraction");
    add(through && !m.volume, "thin pane");
    add(through && m.dispersion > 0 && m.volume, "dispersion");
    add(dielectric && m.diffuseTransmission > 0, "diffuse transmission");
    add(m.anisotropy > 0, "anisotropy");
    add(m.iridescence > 0, "thin film");
    add(!black(m.sheenColor), "sheen");
    add(m.clearcoat > 0, "clearcoat");
    add(m.volume && std::isfinite(m.attenuationDistance) && !(m.attenuationColor == Spectrum(1)), "absorption");
    add(!black(m.emission), "emission");
    return all;
}

std::string kindOf(const MaterialDesc& m) {
    std::string kind = m.unlit                ? "unlit"
                       : m.transmission > 0   ? (m.volume ? "glass" : "thin glass")
                       : m.specularGlossiness ? "specular-glossiness"
                       : m.metallic >= 0.5f   ? "metal"
                                              : "dielectric";
    if (m.alphaMode != AlphaMode::opaque) kind += m.alphaMode == AlphaMode::mask ? ", alpha mask" : ", alpha blend";
    if (!black(m.emission)) kind += ", emissive";
    if (m.doubleSided) kind += ", double-sided";
    return kind;
}

} // namespace

Json materialsOf(const SceneDesc& desc) {
    Json all = Json::array();
    for (const MaterialDesc& m : desc.materials) {
        Json textures = Json::object();
        for (const Slot& s : slots)
            if (const int t = (m.*s.slot).texture; t >= 0) textures[s.name] = desc.textures[std::size_t(t)].image;
        all.push_back({{"name", m.name}, {"kind", kindOf(m)}, {"lobes", lobesOf(m)}, {"textures", textures}});
    }
    return all;
}

} // namespace chiaro::cli
