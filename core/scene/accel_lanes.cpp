#include "core/scene/accel_lanes.h"
#include "core/math/wide_isa.h"
#include <cmath>
#include <cstddef>
#include <embree3/rtcore.h>

namespace chiaro {
namespace {

constexpr std::size_t width = TracePacket::size;
static_assert(offsetof(TracePacket, mask) == offsetof(RTCRay16, mask) && offsetof(TracePacket, flags) == offsetof(RTCRay16, flags));
static_assert(offsetof(RayPacket, tnear) == offsetof(RTCRay16, tnear) && offsetof(RayPacket, tfar) == offsetof(RTCRay16, tfar));
static_assert(offsetof(TracePacket, hits) == offsetof(RTCRayHit16, hit) && offsetof(HitPacket, u) == offsetof(RTCHit16, u));
static_assert(offsetof(HitPacket, geometry) == offsetof(RTCHit16, geomID) && offsetof(HitPacket, instance) == offsetof(RTCHit16, instID));

// What Embree wants beside the rays. Lanes beyond `count` and rays that it could not bear are left out.
[[gnu::always_inline]] inline void readyLanes(TracePacket& p, uint32_t count) noexcept {
    constexpr float far = 1e18f;
    const RayPacket& r = p.rays;
    const float *const ox = r.ox, *const oy = r.oy, *const oz = r.oz, *const dx = r.dx, *const dy = r.dy, *const dz = r.dz,
                       *const tnear = r.tnear, *const time = r.time;
    float* const tfar = p.rays.tfar;
    for (uint32_t k = 0; k < width; ++k) {
        // usable(), without branches: a comparison with NaN is false.
        const bool good = (std::fabs(ox[k]) < far) & (std::fabs(oy[k]) < far) & (std::fabs(oz[k]) < far) & (std::fabs(dx[k]) <= 1.001f) &
                          (std::fabs(dy[k]) <= 1.001f) & (std::fabs(dz[k]) <= 1.001f) & (tnear[k] >= 0) & (tnear[k] < infinity) &
                          (tnear[k] <= tfar[k]) & (std::fabs(time[k]) < infinity) & (k < count);
        p.asked[k] = good ? -1 : 0;
        // Where a machine has no kernel for sixteen, Embree knows lanes that do not count by their empty interval alone.
        tfar[k] = good ? tfar[k] : -infinity;
    }
    for (uint32_t k = 0; k < width; ++k) p.mask[k] = p.hits.geometry[k] = p.hits.instance[k] = ~0u;
    for (uint32_t k = 0; k < width; ++k) p.id[k] = p.flags[k] = 0;
}
void readyBaseline(TracePacket& p, uint32_t count) noexcept { readyLanes(p, count); }
CHIARO_TARGET_AVX2 void readyAvx2(TracePacket& p, uint32_t count) noexcept { readyLanes(p, count); }
CHIARO_TARGET_AVX512 void readyAvx512(TracePacket& p, uint32_t count) noexcept { readyLanes(p, count); }
auto* const readyWidest = widest(readyBaseline, readyAvx2, readyAvx512);

[[gnu::always_inline]] inline uint32_t stoppedLanes(const TracePacket& p) noexcept {
    uint32_t bits = 0;
    for (uint32_t k = 0; k < width; ++k) bits |= uint32_t((p.asked[k] == 0) | (p.rays.tfar[k] < 0)) << k;
    return bits;
}
uint32_t stoppedBaseline(const TracePacket& p) noexcept { return stoppedLanes(p); }
CHIARO_TARGET_AVX2 uint32_t stoppedAvx2(const TracePacket& p) noexcept { return stoppedLanes(p); }
CHIARO_TARGET_AVX512 uint32_t stoppedAvx512(const TracePacket& p) noexcept { return stoppedLanes(p); }
auto* const stoppedWidest = widest(stoppedBaseline, stoppedAvx2, stoppedAvx512);

} // namespace

void readyForEmbree(TracePacket& p, uint32_t count) noexcept { readyWidest(p, count); }
uint32_t stoppedRays(const TracePacket& p) noexcept { return stoppedWidest(p); }

} // namespace chiaro
