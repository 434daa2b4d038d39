// A description as a glTF document: what the built-in scenes are written from.
#include "io/gltf_write_content.h"
#include <fmt/format.h>

namespace chiaro {

using nlohmann::json;
using namespace gltf;

namespace {

json numbersOf(const Spectrum& s) { return {s[0], s[1], s[2]}; }
bool isIdentity(const Affine& m) { return m == Affine{}; }
json matrixOf(const Affine& a) {
    json m = json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) m.push_back(row < 3 ? a.m[row][column] : column == 3 ? 1.0 : 0.0);
    return m;
}

class Describer {
public:
    Describer(const SceneDesc& scene, GltfDocument::Content& to) : scene_(scene), to_(to) {}
    void run();

private:
    void addNode(json node, const Affine& place) {
        if (!isIdentity(place)) node["matrix"] = matrixOf(place);
        to_.json["scenes"][0]["nodes"].push_back(to_.append("nodes", std::move(node)));
    }
    json primitiveOf(const PrimitiveDesc&);
    json lightOf(const PunctualDesc&);
    json cameraOf(const CameraDesc&);
    void addTextures();
    template <class T> std::size_t attribute(const std::vector<T>& values, const char* type) {
        return to_.addAccessor(values.data(), values.size(), floatNumber, type, sizeof(T), arrayBuffer);
    }

    const SceneDesc& scene_;
    GltfDocument::Content& to_;
};

json Describer::primitiveOf(const PrimitiveDesc& p) {
    json attributes;
    const std::size_t at = attribute(p.positions, "VEC3");
    Vec3 low = p.positions.at(0), high = low;
    for (const Vec3& v : p.positions) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    to_.json["accessors"][at]["min"] = {low.x, low.y, low.z};
    to_.json["accessors"][at]["max"] = {high.x, high.y, high.z};
    attributes["POSITION"] = at;
    if (!p.normals.empty()) attributes["NORMAL"] = attribute(p.normals, "VEC3");
    if (!p.tangents.empty()) attributes["TANGENT"] = attribute(p.tangents, "VEC4");
    for (std::size_t k = 0; k < uvSets; ++k)
        if (!p.uv[k].empty()) attributes[fmt::format("TEXCOORD_{}", k)] = attribute(p.uv[k], "VEC2");
    if (!p.colors.empty()) attributes["COLOR_0"] = attribute(p.colors, "VEC4");
    json out{{"attributes", std::move(attributes)}};
    out["indices"] = to_.addAccessor(p.indices.data(), p.indices.size(), uintNumber, "SCALAR", 4, elementArrayBuffer);
    if (p.material >= 0) out["material"] = p.material;
    return out;
}

json Describer::lightOf(const PunctualDesc& l) {
    static constexpr const char* kinds[] = {"point", "spot", "directional"};
    const float strongest = std::max(maxComponent(l.intensity), 1e-30f);
    json out{{"name", l.name}, {"type", kinds[int(l.kind)]}, {"intensity", strongest}, {"color", numbersOf(l.intensity * (1 / strongest))}};
    if (l.range > 0) out["range"] = l.range;
    if (l.kind == PunctualKind::spot) out["spot"] = {{"innerConeAngle", l.innerCone}, {"outerConeAngle", l.outerCone}};
    return out;
}

json Describer::cameraOf(const CameraDesc& c) {
    json out{{"name", c.name}};
    constexpr double near = 0.01, far = 1e5; // metres; glTF wants them, Chiaro has none
    if (c.projection == Projection::orthographic) {
        out["type"] = "orthographic";
        out["orthographic"] = {{"xmag", c.xmag}, {"ymag", c.ymag}, {"znear", near}, {"zfar", far}};
    } else {
        out["type"] = "perspective";
        out["perspective"] = {{"yfov", c.yfov}, {"znear", near}};
        if (c.aspect > 0) out["perspective"]["aspectRatio"] = c.aspect;
    }
    return out;
}

void Describer::addTextures() {
    for (const ImageDesc& i : scene_.images)
        to_.addImage(i.name, pngBytes(uint32_t(i.width), uint32_t(i.height), i.channels, i.type, i.pixels.data(), i.name), "image/png");
    const auto wrap = [](Wrap w) { return w == Wrap::clamp ? 33071 : w == Wrap::mirror ? 33648 : 10497; };
    for (const TextureDesc& t : scene_.textures) {
        const int filter = t.filter == TextureFilter::nearest ? 9728 : 9729;
        const std::size_t sampler = to_.append("samplers", {{"wrapS", wrap(t.wrapS)}, {"wrapT", wrap(t.wrapT)}, {"magFilter", filter}});
        to_.append("textures", {{"source", t.image}, {"sampler", sampler}});
    }
}

void Describer::run() {
    to_.json = {
        {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", json::array({{{"name", scene_.name}, {"nodes", json::array()}}})}};
    addTextures();
    for (const MaterialDesc& m : scene_.materials) to_.append("materials", materialOf(to_, m));
    for (const MeshDesc& m : scene_.meshes) {
        json mesh{{"name", m.name}, {"primitives", json::array()}};
        std::vector<GltfOrigin::Primitive>& parts = to_.origin.meshes.emplace_back();
        for (const PrimitiveDesc& p : m.primitives) {
            parts.push_back({parts.size(), {}});
            mesh["primitives"].push_back(primitiveOf(p));
        }
        to_.append("meshes", std::move(mesh));
    }
    for (const InstanceDesc& i : scene_.instances) {
        to_.origin.instances.push_back({to_.origin.instances.size(), -1, i.mesh});
        addNode({{"name", i.name}, {"mesh", i.mesh}}, i.toWorld);
    }
    for (const CameraDesc& c : scene_.cameras) addNode({{"name", c.name}, {"camera", to_.append("cameras", cameraOf(c))}}, c.toWorld);
    if (scene_.lights.empty()) return;
    to_.use("KHR_lights_punctual");
    json& lights = to_.json["extensions"]["KHR_lights_punctual"]["lights"];
    for (const PunctualDesc& l : scene_.lights) {
        lights.push_back(lightOf(l));
        addNode({{"name", l.name}, {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}}, l.toWorld);
    }
}

} // namespace

GltfDocument GltfDocument::describe(const SceneDesc& scene) {
    auto content = std::make_unique<Content>();
    Describer(scene, *content).run();
    GltfFile& file = content->file;
    file.name = scene.name;
    file.json = content->json;
    file.json["buffers"] = json::array({{{"byteLength", content->binary.size()}}});
    file.loaded = {content->binary};
    file.buffers = {file.loaded[0]};
    checkAccessors(file);
    return GltfDocument(std::move(content));
}

} // namespace chiaro
