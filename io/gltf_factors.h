// Inside the glTF reader: the factors and textures of one material, as its file says them (io/gltf_material.cpp the core and the
// extensions of the base, io/gltf_material_layers.cpp those that lie above or behind it).
#pragma once
#include "io/gltf_file.h"

namespace chiaro::gltf {

// A member of an object, or an empty object.
const nlohmann::json& member(const nlohmann::json& object, const char* key);

// The texture that `holder` reads under `key`, with its UV set and its transform.
TextureSlot slot(Conversion& to, const nlohmann::json& holder, const char* key);

// Values outside their range are brought into it, with a warning that names the material.
class Factors {
public:
    static constexpr double unbounded = 1e30;

    Factors(const GltfFile& file, std::string place) : file_(file), place_(std::move(place)) {}
    float within(const nlohmann::json& holder, const char* key, double otherwise, double low = 0, double high = 1) const;
    Spectrum color(const nlohmann::json& holder, const char* key, double otherwise, double high = 1) const;
    float clamped(double value, const char* key, double low, double high) const;

private:
    const GltfFile& file_;
    std::string place_;
};

// KHR_materials_{clearcoat, sheen, anisotropy, iridescence, dispersion, diffuse_transmission}.
void convertLayers(Conversion& to, const nlohmann::json& extensions, const Factors& factors, MaterialDesc& m);
// KHR_materials_pbrSpecularGlossiness, in place of what pbrMetallicRoughness said: the extension is the better one where both are there.
void convertSpecularGlossiness(Conversion& to, const nlohmann::json& old, const Factors& factors, MaterialDesc& m);

} // namespace chiaro::gltf
