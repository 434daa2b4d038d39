// Inside the glTF reader: what a material asks of the vertices that it is on, by the JSON of the file alone, so that primitives can be read
// before any material is converted.
#pragma once
#include "core/scene/desc.h"
#include "io/gltf_file.h"
#include <array>
#include <optional>

namespace chiaro::gltf {

struct VertexNeeds {
    std::array<bool, uvSets> uv{}; // sets that some texture reads
    std::optional<int> frame;      // tangents, along this UV set: of a normal map, of a coat's normal map, of anisotropy
    bool solid = false;            // faces that agree on what is outside
};
// material: -1: none.
VertexNeeds needsOf(const GltfFile&, int material);

} // namespace chiaro::gltf
