// The shape of the JSON as one table: which member is what, and what each reference may point to. Everything later relies on it.
#include "io/gltf_file.h"
#include <cfloat>
#include <fmt/format.h>
#include <map>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

enum class Is { object, list, number, integer, numbers, flag, text, index, indexes };
struct Rule {
    const char* where; // JSON pointer; * is every element or member
    Is is;
    const char* target = "";                   // index, indexes: the array that is meant
    double low = 0, high = 9007199254740992.0; // integer: the range (to 2^53)
    size_t size = 0;                           // numbers: how many; 0 any
    bool required = false;
};

constexpr double intMax = 2147483647;
constexpr const char* lightsAt = "/extensions/KHR_lights_punctual/lights";

// glTF 2.0.1, section 5 and the schemas of the extensions that are applied. Containers stand before their content.
constexpr Rule table[] = {
    {"/asset", Is::object, "", 0, 0, 0, true},
    {"/asset/version", Is::text, "", 0, 0, 0, true},
    {"/extensions", Is::object},
    {"/extensionsUsed", Is::list},
    {"/extensionsUsed/*", Is::text},
    {"/extensionsRequired", Is::list},
    {"/extensionsRequired/*", Is::text},
    {"/scene", Is::index, "/scenes"},
    {"/scenes/*/nodes", Is::indexes, "/nodes"},
    {"/nodes/*/children", Is::indexes, "/nodes"},
    {"/nodes/*/mesh", Is::index, "/meshes"},
    {"/nodes/*/camera", Is::index, "/cameras"},
    {"/nodes/*/skin", Is::index, "/skins"},
    {"/nodes/*/matrix", Is::numbers, "", 0, 0, 16},
    {"/nodes/*/translation", Is::numbers, "", 0, 0, 3},
    {"/nodes/*/rotation", Is::numbers, "", 0, 0, 4},
    {"/nodes/*/scale", Is::numbers, "", 0, 0, 3},
    {"/nodes/*/weights", Is::numbers},
    {"/nodes/*/extensions/KHR_lights_punctual/light", Is::index, lightsAt, 0, 0, 0, true},
    {"/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes", Is::object, "", 0, 0, 0, true},
    {"/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", Is::index, "/accessors"},
    {"/meshes/*/primitives", Is::list, "", 0, 0, 0, true},
    {"/meshes/*/primitives/*", Is::object},
    {"/meshes/*/primitives/*/attributes", Is::object, "", 0, 0, 0, true},
    {"/meshes/*/primitives/*/attributes/*", Is::index, "/accessors"},
    {"/meshes/*/primitives/*/indices", Is::index, "/accessors"},
    {"/meshes/*/primitives/*/material", Is::index, "/materials"},
    {"/meshes/*/primitives/*/mode", Is::integer, "", 0, 6},
    {"/meshes/*/primitives/*/targets", Is::list},
    {"/meshes/*/primitives/*/targets/*", Is::object},
    {"/meshes/*/primitives/*/targets/*/*", Is::index, "/accessors"},
    {"/meshes/*/primitives/*/extensions", Is::object},
    {"/meshes/*/primitives/*/extensions/*", Is::object},
    {"/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/bufferView", Is::index, "/bufferViews", 0, 0, 0, true},
    {"/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes", Is::object, "", 0, 0, 0, true},
    {"/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes/*", Is::integer, "", 0, 4294967295.0},
    {"/meshes/*/weights", Is::numbers},
    {"/accessors/*/bufferView", Is::index, "/bufferViews"},
    {"/accessors/*/byteOffset", Is::integer},
    {"/accessors/*/componentType", Is::integer, "", 5120, 5126, 0, true},
    {"/accessors/*/count", Is::integer, "", 1, intMax, 0, true},
    {"/accessors/*/type", Is::text, "", 0, 0, 0, true},
    {"/accessors/*/normalized", Is::flag},
    {"/accessors/*/sparse", Is::object},
    {"/accessors/*/sparse/count", Is::integer, "", 1, intMax, 0, true},
    {"/accessors/*/sparse/indices", Is::object, "", 0, 0, 0, true},
    {"/accessors/*/sparse/indices/bufferView", Is::index, "/bufferViews", 0, 0, 0, true},
    {"/accessors/*/sparse/indices/byteOffset", Is::integer},
    {"/accessors/*/sparse/indices/componentType", Is::integer, "", 5121, 5125, 0, true},
    {"/accessors/*/sparse/values", Is::object, "", 0, 0, 0, true},
    {"/accessors/*/sparse/values/bufferView", Is::index, "/bufferViews", 0, 0, 0, true},
    {"/accessors/*/sparse/values/byteOffset", Is::integer},
    {"/bufferViews/*/buffer", Is::index, "/buffers", 0, 0, 0, true},
    {"/bufferViews/*/byteOffset", Is::integer},
    {"/bufferViews/*/byteLength", Is::integer, "", 1, 9007199254740992.0, 0, true},
    {"/bufferViews/*/byteStride", Is::integer, "", 4, 252},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/buffer", Is::index, "/buffers", 0, 0, 0, true},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/byteOffset", Is::integer},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/byteLength", Is::integer, "", 1, 9007199254740992.0, 0, true},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/byteStride", Is::integer, "", 1, 256, 0, true},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/count", Is::integer, "", 1, intMax, 0, true},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/mode", Is::text, "", 0, 0, 0, true},
    {"/bufferViews/*/extensions/EXT_meshopt_compression/filter", Is::text},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/buffer", Is::index, "/buffers", 0, 0, 0, true},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/byteOffset", Is::integer},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/byteLength", Is::integer, "", 1, 9007199254740992.0, 0, true},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/byteStride", Is::integer, "", 1, 256, 0, true},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/count", Is::integer, "", 1, intMax, 0, true},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/mode", Is::text, "", 0, 0, 0, true},
    {"/bufferViews/*/extensions/KHR_meshopt_compression/filter", Is::text},
    {"/buffers/*/byteLength", Is::integer, "", 1, 9007199254740992.0, 0, true},
    {"/buffers/*/uri", Is::text},
    {"/images/*/uri", Is::text},
    {"/images/*/mimeType", Is::text},
    {"/images/*/bufferView", Is::index, "/bufferViews"},
    {"/textures/*/source", Is::index, "/images"},
    {"/textures/*/sampler", Is::index, "/samplers"},
    {"/textures/*/extensions/EXT_texture_webp/source", Is::index, "/images", 0, 0, 0, true},
    {"/textures/*/extensions/KHR_texture_basisu/source", Is::index, "/images", 0, 0, 0, true},
    {"/samplers/*/magFilter", Is::integer, "", 0, 65535},
    {"/samplers/*/minFilter", Is::integer, "", 0, 65535},
    {"/samplers/*/wrapS", Is::integer, "", 0, 65535},
    {"/samplers/*/wrapT", Is::integer, "", 0, 65535},
    {"/cameras/*/type", Is::text, "", 0, 0, 0, true},
    {"/cameras/*/perspective", Is::object},
    {"/cameras/*/perspective/yfov", Is::number, "", 0, 0, 0, true},
    {"/cameras/*/perspective/aspectRatio", Is::number},
    {"/cameras/*/perspective/znear", Is::number},
    {"/cameras/*/perspective/zfar", Is::number},
    {"/cameras/*/orthographic", Is::object},
    {"/cameras/*/orthographic/xmag", Is::number, "", 0, 0, 0, true},
    {"/cameras/*/orthographic/ymag", Is::number, "", 0, 0, 0, true},
    {"/cameras/*/orthographic/znear", Is::number},
    {"/cameras/*/orthographic/zfar", Is::number},
    {"/skins/*/joints", Is::indexes, "/nodes", 0, 0, 0, true},
    {"/skins/*/skeleton", Is::index, "/nodes"},
    {"/skins/*/inverseBindMatrices", Is::index, "/accessors"},
    {"/animations/*/channels", Is::list, "", 0, 0, 0, true},
    {"/animations/*/channels/*", Is::object},
    {"/animations/*/channels/*/sampler", Is::integer, "", 0, intMax, 0, true},
    {"/animations/*/channels/*/target", Is::object, "", 0, 0, 0, true},
    {"/animations/*/channels/*/target/node", Is::index, "/nodes"},
    {"/animations/*/channels/*/target/path", Is::text, "", 0, 0, 0, true},
    {"/animations/*/samplers", Is::list, "", 0, 0, 0, true},
    {"/animations/*/samplers/*", Is::object},
    {"/animations/*/samplers/*/input", Is::index, "/accessors", 0, 0, 0, true},
    {"/animations/*/samplers/*/output", Is::index, "/accessors", 0, 0, 0, true},
    {"/animations/*/samplers/*/interpolation", Is::text},
    {"/extensions/KHR_lights_punctual", Is::object},
    {lightsAt, Is::list, "", 0, 0, 0, true},
    {"/extensions/KHR_lights_punctual/lights/*", Is::object},
    {"/extensions/KHR_lights_punctual/lights/*/name", Is::text},
    {"/extensions/KHR_lights_punctual/lights/*/type", Is::text, "", 0, 0, 0, true},
    {"/extensions/KHR_lights_punctual/lights/*/color", Is::numbers, "", 0, 0, 3},
    {"/extensions/KHR_lights_punctual/lights/*/intensity", Is::number},
    {"/extensions/KHR_lights_punctual/lights/*/range", Is::number},
    {"/extensions/KHR_lights_punctual/lights/*/spot", Is::object},
    {"/extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", Is::number},
    {"/extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", Is::number},
    {"/materials/*/pbrMetallicRoughness", Is::object},
    {"/materials/*/pbrMetallicRoughness/baseColorFactor", Is::numbers, "", 0, 0, 4},
    {"/materials/*/pbrMetallicRoughness/metallicFactor", Is::number},
    {"/materials/*/pbrMetallicRoughness/roughnessFactor", Is::number},
    {"/materials/*/emissiveFactor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/alphaMode", Is::text},
    {"/materials/*/alphaCutoff", Is::number},
    {"/materials/*/doubleSided", Is::flag},
    {"/materials/*/normalTexture/scale", Is::number},
    {"/materials/*/extensions/KHR_materials_emissive_strength/emissiveStrength", Is::number},
    {"/materials/*/extensions/KHR_materials_ior/ior", Is::number},
    {"/materials/*/extensions/KHR_materials_specular/specularFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_specular/specularColorFactor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/extensions/KHR_materials_transmission/transmissionFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_volume/thicknessFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_volume/attenuationDistance", Is::number},
    {"/materials/*/extensions/KHR_materials_volume/attenuationColor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", Is::object},
    {"/materials/*/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", Is::number},
    {"/materials/*/extensions/KHR_materials_sheen/sheenColorFactor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/extensions/KHR_materials_sheen/sheenRoughnessFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_anisotropy/anisotropyStrength", Is::number},
    {"/materials/*/extensions/KHR_materials_anisotropy/anisotropyRotation", Is::number},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceIor", Is::number},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", Is::number},
    {"/materials/*/extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", Is::number},
    {"/materials/*/extensions/KHR_materials_dispersion/dispersion", Is::number},
    {"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", Is::number},
    {"/materials/*/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/extensions/KHR_materials_pbrSpecularGlossiness/diffuseFactor", Is::numbers, "", 0, 0, 4},
    {"/materials/*/extensions/KHR_materials_pbrSpecularGlossiness/specularFactor", Is::numbers, "", 0, 0, 3},
    {"/materials/*/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", Is::number},
};

