#include "core/render/fault.h"
#include "io/gltf_file.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

const json& member(const json& object, const char* key) {
    static const json none = json::object();
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

Wrap wrapMode(int mode) { return mode == 33071 ? Wrap::clamp : mode == 33648 ? Wrap::mirror : Wrap::repeat; }

int convertTexture(Conversion& to, size_t texture) {
    int& converted = to.textures[texture];
    if (converted >= 0) return converted;
    const json& from = list(to.file, "textures")[texture];
    const json& webp = member(member(from, "extensions"), "EXT_texture_webp");
    TextureDesc desc;
    if (webp.contains("source"))
        desc.image = convertImage(to, webp["source"]);
    else if (from.contains("source"))
        desc.image = convertImage(to, from["source"]);
    else {
        to.file.warn(fmt::format("/textures/{} names no picture that this build can read; the materials do without it.", texture));
        return -1;
    }
    if (from.contains("sampler")) {
        const json& sampler = list(to.file, "samplers")[from["sampler"].get<size_t>()];
        desc.wrapS = wrapMode(sampler.value("wrapS", 10497));
        desc.wrapT = wrapMode(sampler.value("wrapT", 10497));
        if (sampler.value("magFilter", 9729) == 9728) desc.filter = TextureFilter::nearest;
    }
    to.scene.textures.push_back(desc);
    return converted = int(to.scene.textures.size()) - 1;
}

// KHR_texture_transform: scale, then rotation counter-clockwise as seen in the picture (v points down), then offset.
TextureSlot slot(Conversion& to, const json& holder, const char* key) {
    TextureSlot s;
    if (!holder.contains(key)) return s;
    const json& info = holder[key];
    s.texture = convertTexture(to, info["index"]);
    s.uvSet = info.value("texCoord", 0);
    const json& t = member(member(info, "extensions"), "KHR_texture_transform");
    s.uvSet = t.value("texCoord", s.uvSet);
    if (s.uvSet > 1) {
        to.file.warn(fmt::format("uses TEXCOORD_{}; only sets 0 and 1 are read, set 0 stands in.", s.uvSet));
        s.uvSet = 0;
    }
    const auto offset = t.value("offset", std::array<double, 2>{0, 0}), scale = t.value("scale", std::array<double, 2>{1, 1});
    const double angle = t.value("rotation", 0.0), c = std::cos(angle), sn = std::sin(angle);
    const double m[2][3] = {{c * scale[0], sn * scale[1], offset[0]}, {-sn * scale[0], c * scale[1], offset[1]}};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 3; ++j) s.transform[i][j] = float(m[i][j]);
    return s;
}

// The factors of one material. Values outside their range are brought into it, with a warning.
class Factors {
public:
    Factors(const GltfFile& file, std::string place) : file_(file), place_(std::move(place)) {}

    float within(const json& holder, const char* key, double otherwise, double low = 0, double high = 1) const {
        return clamped(holder.value(key, otherwise), key, low, high);
    }
    Spectrum color(const json& holder, const char* key, double otherwise, double high = 1) const {
        Spectrum s{float(otherwise)};
        if (holder.contains(key))
            for (size_t c = 0; c < 3; ++c) s[c] = clamped(holder[key][c], key, 0, high);
        return s;
    }
    float clamped(double value, const char* key, double low, double high) const {
        const double out = std::clamp(value, low, high);
        if (out != value) file_.warn(fmt::format("{} has {} {}, must be from {} to {}; {} is used.", place_, key, value, low, high, out));
        return float(out);
    }

private:
    const GltfFile& file_;
    std::string place_;
};

constexpr double unbounded = 1e30;

void convertSurface(Conversion& to, const json& from, const Factors& factors, MaterialDesc& m) {
    const json& pbr = member(from, "pbrMetallicRoughness");
    m.baseColor = factors.color(pbr, "baseColorFactor", 1);
    if (pbr.contains("baseColorFactor")) m.alpha = factors.clamped(pbr["baseColorFactor"][3], "baseColorFactor", 0, 1);
    m.baseColorTexture = slot(to, pbr, "baseColorTexture");
    m.metallic = factors.within(pbr, "metallicFactor", 1);
    m.roughness = factors.within(pbr, "roughnessFactor", 1);
    m.metallicRoughnessTexture = slot(to, pbr, "metallicRoughnessTexture");
    m.normalTexture = slot(to, from, "normalTexture");
    m.normalScale = float(member(from, "normalTexture").value("scale", 1.0));
    const std::string mode = from.value("alphaMode", "OPAQUE");
    m.alphaMode = mode == "MASK" ? AlphaMode::mask : mode == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
    if (mode != "OPAQUE" && m.alphaMode == AlphaMode::opaque)
        to.file.warn(fmt::format("has alphaMode {}, which is unknown; OPAQUE is used.", shown(mode)));
    m.alphaCutoff = float(from.value("alphaCutoff", 0.5));
    m.doubleSided = from.value("doubleSided", false);
}

void convertExtensions(Conversion& to, const json& from, const Factors& factors, MaterialDesc& m) {
    const json& all = member(from, "extensions");
    m.unlit = all.contains("KHR_materials_unlit");
    const double strength = factors.within(member(all, "KHR_materials_emissive_strength"), "emissiveStrength", 1, 0, unbounded);
    m.emission = factors.color(from, "emissiveFactor", 0) * (fault(Fault::emissiveStrengthIgnored) ? 1.f : float(strength));
    m.emissionTexture = slot(to, from, "emissiveTexture");
    const double ior = member(all, "KHR_materials_ior").value("ior", 1.5);
    m.ior = ior == 0 ? 0 : factors.clamped(ior, "ior", 1, 1000);
    const json& specular = member(all, "KHR_materials_specular");
    m.specular = factors.within(specular, "specularFactor", 1);
    m.specularTexture = slot(to, specular, "specularTexture");
    m.specularColor = factors.color(specular, "specularColorFactor", 1, unbounded);
    m.specularColorTexture = slot(to, specular, "specularColorTexture");
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
    convertSurface(to, from, factors, m);
    convertExtensions(to, from, factors, m);
    to.scene.materials.push_back(std::move(m));
    return converted = int(to.scene.materials.size()) - 1;
}

} // namespace chiaro::gltf
