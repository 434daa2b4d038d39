#include "core/scene/accel_record.h"
#include <bit>
#include <cstring>

namespace chiaro {
namespace {

constexpr std::size_t width = RayPacket::size;
static_assert(width == WideRays::size);

void copy(auto (&to)[width], const auto (&from)[width]) noexcept { std::memcpy(to, from, sizeof to); }

RayAnswers closestAnswers(const RTCRayHit16& q, const int (&valid)[width]) noexcept {
    RayAnswers a{1, 0, 0, 0};
    for (std::size_t k = 0; k < width; ++k) {
        const bool asked = valid[k] != 0, hit = asked && q.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
        a.rays += asked;
        a.hits += hit;
        a.distances += hit ? std::bit_cast<uint32_t>(q.ray.tfar[k]) : 0u;
    }
    return a;
}
RayAnswers shadowAnswers(const RTCRay16& q, const int (&valid)[width]) noexcept {
    RayAnswers a{1, 0, 0, 0};
    for (std::size_t k = 0; k < width; ++k) {
        a.rays += valid[k] != 0;
        a.hits += valid[k] != 0 && q.tfar[k] < 0;
    }
    return a;
}

void record(const Accel* accel, RayCall call, const RTCRay16& q, const RayPacket& rays, const int (&valid)[width], const RayAnswers& told) {
    if (told.rays == 0) return;
    WideRays w;
    copy(w.ox, q.org_x), copy(w.oy, q.org_y), copy(w.oz, q.org_z), copy(w.tnear, q.tnear);
    copy(w.dx, q.dir_x), copy(w.dy, q.dir_y), copy(w.dz, q.dir_z), copy(w.time, q.time);
    copy(w.tfar, rays.tfar), copy(w.id, q.id), copy(w.valid, valid);
    for (std::size_t k = 0; k < width; ++k)
        if (valid[k] == 0) w.tfar[k] = -infinity; // as it was asked
    RayRecord::add(accel, call, w, told);
}

void lay(RTCRay16& q, const WideRays& r) noexcept {
    copy(q.org_x, r.ox), copy(q.org_y, r.oy), copy(q.org_z, r.oz), copy(q.tnear, r.tnear);
    copy(q.dir_x, r.dx), copy(q.dir_y, r.dy), copy(q.dir_z, r.dz), copy(q.time, r.time);
    copy(q.tfar, r.tfar), copy(q.id, r.id);
    std::memset(q.mask, 0xff, sizeof q.mask);
    std::memset(q.flags, 0, sizeof q.flags);
}

void again(const SingleRay& r, RayCall call, RTCScene scene, RTCIntersectContext& context, RayAnswers& all) noexcept {
    RTCRayHit q;
    q.ray = {r.ox, r.oy, r.oz, r.tnear, r.dx, r.dy, r.dz, r.time, r.tfar, ~0u, r.id, 0};
    if (call == RayCall::shadowSingle) {
        if (scene) rtcOccluded1(scene, &context, &q.ray);
        all += {1, 1, q.ray.tfar < 0, 0};
        return;
    }
    q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    if (scene) rtcIntersect1(scene, &context, &q);
    const bool hit = q.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    all += {1, 1, hit, hit ? std::bit_cast<uint32_t>(q.ray.tfar) : 0u};
}
void again(const WideRays& r, RayCall call, RTCScene scene, RTCIntersectContext& context, RayAnswers& all) noexcept {
    alignas(64) RTCRayHit16 q;
    lay(q.ray, r);
    if (call == RayCall::shadowWide) {
        if (scene) rtcOccluded16(r.valid, scene, &context, &q.ray);
        all += shadowAnswers(q.ray, r.valid);
        return;
    }
    std::memset(q.hit.geomID, 0xff, sizeof q.hit.geomID);
    std::memset(q.hit.instID, 0xff, sizeof q.hit.instID);
    if (scene) rtcIntersect16(r.valid, scene, &context, &q);
    all += closestAnswers(q, r.valid);
}

} // namespace

void recordClosest(const Accel* accel, RayCall call, const RTCRayHit16& q, const RayPacket& rays, const int (&valid)[width]) {
    record(accel, call, q.ray, rays, valid, closestAnswers(q, valid));
}
void recordShadow(const Accel* accel, const RTCRay16& q, const RayPacket& rays, const int (&valid)[width]) {
    record(accel, RayCall::shadowWide, q, rays, valid, shadowAnswers(q, valid));
}

RayAnswers traceAgain(const RayBlock& block, RTCScene scene) noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (block.call == RayCall::coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RayAnswers all;
    for (const SingleRay& r : block.single) again(r, block.call, scene, context, all);
    for (const WideRays& r : block.wide) again(r, block.call, scene, context, all);
    return all;
}

} // namespace chiaro
