// A material as glTF: its factors, its textures, and those extensions that say more than their defaults.
#include "io/gltf_write_content.h"
#include <cmath>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

json numbersOf(const Spectrum& s) { return {s[0], s[1], s[2]}; }

class MaterialWriter {
public:
    explicit MaterialWriter(GltfDocument::Content& to) : to_(to) {}
    json write(const MaterialDesc& m);

private:
    // KHR_texture_transform from the affine map: scale, then rotation, then offset.
    json slotOf(const TextureSlot& s);
    void slot(json& holder, const char* key, const TextureSlot& s) {
        if (s.texture >= 0) holder[key] = slotOf(s);
    }
    void scaled(json& holder, const char* key, const TextureSlot& s, float scale) {
        slot(holder, key, s);
        if (holder.contains(key)) holder[key]["scale"] = scale;
    }
    void addBase(json& out, const MaterialDesc& m);
    void addSurface(json& out, const MaterialDesc& m);
    void addSpecular(const MaterialDesc& m);
    void addInside(const MaterialDesc& m);
    void addLayers(const MaterialDesc& m);
    void addFilm(const MaterialDesc& m);

    GltfDocument::Content& to_;
    json extensions_ = json::object();
};

json MaterialWriter::slotOf(const TextureSlot& s) {
    json out{{"index", s.texture}};
    if (s.uvSet != 0) out["texCoord"] = s.uvSet;
    const auto& m = s.transform;
    if (m[0][0] == 1 && m[0][1] == 0 && m[0][2] == 0 && m[1][0] == 0 && m[1][1] == 1 && m[1][2] == 0) return out;
    const double sx = std::hypot(m[0][0], m[1][0]), angle = std::atan2(-double(m[1][0]), double(m[0][0]));
    const double sy = std::cos(angle) * double(m[1][1]) + std::sin(angle) * double(m[0][1]);
    out["extensions"]["KHR_texture_transform"] = {{"offset", {m[0][2], m[1][2]}}, {"rotation", angle}, {"scale", {sx, sy}}};
    to_.use("KHR_texture_transform");
    return out;
}

void MaterialWriter::addBase(json& out, const MaterialDesc& m) {
    const json color{m.baseColor[0], m.baseColor[1], m.baseColor[2], m.alpha};
    if (m.specularGlossiness) {
        json& old = extensions_["KHR_materials_pbrSpecularGlossiness"];
        old = {{"diffuseFactor", color}, {"specularFactor", numbersOf(m.specularColor)}, {"glossinessFactor", m.glossiness}};
        slot(old, "diffuseTexture", m.baseColorTexture);
        slot(old, "specularGlossinessTexture", m.specularGlossinessTexture);
        return;
    }
    json& pbr = out["pbrMetallicRoughness"];
    pbr = {{"baseColorFactor", color}, {"metallicFactor", m.metallic}, {"roughnessFactor", m.roughness}};
    slot(pbr, "baseColorTexture", m.baseColorTexture);
    slot(pbr, "metallicRoughnessTexture", m.metallicRoughnessTexture);
    addSpecular(m);
}

void MaterialWriter::addSpecular(const MaterialDesc& m) {
    if (m.specular == 1 && m.specularColor == Spectrum(1) && m.specularTexture.texture < 0 && m.specularColorTexture.texture < 0) return;
    json& s = extensions_["KHR_materials_specular"];
    s = {{"specularFactor", m.specular}, {"specularColorFactor", numbersOf(m.specularColor)}};
    slot(s, "specularTexture", m.specularTexture);
    slot(s, "specularColorTexture", m.specularColorTexture);
}

void MaterialWriter::addSurface(json& out, const MaterialDesc& m) {
    scaled(out, "normalTexture", m.normalTexture, m.normalScale);
    if (const float strongest = maxComponent(m.emission); strongest > 0) {
        out["emissiveFactor"] = numbersOf(m.emission * (1 / std::max(strongest, 1.f)));
        if (strongest > 1) extensions_["KHR_materials_emissive_strength"]["emissiveStrength"] = strongest;
        slot(out, "emissiveTexture", m.emissionTexture);
    }
    if (m.alphaMode != AlphaMode::opaque) out["alphaMode"] = m.alphaMode == AlphaMode::mask ? "MASK" : "BLEND";
    if (m.alphaMode == AlphaMode::mask) out["alphaCutoff"] = m.alphaCutoff;
    if (m.doubleSided) out["doubleSided"] = true;
    if (m.unlit) extensions_["KHR_materials_unlit"] = json::object();
    if (m.ior != 1.5f) extensions_["KHR_materials_ior"]["ior"] = m.ior;
}

