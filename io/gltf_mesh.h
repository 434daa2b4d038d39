// Inside the glTF reader: meshes, all primitives read side by side before any is converted.
#pragma once
#include "io/gltf_primitive.h"

namespace chiaro::gltf {

std::string placeOf(size_t mesh, size_t primitive); // "/meshes/0/primitives/1"
// Says what of a mesh is not drawn, and what was found while it was read.
void nameLeftOut(const GltfFile&, int mesh, const std::vector<ReadPrimitive>&);

} // namespace chiaro::gltf