// All of them are lists of objects with a name and extensions.
constexpr const char* arrays[] = {"/scenes",   "/nodes",  "/meshes",   "/accessors", "/bufferViews", "/buffers",   "/materials",
                                  "/textures", "/images", "/samplers", "/cameras",   "/skins",       "/animations"};

class Checker {
public:
    explicit Checker(GltfFile& file) : file_(file) {}

    void apply(const Rule& rule) {
        path_.clear();
        walk(file_.json, rule.where, rule);
    }

    // Any member of a material called ...Texture, those of unknown extensions too.
    void textures(json& value, const std::string& place) {
        if (!value.is_structured()) return;
        for (auto& [key, member] : value.items()) {
            const std::string here = place + "/" + key;
            if (key.ends_with("Texture") && !value.is_array())
                textureInfo(member, here);
            else if (key != "extras")
                textures(member, here);
        }
    }

private:
    void textureInfo(json& info, const std::string& place) {
        check(info, place, {"", Is::object});
        if (!info.contains("index")) file_.fail(place, "has no \"index\". Export the file again.");
        check(info["index"], place + "/index", {"", Is::index, "/textures"});
        constexpr Rule set{"", Is::integer, "", 0, 1000};
        if (info.contains("texCoord")) check(info["texCoord"], place + "/texCoord", set);
        if (!info.contains("extensions")) return;
        check(info["extensions"], place + "/extensions", {"", Is::object});
        if (!info["extensions"].contains("KHR_texture_transform")) return;
        json& t = info["extensions"]["KHR_texture_transform"];
        const std::string at = place + "/extensions/KHR_texture_transform";
        check(t, at, {"", Is::object});
        for (const char* key : {"offset", "scale"})
            if (t.contains(key)) check(t[key], at + "/" + key, {"", Is::numbers, "", 0, 0, 2});
        if (t.contains("rotation")) check(t["rotation"], at + "/rotation", {"", Is::number});
        if (t.contains("texCoord")) check(t["texCoord"], at + "/texCoord", set);
    }

