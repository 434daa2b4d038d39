#include "io/gltf_mesh.h"
#include "core/render/in_parallel.h"
#include "io/gltf_deform.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::gltf {

std::string placeOf(size_t mesh, size_t primitive) { return fmt::format("/meshes/{}/primitives/{}", mesh, primitive); }

namespace {

bool drawable(const tinygltf::Primitive& p) { return p.mode >= TINYGLTF_MODE_TRIANGLES && p.attributes.contains("POSITION"); }

// Before anything is allocated.
void countElements(Conversion& to, const tinygltf::Primitive& primitive, const std::string& place) {
    const Accessor& positions = to.file.accessors[size_t(primitive.attributes.at("POSITION"))];
    const uint64_t vertices = positions.count;
    if (positions.data.empty() && vertices > freeVertices)
        to.file.fail(place, fmt::format("has {} vertices without a byte behind them. Export the file again.", vertices));
    const uint64_t indices = primitive.indices >= 0 ? to.file.accessors[size_t(primitive.indices)].count : vertices;
    const uint64_t kept = std::min(vertices, indices), drawn = indices * (primitive.mode == TINYGLTF_MODE_TRIANGLES ? 1 : 3);
    to.verticesRead += vertices;
    to.vertices += kept;
    to.indices += drawn;
    if (to.verticesRead > maxVerticesRead || to.vertices > freeVertices + to.bufferBytes / 4 ||
        to.indices > freeIndices + 3 * to.bufferBytes)
        to.file.fail(
            place, fmt::format("brings the meshes to {} vertices and {} indices, more than {} bytes of buffers can mean. Split the scene.",
                               to.vertices, to.indices, to.bufferBytes));
    to.sizes.vertexBytes += kept * vertexBytes(to.file, primitive);
    to.sizes.triangles += drawn / 3;
}

// What makes two meshes of the file one: the same numbers, drawn the same way with the same material.
std::string identityOf(const tinygltf::Mesh& mesh) {
    std::string all;
    for (const tinygltf::Primitive& p : mesh.primitives)
        all += fmt::format("{} {} {} {} {}\n", p.mode, p.indices, p.material, p.attributes, p.targets);
    return all;
}

} // namespace

void readMeshes(Conversion& to, const std::vector<size_t>& nodes) {
    struct Piece {
        int mesh;
        size_t primitive;
    };
    std::vector<Piece> pieces;
    const auto& meshes = to.file.model.meshes;
    std::map<std::string, int> known;
    to.sameAs.assign(meshes.size(), -1);
    for (const size_t node : nodes) {
        const int mesh = to.file.model.nodes[node].mesh;
        if (mesh < 0 || to.sameAs[size_t(mesh)] >= 0) continue;
        const auto [it, isNew] = known.try_emplace(identityOf(meshes[size_t(mesh)]), mesh);
        to.sameAs[size_t(mesh)] = it->second;
        if (!isNew) continue;
        const auto& primitives = meshes[size_t(mesh)].primitives;
        to.read[mesh].resize(primitives.size());
        for (size_t i = 0; i < primitives.size(); ++i) {
            if (!drawable(primitives[i])) continue;
            countElements(to, primitives[i], placeOf(size_t(mesh), i));
            pieces.push_back({mesh, i});
        }
    }
    for (const size_t node : nodes)
        if (mayDeform(to.file, node)) to.reused.insert(to.sameAs[size_t(to.file.model.nodes[node].mesh)]);
    if (to.options.admit) to.options.admit(to.sizes);
    inParallel(to.options.run, pieces.size(), [&](uint64_t i) {
        const auto [mesh, number] = pieces[i];
        to.read.find(mesh)->second[number] = readPrimitive(to.file, meshes[size_t(mesh)].primitives[number], placeOf(size_t(mesh), number));
    });
}

void nameLeftOut(const GltfFile& file, int mesh, const std::vector<ReadPrimitive>& read) {
    const tinygltf::Mesh& from = file.model.meshes[size_t(mesh)];
    size_t pointsOrLines = 0;
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        if (from.primitives[i].mode < TINYGLTF_MODE_TRIANGLES)
            ++pointsOrLines;
        else if (!drawable(from.primitives[i]))
            file.warn(fmt::format("{} has no POSITION and is not drawn.", placeOf(size_t(mesh), i)));
        for (const std::string& w : read[i].warnings) file.warn(w);
    }
    if (pointsOrLines)
        file.warn(fmt::format(
            "/meshes/{}{} has {} of points or lines, which {} not drawn.", mesh, from.name.empty() ? "" : " " + shown(from.name),
            pointsOrLines == 1 ? "a primitive" : fmt::format("{} primitives", pointsOrLines), pointsOrLines == 1 ? "is" : "are"));
}

int convertMesh(Conversion& to, int mesh) {
    mesh = to.sameAs[size_t(mesh)];
    int& converted = to.meshes[size_t(mesh)];
    if (converted >= 0) return converted;
    const GltfFile& file = to.file;
    const tinygltf::Mesh& from = file.model.meshes[size_t(mesh)];
    MeshDesc desc;
    desc.name = from.name;
    std::vector<GltfOrigin::Primitive> origin;
    std::vector<ReadPrimitive> read;
    if (to.reused.contains(mesh))
        read = to.read[mesh];
    else
        read = std::move(to.read[mesh]);
    nameLeftOut(file, mesh, read);
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = from.primitives[i];
        if (read[i].desc.indices.empty()) continue;
        if (primitive.material >= 0) read[i].desc.material = convertMaterial(to, primitive.material);
        desc.primitives.push_back(std::move(read[i].desc));
        origin.push_back({i, std::move(read[i].kept)});
    }
    to.scene.meshes.push_back(std::move(desc));
    to.origin.meshes.push_back(std::move(origin));
    return converted = int(to.scene.meshes.size()) - 1;
}

} // namespace chiaro::gltf
