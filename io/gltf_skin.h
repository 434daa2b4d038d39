// Inside the glTF reader: skins (glTF 2.0.1, 3.7.3). A vertex goes where the weighted mean of its joints' maps takes it (linear blend
// skinning); where the node with the mesh stands has no say, nor has the skin's "skeleton".
#pragma once
#include "io/gltf_path.h"
#include "io/gltf_primitive.h"
#include <map>

namespace chiaro::gltf {

inline constexpr size_t maxJoints = 16384, maxInfluences = 32; // of one skin, and those that move in the scene; of one vertex

// The joints of a skin. Throws Error for a skin that is none.
std::vector<size_t> jointsOf(const GltfFile&, size_t skin);
// By joint: from the bind pose to the world, moved by -anchor. paths: of the joints, in the world.
std::vector<Path> skinMaps(const GltfFile&, size_t skin, const std::map<size_t, Path>& paths, const Vec3d& anchor);

// Which joints pull at each vertex, and how strongly: `each` of them, weights that sum to 1. each 0: the primitive has no joints.
struct Influences {
    size_t each = 0;
    std::vector<uint32_t> joints;
    std::vector<float> weights;
};
// Of the vertices that were kept, under a skin with so many joints.
Influences readInfluences(const GltfFile&, const tinygltf::Primitive&, const ReadPrimitive&, const std::string& place, size_t joints);

} // namespace chiaro::gltf
