// Baked surfaces into a document: primitives, meshes of their own, materials that show the light, variants that bring the old ones back.
#include "io/gltf_write_content.h"
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <numbers>
#include <tuple>

namespace chiaro {

using nlohmann::json;
using namespace gltf;

namespace {

std::size_t bytesOf(int component) { return component == 5120 || component == 5121 ? 1 : component == 5122 || component == 5123 ? 2 : 4; }
double numberAt(const std::byte* at, int component) {
    const auto as = [&](auto v) {
        std::memcpy(&v, at, sizeof v);
        return double(v);
    };
    switch (component) {
    case 5120: return as(int8_t());
    case 5121: return as(uint8_t());
    case 5122: return as(int16_t());
    case 5123: return as(uint16_t());
    case 5125: return as(uint32_t());
    default: return as(float());
    }
}

bool usesTexCoord(const json& value, int set) {
    if (!value.is_structured()) return false;
    for (const auto& [key, member] : value.items())
        if (key != "extras" && ((key == "texCoord" && member == set) || usesTexCoord(member, set))) return true;
    return false;
}

class Baker {
public:
    Baker(GltfDocument::Content& to, const BakedScene& baked) : to_(to), baked_(baked), original_(to.json) {}
    void run();

private:
    struct Placed {
        std::size_t instance = 0;
        std::vector<const BakedPart*> parts;
    };
    void addLightMap();
    json primitive(const json& from, const BakedPart&, const GltfOrigin::Primitive&);
    void reshape(json& attributes, const BakedPart&, const GltfOrigin::Primitive&);
    std::size_t gathered(std::size_t accessor, const std::string& name, const BakedPart&, const GltfOrigin::Primitive&);
    std::size_t interpolated(std::size_t accessor, const std::string& name, const BakedPart&, const GltfOrigin::Primitive&);
    int putCoordinates(json& attributes, const json& material, const BakedPart&);
    std::size_t material(int from, std::optional<BakedLook>, int uvSet);
    json shown(const json& from, BakedLook, int uvSet) const;
    void offerOriginal(json& primitive, int from, std::size_t baked);
    json meshOf(const Placed&);
    void placeNodes(const std::vector<Placed>&);
    void expand(std::size_t node);

