#include "io/gltf_inventory.h"
#include "io/gltf_factors.h"
#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

class Inventory {
public:
    Inventory(const Conversion& to, GltfInventory& into) : to_(to), file_(to.file), into_(into) {}
    void take() {
        const json& asset = member(file_.json, "asset");
        into_.version = asset.value("version", "");
        into_.generator = textOf(asset, "generator");
        into_.copyright = textOf(asset, "copyright");
        into_.bytes = file_.content.size();
        for (size_t i = 0; i < file_.loaded.size(); ++i) // what was unpacked has none
            if (const json& b = list(file_, "buffers")[i]; b.contains("uri") && !isDataUri(b["uri"].get<std::string>()))
                into_.bytes += file_.loaded[i].size();
        into_.meshes = list(file_, "meshes").size();
        into_.materials = list(file_, "materials").size();
        into_.images = list(file_, "images").size();
        for (const json& s : list(file_, "skins")) into_.skins.push_back({textOf(s, "name"), s["joints"].size()});
        countPrimitives();
        countMaterials();
        countUnused();
    }

private:
    static std::string textOf(const json& holder, const char* key) { // asset's members are not in the schema's table
        const auto found = holder.find(key);
        return found != holder.end() && found->is_string() ? found->get<std::string>() : std::string();
    }
    static std::string many(size_t n, const char* one, const char* several) { return fmt::format("{} {}", n, n == 1 ? one : several); }
    void note(std::vector<std::string>& lines, size_t n, const char* one, const char* several, const char* rest) {
        if (n) lines.push_back(many(n, one, several) + rest);
    }

    // The meshes of the file that the scene shows, each with what was made of it.
    void countPrimitives() {
        size_t points = 0, lines = 0, tangents = 0, normals = 0, plain = 0, colors = 0;
        std::set<std::pair<size_t, int>> shown;
        for (const GltfOrigin::Instance& i : to_.origin.instances)
            if (const json& node = list(file_, "nodes")[i.node]; node.contains("mesh")) shown.emplace(node["mesh"].get<size_t>(), i.mesh);
        std::set<size_t> meshes;
        for (const auto& [number, made] : shown) {
            const json& primitives = list(file_, "meshes")[number]["primitives"];
            if (meshes.insert(number).second)
                for (const json& p : primitives) {
                    const int mode = p.value("mode", 4);
                    points += mode == 0;
                    lines += mode > 0 && mode < 4;
                    into_.morphTargets += p.contains("targets") ? p["targets"].size() : 0;
                }
            if (made < 0 || size_t(made) >= to_.origin.meshes.size()) continue;
            const auto& parts = to_.origin.meshes[size_t(made)];
            for (size_t k = 0; k < parts.size() && k < to_.scene.meshes[size_t(made)].primitives.size(); ++k) {
                const PrimitiveDesc& desc = to_.scene.meshes[size_t(made)].primitives[k];
                const json& p = primitives[parts[k].number];
                const json& attributes = p["attributes"];
                tangents += !desc.tangents.empty() && !attributes.contains("TANGENT");
                normals += !attributes.contains("NORMAL");
                plain += desc.material < 0;
                colors += attributes.contains("COLOR_1");
            }
        }
        note(into_.ignored, points, "primitive", "primitives", " of points");
        note(into_.ignored, lines, "primitive", "primitives", " of lines");
        note(into_.ignored, colors, "primitive", "primitives", " with a second set of vertex colours: the first is shown");
        note(into_.added, tangents, "primitive", "primitives", " got tangents, which a texture needs (MikkTSpace's weighting)");
        note(into_.added, normals, "primitive", "primitives", " without normals: flat facets");
        note(into_.added, plain, "primitive", "primitives", " without a material: glTF's own, a rough white metal");
    }

    void countMaterials() {
        size_t occlusion = 0, thickness = 0, minification = 0;
        std::set<int> textures;
        for (size_t i = 0; i < to_.materials.size(); ++i) {
            if (to_.materials[i] < 0) continue;
            const json& m = list(file_, "materials")[i];
            occlusion += m.contains("occlusionTexture");
            thickness += member(member(m, "extensions"), "KHR_materials_volume").contains("thicknessTexture");
        }
        for (size_t i = 0; i < to_.textures.size(); ++i) {
            const json& t = list(file_, "textures")[i];
            if (to_.textures[i] < 0 || !t.contains("sampler")) continue;
            minification += list(file_, "samplers")[t["sampler"].get<size_t>()].value("minFilter", 9987) != 9987;
        }
        note(into_.ignored, occlusion, "occlusion texture", "occlusion textures", ": light finds its own way into the corners");
        note(into_.ignored, thickness, "thickness texture", "thickness textures", ": a ray measures the way through the mesh itself");
        note(into_.approximated, minification, "texture", "textures",
             " with another minFilter than trilinear: filtered by the footprint of the ray");
        note(into_.ignored, list(file_, "cameras").size(), "camera's", "cameras'", " near and far planes: nothing is cut off");
    }

    void countUnused() {
        const auto unused = [](const std::vector<int>& all) { return size_t(std::count(all.begin(), all.end(), -1)); };
        note(into_.ignored, unused(to_.materials), "material", "materials", " that nothing shown wears");
        note(into_.ignored, unused(to_.images), "picture", "pictures", " that no material shown reads");
        std::set<size_t> shown;
        for (const GltfOrigin::Instance& i : to_.origin.instances) {
            const json& node = list(file_, "nodes")[i.node];
            if (node.contains("mesh")) shown.insert(node["mesh"].get<size_t>());
        }
        note(into_.ignored, list(file_, "meshes").size() - shown.size(), "mesh", "meshes", " that the scene does not show");
        for (const GltfInventory::Extension& e : into_.extensions)
            if (e.use == GltfInventory::Use::ignored && e.places)
                into_.ignored.push_back(fmt::format("extension {}", e.name.substr(0, 100)));
    }

    const Conversion& to_;
    const GltfFile& file_;
    GltfInventory& into_;
};

} // namespace

void takeInventory(const Conversion& to, GltfInventory& into) { Inventory(to, into).take(); }

} // namespace chiaro::gltf
