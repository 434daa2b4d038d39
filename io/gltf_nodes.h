// Inside the glTF reader: nodes (io/gltf_graph.cpp: the graph, places and paths; io/gltf_nodes.cpp: what they carry).
#pragma once
#include "io/gltf_file.h"
#include "io/gltf_path.h"
#include <array>

namespace chiaro::gltf {

// Translation, rotation (x, y, z, w; isRotation()) and scale as one map.
Affine compose(const std::array<double, 3>& t, const std::array<double, 4>& quaternion, const std::array<double, 3>& s);
bool isRotation(const std::array<double, 4>& q); // that can be brought to unit length

template <size_t N, class Numbers> std::array<double, N> numbers(const Numbers& from, std::array<double, N> otherwise, size_t at = 0) {
    if (!from.empty())
        for (size_t i = 0; i < N; ++i) otherwise[i] = double(from[at + i]);
    return otherwise;
}

// The scene that is meant, by name or number; empty: the file's default, else its first one. Throws Exit::usage.
size_t sceneNumber(const GltfFile&, const std::string& wanted);
// What the node carries, into the description.
void convertNode(Conversion& to, size_t index, const Path& path);

} // namespace chiaro::gltf
