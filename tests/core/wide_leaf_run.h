// The body of the functions of wide_leaf.h. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_sampler.h"
#include "tests/core/wide_leaf.h"

namespace chiaro::CHIARO_ISA {

inline void runLeaf(test::LeafLanes& l) {
    const Float x(l.x), y(l.y);
    const Int bits(l.bits), depth(l.depth);
    const Mask lanes(l.lanes);
    const WideSampler sampler(Int(l.keyLow), Int(l.keyHigh), Int(l.sample));
    const bool shallow = none(depth >= Int(16u));
    const WidePick pick = sampler.get3D(mixedAt<5, 8>(depth, shallow));
    pick.pick.store(l.pick), pick.u.x.store(l.u), pick.u.y.store(l.v);
    sampler.get1D(mixedAt<12, 8>(depth, shallow)).store(l.one);
    reverseBits(bits).store(l.reversed);
    mulHigh(bits, Int(12345u)).store(l.high);
    inverseSqrt(y).store(l.inverseRoot);
    const Vec3w h = cosineHemisphere(Vec2w{x, y});
    h.x.store(l.hx), h.y.store(l.hy), h.z.store(l.hz);
    storePacked(l.packed, lanes, x);
    alignas(64) uint32_t at[laneCount];
    for (uint32_t k = 0; k < laneCount; ++k) at[k] = laneCount - 1 - k;
    addTo<true>(l.sums, at, lanes, x, y, x * y);
    addTo(l.sums, at, lanes, x, y, x * y);
}

} // namespace chiaro::CHIARO_ISA
