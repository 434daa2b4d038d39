// Scene: what every integrator asks its questions of. Compiled once from a SceneDesc, immutable ever after, shared by all threads.
// Space: world axes of glTF, recentred: the middle of the bounds is the origin, so that a scene far from its own origin keeps its digits.
// Queries carry a time. Directions are unit vectors, distances metres.
#pragma once
#include "core/math/ray.h"
#include "core/scene/desc.h"
#include "core/scene/lights.h"
#include "core/scene/motion.h"
#include "core/scene/scene_bytes.h"
#include "core/scene/texture.h"
#include <array>
#include <memory>
#include <span>

namespace chiaro {

class Accel;
class Diagnostics;
class Executor;
struct ConeSection;
struct FlatTriangle;
struct HitPacket;
struct RayPacket;
struct Geometry;
struct Instance;

// The interpolated hit. ng is the geometric normal of the front side, whatever side was hit; ns the interpolated (not yet normal-mapped)
// shading normal, on the side of ng.
struct SurfacePoint {
    Vec3 p, ng, ns;
    Vec3 tangent;          // of the file, orthogonal to ns, or zero where there is none: then dpdu speaks
    float tangentSign = 1; // bitangent = cross(ns, tangent) * sign
    Vec3 dpdu, dpdv;       // by UV set 0 of the normal map's slot; zero without UVs
    Point2 uv[uvSets];
    Vec4 color{1, 1, 1, 1}; // vertex colour, linear
    uint32_t material = 0;
    uint32_t light = Lights::none;                                     // the emissive triangle this is
    uint32_t geometry = Hit::none, triangle = 0, instance = Hit::none; // as in Hit; none: not a point of a triangle
    float error = 0; // bound of the position's rounding error, metres, in every coordinate
    float time = 0;

    // A ray that leaves into the half space of wi, from beyond the error bound: it cannot meet its own surface again.
    Ray towards(const Vec3& wi) const noexcept;
    // The open segment to another point, both ends moved off their surfaces.
    Ray to(const SurfacePoint& other) const noexcept;
    // The origin moved along the side of ng that w points to.
    Vec3 offset(const Vec3& w) const noexcept;
};

// A triangle list as it is drawn: once for each node that draws its mesh. Its triangle i is hit as Hit{geometry, i, instance}.
struct DrawnPart {
    uint32_t geometry = 0, instance = Hit::none;
    uint32_t triangles = 0, material = 0;
    uint32_t node = 0, primitive = 0; // of the description: instances[node], primitives[primitive] of its mesh
};

struct SceneCounts {
    uint64_t triangles = 0, trianglesDrawn = 0, instances = 0, emissiveTriangles = 0, punctualLights = 0, emissiveMeshes = 0;
    SceneBytes bytes;
};

// What a library above makes of a scene, a pure function of it, to be read at every hit: it lives with the scene.
class SceneTable {
public:
    virtual ~SceneTable() = default;
    virtual std::size_t bytes() const noexcept = 0;
};

class Scene {
public:
    using MakeTable = std::unique_ptr<const SceneTable> (*)(const Scene&);
    // Throws Error (Exit::unsupported, Exit::resources). isa names Embree's instruction set ("sse2", "sse4.2", "avx", "avx2", "avx512"),
    // empty: the best. run: builds on its threads, null: on this one; the scene is the same to the last bit. makeTable is called last;
    // whoever will shade gives ClosureTable::make (materials/closure_table.h).
    static std::unique_ptr<const Scene> compile(SceneDesc, Diagnostics&, const std::string& isa = {}, const Executor* run = nullptr,
                                                MakeTable makeTable = nullptr);
    ~Scene();

    Hit intersect(const Ray&) const noexcept;
    // 16 at a time; coherent: the rays start together and go the same way (camera rays).
    void intersect(std::span<const Ray>, std::span<Hit>, bool coherent) const noexcept;
    void intersect(const RayPacket&, std::span<Hit>, bool coherent) const noexcept; // core/scene/ray_packet.h
    // The nearest surface of any opacity above zero, where intersect() passes a surface with probability 1 - opacity.
    Hit firstSurface(const Ray&) const noexcept;
    // Of the first rays of a packet: their hits as arrays; which of them are stopped, one bit a ray (core/scene/ray_packet.h).
    void intersect(const RayPacket&, HitPacket&, uint32_t count, bool coherent) const noexcept;
    uint32_t occluded(const RayPacket&, uint32_t count) const noexcept;
    bool occluded(const Ray&) const noexcept;
    void occluded(std::span<const Ray>, std::span<uint8_t> answers) const noexcept;
    void occluded(const RayPacket&, std::span<uint8_t> answers) const noexcept;

