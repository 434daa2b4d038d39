// Inside the glTF reader: whether the faces of a mesh agree on what is outside. Of a solid they must: light that meets the back of a face
// leaves the medium there, and where some faces are turned it is refracted, or thrown back, the wrong way.
#pragma once
#include "core/scene/desc.h"

namespace chiaro::gltf {

// Edges, between two triangles each, that join the front of one to the back of the other. Vertices in one place are one; edges of one
// triangle, or of more than two, say nothing.
std::size_t turnedEdges(const PrimitiveDesc&);

} // namespace chiaro::gltf
