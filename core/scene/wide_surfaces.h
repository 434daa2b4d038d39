// WideSurfaces: the triangles of a scene as loops over lanes want them, one record of 64 bytes each: a hit brings one cache line, and four
// loads of 16 bytes that are transposed in registers. Made once before a render, read by all threads. Which hits are not in the tables
// (vertex colours, moving instances, what deforms, normals of unequal length) is said, and Scene::point() answers for them.
#pragma once
#include "core/math/vec.h"
#include <cstdint>
#include <vector>

namespace chiaro {

class Accel;
class Executor;
class Scene;

struct alignas(64) WideTriangle {
    float a[3], b[3], c[3]; // corners, in the space of their mesh
    uint32_t material;      // the highest bit: its normals are interpolated
    uint32_t light;         // of the scene, ~0u: none, WideSurfaces::askLight: by the instance
    uint32_t normals[5];    // of the corners, octahedral: two numbers of 24 bits each
};
struct alignas(64) WideInstance {
    float toWorld[12]; // rows
    float side;        // -1 where the map mirrors
    float moves;       // 1: not for lanes
    float unused[2];
};

class WideSurfaces {
public:
    static constexpr uint32_t none = ~0u, askLight = ~1u, smoothBit = 0x80000000u;
    static constexpr float normalSteps = 16777214; // even, so that the axes are exact

    explicit WideSurfaces(const Scene&, const Executor* run = nullptr); // run: on its threads; null: on this one
    const uint32_t* firsts() const noexcept { return firsts_.data(); }  // by geometry: its first record; none: ask the scene
    std::size_t geometries() const noexcept { return firsts_.size(); }
    const WideTriangle* triangles() const noexcept { return triangles_.data(); }
    const WideInstance* instances() const noexcept { return instances_.data(); }
    bool moves() const noexcept { return moves_; }        // anything in the scene: rays need their times
    static const Accel& hierarchy(const Scene&) noexcept; // for those who trace packets in place
    bool instanced() const noexcept { return !instances_.empty(); }
    struct Block { // triangles of one geometry that one task makes something of
        std::size_t geometry;
        uint32_t begin, end;
    };
    std::vector<Block> blocks(const Scene&) const; // of all triangles with a record
    std::size_t bytes() const noexcept {
        return firsts_.size() * sizeof(uint32_t) + triangles_.size() * sizeof(WideTriangle) + instances_.size() * sizeof(WideInstance);
    }

private:
    std::vector<uint32_t> firsts_;
    std::vector<WideTriangle> triangles_;
    std::vector<WideInstance> instances_;
    bool moves_;
};

} // namespace chiaro
