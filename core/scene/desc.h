// SceneDesc: a scene as it was written down, before anything is built from it. Readers fill it, tests write it by hand, Scene::compile
// consumes it. Plain vectors and indexes; every default is that of glTF 2.0. Units: metres, radians, seconds; light in photometric units
// (point and spot candela, directional lux, emission cd/m2). World axes are glTF's: right-handed, +Y up, cameras and lights look along -Z.
#pragma once
#include "core/math/ray.h"
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

enum class PixelType : uint8_t { u8, u16, f32, f16 }; // f16: IEEE 754 binary16
// Pixels, row 0 at the top, channels interleaved (1 grey, 2 grey+alpha, 3 RGB, 4 RGBA), in the depth of the source.
struct ImageDesc {
    std::string name;
    int width = 0, height = 0, channels = 0;
    PixelType type = PixelType::u8;
    std::vector<std::byte> pixels;
};

enum class Wrap : uint8_t { repeat, mirror, clamp };
enum class TextureFilter : uint8_t { linear, nearest };
enum class Transfer : uint8_t { linear, srgb };
struct TextureDesc {
    int image = -1;
    Wrap wrapS = Wrap::repeat, wrapT = Wrap::repeat;
    TextureFilter filter = TextureFilter::linear;
};
// Where a material reads a texture: which one, by which UV set, under which affine map of (u, v, 1) (KHR_texture_transform).
struct TextureSlot {
    int texture = -1; // -1: none
    int uvSet = 0;
    float transform[2][3] = {{1, 0, 0}, {0, 1, 0}};
};

enum class AlphaMode : uint8_t { opaque, mask, blend };
struct MaterialDesc {
    std::string name;
    Spectrum baseColor{1};
    float alpha = 1;
    TextureSlot baseColorTexture; // sRGB, alpha linear
    float metallic = 1, roughness = 1;
    TextureSlot metallicRoughnessTexture; // linear: G roughness, B metallic
    TextureSlot normalTexture;            // linear
    float normalScale = 1;
    Spectrum emission{0};        // emissiveFactor x emissiveStrength, cd/m2
    TextureSlot emissionTexture; // sRGB
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    bool unlit = false;          // KHR_materials_unlit: shows its base colour as radiance from both sides and scatters nothing
    float ior = 1.5f;            // KHR_materials_ior; 0 is the extension's "infinite": Fresnel reflectance 1
    float specular = 1;          // KHR_materials_specular; 0 leaves an ideal diffuse base
    TextureSlot specularTexture; // linear, A
    Spectrum specularColor{1};
    TextureSlot specularColorTexture; // sRGB
    float transmission = 0;           // KHR_materials_transmission
    TextureSlot transmissionTexture;  // linear, R
    bool volume = false;              // KHR_materials_volume with thickness above 0: solid; otherwise transmission is a thin pane
    float attenuationDistance = std::numeric_limits<float>::infinity();
    Spectrum attenuationColor{1};
    float clearcoat = 0, clearcoatRoughness = 0; // KHR_materials_clearcoat
    TextureSlot clearcoatTexture;                // linear, R
    TextureSlot clearcoatRoughnessTexture;       // linear, G
    TextureSlot clearcoatNormalTexture;          // linear; none: the interpolated normal
    float clearcoatNormalScale = 1;
    Spectrum sheenColor{0}; // KHR_materials_sheen
    float sheenRoughness = 0;
    TextureSlot sheenColorTexture;                    // sRGB
    TextureSlot sheenRoughnessTexture;                // linear, A
    float anisotropy = 0, anisotropyRotation = 0;     // KHR_materials_anisotropy; radians counter-clockwise from the tangent
    TextureSlot anisotropyTexture;                    // linear: RG direction (2 c - 1), B strength
    float iridescence = 0, iridescenceIor = 1.3f;     // KHR_materials_iridescence
    float iridescenceMin = 100, iridescenceMax = 400; // thickness of the film, nanometres; without a texture it is the maximum
    TextureSlot iridescenceTexture;                   // linear, R
    TextureSlot iridescenceThicknessTexture;          // linear, G: from the minimum to the maximum
    float dispersion = 0;                             // KHR_materials_dispersion: 20 / Abbe number
    float diffuseTransmission = 0;                    // KHR_materials_diffuse_transmission
    Spectrum diffuseTransmissionColor{1};
    TextureSlot diffuseTransmissionTexture;      // linear, A
    TextureSlot diffuseTransmissionColorTexture; // sRGB
    // What rough facets send to each other leaves at last; false: single scattering alone, as glTF's appendix and other renderers have it.
    bool compensated = true;
    // KHR_materials_pbrSpecularGlossiness: baseColor is the diffuse colour, specularColor the reflectance at normal incidence; metallic,
    // roughness, ior and specular have no say.
    bool specularGlossiness = false;
    float glossiness = 1;                  // roughness = 1 - glossiness
    TextureSlot specularGlossinessTexture; // RGB sRGB: specularColor, A linear: glossiness
};

