// Writes lines and clouds of points as binary glTF 2.0 that any viewer shows: ray trees and paths, photon maps. One buffer, positions and
// colours as float32, materials that need no light (KHR_materials_unlit), so that a ray has the colour it was given. Lengths in metres,
// colours linear, axes those of glTF.
// Source: Khronos glTF 2.0.1 (2021), sections 3.7 (geometry) and 4.4 (GLB layout); KHR_materials_unlit.
#pragma once
#include "core/math/vec.h"
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace chiaro {

enum class GlbMode : uint8_t { points = 0, lines = 1, lineStrip = 3 }; // the numbers are glTF's
// One primitive. Lines take their vertices in pairs.
struct GlbShape {
    GlbMode mode = GlbMode::lines;
    std::vector<Vec3> positions;
    std::vector<Spectrum> colors; // linear, [0, 1]; as many as positions
};
struct GlbNode {
    std::string name;
    int parent = -1; // a node before this one; -1: a root
    Vec3d translation;
    std::vector<GlbShape> shapes;                           // those without vertices are left out
    std::vector<std::pair<std::string, std::string>> notes; // for who reads the file: "extras" of the node
};
struct GlbScene {
    std::string name, generator;
    std::vector<GlbNode> nodes;
};

// JSON and binary chunk as one .glb, both padded to four bytes. Throws Error(Exit::resources) beyond the 4 GB that it can hold.
std::vector<std::byte> glbContainer(std::string json, std::span<const std::byte> binary);
// The bytes of the file; equal scenes give equal bytes. Names may hold anything: what is not UTF-8 is replaced. Throws
// Error(Exit::internal) for shapes that are none (an odd number of line ends, a position that is not finite), Error(Exit::resources) beyond
// the 4 GB that a GLB can hold.
std::vector<std::byte> glbBytes(const GlbScene&);
// Replaces the file whole; throws as io/replace_file.h does.
void writeGlb(const std::filesystem::path&, const GlbScene&);

} // namespace chiaro
