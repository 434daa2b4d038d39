// The meshes that carry the light: for a light map, vertices that lie in two charts are two; per vertex, edges that are too long are halved
// until they are not, the same on both sides of an edge (no T-junctions within a primitive).
#pragma once
#include "io/gltf_write.h"
#include "tools/bake/sites.h"

namespace chiaro::bake {

// Which of a description's nodes turn their meshes inside out: their triangles are stored the other way round in a compiled scene.
using Mirrored = std::vector<bool>; // of each instance of the description
Mirrored mirroredInstances(const SceneDesc&);

// One part as it is written, without its light.
BakedPart mappedMesh(const Scene&, const PartLayout&, uint32_t mapSize, const Mirrored&);

struct VertexMesh {
    std::vector<BakedPart> parts;
    std::vector<uint32_t> first; // of each part: its first vertex among all, and the end
    // Sites of all vertices, in this order.
    std::vector<uint32_t> begin;
    std::vector<VertexCorner> corners;
};
// longest: of an edge, metres; 0: as they are. most: vertices, else Error(Exit::resources).
VertexMesh vertexMesh(const Scene&, std::span<const uint32_t> parts, double longest, float time, const Mirrored&, std::size_t most);

} // namespace chiaro::bake
