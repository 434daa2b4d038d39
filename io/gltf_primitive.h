// Inside the glTF reader: one primitive of a mesh out of its accessors. It touches nothing but what it returns, so that many are read at
// the same time.
#pragma once
#include "io/gltf_file.h"

namespace chiaro::gltf {

// A list, strip or fan of triangles with positions; without indices in the result there is nothing to draw. place:
// "/meshes/0/primitives/1".
ReadPrimitive readPrimitive(const GltfFile&, const tinygltf::Primitive&, const std::string& place);

// Bytes of a vertex of it in memory.
size_t vertexBytes(const GltfFile&, const tinygltf::Primitive&);

} // namespace chiaro::gltf
