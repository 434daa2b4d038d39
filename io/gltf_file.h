// Inside the glTF reader: a file taken apart and checked. What is in a GltfFile can be used without further thought about ranges: every
// index points to something, every accessor lies inside its buffer, the node graph is a forest. Steps, each in a file of its own:
// gltf_container (bytes -> JSON + binary chunk), gltf_schema (types, numbers, references), gltf_uri + gltf_buffers (bytes of the buffers),
// gltf_compressed (what is packed becomes plain),
// gltf_accessor (ranges, then values), gltf_animation (channels), gltf_nodes (graph, placement), gltf_path (motion), gltf_mesh,
// gltf_primitive, gltf_material, gltf_images (conversion), gltf_inventory (what people are told), gltf (the order).
#pragma once
#include "io/file_bytes.h"
#include "io/gltf.h"
#include "io/gltf_path.h"
#include "io/tangent_space.h"
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tiny_gltf.h>
#include <vector>

namespace chiaro::gltf {

using Bytes = std::span<const std::byte>;

// Sums over a whole file above which it is refused: a small hostile file must not ask for all memory or time. What meshes keep may grow
// with the bytes of the buffers (primitives that share one vertex buffer keep the part that they use).
inline constexpr uint64_t maxJsonBytes = uint64_t(1) << 30;
inline constexpr uint64_t maxVerticesRead = uint64_t(1) << 30, freeVertices = uint64_t(1) << 24, freeIndices = uint64_t(1) << 26;
inline constexpr uint64_t maxInstances = 10'000'000, maxImageBytes = uint64_t(1) << 33;
inline constexpr int maxJsonDepth = 100, maxNodeDepth = 1000;

// A block of numbers in a buffer, as stored. Bytes are copied out one element at a time, so alignment does not matter here.
struct Accessor {
    int component = 0; // glTF's componentType: 5120 i8, 5121 u8, 5122 i16, 5123 u16, 5125 u32, 5126 f32
    int width = 1;     // numbers an element
    std::string type;
    bool normalized = false;
    size_t count = 0, stride = 0;
    Bytes data; // from the first element on; empty: all zeros
    struct {
        size_t count = 0;
        int component = 0;
        Bytes indices, values;
    } sparse;
};

struct GltfFile {
    std::filesystem::path path;
    std::string name; // the path as the user wrote it
    Diagnostics* notes = nullptr;
    const Executor* run = nullptr;
    std::function<void(const SceneSizes&)> admission = {}; // GltfOptions::admit
    std::vector<std::byte> content;                        // the whole file
    Bytes binary;                                          // the BIN chunk of a .glb
    bool hasBinary = false;
    nlohmann::json json;
    std::vector<std::vector<std::byte>> loaded; // buffers that are not the BIN chunk
    std::vector<Bytes> buffers;
    std::vector<Accessor> accessors;
    tinygltf::Model model; // nodes and meshes of the same JSON: tinygltf touches no file and no pixel

    // Throws Error(Exit::file): "name: place problem". `what` holds problem and fix.
    [[noreturn]] void fail(const std::string& place, const std::string& what) const;
    void warn(const std::string& what) const;
    void admit(uint64_t more) const; // bytes, beside those of the files; may throw
};

// container
void openContainer(GltfFile& file); // fills content, binary, json
// schema
void checkSchema(GltfFile& file); // JSON types, numbers, every reference
// extensions
void checkVersion(const GltfFile& file); // Exit::unsupported unless glTF 2.0
std::vector<GltfInventory::Extension> extensionsOf(const GltfFile& file);
void checkExtensions(const GltfFile& file); // Exit::unsupported for required ones; one warning each for those not applied
// uri
std::optional<std::vector<std::byte>> decodeDataUri(std::string_view uri); // empty: malformed
bool isDataUri(std::string_view uri);
// The file that a relative URI names, inside the scene's folder; empty when there is none. Leaving the folder is an Error.
std::filesystem::path resolveUri(const GltfFile& file, const std::string& place, const std::string& uri);
// buffers
const nlohmann::json& list(const GltfFile& file, const char* name); // a top-level array, or an empty one
void loadBuffers(GltfFile& file);                                   // unpacked (io/gltf_compressed.h)
Bytes bufferView(const GltfFile& file, size_t view);                // checked
// accessor
void checkAccessors(GltfFile& file);                                  // fills accessors
std::vector<float> readFloats(const GltfFile& file, size_t accessor); // count x width; normalized integers mapped as glTF 3.6.2.2 says
void readFloats(const GltfFile& file, size_t accessor, std::span<float> out);
std::vector<uint32_t> readIndices(const GltfFile& file, size_t accessor);
// nodes
struct ReadPrimitive;                  // io/gltf_primitive.h
void checkNodes(const GltfFile& file); // cycles, two parents, depth, matrices
class Animations;                      // io/gltf_animation.h
// A primitive out of its accessors (io/gltf_primitive.h).
struct ReadPrimitive {
    PrimitiveDesc desc;                // without its material
    std::vector<uint32_t> kept;        // numbers in the file of the vertices that were kept; empty: all
    std::vector<std::string> warnings; // for GltfFile::warn
    // Of tangents that were made here, to make them again for another shape: how corners share them, and which of them each vertex has.
    std::shared_ptr<const TangentSpace> tangentSpace;
    std::vector<uint32_t> tangentGroup;
};
// What conversion has built so far: glTF index -> index in the description, -1 not yet used.
struct Conversion {
    const GltfFile& file;
    const GltfOptions& options;
    const Animations& animations;
    SceneDesc& scene;
    std::vector<int> meshes, materials, textures, images;
    std::vector<double> radii; // of the description's meshes about their origins; -1: not yet known
    GltfOrigin origin = {};
    bool uneven = false; // a path was too wild for the steps that there are
    uint64_t bufferBytes = 0, verticesRead = 0, vertices = 0, indices = 0;
    SceneSizes sizes = {};
    std::vector<int> sameAs = {};                        // of each mesh: the first that is the same
    std::map<int, std::vector<ReadPrimitive>> read = {}; // meshes whose primitives wait to be converted
    std::set<int> reused = {};                           // of these: those that nodes deform, each in its own way
    std::map<size_t, Path> joints = {};                  // the ways of all joints through the world
    uint64_t shapeVertices = 0;                          // that skins and morph targets have made
    std::vector<GltfInventory::Picture> pictures = {};   // of the description's images
    std::vector<size_t> imagesUsed = {};                 // of the file, in the order of the description
};
void convertNodes(Conversion& to); // after readMeshes; pictures are noted, not yet read
// The primitives of all meshes that these nodes show, side by side.
void readMeshes(Conversion& to, const std::vector<size_t>& nodes);
int convertMesh(Conversion& to, int mesh);
int convertMaterial(Conversion& to, int material);
int convertImage(Conversion& to, int image);
void measureImages(Conversion& to); // by their headers
void decodeImages(Conversion& to);  // those that were noted, side by side
// inventory
void takeInventory(const Conversion& to, GltfInventory& into); // all but extensions and pictures

} // namespace chiaro::gltf
