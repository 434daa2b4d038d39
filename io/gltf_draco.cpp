#include "core/render/in_parallel.h"
#include "io/draco_mesh.h"
#include "io/gltf_compressed.h"
#include <atomic>
#include <fmt/format.h>
#include <stdexcept>

namespace chiaro::gltf {

using nlohmann::json;

namespace {

constexpr const char* name = "KHR_draco_mesh_compression";
constexpr uint64_t freeBytes = uint64_t(1) << 30, bytesPerByte = 1024; // of all meshes together

// glTF's types, by the numbers of an element.
int widthOf(const std::string& type) {
    constexpr std::pair<const char*, int> all[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    for (const auto& [known, width] : all)
        if (type == known) return width;
    return 0;
}
size_t sizeOf(int component) { return component < 5122 ? 1 : component < 5124 ? 2 : 4; }

struct Attribute {
    std::string name;
    uint32_t number = 0;
    json accessor;
    size_t stride = 0;
    std::vector<std::byte> values;
};
struct Packed {
    size_t mesh = 0, primitive = 0, points = 0;
    std::string place;
    Bytes data;
    std::vector<Attribute> attributes;
    std::vector<uint32_t> indices;
};

json& primitiveOf(GltfFile& file, const Packed& p) { return file.json["meshes"][p.mesh]["primitives"][p.primitive]; }

Packed packedOf(const GltfFile& file, const json& primitive, size_t mesh, size_t number) {
    Packed p{mesh, number, 0, fmt::format("/meshes/{}/primitives/{}/extensions/{}", mesh, number, name), {}, {}, {}};
    const json& from = primitive["extensions"][name];
    p.data = bufferView(file, from["bufferView"]);
    const int mode = primitive.value("mode", 4);
    if (mode != 4 && mode != 5) file.fail(p.place, fmt::format("packs a primitive of mode {}, must be 4 or 5. Export it again.", mode));
    for (const auto& [semantic, id] : from["attributes"].items()) {
        if (!primitive["attributes"].contains(semantic)) continue; // nothing says what its numbers are
        Attribute a{semantic, id, list(file, "accessors")[primitive["attributes"][semantic].get<size_t>()], 0, {}};
        const std::string& type = a.accessor["type"].get_ref<const std::string&>();
        if (widthOf(type) == 0)
            file.fail(fmt::format("{}/attributes/{}", p.place, shown(semantic)),
                      fmt::format("cannot be {}. Export it again.", shown(type)));
        a.stride = (sizeOf(a.accessor["componentType"]) * size_t(widthOf(type)) + 3) / 4 * 4; // vertex data begins at multiples of four
        p.attributes.push_back(std::move(a));
    }
    return p;
}

void unpack(const GltfFile& file, Packed& p) {
    try {
        const DracoMesh mesh(p.data);
        p.points = mesh.points();
        p.indices = mesh.indices();
        for (Attribute& a : p.attributes)
            a.values = mesh.values(a.number, a.accessor["componentType"], widthOf(a.accessor["type"]), a.stride);
    } catch (const std::length_error&) {
        file.fail(p.place, "cannot be unpacked: its bytes are damaged. Download or export the file again.");
    } catch (const std::runtime_error& e) {
        file.fail(p.place, fmt::format("cannot be unpacked: {}. Download or export the file again.", e.what()));
    }
}

size_t addView(GltfFile& file, std::vector<std::byte> bytes, size_t stride) {
    json view{{"byteLength", bytes.size()}, {"buffer", addBuffer(file, std::move(bytes))}};
    if (stride != 0) view["byteStride"] = stride;
    file.json["bufferViews"].push_back(std::move(view));
    return file.json["bufferViews"].size() - 1;
}
size_t addAccessor(GltfFile& file, json accessor) {
    file.json["accessors"].push_back(std::move(accessor));
    return file.json["accessors"].size() - 1;
}

// The primitive as one that never was packed.
void replace(GltfFile& file, Packed& p) {
    for (Attribute& a : p.attributes) {
        a.accessor["bufferView"] = addView(file, std::move(a.values), a.stride);
        a.accessor["count"] = p.points;
        a.accessor.erase("byteOffset");
        a.accessor.erase("sparse");
        primitiveOf(file, p)["attributes"][a.name] = addAccessor(file, std::move(a.accessor));
    }
    const auto bytes = std::as_bytes(std::span(p.indices));
    const size_t view = addView(file, {bytes.begin(), bytes.end()}, 0);
    json& primitive = primitiveOf(file, p);
    primitive["indices"] =
        addAccessor(file, {{"bufferView", view}, {"componentType", 5125}, {"count", p.indices.size()}, {"type", "SCALAR"}});
    primitive["mode"] = 4;
    primitive["extensions"].erase(name);
    std::vector<uint32_t>().swap(p.indices);
}

} // namespace

void unpackDraco(GltfFile& file) {
    std::vector<Packed> all;
    uint64_t length = 0;
    const json& meshes = list(file, "meshes");
    for (size_t m = 0; m < meshes.size(); ++m)
        for (size_t i = 0; i < meshes[m]["primitives"].size(); ++i) {
            const json& primitive = meshes[m]["primitives"][i];
            if (!primitive.contains("extensions") || !primitive["extensions"].contains(name)) continue;
            all.push_back(packedOf(file, primitive, m, i));
            length += all.back().data.size();
        }
    if (all.empty()) return;
    std::atomic<uint64_t> held = 0;
    inParallel(file.run, all.size(), [&](uint64_t i) {
        Packed& p = all[i];
        unpack(file, p);
        uint64_t bytes = p.indices.size() * 4;
        for (const Attribute& a : p.attributes) bytes += a.values.size();
        if ((held += bytes) > freeBytes + bytesPerByte * length)
            file.fail(p.place, fmt::format("brings what {} packed bytes hold above {}. Split the scene.", length,
                                           freeBytes + bytesPerByte * length));
    });
    file.admit(held);
    for (Packed& p : all) replace(file, p);
    forgetExtension(file, name);
}

} // namespace chiaro::gltf
