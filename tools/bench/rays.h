// The rays of a path tracer's first bounces, recorded from a view, and how fast Embree traces each kind alone: the limit that everything
// else is measured by. The same rays are asked one by one and sixteen at a time, so that their answers can be compared.
#pragma once
#include "core/scene/ray_packet.h"
#include "tools/bench/bench.h"
#include "tools/bench/measure.h"

namespace chiaro::bench {

enum class RayKind { cameraWide, cameraSingle, bounceSingle, bounceWide, shadowSingle, shadowWide };
inline constexpr int rayKinds = 6;
std::string_view rayKindName(RayKind) noexcept; // "camera, 16 coherent"

struct RecordedRays {
    std::vector<Ray> camera, bounce, shadow; // shadow: sixteen from one point, one after the other
    std::vector<RayPacket> cameraPackets, bouncePackets, shadowPackets;
};
// Of about so many pixels spread over the view, in tiles of 8 x 8.
RecordedRays recordRays(const Job&, uint32_t pixels);

struct Traced {
    uint64_t rays = 0, hits = 0; // of shadow rays: those that are stopped
};
// All rays of a kind once, in parallel.
Traced traceAll(const Scene&, const Executor&, const RecordedRays&, RayKind, const StopToken&);

} // namespace chiaro::bench
