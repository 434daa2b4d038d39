#include "io/gltf_needs.h"

namespace chiaro::gltf {

using nlohmann::json;

namespace {

const json* find(const json* in, const char* key) {
    if (!in || !in->is_object()) return nullptr;
    const auto found = in->find(key);
    return found == in->end() ? nullptr : &*found;
}

// KHR_texture_transform may name another set. Beyond what can be held set 0 stands in (io/gltf_texture.cpp).
int setOf(const json& info) {
    int set = info.value("texCoord", 0);
    if (const json* transform = find(find(&info, "extensions"), "KHR_texture_transform")) set = transform->value("texCoord", set);
    return set < uvSets ? set : 0;
}

void collect(const json& value, VertexNeeds& needs) {
    if (!value.is_object()) return;
    for (const auto& [key, member] : value.items()) {
        if (key.ends_with("Texture") && member.is_object())
            needs.uv[size_t(setOf(member))] = true;
        else if (key != "extras")
            collect(member, needs);
    }
}

} // namespace

VertexNeeds needsOf(const GltfFile& file, int material) {
    VertexNeeds needs;
    if (material < 0) return needs;
    const json& from = list(file, "materials")[size_t(material)];
    collect(from, needs);
    const json* extensions = find(&from, "extensions");
    const json* volume = find(extensions, "KHR_materials_volume");
    needs.solid = volume && volume->value("thicknessFactor", 0.0) > 0;
    const json* anisotropy = find(extensions, "KHR_materials_anisotropy");
    for (const json* info : {find(&from, "normalTexture"), find(find(extensions, "KHR_materials_clearcoat"), "clearcoatNormalTexture"),
                             find(anisotropy, "anisotropyTexture")})
        if (info && !needs.frame) needs.frame = setOf(*info);
    if (anisotropy && !needs.frame) needs.frame = 0;
    return needs;
}

} // namespace chiaro::gltf
