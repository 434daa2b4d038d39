#include "tools/cli/info_scene.h"
#include "core/render/executor.h"
#include "tools/cli/command.h"
#include "tools/cli/info_materials.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Box {
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void add(const Vec3d& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    bool empty() const { return low.x > high.x; }
};

// Of all that is drawn: the boxes of the meshes, placed. A turned box is larger than what it holds.
Box worldBounds(const SceneDesc& desc) {
    std::vector<Box> meshes(desc.meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i)
        for (const PrimitiveDesc& p : desc.meshes[i].primitives)
            for (const Vec3& v : p.positions) meshes[i].add(cast<double>(v));
    Box world;
    for (const InstanceDesc& instance : desc.instances) {
        if (instance.mesh < 0 || meshes[std::size_t(instance.mesh)].empty()) continue;
        const Box& b = meshes[std::size_t(instance.mesh)];
        for (int k = 0; k < 8; ++k)
            world.add(instance.toWorld.point({k & 1 ? b.high.x : b.low.x, k & 2 ? b.high.y : b.low.y, k & 4 ? b.high.z : b.low.z}));
    }
    return world;
}

Json vector(const Vec3d& v) { return {v.x, v.y, v.z}; }

Json imagesOf(const SceneDesc& desc) {
    constexpr const char* channels[] = {"grey", "grey + alpha", "RGB", "RGBA"};
    constexpr const char* depths[] = {"8 bit", "16 bit", "float"};
    Json all = Json::array();
    for (const ImageDesc& i : desc.images)
        all.push_back({{"name", i.name},
                       {"size", {i.width, i.height}},
                       {"channels", channels[std::clamp(i.channels, 1, 4) - 1]},
                       {"depth", depths[std::size_t(i.type)]},
                       {"format", ""},
                       {"bytes", i.pixels.size()}});
    return all;
}

// Of a built-in scene there is no file.
void addFile(Json& info, const LoadedScene& loaded, Json& images) {
    for (const char* kind : {"approximated", "ignored", "added"}) info[kind] = Json::array();
    if (!loaded.inventory) return;
    const GltfInventory& file = *loaded.inventory;
    Json extensions = Json::array(), skins = Json::array();
    constexpr const char* uses[] = {"applied", "nothing to see", "ignored"};
    for (const GltfInventory::Extension& e : file.extensions)
        extensions.push_back({{"name", e.name}, {"use", uses[std::size_t(e.use)]}, {"required", e.required}, {"places", e.places}});
    for (const GltfInventory::Skin& s : file.skins) skins.push_back({{"name", s.name}, {"joints", s.joints}});
    info["file"] = {{"bytes", file.bytes},         {"version", file.version}, {"generator", file.generator},
                    {"copyright", file.copyright}, {"scenes", loaded.scenes}, {"scene", loaded.number},
                    {"extensions", extensions},    {"meshes", file.meshes},   {"materials", file.materials},
                    {"images", file.images},       {"skins", skins},          {"morphTargets", file.morphTargets}};
    for (std::size_t i = 0; i < std::min(images.size(), file.pictures.size()); ++i) {
        images[i]["format"] = file.pictures[i].format;
        images[i]["stored"] = file.pictures[i].bytes;
    }
    info["approximated"] = file.approximated;
    info["ignored"] = file.ignored;
    info["added"] = file.added;
}

Json camerasOf(const Scene& scene) {
    Json all = Json::array();
    for (const CameraDesc& c : scene.cameras()) {
        const bool perspective = c.projection == Projection::perspective;
        Json camera{{"name", c.name}, {"projection", perspective ? "perspective" : "orthographic"}};
        if (perspective)
            camera["yfov"] = c.yfov * 180 / std::numbers::pi;
        else
            camera["ymag"] = c.ymag;
        camera["aspect"] = perspective ? c.aspect : c.xmag / c.ymag;
        all.push_back(std::move(camera));
    }
    return all;
}

Json animationsOf(const LoadedScene& loaded) {
    Json all = Json::array();
    for (const AnimationInfo& a : loaded.animations) {
        Json channels = Json::object();
        for (const auto& [path, count] : a.channels) channels[path] = count;
        all.push_back({{"name", a.name}, {"seconds", a.seconds}, {"channels", channels}, {"plays", a.used}});
    }
    return all;
}

Json lightsOf(const Scene& scene) {
    Json all = Json::array();
    for (const LightInfo& l : scene.lights().describe())
        all.push_back({{"name", l.name}, {"kind", l.kind}, {"lumen", l.power}, {"triangles", l.triangles}});
    return all;
}

} // namespace

Json describeScene(const SceneRequest& request, Diagnostics& notes) {
    Json fromDesc;
    const Executor run;
    const LoadedScene loaded = loadScene(request, notes, run, [&](const SceneDesc& desc) {
        const Box box = worldBounds(desc);
        if (!box.empty()) fromDesc["bounds"] = {vector(box.low), vector(box.high)};
        fromDesc["materials"] = materialsOf(desc);
        fromDesc["images"] = imagesOf(desc);
    });
    const Scene& scene = *loaded.scene;
    const SceneCounts& c = scene.counts();
    Json info{{"scene", request.operand}, {"hash", fmt::format("{:016x}", scene.hash())}};
    addFile(info, loaded, fromDesc["images"]);
    if (fromDesc.contains("bounds")) info["bounds"] = fromDesc["bounds"];
    info["triangles"] = {{"stored", c.triangles}, {"drawn", c.trianglesDrawn}, {"emissive", c.emissiveTriangles}};
    info["instances"] = c.instances;
    info["cameras"] = camerasOf(scene);
    info["animations"] = animationsOf(loaded);
    info["lights"] = lightsOf(scene);
    info["lumen"] = scene.lights().power();
    info["environment"] = loaded.environment;
    info["materials"] = fromDesc["materials"];
    info["textures"] = {{"bytes", c.bytes.textures}, {"images", fromDesc["images"]}};
    std::vector<std::string> added = loaded.added;
    if (scene.cameras().empty())
        added.insert(added.begin(), "no camera in the scene: one that frames it all      keep it with: --camera auto");
    for (std::string& line : added) info["added"].push_back(std::move(line));
    info["memory"] = sceneBytesJson(c.bytes);
    info["memory"]["peak"] = peakBytes();
    info["seconds"] = loaded.seconds;
    info["warnings"] = notes.warnings();
    return info;
}

} // namespace chiaro::cli
