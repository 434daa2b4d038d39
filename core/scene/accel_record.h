// How Accel's calls are written into a RayRecord, and made again from one.
#pragma once
#include "core/scene/ray_packet.h"
#include "core/scene/ray_record.h"
#include <embree3/rtcore.h>

namespace chiaro {

// After the call. Of the packet only the far ends are read: Embree writes over those of its own.
void recordClosest(const Accel*, RayCall, const RTCRayHit16&, const RayPacket&, const int (&valid)[RayPacket::size]);
void recordShadow(const Accel*, const RTCRay16&, const RayPacket&, const int (&valid)[RayPacket::size]);

// Every call with a fresh ray record. No scene: all is done but the calls.
RayAnswers traceAgain(const RayBlock&, RTCScene) noexcept;

} // namespace chiaro