    void walk(json& value, std::string_view rest, const Rule& rule) {
        if (rest.empty()) return check(value, place(), rule);
        const size_t slash = rest.find('/', 1);
        const std::string_view key = rest.substr(1, slash == rest.npos ? rest.npos : slash - 1);
        const std::string_view next = slash == rest.npos ? std::string_view() : rest.substr(slash);
        if (key == "*") {
            size_t i = 0;
            for (auto it = value.begin(); value.is_structured() && it != value.end(); ++it, ++i) {
                path_.push_back(value.is_object() ? Step{&it.key(), 0} : Step{nullptr, i});
                walk(*it, next, rule);
                path_.pop_back();
            }
        } else if (value.is_object()) {
            const auto found = value.find(key);
            if (found == value.end()) {
                if (rule.required && next.empty()) file_.fail(place(), fmt::format("has no \"{}\". Export the file again.", key));
                return;
            }
            const std::string held(key);
            path_.push_back({&held, 0});
            walk(*found, next, rule);
            path_.pop_back();
        }
    }

    void check(json& value, const std::string& at, const Rule& rule) {
        switch (rule.is) {
        case Is::object: return expect(value.is_object(), value, at, "an object");
        case Is::list: return expect(value.is_array(), value, at, "a list");
        case Is::flag: return expect(value.is_boolean(), value, at, "true or false");
        case Is::text: return expect(value.is_string(), value, at, "a string");
        case Is::number: return checkNumber(value, at);
        case Is::integer: return checkInteger(value, at, rule);
        case Is::index: return checkIndex(value, at, rule.target);
        case Is::indexes:
            expect(value.is_array(), value, at, "a list");
            for (size_t i = 0; i < value.size(); ++i) checkIndex(value[i], fmt::format("{}/{}", at, i), rule.target);
            return;
        case Is::numbers:
            expect(value.is_array() && (!rule.size || value.size() == rule.size), value, at,
                   fmt::format("a list of {} numbers", rule.size));
            for (size_t i = 0; i < value.size(); ++i) checkNumber(value[i], fmt::format("{}/{}", at, i));
        }
    }
    void expect(bool met, const json& value, const std::string& at, const std::string& what) const {
        if (!met) file_.fail(at, fmt::format("must be {}, not {}. Export the file again.", what, describe(value)));
    }
    static std::string describe(const json& value) {
        return value.is_structured() ? fmt::format("{} of {}", value.is_array() ? "a list" : "an object", value.size())
                                     : shown(value.dump(), 40);
    }
    void checkNumber(const json& value, const std::string& at) const {
        expect(value.is_number(), value, at, "a number");
        expect(std::abs(value.get<double>()) <= double(FLT_MAX), value, at, "a number that a 32-bit float holds");
    }
    // Some exporters write 3.0 for 3: from here on it is 3.
    void checkInteger(json& value, const std::string& at, const Rule& rule) const {
        expect(value.is_number(), value, at, "a whole number");
        const double v = value.get<double>();
        if (v != std::floor(v) || v < rule.low || v > rule.high)
            file_.fail(at, fmt::format("is {}, must be a whole number from {:.0f} to {:.0f}. Export the file again.", value.dump(),
                                       rule.low, rule.high));
    }
    void checkIndex(json& value, const std::string& at, const char* target) {
        expect(value.is_number(), value, at, "an index");
        auto [it, isNew] = sizes_.try_emplace(target, 0);
        const json::json_pointer pointer(target);
        if (isNew && file_.json.contains(pointer)) it->second = file_.json[pointer].size();
        const double v = value.get<double>();
        if (v < 0 || v != std::floor(v) || v >= double(it->second))
            file_.fail(at, fmt::format("is {}, but {} has {} entries. Export the file again.", value.dump(), target, it->second));
        value = uint64_t(v);
    }

    struct Step {
        const std::string* key;
        size_t index;
    };
    std::string place() const {
        std::string out;
        for (const Step& s : path_) out += "/" + (s.key ? *s.key : std::to_string(s.index));
        return out;
    }

    GltfFile& file_;
    std::vector<Step> path_;
    std::map<std::string, size_t> sizes_;
};

} // namespace

void checkSchema(GltfFile& file) {
    Checker checker(file);
    for (const std::string array : arrays) {
        checker.apply({array.c_str(), Is::list});
        checker.apply({(array + "/*").c_str(), Is::object});
        checker.apply({(array + "/*/name").c_str(), Is::text});
        checker.apply({(array + "/*/extensions").c_str(), Is::object});
        checker.apply({(array + "/*/extensions/*").c_str(), Is::object});
    }
    for (const Rule& rule : table) checker.apply(rule);
    if (file.json.contains("materials"))
        for (size_t i = 0; i < file.json["materials"].size(); ++i)
            checker.textures(file.json["materials"][i], fmt::format("/materials/{}", i));
}

} // namespace chiaro::gltf
