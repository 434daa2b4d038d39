#include "io/gltf_file.h"
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

const std::set<std::string> applied = {"KHR_lights_punctual",
                                       "KHR_materials_anisotropy",
                                       "KHR_materials_clearcoat",
                                       "KHR_materials_diffuse_transmission",
                                       "KHR_materials_dispersion",
                                       "KHR_materials_emissive_strength",
                                       "KHR_materials_ior",
                                       "KHR_materials_iridescence",
                                       "KHR_materials_pbrSpecularGlossiness",
                                       "KHR_materials_sheen",
                                       "KHR_materials_specular",
                                       "KHR_materials_transmission",
                                       "KHR_materials_unlit",
                                       "KHR_materials_volume",
                                       "KHR_mesh_quantization",
                                       "KHR_texture_transform",
                                       "EXT_mesh_gpu_instancing",
                                       "EXT_meshopt_compression",
                                       "KHR_draco_mesh_compression",
                                       "KHR_meshopt_compression",
                                       "EXT_texture_webp"};
// Change nothing that is drawn: metadata, how polygons were cut into triangles, other materials to choose from.
const std::set<std::string> silent = {"KHR_xmp", "KHR_xmp_json_ld", "FB_ngon_encoding", "KHR_materials_variants"};

// The extensions that something in the file carries, and how often.
void collect(const json& value, std::map<std::string, size_t>& names) {
    if (!value.is_structured()) return;
    for (const auto& [key, member] : value.items()) {
        if (key == "extras") continue;
        if (key == "extensions" && member.is_object())
            for (const auto& [name, body] : member.items()) ++names[name];
        collect(member, names);
    }
}

std::string remedy(const std::string& extension, const std::string& file) {
    if (extension == "KHR_texture_basisu") return fmt::format("Try: gltf-transform ktxdecompress {} out.glb", file);
    return "Export it again without this extension.";
}

} // namespace

void checkExtensions(const GltfFile& file) {
    if (file.json.contains("extensionsRequired"))
        for (const auto& entry : file.json["extensionsRequired"]) {
            const std::string& name = entry.get_ref<const std::string&>();
            if (!applied.contains(name) && !silent.contains(name))
                throw Error(Exit::unsupported, printable(fmt::format("{} needs {}, which this build cannot read. {}", file.name,
                                                                     name.substr(0, 100), remedy(name, file.name))));
        }
    for (const GltfInventory::Extension& e : extensionsOf(file))
        if (e.places > 0 && e.use == GltfInventory::Use::ignored)
            file.warn(fmt::format("uses {}, which is not applied.", e.name.substr(0, 100)));
}

std::vector<GltfInventory::Extension> extensionsOf(const GltfFile& file) {
    std::map<std::string, size_t> names; // what is announced and never carried has no effect
    std::set<std::string> required;
    for (const char* key : {"extensionsUsed", "extensionsRequired"})
        if (file.json.contains(key))
            for (const auto& entry : file.json[key]) {
                names.try_emplace(entry.get<std::string>(), 0);
                if (key == std::string_view("extensionsRequired")) required.insert(entry.get<std::string>());
            }
    collect(file.json, names);
    std::vector<GltfInventory::Extension> all;
    for (const auto& [name, places] : names) {
        using Use = GltfInventory::Use;
        all.push_back({name,
                       applied.contains(name)  ? Use::applied
                       : silent.contains(name) ? Use::invisible
                                               : Use::ignored,
                       required.contains(name), places});
    }
    return all;
}

void checkVersion(const GltfFile& file) {
    const json& asset = file.json["asset"];
    const std::string version = asset["version"];
    std::string least = "2.0";
    if (asset.contains("minVersion")) {
        if (!asset["minVersion"].is_string()) file.fail("/asset/minVersion", "must be a string. Export the file again.");
        least = asset["minVersion"];
    }
    if (!version.starts_with("2.") || least != "2.0")
        throw Error(Exit::unsupported, printable(fmt::format("{} is glTF {}, this build reads 2.0. Export it again as glTF 2.0.", file.name,
                                                             shown(least != "2.0" ? least : version, 20))));
}

} // namespace chiaro::gltf