    SurfacePoint point(const Hit&, const Ray&) const noexcept;
    // What all points of a triangle share, where it is flat and plain (core/scene/flat_triangle.h); false: ask point().
    bool flat(const Hit&, FlatTriangle&) const noexcept;
    // Only what a texture look-up needs: UVs, vertex colour, material, light; position and normals stay zero.
    SurfacePoint attributes(const Hit&) const noexcept;

    // Everything that is drawn, for those who divide surfaces (radiosity, light maps) or look for them.
    std::span<const DrawnPart> parts() const noexcept { return parts_; }
    // Corners in space at a time, in the order of Hit's u and v: under a mirroring node clockwise seen from the front, whose side ng of
    // point() tells.
    std::array<Vec3, 3> corners(const DrawnPart&, uint32_t triangle, float time) const noexcept;
    // Their numbers among the vertices of the mesh: triangles that share a vertex number share the corner.
    std::array<uint32_t, 3> vertices(const DrawnPart&, uint32_t triangle) const noexcept;
    bool moves(const DrawnPart&) const noexcept; // its node, or its shape, while the shutter is open

    const MaterialDesc& material(uint32_t id) const noexcept { return materials_[id]; }
    std::span<const MaterialDesc> materials() const noexcept { return materials_; }
    const Textures& textures() const noexcept { return textures_; }
    // RGBA of a slot at a point; white without a texture. With a footprint: its mean there.
    Vec4 sample(const TextureSlot&, const SurfacePoint&, Transfer) const noexcept;
    Vec4 sample(const TextureSlot&, const SurfacePoint&, Transfer, const ConeSection&) const noexcept;
    // Where a cone of this width (metres, across its axis along d) meets the point's triangle (core/scene/ray_cone.h).
    ConeSection section(const SurfacePoint&, const Vec3& d, float width) const noexcept;
    // Of the triangle at a point, as its corners' normals tell, per metre; positive where the front is convex, 0 where it is flat.
    float curvature(const SurfacePoint&) const noexcept;
    // Fraction of light that a surface stops, [0, 1]: alpha under the material's alpha mode.
    float opacity(const SurfacePoint&) const noexcept;
    const Lights& lights() const noexcept { return lights_; }
    // That of compile(); null: none was asked for.
    const SceneTable* table() const noexcept { return table_.get(); }

    std::span<const CameraDesc> cameras() const noexcept { return cameras_; } // recentred like everything else
    const std::string& name() const noexcept { return name_; }
    Interval shutter() const noexcept { return shutter_; }
    const Motion& motion(uint32_t id) const noexcept { return motions_[id]; }
    Vec3d centre() const noexcept { return centre_; } // world position of our origin
    float radius() const noexcept { return radius_; } // of the sphere about the origin that holds all geometry
    const SceneCounts& counts() const noexcept { return counts_; }
    const std::string& isa() const noexcept { return isa_; }
    uint64_t hash() const noexcept { return hash_; } // of the content, environment included (XXH3)

private:
    friend class SceneCompiler;
    friend class WideSurfaces; // core/scene/wide_surfaces.h
    friend class WideTextures; // core/scene/wide_textures.h
    friend class Lights;
    Scene();
    // Corners of a triangle in the space of its geometry.
    std::array<Vec3, 3> localCorners(uint32_t geometry, uint32_t triangle, float time) const noexcept;
    std::string name_, isa_;
    std::vector<MaterialDesc> materials_;
    Textures textures_;
    std::vector<CameraDesc> cameras_;
    Lights lights_;
    std::vector<Geometry> geometries_; // those of the top level first, in world space; then those of instanced meshes
    std::vector<Instance> instances_;
    std::vector<DrawnPart> parts_;
    std::vector<Motion> motions_; // of instances and punctual lights
    Interval shutter_;
    ShutterClock clock_;
    std::unique_ptr<Accel> accel_;
    Vec3d centre_;
    float radius_ = 1;
    SceneCounts counts_;
    uint64_t hash_ = 0;
    std::unique_ptr<const SceneTable> table_;
};

} // namespace chiaro
