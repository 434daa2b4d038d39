// What Accel does to a packet before and after Embree, in the lanes of the machine.
#pragma once
#include "core/scene/ray_packet.h"

namespace chiaro {

// All that Embree wants beside the rays. Lanes beyond `count` and rays that it could not bear are left out.
void readyForEmbree(TracePacket&, uint32_t count) noexcept;
// Of shadow rays: one bit for each that something stops, or that was not asked.
uint32_t stoppedRays(const TracePacket&) noexcept;

} // namespace chiaro