    GltfDocument::Content& to_;
    const BakedScene& baked_;
    const json original_; // the document before
    std::size_t lightMap_ = 0;
    int variants_[2] = {-1, -1}; // "baked", "original"
    std::map<std::tuple<int, int, int>, std::size_t> materials_;
    std::map<std::size_t, json> meshes_; // of instances, baked
};

void Baker::addLightMap() {
    if (baked_.lightMap.empty()) return;
    const std::size_t image = to_.addImage("light map", baked_.lightMap, "image/png");
    // Without mip levels: they would mix charts that have nothing to do with each other.
    const std::size_t sampler = to_.append("samplers", {{"magFilter", 9729}, {"minFilter", 9729}, {"wrapS", 33071}, {"wrapT", 33071}});
    lightMap_ = to_.append("textures", {{"name", "light map"}, {"source", image}, {"sampler", sampler}});
}

// The elements as they are stored, for other vertices.
std::size_t Baker::gathered(std::size_t number, const std::string& name, const BakedPart& part, const GltfOrigin::Primitive& origin) {
    const Accessor& a = to_.file.accessors[number];
    const bool pure = std::all_of(part.vertices.begin(), part.vertices.end(), [](const BakedVertex& v) { return v.weight[0] == 1; });
    if (!pure || a.sparse.count > 0 || a.data.empty()) return interpolated(number, name, part, origin);
    const std::size_t size = bytesOf(a.component) * std::size_t(a.width);
    std::vector<std::byte> bytes(size * part.vertices.size());
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
        const uint32_t v = part.vertices[i].from[0], at = origin.vertices.empty() ? v : origin.vertices[v];
        std::copy_n(a.data.data() + at * a.stride, size, &bytes[i * size]);
    }
    const std::size_t made = to_.addAccessor(bytes.data(), part.vertices.size(), a.component, a.type.c_str(), size, arrayBuffer);
    json& out = to_.json["accessors"][made];
    if (a.normalized) out["normalized"] = true;
    if (name != "POSITION") return made;
    for (int k = 0; k < a.width; ++k) {
        double low = 1e300, high = -1e300;
        for (std::size_t i = 0; i < part.vertices.size(); ++i) {
            const double v = numberAt(&bytes[i * size + std::size_t(k) * bytesOf(a.component)], a.component);
            low = std::min(low, v), high = std::max(high, v);
        }
        out["min"].push_back(low);
        out["max"].push_back(high);
    }
    return made;
}

std::size_t Baker::interpolated(std::size_t number, const std::string& name, const BakedPart& part, const GltfOrigin::Primitive& origin) {
    const Accessor& a = to_.file.accessors[number];
    const std::vector<float> from = readFloats(to_.file, number);
    const std::size_t width = std::size_t(a.width);
    std::vector<float> to(width * part.vertices.size(), 0);
    std::vector<float> low(width, std::numeric_limits<float>::infinity()), high(width, -std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
        float* out = &to[i * width];
        for (std::size_t j = 0; j < 3; ++j) {
            const uint32_t v = part.vertices[i].from[j], at = origin.vertices.empty() ? v : origin.vertices[v];
            for (std::size_t k = 0; k < width && part.vertices[i].weight[j] != 0; ++k)
                out[k] += part.vertices[i].weight[j] * from[at * width + k];
        }
        if (name == "NORMAL" || name == "TANGENT") {
            const float l = std::hypot(out[0], out[1], out[2]);
            for (std::size_t k = 0; k < 3 && l > 0; ++k) out[k] /= l;
            if (name == "TANGENT") out[3] = out[3] < 0 ? -1.f : 1.f;
        }
        for (std::size_t k = 0; k < width; ++k) low[k] = std::min(low[k], out[k]), high[k] = std::max(high[k], out[k]);
    }
    const std::size_t made = to_.addAccessor(to.data(), part.vertices.size(), floatNumber, a.type.c_str(), width * 4, arrayBuffer);
    if (name == "POSITION") {
        to_.json["accessors"][made]["min"] = low;
        to_.json["accessors"][made]["max"] = high;
    }
    return made;
}

// Attributes for the vertices of the part, where they are not the file's own.
void Baker::reshape(json& attributes, const BakedPart& part, const GltfOrigin::Primitive& origin) {
    const std::size_t count = to_.file.accessors[attributes["POSITION"].get<std::size_t>()].count;
    bool same = origin.vertices.empty() && part.vertices.size() == count;
    for (std::size_t i = 0; same && i < count; ++i) same = part.vertices[i].from[0] == i && part.vertices[i].weight[0] == 1;
    if (same) return;
    for (auto& [name, accessor] : attributes.items()) accessor = gathered(accessor.get<std::size_t>(), name, part, origin);
}

// TEXCOORD_1, unless the material needs what is there. Returns the number of the set.
int Baker::putCoordinates(json& attributes, const json& material, const BakedPart& part) {
    if (part.uv.empty()) return part.uvSet;
    int set = 1;
    if (attributes.contains("TEXCOORD_1") && usesTexCoord(material, 1))
        while (attributes.contains(fmt::format("TEXCOORD_{}", set))) ++set;
    const std::size_t made = to_.addAccessor(part.uv.data(), part.uv.size(), floatNumber, "VEC2", sizeof(Point2), arrayBuffer);
    for (int k = 0; k <= set; ++k) // sets are numbered without gaps
        if (const std::string name = fmt::format("TEXCOORD_{}", k); k == set || !attributes.contains(name)) attributes[name] = made;
    return set;
}

json Baker::shown(const json& from, BakedLook look, int uvSet) const {
    json m;
    for (const char* key : {"name", "alphaMode", "alphaCutoff", "doubleSided", "extras"})
        if (from.contains(key)) m[key] = from[key];
    json pbr = from.value("pbrMetallicRoughness", json::object());
    if (look != BakedLook::tinted) pbr = json::object();
    if (look == BakedLook::lit) pbr["baseColorTexture"] = {{"index", lightMap_}, {"texCoord", uvSet}};
    pbr.erase("metallicRoughnessTexture");
    pbr["metallicFactor"] = 0;
    pbr["roughnessFactor"] = 1;
    m["pbrMetallicRoughness"] = std::move(pbr);
    m["extensions"]["KHR_materials_unlit"] = json::object();
    return m;
}

std::size_t Baker::material(int from, std::optional<BakedLook> look, int uvSet) {
    const auto key = std::tuple(from, look ? int(*look) : -1, uvSet);
    if (const auto found = materials_.find(key); found != materials_.end()) return found->second;
    const json old = from >= 0 ? original_["materials"][std::size_t(from)] : json::object();
    json made = look ? shown(old, *look, uvSet) : old;
    if (look) {
        to_.use("KHR_materials_unlit");
    } else {
        to_.use("MOZ_lightmap");
        made["extensions"]["MOZ_lightmap"] = {{"index", lightMap_}, {"texCoord", uvSet}, {"intensity", std::numbers::pi}};
    }
    return materials_[key] = to_.append("materials", std::move(made));
}

void Baker::offerOriginal(json& primitive, int from, std::size_t baked) {
    constexpr const char* extension = "KHR_materials_variants";
    json& names = to_.json["extensions"][extension]["variants"];
    if (variants_[0] < 0) {
        to_.use(extension);
        for (const char* name : {"baked", "original"}) {
            variants_[name[0] == 'o'] = int(names.size());
            names.push_back({{"name", name}});
        }
    }
    json& mappings = primitive["extensions"][extension]["mappings"];
    mappings.push_back({{"material", baked}, {"variants", {variants_[0]}}});
    if (from >= 0) mappings.push_back({{"material", from}, {"variants", {variants_[1]}}});
}

json Baker::primitive(const json& from, const BakedPart& part, const GltfOrigin::Primitive& origin) {
    json p = from;
    json& attributes = p["attributes"];
    reshape(attributes, part, origin);
    const int old = from.value("material", -1);
    const int set = putCoordinates(attributes, old >= 0 ? original_["materials"][std::size_t(old)] : json::object(), part);
    if (part.look && attributes.contains("COLOR_0")) { // it would darken what is in the light already
        attributes["_COLOR_0"] = attributes["COLOR_0"];
        attributes.erase("COLOR_0");
    }
    if (!part.colors.empty())
        attributes["COLOR_0"] = to_.addAccessor(part.colors.data(), part.colors.size(), floatNumber, "VEC4", sizeof(Vec4), arrayBuffer);
    if (!part.irradiance.empty())
        attributes["_IRRADIANCE"] =
            to_.addAccessor(part.irradiance.data(), part.irradiance.size(), floatNumber, "VEC3", sizeof(Spectrum), arrayBuffer);
    p["indices"] = to_.addAccessor(part.indices.data(), part.indices.size(), uintNumber, "SCALAR", 4, elementArrayBuffer);
    p.erase("mode");
    if (part.look || !baked_.lightMap.empty()) {
        const std::size_t made = material(old, part.look, set);
        p["material"] = made;
        if (part.look == BakedLook::lit) offerOriginal(p, old, made);
    }
    return p;
}

json Baker::meshOf(const Placed& placed) {
    const GltfOrigin::Instance& at = to_.origin.instances[placed.instance];
    json mesh = original_["meshes"][original_["nodes"][at.node]["mesh"].get<std::size_t>()];
    const auto& origins = to_.origin.meshes[std::size_t(at.mesh)];
    for (const BakedPart* part : placed.parts) {
        json& p = mesh["primitives"][origins[part->primitive].number];
        p = primitive(p, *part, origins[part->primitive]);
    }
    return mesh;
}

// The instances of a node as children of it.
void Baker::expand(std::size_t number) {
    const json extension = original_["nodes"][number]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    const std::size_t shared = original_["nodes"][number]["mesh"];
    std::map<std::string, std::vector<float>> values;
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"})
        if (extension.contains(name)) values[name] = readFloats(to_.file, extension[name].get<std::size_t>());
    json& parent = to_.json["nodes"][number];
    parent.erase("mesh");
    parent["extensions"].erase("EXT_mesh_gpu_instancing");
    if (parent["extensions"].empty()) parent.erase("extensions");
    for (std::size_t i = 0; i < to_.origin.instances.size(); ++i) {
        const GltfOrigin::Instance& at = to_.origin.instances[i];
        if (at.node != number || at.element < 0) continue;
        json child;
        for (const auto& [name, all] : values) {
            const std::size_t width = name == "ROTATION" ? 4 : 3, first = std::size_t(at.element) * width;
            const char* key = name == "TRANSLATION" ? "translation" : name == "ROTATION" ? "rotation" : "scale";
            child[key] = std::vector<float>(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(first + width));
        }
        const auto made = meshes_.find(i);
        child["mesh"] = made == meshes_.end() ? shared : to_.append("meshes", std::move(made->second));
        const std::size_t node = to_.append("nodes", std::move(child));
        to_.json["nodes"][number]["children"].push_back(node);
    }
}

void Baker::placeNodes(const std::vector<Placed>& all) {
    std::map<std::size_t, std::size_t> references, baked; // of each mesh of the file: nodes that show it; those of them that are baked
    std::set<std::size_t> expanded;
    for (const json& node : original_["nodes"])
        if (node.contains("mesh")) ++references[node["mesh"].get<std::size_t>()];
    for (const Placed& p : all) {
        const GltfOrigin::Instance& at = to_.origin.instances[p.instance];
        if (at.element < 0) ++baked[original_["nodes"][at.node]["mesh"].get<std::size_t>()];
    }
    std::set<std::size_t> taken;
    for (const Placed& p : all) {
        const GltfOrigin::Instance& at = to_.origin.instances[p.instance];
        if (at.element >= 0) {
            expanded.insert(at.node);
            continue;
        }
        // A mesh that is only shown with its light is replaced; else the first one to come takes no place that others need.
        const std::size_t mesh = original_["nodes"][at.node]["mesh"];
        json made = std::move(meshes_[p.instance]);
        if (references[mesh] == baked[mesh] && taken.insert(mesh).second)
            to_.json["meshes"][mesh] = std::move(made);
        else
            to_.json["nodes"][at.node]["mesh"] = to_.append("meshes", std::move(made));
    }
    for (const std::size_t node : expanded) expand(node);
    for (const json& node : to_.json["nodes"])
        if (node.contains("extensions") && node["extensions"].contains("EXT_mesh_gpu_instancing")) return;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        if (to_.json.contains(list)) {
            json kept = json::array();
            for (const json& name : to_.json[list])
                if (name != "EXT_mesh_gpu_instancing") kept.push_back(name);
            to_.json[list] = kept;
            if (kept.empty()) to_.json.erase(list);
        }
}

void Baker::run() {
    addLightMap();
    std::map<std::size_t, Placed> placed;
    for (const BakedPart& part : baked_.parts) {
        Placed& p = placed[part.instance];
        p.instance = part.instance;
        p.parts.push_back(&part);
    }
    std::vector<Placed> all;
    for (auto& [instance, p] : placed) {
        meshes_[instance] = meshOf(p);
        all.push_back(std::move(p));
    }
    placeNodes(all);
    json& asset = to_.json["asset"];
    asset["generator"] = baked_.generator;
    json& notes = asset["extras"];
    if (!notes.is_object()) notes = json::object();
    for (const auto& [name, value] : baked_.notes) std::visit([&](const auto& v) { notes["chiaro"][name] = v; }, value);
}

} // namespace

void GltfDocument::apply(const BakedScene& baked) { Baker(*content_, baked).run(); }

} // namespace chiaro
