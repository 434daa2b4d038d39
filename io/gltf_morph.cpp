#include "io/gltf_morph.h"
#include "io/gltf_animation.h"
#include "io/gltf_deform.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

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

// One delta for each vertex that was kept; numbers that the accessor does not have are 0.
template <class V> std::vector<V> deltas(const GltfFile& file, size_t accessor, const ReadPrimitive& read, const std::string& place) {
    static_assert(std::is_trivially_copyable_v<V> && sizeof(V) % sizeof(float) == 0);
    const size_t width = size_t(file.accessors[accessor].width);
    const std::vector<float> all = readFloats(file, accessor);
    std::vector<V> kept(read.desc.positions.size());
    for (size_t v = 0; v < kept.size(); ++v) {
        const size_t vertex = read.kept.empty() ? v : read.kept[v];
        const float* const from = &all[vertex * width];
        if (!std::all_of(from, from + width, [](float x) { return std::isfinite(x); }))
            file.fail(place, fmt::format("element {} is not finite. Mend the morph target and export it again.", vertex));
        std::copy_n(from, width, reinterpret_cast<float*>(&kept[v]));
    }
    return kept;
}

// The set of TEXCOORD_n; none for other names.
std::optional<size_t> uvSetOf(const std::string& name) {
    for (size_t set = 0; set < uvSets; ++set)
        if (name == fmt::format("TEXCOORD_{}", set)) return set;
    return {};
}

struct TargetAttribute {
    std::string name, place;
    size_t accessor = 0;
};
// Types, whether it is wanted or not.
void check(const GltfFile& file, const TargetAttribute& a, size_t vertices) {
    const Accessor& from = file.accessors[a.accessor];
    const bool uv = uvSetOf(a.name).has_value(), color = a.name == "COLOR_0";
    const bool fits = uv ? from.type == "VEC2" : from.type == "VEC3" || (color && from.type == "VEC4");
    if (!fits) file.fail(a.place, fmt::format("has type {}, must be {}. Export the file again.", from.type, uv ? "VEC2" : "VEC3"));
    if (from.count != vertices)
        file.fail(a.place, fmt::format("has {} elements, POSITION has {}. Export the file again.", from.count, vertices));
}

// What the primitive itself does not have cannot be changed; tangents that are made are made again.
void readInto(MorphTarget& target, const GltfFile& file, const TargetAttribute& a, const ReadPrimitive& read) {
    if (a.name == "POSITION") target.positions = deltas<Vec3>(file, a.accessor, read, a.place);
    if (a.name == "NORMAL" && !read.desc.normals.empty()) target.normals = deltas<Vec3>(file, a.accessor, read, a.place);
    if (a.name == "TANGENT" && !read.tangentSpace) target.tangents = deltas<Vec3>(file, a.accessor, read, a.place);
    if (a.name == "COLOR_0" && !read.desc.colors.empty()) target.colors = deltas<Vec4>(file, a.accessor, read, a.place);
    if (const auto set = uvSetOf(a.name); set && !read.desc.uv[*set].empty())
        target.uv[*set] = deltas<Point2>(file, a.accessor, read, a.place);
}

} // namespace

std::vector<MorphTarget> readMorphTargets(Conversion& to, const tinygltf::Primitive& primitive, const ReadPrimitive& read,
                                          const std::string& place, const std::vector<size_t>& wanted) {
    const GltfFile& file = to.file;
    const size_t vertices = file.accessors[size_t(primitive.attributes.at("POSITION"))].count;
    std::vector<MorphTarget> all(wanted.size());
    for (size_t k = 0; k < primitive.targets.size(); ++k)
        for (const auto& [name, accessor] : primitive.targets[k]) {
            const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "COLOR_0" || uvSetOf(name);
            if (!known) {
                if (!name.starts_with("_")) file.warn(fmt::format("has morph targets that change {}, which is not applied.", shown(name)));
                continue;
            }
            const TargetAttribute a{name, fmt::format("{}/targets/{}/{}", place, k, name), size_t(accessor)};
            check(file, a, vertices);
            if (const auto used = std::find(wanted.begin(), wanted.end(), k); used != wanted.end())
                readInto(all[size_t(used - wanted.begin())], file, a, read);
        }
    return all;
}

} // namespace chiaro::gltf
