// Inside the glTF reader: meshes that change their shape, by morph targets (glTF 2.0.1, 3.7.2.2) and then by a skin (io/gltf_skin.h). At
// each node they are a mesh of their own, in the shape of the moment, and over an open shutter in as many shapes as follow its way closely.
#pragma once
#include "io/gltf_path.h"
#include "io/gltf_primitive.h"

namespace chiaro::gltf {

// What a node does to the shape of its mesh.
struct Deformation {
    int skin = -1;
    std::vector<size_t> targets;              // that have a weight at some time of the shutter
    std::vector<std::vector<double>> weights; // of these, at Path::samples times of the shutter, or once: they rest
    explicit operator bool() const { return skin >= 0 || !targets.empty(); }
};
Deformation deformationOf(Conversion&, size_t node);

// Whether some time may come at which deformationOf() says something.
bool mayDeform(const GltfFile&, size_t node);

struct DeformedMesh {
    int mesh = -1; // of the description; -1: nothing to draw
    Affine place;  // of a skinned mesh: in the world, whatever its node says
};
// path: of the node. The ways of all joints must be known.
DeformedMesh convertDeformed(Conversion&, size_t node, const Deformation&, const Path& path);

} // namespace chiaro::gltf
