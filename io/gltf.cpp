#include "io/gltf.h"
#include "io/gltf_animation.h"
#include "io/gltf_file.h"
#include "io/gltf_nodes.h"
#include <fmt/format.h>
#include <new>

namespace chiaro {

using namespace gltf;
using nlohmann::json;

namespace {

// tinygltf turns the checked JSON of nodes and meshes into its typed model. It gets no buffer and no picture, so it opens no file and
// decodes nothing; of the accessors, which are checked and read here, it sees only how many there are.
void parseModel(GltfFile& file) {
    json reduced = json::object();
    for (const char* key : {"asset", "nodes", "meshes"})
        if (file.json.contains(key)) reduced[key] = file.json[key];
    const json stub = {{"bufferView", 0}, {"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
    if (!file.accessors.empty()) {
        reduced["accessors"] = json::array_t(file.accessors.size(), stub);
        reduced["bufferViews"] = json::array_t{{{"buffer", 0}, {"byteLength", 4}}};
    }
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(
        [](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; }, nullptr);
    tinygltf::FsCallbacks none{};
    none.FileExists = [](const std::string&, void*) { return false; };
    none.ExpandFilePath = [](const std::string& name, void*) { return name; };
    none.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; };
    none.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
    loader.SetFsCallbacks(none);
    std::string error, warning;
    const std::string text = reduced.dump();
    if (!loader.LoadASCIIFromString(&file.model, &error, &warning, text.data(), unsigned(text.size()), "") || !error.empty())
        file.fail("", fmt::format("is refused by tinygltf: {}. Export it again.", shown(error)));
    for (const auto& [key, parsed] : {std::pair{"nodes", file.model.nodes.size()}, std::pair{"meshes", file.model.meshes.size()}})
        if (parsed != list(file, key).size())
            file.fail(fmt::format("/{}", key), "has an entry that tinygltf cannot read. Export the file again.");
}

void countPlaced(Conversion& to) {
    to.sizes.instances = to.scene.instances.size();
    to.sizes.materials = to.scene.materials.size();
    std::vector<uint64_t> emissive(to.scene.meshes.size());
    for (size_t i = 0; i < emissive.size(); ++i)
        for (const PrimitiveDesc& p : to.scene.meshes[i].primitives) {
            if (p.material < 0) continue;
            const MaterialDesc& m = to.scene.materials[size_t(p.material)];
            if (!black(m.unlit ? m.baseColor : m.emission)) emissive[i] += p.indices.size() / 3;
        }
    for (const InstanceDesc& i : to.scene.instances) to.sizes.emissive += emissive[size_t(i.mesh)];
}

SceneDesc convert(const GltfFile& file, const GltfOptions& options, GltfContents* found) {
    SceneDesc scene;
    scene.name = file.path.stem().string();
    scene.shutter = options.shutter;
    const Animations animations(file, options.animation);
    if (found) {
        found->animations = animations.info();
        for (const json& s : list(file, "scenes")) found->scenes.push_back(s.value("name", std::string()));
        found->scene = sceneNumber(file, options.scene);
    }
    Conversion to{file, options, animations, scene, {}, {}, {}, {}, {}};
    to.meshes.assign(list(file, "meshes").size(), -1);
    to.materials.assign(list(file, "materials").size(), -1);
    to.textures.assign(list(file, "textures").size(), -1);
    to.images.assign(list(file, "images").size(), -1);
    for (const Bytes& buffer : file.buffers) to.bufferBytes += buffer.size();
    to.sizes.fileBytes = file.content.size();
    for (const auto& loaded : file.loaded) to.sizes.fileBytes += loaded.size();
    convertNodes(to);
    countPlaced(to);
    measureImages(to);
    if (options.admit) options.admit(to.sizes);
    decodeImages(to);
    if (found) {
        takeInventory(to, found->inventory);
        found->inventory.pictures = std::move(to.pictures);
        found->origin = std::move(to.origin);
    }
    return scene;
}

} // namespace

SceneDesc readGltf(const std::filesystem::path& path, const GltfOptions& options, Diagnostics& notes, GltfContents* found) {
    GltfFile file;
    file.path = path;
    file.name = path.string();
    file.notes = &notes;
    file.run = options.run;
    file.admission = options.admit;
    try {
        std::error_code absent; // reading says so
        if (const uintmax_t bytes = std::filesystem::file_size(path, absent); options.admit && !absent) options.admit({.fileBytes = bytes});
        openContainer(file);
        checkSchema(file);
        checkVersion(file);
        checkExtensions(file);
        if (found) found->inventory.extensions = extensionsOf(file);
        loadBuffers(file);
        checkAccessors(file);
        checkNodes(file);
        parseModel(file);
        return convert(file, options, found);
    } catch (const std::bad_alloc&) {
        throw Error(Exit::resources, fmt::format("{}: does not fit into memory. Split the scene.", file.name));
    } catch (const nlohmann::json::exception& e) {
        file.fail("", fmt::format("has a member of an unexpected type: {}. Export it again.", shown(e.what())));
    }
}

} // namespace chiaro
