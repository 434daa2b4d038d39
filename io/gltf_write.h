// Writes light back into a glTF scene: a copy of a file in which chosen surfaces carry what was computed for them, per vertex or as
// coordinates of a light map. Everything else that the file says stays as it is written there: nodes, names, extras, cameras, lights,
// animations, extensions. A mesh that is drawn more than once gets a copy for each place, since light differs from place to place;
// instances of EXT_mesh_gpu_instancing become nodes. Buffers and pictures that lay outside come along, so that the result is one file
// (.glb) or two
// (.gltf and its .bin). A description that has no file is written as one first.
// Source: Khronos glTF 2.0.1 (2021), KHR_materials_unlit, KHR_materials_variants; MOZ_lightmap as Hubs and glTF Transform write it.
#pragma once
#include "io/gltf.h"
#include "io/picture.h"
#include <array>
#include <memory>

namespace chiaro {

// A vertex to be written, made from up to three of the description's: attributes are interpolated, directions made unit length again.
struct BakedVertex {
    std::array<uint32_t, 3> from{};
    std::array<float, 3> weight{1, 0, 0};
};
// How a baked surface shows its light without help.
enum class BakedLook : uint8_t {
    lit,    // unlit: the light map is the picture; what the material was stays in the file as a variant
    tinted, // unlit: base colour x COLOR_0
    shining // unlit: COLOR_0 alone
};
struct BakedPart {
    uint32_t instance = 0, primitive = 0; // of the description
    std::optional<BakedLook> look;        // none: the material stays
    std::vector<BakedVertex> vertices;    // the first ones may be the description's own, in their order
    std::vector<uint32_t> indices;        // three a triangle
    std::vector<Point2> uv;               // of the light map; empty: none is written
    int uvSet = 0;                        // with empty uv: the set of the file that leads to the light map
    std::vector<Vec4> colors;             // COLOR_0, [0, 1], in place of the file's; empty: none, with look the file's is put aside
    std::vector<Spectrum> irradiance;     // _IRRADIANCE, lux; empty: none
};
struct BakedScene {
    std::string generator;
    std::vector<BakedPart> parts;
    std::vector<std::byte> lightMap; // a PNG, sRGB; empty: none
    bool mapAlpha = false;           // it holds opacity too
    Metadata notes;                  // into asset.extras.chiaro
};

class GltfDocument {
public:
    // The file again that readGltf() has read: what it found there says where things are. Pictures that cannot be found stay named.
    static GltfDocument read(const std::filesystem::path&, GltfOrigin, Diagnostics&);
    // Of a description without a file. Environments are not written: glTF has no place for them.
    static GltfDocument describe(const SceneDesc&);
    GltfDocument(GltfDocument&&) noexcept;
    ~GltfDocument();

    // What keeps the light of an instance's primitive from being written: "skins", "morph targets"; empty: nothing.
    std::string obstacle(uint32_t instance, uint32_t primitive) const;
    bool animated(uint32_t instance) const; // its node, or one above it, moves in an animation of the file
    std::size_t materials() const;          // baked surfaces without a look keep these

    void apply(const BakedScene&);
    // .glb, or .gltf with a .bin of the same name beside it. Throws as io/replace_file.h does, Error(Exit::resources) beyond 4 GB.
    void write(const std::filesystem::path&) const;

    struct Content; // io/gltf_write_content.h

private:
    explicit GltfDocument(std::unique_ptr<Content>);
    std::unique_ptr<Content> content_;
};

} // namespace chiaro
