#include "io/gltf_morph.h"
#include "io/gltf_animation.h"
#include "io/gltf_deform.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::gltf {

size_t targetsOf(const GltfFile& file, int mesh) {
    size_t most = 0;
    if (mesh >= 0)
        for (const tinygltf::Primitive& p : file.model.meshes[size_t(mesh)].primitives) most = std::max(most, p.targets.size());
    return most;
}

bool mayDeform(const GltfFile& file, size_t node) {
    const tinygltf::Node& n = file.model.nodes[node];
    return n.mesh >= 0 && (n.skin >= 0 || targetsOf(file, n.mesh) > 0);
}

namespace {

// Of the node, else of the mesh, else zero.
std::vector<double> weightsAtRest(const GltfFile& file, size_t node, size_t targets) {
    const tinygltf::Node& n = file.model.nodes[node];
    const tinygltf::Mesh& mesh = file.model.meshes[size_t(n.mesh)];
    const auto checked = [&](const std::vector<double>& weights, const std::string& place) {
        if (weights.size() != targets)
            file.fail(place, fmt::format("has {} numbers, /meshes/{} has {} morph targets. Export the file again.", weights.size(), n.mesh,
                                         targets));
        return weights;
    };
    if (!mesh.weights.empty()) checked(mesh.weights, fmt::format("/meshes/{}/weights", n.mesh));
    if (!n.weights.empty()) return checked(n.weights, fmt::format("/nodes/{}/weights", node));
    return mesh.weights.empty() ? std::vector<double>(targets) : mesh.weights;
}

} // namespace

Deformation deformationOf(Conversion& to, size_t node) {
    const GltfFile& file = to.file;
    const tinygltf::Node& n = file.model.nodes[node];
    Deformation all;
    all.skin = n.skin;
    const size_t targets = targetsOf(file, n.mesh);
    if (targets == 0) return all;
    if (targets > maxTargets)
        file.fail(fmt::format("/meshes/{}", n.mesh),
                  fmt::format("has {} morph targets, more than {}. Split the mesh.", targets, maxTargets));
    const std::vector<double> atRest = weightsAtRest(file, node, targets);
    const Interval shutter = to.options.shutter;
    const bool moves = shutter.close > shutter.open && to.animations.morphs(node);
    const size_t samples = moves ? Path::samples : 1;
    to.verticesRead += targets * samples;
    std::vector<std::vector<double>> weights(samples, atRest);
    for (size_t i = 0; i < samples; ++i) {
        const double share = moves ? double(i) / double(samples - 1) : 0;
        const double length = double(shutter.close) - double(shutter.open);
        to.animations.apply(node, to.options.frameTime + double(shutter.open) + length * share, weights[i]);
    }
    for (size_t k = 0; k < targets; ++k)
        if (std::any_of(weights.begin(), weights.end(), [k](const auto& w) { return w[k] != 0; })) all.targets.push_back(k);
    for (const auto& w : weights) {
        std::vector<double> used;
        for (const size_t k : all.targets) used.push_back(w[k]);
        all.weights.push_back(std::move(used));
    }
    return all;
}

namespace {

std::vector<Vec3> deltas(const GltfFile& file, size_t accessor, const ReadPrimitive& read, const std::string& place) {
    std::vector<Vec3> all(file.accessors[accessor].count);
    readFloats(file, accessor, {reinterpret_cast<float*>(all.data()), all.size() * 3});
    std::vector<Vec3> kept;
    for (size_t v = 0; v < read.desc.positions.size(); ++v) {
        const size_t vertex = read.kept.empty() ? v : read.kept[v];
        if (!chiaro::finite(all[vertex]))
            file.fail(place, fmt::format("element {} is not finite. Mend the morph target and export it again.", vertex));
        kept.push_back(all[vertex]);
    }
    return kept;
}

} // namespace

std::vector<MorphTarget> readMorphTargets(Conversion& to, const tinygltf::Primitive& primitive, const ReadPrimitive& read,
                                          const std::string& place, const std::vector<size_t>& wanted) {
    const GltfFile& file = to.file;
    const size_t vertices = file.accessors[size_t(primitive.attributes.at("POSITION"))].count;
    std::vector<MorphTarget> all(wanted.size());
    for (size_t k = 0; k < primitive.targets.size(); ++k)
        for (const auto& [name, accessor] : primitive.targets[k]) {
            const std::string at = fmt::format("{}/targets/{}/{}", place, k, name);
            const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT";
            if (!known) {
                if (!name.starts_with("_")) file.warn(fmt::format("has morph targets that change {}, which is not applied.", shown(name)));
                continue;
            }
            const Accessor& a = file.accessors[size_t(accessor)];
            if (a.type != "VEC3") file.fail(at, fmt::format("has type {}, must be VEC3. Export the file again.", a.type));
            if (a.count != vertices)
                file.fail(at, fmt::format("has {} elements, POSITION has {}. Export the file again.", a.count, vertices));
            const auto used = std::find(wanted.begin(), wanted.end(), k);
            if (used == wanted.end() || (name == "NORMAL" && read.desc.normals.empty()) || (name == "TANGENT" && read.tangentSpace))
                continue;
            MorphTarget& target = all[size_t(used - wanted.begin())];
            (name == "POSITION" ? target.positions
             : name == "NORMAL" ? target.normals
                                : target.tangents) = deltas(file, size_t(accessor), read, at);
        }
    return all;
}

} // namespace chiaro::gltf
