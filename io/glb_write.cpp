#include "io/glb_write.h"
#include "core/render/error.h"
#include "io/replace_file.h"
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "GLB is little-endian");
constexpr int floatType = 5126, arrayBuffer = 34962;
constexpr uint32_t chunkJson = 0x4E4F534A, chunkBin = 0x004E4942;

void append(std::vector<std::byte>& to, const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    to.insert(to.end(), bytes, bytes + size);
}
void append(std::vector<std::byte>& to, uint32_t v) { append(to, &v, 4); }

// The file under construction: JSON and the bytes that it speaks of.
class Writer {
public:
    explicit Writer(const GlbScene& scene) : scene_(scene) {}
    std::vector<std::byte> bytes() {
        root_["asset"] = {{"version", "2.0"}, {"generator", scene_.generator}};
        root_["scene"] = 0;
        root_["scenes"] = Json::array({{{"name", scene_.name}}});
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) addNode(i);
        if (root_.contains("meshes")) {
            root_["extensionsUsed"] = {"KHR_materials_unlit"};
            root_["materials"] = Json::array({{{"name", "unlit"},
                                               {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                                               {"extensions", {{"KHR_materials_unlit", Json::object()}}}}});
            root_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
        }
        return glbContainer(root_.dump(-1, ' ', false, Json::error_handler_t::replace), binary_);
    }

private:
    void addNode(std::size_t i) {
        const GlbNode& n = scene_.nodes[i];
        Json node{{"name", n.name}};
        const Vec3d& t = n.translation;
        if (t.x != 0 || t.y != 0 || t.z != 0) node["translation"] = {t.x, t.y, t.z};
        for (const auto& [key, value] : n.notes) node["extras"][key] = value;
        Json primitives = Json::array();
        for (const GlbShape& s : n.shapes)
            if (!s.positions.empty()) primitives.push_back(primitive(n.name, s));
        if (!primitives.empty()) {
            node["mesh"] = root_["meshes"].size();
            root_["meshes"].push_back({{"name", n.name}, {"primitives", std::move(primitives)}});
        }
        if (n.parent >= int(i)) throw Error(Exit::internal, fmt::format("GLB node {} hangs under a later one", i));
        root_["nodes"].push_back(std::move(node));
        Json& above = n.parent < 0 ? root_["scenes"][0]["nodes"] : root_["nodes"][std::size_t(n.parent)]["children"];
        above.push_back(i);
    }

    Json primitive(const std::string& name, const GlbShape& s) {
        const bool whole = s.mode == GlbMode::points || (s.mode == GlbMode::lines ? s.positions.size() % 2 == 0 : s.positions.size() > 1);
        if (!whole || s.colors.size() != s.positions.size())
            throw Error(Exit::internal,
                        fmt::format("GLB shape of {} has {} positions and {} colours", name, s.positions.size(), s.colors.size()));
        Vec3 low = s.positions[0], high = low;
        for (const Vec3& p : s.positions) {
            if (!finite(p)) throw Error(Exit::internal, fmt::format("GLB shape of {} has a position that is not finite", name));
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
        const std::size_t positions = accessor(s.positions.data(), s.positions.size());
        root_["accessors"][positions]["min"] = {low.x, low.y, low.z};
        root_["accessors"][positions]["max"] = {high.x, high.y, high.z};
        const std::size_t colors = accessor(s.colors.data(), s.colors.size());
        return {{"attributes", {{"POSITION", positions}, {"COLOR_0", colors}}}, {"material", 0}, {"mode", int(s.mode)}};
    }

    template <class T> std::size_t accessor(const T* values, std::size_t count) {
        static_assert(sizeof(T) == 3 * sizeof(float));
        root_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", count * sizeof(T)}, {"target", arrayBuffer}});
        append(binary_, values, count * sizeof(T));
        root_["accessors"].push_back(
            {{"bufferView", root_["bufferViews"].size() - 1}, {"componentType", floatType}, {"count", count}, {"type", "VEC3"}});
        return root_["accessors"].size() - 1;
    }

    const GlbScene& scene_;
    Json root_;
    std::vector<std::byte> binary_;
};

} // namespace

std::vector<std::byte> glbContainer(std::string json, std::span<const std::byte> binary) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t padded = (binary.size() + 3) / 4 * 4, total = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + padded);
    if (total > 0xffffffffu) throw Error(Exit::resources, "a .glb can hold 4 GB. Write less into one file.");
    std::vector<std::byte> file;
    file.reserve(total);
    append(file, "glTF", 4);
    append(file, 2);
    append(file, uint32_t(total));
    append(file, uint32_t(json.size()));
    append(file, chunkJson);
    append(file, json.data(), json.size());
    if (binary.empty()) return file;
    append(file, uint32_t(padded));
    append(file, chunkBin);
    append(file, binary.data(), binary.size());
    file.resize(total);
    return file;
}

std::vector<std::byte> glbBytes(const GlbScene& scene) { return Writer(scene).bytes(); }

void writeGlb(const std::filesystem::path& file, const GlbScene& scene) { replaceFile(file, glbBytes(scene)); }

} // namespace chiaro
