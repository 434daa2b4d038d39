// Accel: the bounding volume hierarchy. Every call to Embree in the program is in accel*.cpp. Two levels: meshes that several nodes use, or
// one that moves, are built once and instanced, all other geometry lies in world space in the top level.
#pragma once
#include "core/math/ray.h"
#include "core/scene/desc.h"
#include "core/scene/motion.h"
#include "core/scene/ray_packet.h"
#include "core/scene/ray_record.h"
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace chiaro {

class Executor;

// A compiled triangle list. Normals, tangents, UVs and colours are empty or one a vertex.
struct Geometry {
    std::vector<Vec3> positions; // one more than the vertices at the end: Embree reads 16 bytes at a time
    std::vector<uint32_t> indices;
    std::vector<Vec3> normals;
    std::vector<Vec4> tangents;
    std::vector<Point2> uv[uvSets];
    std::vector<Vec4> colors;
    std::vector<ShapeDesc> steps; // of what deforms: later shapes at equal steps of the shutter, their positions one more too
    uint32_t material = 0;
    uint32_t firstLight = ~0u; // of its first triangle, where the geometry lies in the top level; instances keep their own
    bool cutOut = false;       // opacity below 1 somewhere: rays ask
    uint8_t uvEnd = 0;         // one beyond the last UV set that it has
    static constexpr uint8_t noFrame = 255;
    uint8_t frameSet = noFrame; // the UV set along which tangents run; noFrame: the material asks for none
    uint32_t triangles() const noexcept { return uint32_t(indices.size() / 3); }
    bool deforms() const noexcept { return !steps.empty(); }
    const std::vector<Vec3>& positionsAt(std::size_t step) const noexcept { return step == 0 ? positions : steps[step - 1].positions; }
    const std::vector<Vec3>& normalsAt(std::size_t step) const noexcept { return step == 0 ? normals : steps[step - 1].normals; }
    const std::vector<Vec4>& tangentsAt(std::size_t step) const noexcept { return step == 0 ? tangents : steps[step - 1].tangents; }
    std::span<const uint32_t, 3> triangle(uint32_t i) const noexcept {
        return std::span<const uint32_t, 3>(&indices[std::size_t(i) * 3], 3);
    }
};

struct Instance {
    AffineT<float> toWorld;                        // of a moving one: when the shutter opens
    uint32_t firstGeometry = 0, geometryCount = 0; // of the mesh
    std::vector<uint32_t> firstLights;             // one a geometry; ~0u: not a light
    bool flipped = false;                          // negative determinant: the front is the clockwise side of the stored winding
    uint32_t motion = ~0u;                         // of the scene; ~0u: at rest
};

// The opacity of cut-out geometry at a hit (its t is not set), in [0, 1]. A ray passes with probability 1 - opacity, by a hash of the ray
// and the triangle: the same ray always gets the same answer.
using OpacityAt = std::function<float(const Hit&)>;

class Accel {
public:
    // The first `top` geometries lie in world space; the rest belong to meshes, which instances name by their first geometry. Motions are
    // those that instances name; rays carry times of the shutter, in seconds.
    Accel(std::span<const Geometry>, std::size_t top, std::span<const Instance>, std::span<const Motion>, Interval shutter, OpacityAt,
          const std::string& isa, const Executor* run);
    ~Accel();
    Hit intersect(const Ray&) const noexcept;
    void intersect(std::span<const Ray>, std::span<Hit>, bool coherent) const noexcept;
    void intersect(const RayPacket&, std::span<Hit>, bool coherent) const noexcept;             // of its first rays, one a hit; 16 at most
    void intersect(const RayPacket&, HitPacket&, uint32_t count, bool coherent) const noexcept; // of its first rays; 16 at most
    uint32_t occluded(const RayPacket&, uint32_t count) const noexcept;                         // one bit a ray
    // The same of packets that are Embree's own.
    void trace(TracePacket&, uint32_t count, bool coherent) const noexcept;
    uint32_t stopped(TracePacket&, uint32_t count) const noexcept; // one bit a ray
    // The nearest surface of any opacity above zero: nothing passes by lot. For those who weigh what passes themselves.
    Hit firstSurface(const Ray&) const noexcept;
    bool occluded(const Ray&) const noexcept;
    void occluded(std::span<const Ray>, std::span<uint8_t>) const noexcept;
    void occluded(const RayPacket&, std::span<uint8_t>) const noexcept;
    const std::string& isa() const noexcept { return isa_; }
    std::size_t bytes() const noexcept; // that Embree has taken
    static std::string version();       // of Embree
    // The calls of a record once more, to the Accel that they went to and with nothing but Embree around them.
    static RayAnswers replay(const RayBlock&) noexcept;
    // What replay() does besides: reading the records and laying them out for Embree.
    static RayAnswers readThrough(const RayBlock&) noexcept;

    struct Impl;

private:
    Hit single(RayCall, const Ray&, uint32_t id) const noexcept;
    std::unique_ptr<Impl> impl_;
    std::string isa_;
    ShutterClock clock_;
    bool moves_ = false; // something does: Embree looks at times
};

} // namespace chiaro
