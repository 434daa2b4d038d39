// The body of the functions of wide_lookup.h. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/scene/wide_light_tree.h"
#include "core/scene/wide_sky.h"
#include "core/scene/wide_texture_lookup.h"
#include "tests/core/wide_lookup.h"

namespace chiaro::CHIARO_ISA {

inline void runSky(const Sky& sky, test::LookupLanes& l) {
    const WideSkyTables tables{sky.frame(),      sky.texels(), sky.cells(),
                               sky.rowCosines(), sky.count(),  sky.filter() == TextureFilter::linear};
    const WideSkyValue v = skyAt(tables, {Float(l.dx), Float(l.dy), Float(l.dz)}, Mask(0xffffu));
    v.radiance.c[0].store(l.r), v.radiance.c[1].store(l.g), v.radiance.c[2].store(l.b), v.pdfW.store(l.pdfW);
    const WideSkySample s = skySample(tables, mulHigh(Int(l.pick), Int(sky.count())), {Float(l.ux), Float(l.uy)});
    s.wi.x.store(l.sampleX), s.wi.y.store(l.sampleY), s.wi.z.store(l.sampleZ), s.pdfW.store(l.samplePdf);
    s.radiance.c[0].store(l.sampleR), s.radiance.c[1].store(l.sampleG), s.radiance.c[2].store(l.sampleB);
}
inline void runTree(const LightTreeView& tree, uint32_t lanes, test::TreeLanes& l) {
    const WideTreePick pick = chooseInTree(tree, {Float(l.px), Float(l.py), Float(l.pz)}, {Float(l.nx), Float(l.ny), Float(l.nz)},
                                           Mask(lanes), toDouble(Int(l.pick)) * 0x1p-32);
    pick.light.store(l.light), pick.pmf.store(l.pmf);
}
inline void runTexture(const WideTexture& t, bool footprint, uint32_t lanes, test::LookupLanes& l) {
    const Float zero(0.f), one(1.f);
    const WideUv uv{{Float(l.u), Float(l.v)}, {{zero, zero}, {one, zero}, {zero, one}}};
    const ConeSectionT<Float> cone{{Float(l.majorX), Float(l.majorY)}, {Float(l.minorX), Float(l.minorY)}};
    const Rgbw c = footprint ? textureAt(t, uv, cone, Mask(lanes)) : textureAt(t, uv, Mask(lanes));
    c.c[0].store(l.r), c.c[1].store(l.g), c.c[2].store(l.b);
}

} // namespace chiaro::CHIARO_ISA