void MaterialWriter::addInside(const MaterialDesc& m) {
    if (m.transmission > 0) {
        json& t = extensions_["KHR_materials_transmission"];
        t["transmissionFactor"] = m.transmission;
        slot(t, "transmissionTexture", m.transmissionTexture);
    }
    if (m.diffuseTransmission > 0) {
        json& t = extensions_["KHR_materials_diffuse_transmission"];
        t = {{"diffuseTransmissionFactor", m.diffuseTransmission},
             {"diffuseTransmissionColorFactor", numbersOf(m.diffuseTransmissionColor)}};
        slot(t, "diffuseTransmissionTexture", m.diffuseTransmissionTexture);
        slot(t, "diffuseTransmissionColorTexture", m.diffuseTransmissionColorTexture);
    }
    if (m.volume) {
        json& v = extensions_["KHR_materials_volume"];
        v = {{"thicknessFactor", 1}, {"attenuationColor", numbersOf(m.attenuationColor)}};
        if (std::isfinite(m.attenuationDistance)) v["attenuationDistance"] = m.attenuationDistance;
    }
    if (m.dispersion > 0) extensions_["KHR_materials_dispersion"]["dispersion"] = m.dispersion;
}

void MaterialWriter::addFilm(const MaterialDesc& m) {
    if (!(m.iridescence > 0)) return;
    json& film = extensions_["KHR_materials_iridescence"];
    film = {{"iridescenceFactor", m.iridescence},
            {"iridescenceIor", m.iridescenceIor},
            {"iridescenceThicknessMinimum", m.iridescenceMin},
            {"iridescenceThicknessMaximum", m.iridescenceMax}};
    slot(film, "iridescenceTexture", m.iridescenceTexture);
    slot(film, "iridescenceThicknessTexture", m.iridescenceThicknessTexture);
}

void MaterialWriter::addLayers(const MaterialDesc& m) {
    if (m.clearcoat > 0) {
        json& coat = extensions_["KHR_materials_clearcoat"];
        coat = {{"clearcoatFactor", m.clearcoat}, {"clearcoatRoughnessFactor", m.clearcoatRoughness}};
        slot(coat, "clearcoatTexture", m.clearcoatTexture);
        slot(coat, "clearcoatRoughnessTexture", m.clearcoatRoughnessTexture);
        scaled(coat, "clearcoatNormalTexture", m.clearcoatNormalTexture, m.clearcoatNormalScale);
    }
    if (!black(m.sheenColor)) {
        json& sheen = extensions_["KHR_materials_sheen"];
        sheen = {{"sheenColorFactor", numbersOf(m.sheenColor)}, {"sheenRoughnessFactor", m.sheenRoughness}};
        slot(sheen, "sheenColorTexture", m.sheenColorTexture);
        slot(sheen, "sheenRoughnessTexture", m.sheenRoughnessTexture);
    }
    if (m.anisotropy > 0) {
        json& brushed = extensions_["KHR_materials_anisotropy"];
        brushed = {{"anisotropyStrength", m.anisotropy}, {"anisotropyRotation", m.anisotropyRotation}};
        slot(brushed, "anisotropyTexture", m.anisotropyTexture);
    }
    addFilm(m);
}

json MaterialWriter::write(const MaterialDesc& m) {
    json out{{"name", m.name}};
    addBase(out, m);
    addSurface(out, m);
    addInside(m);
    addLayers(m);
    for (const auto& [name, body] : extensions_.items()) to_.use(name);
    if (!extensions_.empty()) out["extensions"] = std::move(extensions_);
    return out;
}

} // namespace

json materialOf(GltfDocument::Content& to, const MaterialDesc& m) { return MaterialWriter(to).write(m); }

} // namespace chiaro::gltf
