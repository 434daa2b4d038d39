#include "core/render/fault.h"
#include "io/gltf_factors.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

float Factors::within(const json& holder, const char* key, double otherwise, double low, double high) const {
    return clamped(holder.value(key, otherwise), key, low, high);
}

Spectrum Factors::color(const json& holder, const char* key, double otherwise, double high) const {
    Spectrum s{float(otherwise)};
    if (holder.contains(key))
        for (size_t c = 0; c < 3; ++c) s[c] = clamped(holder[key][c], key, 0, high);
    return s;
}

float Factors::clamped(double value, const char* key, double low, double high) const {
    const double out = std::clamp(value, low, high);
    if (out != value) file_.warn(fmt::format("{} has {} {}, must be from {} to {}; {} is used.", place_, key, value, low, high, out));
    return float(out);
}

namespace {

void convertBase(Conversion& to, const json& pbr, const Factors& factors, MaterialDesc& m) {
    m.baseColor = factors.color(pbr, "baseColorFactor", 1);
    if (pbr.contains("baseColorFactor")) m.alpha = factors.clamped(pbr["baseColorFactor"][3], "baseColorFactor", 0, 1);
    m.baseColorTexture = slot(to, pbr, "baseColorTexture");
    m.metallic = factors.within(pbr, "metallicFactor", 1);
    m.roughness = factors.within(pbr, "roughnessFactor", 1);
    m.metallicRoughnessTexture = slot(to, pbr, "metallicRoughnessTexture");
}

void convertSurface(Conversion& to, const json& from, MaterialDesc& m) {
    m.normalTexture = slot(to, from, "normalTexture");
    m.normalScale = float(member(from, "normalTexture").value("scale", 1.0));
    const std::string mode = from.value("alphaMode", "OPAQUE");
    m.alphaMode = mode == "MASK" ? AlphaMode::mask : mode == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
    if (mode != "OPAQUE" && m.alphaMode == AlphaMode::opaque)
        to.file.warn(fmt::format("has alphaMode {}, which is unknown; OPAQUE is used.", shown(mode)));
    m.alphaCutoff = float(from.value("alphaCutoff", 0.5));
    m.doubleSided = from.value("doubleSided", false);
}

void convertSpecular(Conversion& to, const json& specular, const Factors& factors, MaterialDesc& m) {
    m.specular = factors.within(specular, "specularFactor", 1);
    m.specularTexture = slot(to, specular, "specularTexture");
    m.specularColor = factors.color(specular, "specularColorFactor", 1, Factors::unbounded);
    m.specularColorTexture = slot(to, specular, "specularColorTexture");
}

void convertExtensions(Conversion& to, const json& from, const Factors& factors, MaterialDesc& m) {
    const json& all = member(from, "extensions");
    const double strength = factors.within(member(all, "KHR_materials_emissive_strength"), "emissiveStrength", 1, 0, Factors::unbounded);
    m.emission = factors.color(from, "emissiveFactor", 0) * (fault(Fault::emissiveStrengthIgnored) ? 1.f : float(strength));
    m.emissionTexture = slot(to, from, "emissiveTexture");
    const double ior = member(all, "KHR_materials_ior").value("ior", 1.5);
    m.ior = ior == 0 ? 0 : factors.clamped(ior, "ior", 1, 1000);
    const json& transmission = member(all, "KHR_materials_transmission");
    m.transmission = factors.within(transmission, "transmissionFactor", 0);
    m.transmissionTexture = slot(to, transmission, "transmissionTexture");
    const json& volume = member(all, "KHR_materials_volume");
    m.volume = volume.value("thicknessFactor", 0.0) > 0;
    m.attenuationColor = factors.color(volume, "attenuationColor", 1);
    if (volume.contains("attenuationDistance")) m.attenuationDistance = factors.within(volume, "attenuationDistance", 1, 1e-30, 3.4e38);
}

} // namespace

int convertMaterial(Conversion& to, int material) {
    int& converted = to.materials[size_t(material)];
    if (converted >= 0) return converted;
    const json& from = list(to.file, "materials")[size_t(material)];
    const Factors factors(to.file, fmt::format("/materials/{}", material));
    MaterialDesc m;
    m.name = from.value("name", std::string());
    const json& extensions = member(from, "extensions");
    m.unlit = extensions.contains("KHR_materials_unlit");
    m.specularGlossiness =
        extensions.contains("KHR_materials_pbrSpecularGlossiness") && !m.unlit; // unlit knows of metal and roughness alone
    if (m.specularGlossiness) {
        convertSpecularGlossiness(to, extensions["KHR_materials_pbrSpecularGlossiness"], factors, m);
    } else {
        convertBase(to, member(from, "pbrMetallicRoughness"), factors, m);
        convertSpecular(to, member(extensions, "KHR_materials_specular"), factors, m);
    }
    convertSurface(to, from, m);
    convertExtensions(to, from, factors, m);
    convertLayers(to, extensions, factors, m);
    to.scene.materials.push_back(std::move(m));
    return converted = int(to.scene.materials.size()) - 1;
}

} // namespace chiaro::gltf
