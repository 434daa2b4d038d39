// chiaro info SCENE | IMAGE: what is in it, what Chiaro will use, approximate, ignore, add.
#include "core/render/executor.h"
#include "io/picture.h"
#include "tools/cli/command.h"
#include "tools/cli/info_image.h"
#include "tools/cli/scene_source.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
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
    Json all = Json::array();
    for (const ImageDesc& i : desc.images)
        all.push_back({{"name", i.name}, {"size", {i.width, i.height}}, {"channels", i.channels}, {"bytes", i.pixels.size()}});
    return all;
}

Json materialsOf(const SceneDesc& desc) {
    Json all = Json::array();
    for (const MaterialDesc& m : desc.materials) {
        std::string kind = m.unlit              ? "unlit"
                           : m.transmission > 0 ? (m.volume ? "glass" : "thin glass")
                           : m.metallic >= 0.5f ? "metal"
                                                : "dielectric";
        if (m.alphaMode != AlphaMode::opaque) kind += m.alphaMode == AlphaMode::mask ? ", alpha mask" : ", alpha blend";
        if (!black(m.emission)) kind += ", emissive";
        if (m.doubleSided) kind += ", double-sided";
        all.push_back({{"name", m.name}, {"kind", kind}});
    }
    return all;
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
    info["added"] = added;
    info["memory"] = sceneBytesJson(c.bytes);
    info["memory"]["peak"] = peakBytes();
    info["seconds"] = loaded.seconds;
    info["warnings"] = notes.warnings();
    return info;
}

void printBounds(const Json& bounds) {
    const auto at = [&](int end, int axis) { return bounds[std::size_t(end)][std::size_t(axis)].get<double>(); };
    fmt::print("{:<12} {:.4g} x {:.4g} x {:.4g} m, from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})\n", "bounds",
               at(1, 0) - at(0, 0), at(1, 1) - at(0, 1), at(1, 2) - at(0, 2), at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2));
}

// The first few of a list, then how many more there are (--json has all).
template <class F> void printList(const char* label, const Json& list, F&& line) {
    constexpr std::size_t shown = 40;
    fmt::print("{:<12} {}\n", label, list.size());
    for (std::size_t i = 0; i < std::min(shown, list.size()); ++i) fmt::print("{:<12}   {}\n", "", line(list[i], i));
    if (list.size() > shown) fmt::print("{:<12}   ... and {} more (--json lists them)\n", "", list.size() - shown);
}

std::string text(const Json& j) { return j.get<std::string>(); }

void printMemory(const Json& memory, double triangles) {
    std::string parts;
    for (const auto& [part, bytes] : memory.items())
        if (part != "total" && part != "peak" && bytes.get<double>() > 0)
            parts += fmt::format(", {} {}", part, memorySize(bytes.get<double>()));
    const double total = memory["total"].get<double>(), textures = memory["textures"].get<double>();
    const std::string each = triangles > 0 ? fmt::format("; {:.0f} bytes a triangle without textures", (total - textures) / triangles) : "";
    fmt::print("{:<12} {}{}{}; {} with all of chiaro\n", "memory", memorySize(total), parts, each,
               memorySize(memory["peak"].get<double>()));
}

void printScene(const Json& i) {
    fmt::print("{:<12} {}   hash {}\n", "scene", text(i["scene"]), text(i["hash"]));
    if (i.contains("bounds")) printBounds(i["bounds"]);
    const Json& t = i["triangles"];
    fmt::print("{:<12} {} stored, {} drawn, {} emissive\n", "triangles", t["stored"].get<uint64_t>(), t["drawn"].get<uint64_t>(),
               t["emissive"].get<uint64_t>());
    fmt::print("{:<12} {}\n", "instances", i["instances"].get<uint64_t>());
    printList("cameras", i["cameras"], [](const Json& c, std::size_t n) {
        return fmt::format("{} \"{}\"  {}{}, aspect {:.4g}", n, text(c["name"]), text(c["projection"]),
                           c.contains("yfov") ? fmt::format(", vertical angle {:.4g} deg", c["yfov"].get<double>()) : "",
                           c["aspect"].get<double>());
    });
    if (!i["animations"].empty())
        printList("animations", i["animations"], [](const Json& a, std::size_t n) {
            std::string channels;
            for (const auto& [path, count] : a["channels"].items()) channels += fmt::format(", {} {}", count.get<std::size_t>(), path);
            return fmt::format("{} \"{}\"  {:.4g} s{}{}", n, text(a["name"]), a["seconds"].get<double>(), channels,
                               a["plays"].get<bool>() ? ", plays" : "");
        });
    printList("lights", i["lights"], [](const Json& l, std::size_t) {
        const uint64_t triangles = l["triangles"].get<uint64_t>();
        return fmt::format("{} \"{}\"  {:.4g} lm{}", text(l["kind"]), text(l["name"]), l["lumen"].get<double>(),
                           triangles ? fmt::format(", {} triangles", triangles) : "");
    });
    fmt::print("{:<12} {}\n", "environment", text(i["environment"]));
    printList("materials", i["materials"],
              [](const Json& m, std::size_t) { return fmt::format("\"{}\"  {}", text(m["name"]), text(m["kind"])); });
    const Json& textures = i["textures"];
    printList("textures", textures["images"], [](const Json& p, std::size_t) {
        return fmt::format("\"{}\"  {}x{}, {} channels, {}", text(p["name"]), p["size"][0].get<int>(), p["size"][1].get<int>(),
                           p["channels"].get<int>(), memorySize(p["bytes"].get<double>()));
    });
    printMemory(i["memory"], t["stored"].get<double>());
    for (const Json& line : i["added"]) fmt::print("{:<12} {}\n", "added", text(line));
    for (const Json& line : i["warnings"]) fmt::print("{:<12} {}\n", "warning", text(line));
}

bool looksLikeScene(const std::string& operand) {
    std::string extension = std::filesystem::path(operand).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return operand.starts_with('@') || extension == ".gltf" || extension == ".glb" || extension.empty();
}

} // namespace

int runInfo(const Arguments& arguments) {
    Diagnostics notes;
    const std::string& operand = arguments.operands[0];
    const bool json = arguments.on("json");
    if (!looksLikeScene(operand)) {
        printImageInfo(operand, json);
        return 0;
    }
    const Json info = describeScene(readSceneRequest(arguments), notes);
    if (json)
        fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
    else
        printScene(info);
    return arguments.on("strict") && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