inline constexpr int uvSets = 4; // that a primitive can carry: TextureSlot::uvSet lies below
// The vertices of a primitive at another moment: as many positions, normals and tangents as it has itself.
struct ShapeDesc {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> tangents;
};
// One triangle list with one material. Attributes are empty or as long as positions.
struct PrimitiveDesc {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> tangents; // w: sign of the bitangent, cross(n, t) * w
    std::vector<Point2> uv[uvSets];
    std::vector<Vec4> colors;      // linear, multiplies the base colour and alpha
    std::vector<uint32_t> indices; // three a triangle, counter-clockwise seen from the front
    int material = -1;             // -1: glTF's default material
    // Of what changes its shape while the shutter is open: how it is at equal steps of time, after its shape at the opening, which stands
    // above; the last at the closing. Between two steps everything goes linearly. Empty: it keeps its shape. 128 steps at most.
    std::vector<ShapeDesc> steps = {};
};
struct MeshDesc {
    std::string name;
    std::vector<PrimitiveDesc> primitives;
};
// Where a thing is while the shutter is open: its maps to the world at equal steps of time, the first at the opening, the last at the
// closing. Fewer than two: it rests. Between steps translation and stretch go linearly, rotation along the great arc (core/scene/motion.h).
using MotionDesc = std::vector<Affine>;
struct InstanceDesc {
    int mesh = -1;
    Affine toWorld; // of a moving one: at the opening of the shutter
    std::string name;
    MotionDesc motion = {};
};

enum class Projection : uint8_t { perspective, orthographic };
// A thin lens: everything on the plane at `focus` metres along the viewing axis is sharp. Its opening is a disc, or a regular polygon.
struct LensDesc {
    double radius = 0;   // metres; 0: a pinhole
    double focus = 1;    // metres
    int blades = 0;      // corners of the polygon; below 3: a disc
    double rotation = 0; // of the polygon, radians counter-clockwise seen from the scene
};
struct CameraDesc {
    std::string name;
    Projection projection = Projection::perspective;
    double yfov = 0.8;         // full vertical angle
    double aspect = 0;         // width / height; 0: that of the picture
    double xmag = 1, ymag = 1; // half extents of an orthographic view
    Affine toWorld;
    MotionDesc motion = {};
    LensDesc lens = {};
};

enum class PunctualKind : uint8_t { point, spot, directional };
struct PunctualDesc {
    std::string name;
    PunctualKind kind = PunctualKind::point;
    Spectrum intensity{1}; // colour x intensity: candela, or lux when directional
    double range = 0;      // KHR_lights_punctual cut-off in metres; 0: none
    double innerCone = 0, outerCone = 0.7853981633974483;
    Affine toWorld; // scale does not change the light
    MotionDesc motion = {};
};

struct EnvironmentDesc {
    ImageDesc image;                              // f32, 3 channels, latitude-longitude radiance; one texel is a uniform sky
    TextureFilter filter = TextureFilter::linear; // nearest: every texel is a patch of constant radiance
    float rotate = 0;                             // about +Y, radians, counter-clockwise seen from above
    float scale = 1;
};

struct SceneDesc {
    std::string name;
    std::vector<ImageDesc> images;
    std::vector<TextureDesc> textures;
    std::vector<MaterialDesc> materials;
    std::vector<MeshDesc> meshes;
    std::vector<InstanceDesc> instances;
    std::vector<CameraDesc> cameras;
    std::vector<PunctualDesc> lights;
    std::optional<EnvironmentDesc> environment;
    Interval shutter; // what the motions cover, seconds; rays carry times within it
};

} // namespace chiaro
