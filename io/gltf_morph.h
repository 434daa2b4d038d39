// Inside the glTF reader: morph targets (glTF 2.0.1, 3.7.2.2) and their weights at a time.
#pragma once
#include "io/gltf_primitive.h"
#include <algorithm>

namespace chiaro::gltf {

inline constexpr size_t maxTargets = 16384; // of one mesh

// What a target adds to each vertex that was kept, at full weight. Empty: nothing.
struct MorphTarget {
    std::vector<Vec3> positions, normals, tangents;
    std::vector<Point2> uv[uvSets];
    std::vector<Vec4> colors;
    bool looks() const { // what stands still over the shutter
        return !colors.empty() || std::any_of(std::begin(uv), std::end(uv), [](const auto& set) { return !set.empty(); });
    }
};
// Those that are wanted, by number; all of them are checked.
std::vector<MorphTarget> readMorphTargets(Conversion&, const tinygltf::Primitive&, const ReadPrimitive&, const std::string& place,
                                          const std::vector<size_t>& wanted);

} // namespace chiaro::gltf
