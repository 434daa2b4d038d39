#include "io/gltf_factors.h"

namespace chiaro::gltf {

using nlohmann::json;

namespace {

void convertCoat(Conversion& to, const json& coat, const Factors& factors, MaterialDesc& m) {
    m.clearcoat = factors.within(coat, "clearcoatFactor", 0);
    m.clearcoatTexture = slot(to, coat, "clearcoatTexture");
    m.clearcoatRoughness = factors.within(coat, "clearcoatRoughnessFactor", 0);
    m.clearcoatRoughnessTexture = slot(to, coat, "clearcoatRoughnessTexture");
    m.clearcoatNormalTexture = slot(to, coat, "clearcoatNormalTexture");
    m.clearcoatNormalScale = float(member(coat, "clearcoatNormalTexture").value("scale", 1.0));
}

void convertSheen(Conversion& to, const json& sheen, const Factors& factors, MaterialDesc& m) {
    m.sheenColor = factors.color(sheen, "sheenColorFactor", 0);
    m.sheenColorTexture = slot(to, sheen, "sheenColorTexture");
    m.sheenRoughness = factors.within(sheen, "sheenRoughnessFactor", 0);
    m.sheenRoughnessTexture = slot(to, sheen, "sheenRoughnessTexture");
}

void convertFilm(Conversion& to, const json& film, const Factors& factors, MaterialDesc& m) {
    constexpr double thickest = 1e6; // nanometres: beyond any interference
    m.iridescence = factors.within(film, "iridescenceFactor", 0);
    m.iridescenceTexture = slot(to, film, "iridescenceTexture");
    m.iridescenceIor = factors.within(film, "iridescenceIor", 1.3, 1, 1000);
    m.iridescenceMin = factors.within(film, "iridescenceThicknessMinimum", 100, 0, thickest);
    m.iridescenceMax = factors.within(film, "iridescenceThicknessMaximum", 400, 0, thickest);
    m.iridescenceThicknessTexture = slot(to, film, "iridescenceThicknessTexture");
}

void convertDiffuseTransmission(Conversion& to, const json& through, const Factors& factors, MaterialDesc& m) {
    m.diffuseTransmission = factors.within(through, "diffuseTransmissionFactor", 0);
    m.diffuseTransmissionTexture = slot(to, through, "diffuseTransmissionTexture");
    m.diffuseTransmissionColor = factors.color(through, "diffuseTransmissionColorFactor", 1);
    m.diffuseTransmissionColorTexture = slot(to, through, "diffuseTransmissionColorTexture");
}

} // namespace

void convertLayers(Conversion& to, const json& extensions, const Factors& factors, MaterialDesc& m) {
    convertCoat(to, member(extensions, "KHR_materials_clearcoat"), factors, m);
    convertSheen(to, member(extensions, "KHR_materials_sheen"), factors, m);
    const json& brushed = member(extensions, "KHR_materials_anisotropy");
    m.anisotropy = factors.within(brushed, "anisotropyStrength", 0);
    m.anisotropyRotation = float(brushed.value("anisotropyRotation", 0.0));
    m.anisotropyTexture = slot(to, brushed, "anisotropyTexture");
    convertFilm(to, member(extensions, "KHR_materials_iridescence"), factors, m);
    m.dispersion = factors.within(member(extensions, "KHR_materials_dispersion"), "dispersion", 0, 0, Factors::unbounded);
    convertDiffuseTransmission(to, member(extensions, "KHR_materials_diffuse_transmission"), factors, m);
}

void convertSpecularGlossiness(Conversion& to, const json& old, const Factors& factors, MaterialDesc& m) {
    m.baseColor = factors.color(old, "diffuseFactor", 1);
    if (old.contains("diffuseFactor")) m.alpha = factors.clamped(old["diffuseFactor"][3], "diffuseFactor", 0, 1);
    m.baseColorTexture = slot(to, old, "diffuseTexture");
    m.specularColor = factors.color(old, "specularFactor", 1);
    m.glossiness = factors.within(old, "glossinessFactor", 1);
    m.specularGlossinessTexture = slot(to, old, "specularGlossinessTexture");
}

} // namespace chiaro::gltf
