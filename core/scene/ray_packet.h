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

} // namespace chiaro
