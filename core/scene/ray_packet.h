// RayPacket: sixteen rays side by side, as the wide kernels take them. Whoever makes rays in a loop over lanes writes them here at once,
// without a round by way of single rays; the answers are those of the same rays one by one.
#pragma once
#include "core/math/ray.h"
#include <cstddef>

namespace chiaro {

struct alignas(64) RayPacket {
    static constexpr std::size_t size = 16;
    float ox[size], oy[size], oz[size], tnear[size];
    float dx[size], dy[size], dz[size], time[size], tfar[size];

    void set(std::size_t k, const Ray& r) noexcept {
        ox[k] = r.o.x, oy[k] = r.o.y, oz[k] = r.o.z, tnear[k] = r.tnear;
        dx[k] = r.d.x, dy[k] = r.d.y, dz[k] = r.d.z, time[k] = r.time, tfar[k] = r.tfar;
    }
    Ray ray(std::size_t k) const noexcept { return {{ox[k], oy[k], oz[k]}, tnear[k], {dx[k], dy[k], dz[k]}, tfar[k], time[k]}; }
};

// What such a packet met, as arrays of Hit's members; geometry Hit::none where a ray met nothing.
struct alignas(64) HitPacket {
    static constexpr std::size_t size = RayPacket::size;
    float across[3][size]; // of Embree: a normal of any length in the space of the mesh
    float u[size], v[size];
    uint32_t triangle[size], geometry[size], instance[size];
    float t[size];

    Hit hit(std::size_t k) const noexcept { return {geometry[k], triangle[k], instance[k], u[k], v[k], t[k]}; }
};

// Rays and what they met in one piece, laid out as Embree's RTCRayHit16: asked and answered in place (Accel::trace, Accel::stopped), for
// those who make so many packets that copies of them count.
struct alignas(64) TracePacket {
    static constexpr std::size_t size = RayPacket::size;
    RayPacket rays; // the far ends are written over
    uint32_t mask[size], id[size], flags[size];
    HitPacket hits;
    int32_t asked[size]; // -1; 0: no such ray, or none that Embree could bear
};

} // namespace chiaro
