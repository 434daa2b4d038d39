#include "io/gltf_skin.h"
#include <cmath>
#include <fmt/format.h>

namespace chiaro::gltf {

using nlohmann::json;

std::vector<size_t> jointsOf(const GltfFile& file, size_t skin) {
    const json& joints = list(file, "skins")[skin]["joints"];
    const std::string place = fmt::format("/skins/{}/joints", skin);
    if (joints.empty()) file.fail(place, "is empty: a skin needs one joint or more. Export the file again.");
    if (joints.size() > maxJoints) file.fail(place, fmt::format("has {} joints, more than {}. Split the skin.", joints.size(), maxJoints));
    std::vector<size_t> all;
    for (const json& joint : joints) all.push_back(joint);
    return all;
}

namespace {

std::vector<Affine> inverseBinds(const GltfFile& file, size_t skin, size_t joints) {
    const json& from = list(file, "skins")[skin];
    std::vector<Affine> all(joints); // absent: identity
    if (!from.contains("inverseBindMatrices")) return all;
    const size_t accessor = from["inverseBindMatrices"];
    const std::string place = fmt::format("/skins/{}/inverseBindMatrices", skin);
    const Accessor& a = file.accessors[accessor];
    if (a.type != "MAT4" || a.component != 5126)
        file.fail(place, fmt::format("has type {} of component {}, must be MAT4 of floats. Export the file again.", a.type, a.component));
    if (a.count < joints) file.fail(place, fmt::format("has {} matrices, the skin has {} joints. Export the file again.", a.count, joints));
    const std::vector<float> numbers = readFloats(file, accessor);
    for (size_t j = 0; j < joints; ++j) {
        const float* m = &numbers[j * 16]; // column-major
        for (size_t k = 0; k < 16; ++k)
            if (!(std::abs(m[k]) <= 1e18f))
                file.fail(place, fmt::format("number {} of matrix {} is {}. Export the file again.", k, j, m[k]));
        if (std::abs(m[3]) > 1e-4f || std::abs(m[7]) > 1e-4f || std::abs(m[11]) > 1e-4f || std::abs(m[15] - 1) > 1e-4f)
            file.fail(place, fmt::format("matrix {} is not affine: its last row must be 0 0 0 1. Export the file again.", j));
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column) all[j].m[row][column] = double(m[column * 4 + row]);
    }
    return all;
}

} // namespace

std::vector<Path> skinMaps(const GltfFile& file, size_t skin, const std::map<size_t, Path>& paths, const Vec3d& anchor) {
    const std::vector<size_t> joints = jointsOf(file, skin);
    const std::vector<Affine> inverse = inverseBinds(file, skin, joints.size());
    std::vector<Path> maps;
    for (size_t j = 0; j < joints.size(); ++j)
        maps.push_back(paths.at(joints[j]).each([&](Affine m) {
            m.m[0][3] -= anchor.x, m.m[1][3] -= anchor.y, m.m[2][3] -= anchor.z;
            return m * inverse[j];
        }));
    return maps;
}

namespace {

// The accessor of JOINTS_n or WEIGHTS_n.
size_t accessorOf(const GltfFile& file, const tinygltf::Primitive& primitive, const std::string& place, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end())
        file.fail(place + "/attributes", fmt::format("has no {}: JOINTS and WEIGHTS come in pairs. Export the file again.", name));
    const Accessor& a = file.accessors[size_t(found->second)];
    const size_t vertices = file.accessors[size_t(primitive.attributes.at("POSITION"))].count;
    const bool joints = name.starts_with("J"), fits = a.component == 5121 || a.component == 5123 || (!joints && a.component == 5126);
    if (a.type != "VEC4" || !fits)
        file.fail(fmt::format("{}/attributes/{}", place, name),
                  fmt::format("has type {} of component {}, must be VEC4 of 5121{} 5123{}. Export the file again.", a.type, a.component,
                              joints ? " or" : ",", joints ? "" : " or 5126"));
    if (a.count != vertices)
        file.fail(fmt::format("{}/attributes/{}", place, name),
                  fmt::format("has {} elements, POSITION has {}. Export the file again.", a.count, vertices));
    return size_t(found->second);
}

// Weights that sum to 1; how many vertices had none, for which their first joint speaks alone.
size_t normalise(Influences& all) {
    size_t without = 0;
    for (size_t v = 0; v < all.weights.size(); v += all.each) {
        double sum = 0;
        for (size_t k = 0; k < all.each; ++k) sum += double(all.weights[v + k]);
        for (size_t k = 0; k < all.each && sum > 0; ++k) all.weights[v + k] = float(double(all.weights[v + k]) / sum);
        if (sum > 0) continue;
        all.weights[v] = 1;
        ++without;
    }
    return without;
}

} // namespace

Influences readInfluences(const GltfFile& file, const tinygltf::Primitive& primitive, const ReadPrimitive& read, const std::string& place,
                          size_t joints) {
    const auto has = [&](const std::string& name) { return primitive.attributes.contains(name); };
    size_t sets = 0;
    while (has(fmt::format("JOINTS_{}", sets)) || has(fmt::format("WEIGHTS_{}", sets))) ++sets;
    if (4 * sets > maxInfluences)
        file.fail(place,
                  fmt::format("has {} joints a vertex, more than {}. Reduce the influences and export it again.", 4 * sets, maxInfluences));
    Influences all;
    all.each = 4 * sets;
    const size_t vertices = read.desc.positions.size();
    all.joints.resize(vertices * all.each);
    all.weights.resize(vertices * all.each);
    for (size_t set = 0; set < sets; ++set) {
        const std::string jointsName = fmt::format("JOINTS_{}", set), weightsName = fmt::format("WEIGHTS_{}", set);
        const std::vector<float> numbers = readFloats(file, accessorOf(file, primitive, place, jointsName)),
                                 weights = readFloats(file, accessorOf(file, primitive, place, weightsName));
        for (size_t v = 0; v < vertices; ++v)
            for (size_t k = 0; k < 4; ++k) {
                const size_t vertex = read.kept.empty() ? v : read.kept[v], from = vertex * 4 + k, to = v * all.each + set * 4 + k;
                const float weight = weights[from], joint = numbers[from];
                if (!(weight >= 0) || std::isinf(weight))
                    file.fail(
                        fmt::format("{}/attributes/{}", place, weightsName),
                        fmt::format("vertex {} has weight {}, must be from 0 on. Mend the skin and export it again.", vertex, weight));
                if (weight > 0 && !(joint < float(joints)))
                    file.fail(fmt::format("{}/attributes/{}", place, jointsName),
                              fmt::format("vertex {} names joint {} of {}. Export the file again.", vertex, joint, joints));
                all.weights[to] = weight;
                all.joints[to] = joint < float(joints) ? uint32_t(joint) : 0u;
            }
    }
    if (const size_t without = sets ? normalise(all) : 0)
        file.warn(fmt::format("{} has {} vertices whose joints have no weight; they follow their first joint.", place, without));
    return all;
}

} // namespace chiaro::gltf
