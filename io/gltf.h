// Reads a glTF 2.0 scene (.gltf with external or data: URIs, .glb) into a SceneDesc. A file comes from anywhere: everything that it says is
// checked before it is used, and whatever is understood but not applied, or not understood at all, is named in one warning.
// Source: Khronos glTF 2.0.1 (2021) and its registry of extensions; which of them are applied, and how: docs/gltf.md, and the table of
// io/gltf_extensions.cpp.
#pragma once
#include "core/render/error.h"
#include "core/scene/desc.h"
#include "core/scene/scene_bytes.h"
#include "io/gltf_inventory.h"
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace chiaro {

class Executor;

enum class MissingTexture { error, grey };
struct GltfOptions {
    MissingTexture missingTexture =
        MissingTexture::error;     // grey: an absent or undecodable picture becomes one mid-grey texel, with a warning
    double frameTime = 0;          // of the animation, seconds
    Interval shutter = {};         // relative to it; an instant: nothing moves, everything stands where it is at the opening
    std::string animation = {};    // its name or number, "all" together (the first that names a target counts), "none"; empty: the first
    std::string scene = {};        // its name or number; empty: the file's default scene, else its first one
    const Executor* run = nullptr; // meshes and pictures are read on its threads; the description is the same without
    // Told what the scene will take: the file before it is read, the meshes before any of them is, then all with pictures, lights and
    // instances before any picture is decoded. May throw.
    std::function<void(const SceneSizes&)> admit = {};
};

// What people are told about an animation.
struct AnimationInfo {
    std::string name;
    double seconds = 0;                     // of its last key
    std::map<std::string, size_t> channels; // how many, by what they animate
    bool used = false;
};
// Where in the file the parts of the description come from: for those who write into a copy of it (io/gltf_write.h).
struct GltfOrigin {
    struct Instance {
        std::size_t node = 0;
        int element = -1; // of EXT_mesh_gpu_instancing
        int mesh = -1;    // of the description
    };
    struct Primitive {
        std::size_t number = 0;         // among the primitives of its mesh in the file
        std::vector<uint32_t> vertices; // numbers there of the vertices that were kept; empty: all, in their order
    };
    std::vector<Instance> instances;
    std::vector<std::vector<Primitive>> meshes;
};
struct GltfContents {
    std::vector<AnimationInfo> animations;
    std::vector<std::string> scenes; // their names
    std::size_t scene = 0;           // the one that was read
    GltfOrigin origin;
    GltfInventory inventory;
};

// The default scene of the file (else its first one, else all root nodes). Instances, cameras and lights come in the order of the node
// traversal, so the first camera is the one that is meant. Units, axes and light conventions are those of core/scene/desc.h. Animated nodes
// stand where they are at options.frameTime, skinned and morphed meshes have their shape of then, one mesh a node; over an open shutter
// what moves gets as many steps of motion, and what deforms as many shapes, as follow its way closely. found: filled with what the scene
// does not hold. Throws Error: Exit::file for a missing, unreadable or malformed file, Exit::unsupported for a required extension that
// cannot be honoured, Exit::usage for an animation that is not there.
SceneDesc readGltf(const std::filesystem::path& file, const GltfOptions& options, Diagnostics& notes, GltfContents* found = nullptr);

} // namespace chiaro
