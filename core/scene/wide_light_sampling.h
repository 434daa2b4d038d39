// Light samples for sixteen receivers at once: Lights::sampleTowards() over lanes, from the tables of WideLights. The numbers choose the
// same light and the same point on it. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/warp.h"
#include "core/math/wide_sampler.h"
#include "core/scene/wide_light_tree.h"
#include "core/scene/wide_lights.h"
#include "core/scene/wide_point.h"
#include "core/scene/wide_sky.h"

namespace chiaro::CHIARO_ISA {

struct WideLightSample {
    Vec3w wi;
    Rgbw radiance;
    Float pdfW;
    Vec3w o, d; // shadow ray
    Float tfar;
    Mask arrives, delta;
};

// The cell of each lane, or the sky.
CHIARO_LANE void cells(const WideLights& lights, LightLanes& l) noexcept {
    const double edge = lights.edge(), rest = 1 - edge, count = double(lights.finite());
    const uint32_t last = lights.finite() - 1;
    for (uint32_t k = 0; k < laneCount; ++k) {
        const double u = double(l.pick[k]) * 0x1p-32, at = (u - edge) / rest * count;
        const uint32_t cell = at > 0 ? uint32_t(at) : 0;
        l.light[k] = u < edge ? LightLanes::sky : cell < last ? cell : last;
    }
}

// By WideLight::inverse.
CHIARO_LANE Float inverseArea(Float inverse) noexcept { return abs(inverse + inverse); }

// The first to answer: what it says of lanes that are not in m means nothing.
CHIARO_LANE void triangleSample(const Float (&w)[WideLights::members], const WidePoint& at, const Vec2w& u, Mask m,
                                WideLightSample& s) noexcept {
    const Vec3w corner{w[0], w[1], w[2]}, e1{w[3], w[4], w[5]}, e2{w[6], w[7], w[8]};
    const Vec2w b = uniformTriangle(u);
    const Vec3w p = mulAdd(e2, b.y, mulAdd(e1, b.x, corner)), ng = cross(e1, e2) * w[9], way = p - at.p;
    const Float distanceSquared = lengthSquared(way);
    const Vec3w wi = way * inverseSqrt(distanceSquared);
    const Float cosine = -dot(wi, ng);
    const Mask bothSides = (floatAsBits(w[15]) & Int(WideLight::doubleSided)) != Int(0u);
    const Mask seen = m & (distanceSquared > Float(0.f)) & ((cosine > Float(0.f)) | (bothSides & (cosine < Float(0.f))));
    const Vec3w from = offset(at.p, at.ng, at.error, way), d = offset(p, ng, w[14], -way) - from;
    const Float squared = lengthSquared(d), inverse = inverseSqrt(squared), distance = squared * inverse;
    s.wi = wi;
    s.radiance = {w[11], w[12], w[13]};
    s.pdfW = areaToSolidAngle(inverseArea(w[9]), distanceSquared, cosine);
    s.o = from;
    s.d = select(squared > Float(0.f), d * inverse, at.ng);
    s.tfar = distance * Float(fault(Fault::shadowRayShort) ? 0.9f : 1 - 0x1p-20f);
    s.arrives = seen & notBlack(s.radiance);
}

CHIARO_LANE void punctualSample(const Float (&w)[WideLights::members], const WidePoint& at, Mask m, WideLightSample& s) noexcept {
    const Vec3w place{w[0], w[1], w[2]}, axis{w[3], w[4], w[5]}, way = place - at.p;
    const Int flags = floatAsBits(w[15]);
    const Mask parallel = m & ((flags & Int(WideLight::directional)) != Int(0u)), spot = (flags & Int(WideLight::spot)) != Int(0u);
    const Float distanceSquared = lengthSquared(way), infinite(infinity);
    const Vec3w wi = select(parallel, -axis, way * (Float(1.f) / sqrt(distanceSquared)));
    Float attenuation = Float(1.f) / distanceSquared;
    attenuation = select(w[9] > Float(0.f), attenuation * clamp01(Float(1.f) - sqr(distanceSquared / sqr(w[9]))), attenuation);
    attenuation = select(spot, attenuation * sqr(clamp01(-dot(wi, axis) * w[11] + w[12])), attenuation);
    attenuation = select(parallel, Float(1.f), attenuation);
    const Vec3w from = offset(at.p, at.ng, at.error, wi), d = place - from;
    const Float distance = length(d);
    s.wi = select(m, wi, s.wi);
    s.radiance = select(m, Rgbw{w[6], w[7], w[8]} * attenuation, s.radiance);
    s.pdfW = select(m, Float(1.f), s.pdfW);
    s.o = select(m, from, s.o);
    s.d = select(m, select(parallel, wi, d * (Float(1.f) / distance)), s.d);
    s.tfar = select(m, select(parallel, infinite, distance), s.tfar);
    s.delta = s.delta | m;
    s.arrives = s.arrives | (m & (parallel | (distanceSquared > Float(0.f))) & notBlack(s.radiance));
}

CHIARO_LANE WideSkyTables skyTables(const Sky& sky) noexcept {
    return {sky.frame(), sky.texels(), sky.cells(), sky.rowCosines(), sky.count(), sky.filter() == TextureFilter::linear};
}
// edge: the share of all choices that falls to the sky; lanes beyond it get the last cell.
CHIARO_LANE Int skyCell(const WideSkyTables& sky, double edge, const WidePick& pick) noexcept {
    if (edge == 1) return mulHigh(pick.pick, Int(sky.count));
    alignas(64) uint32_t picks[laneCount];
    pick.pick.store(picks);
    for (uint32_t& p : picks) {
        const double place = double(p) * 0x1p-32 / edge * double(sky.count);
        p = place < double(sky.count - 1) ? uint32_t(place) : sky.count - 1;
    }
    return Int(picks);
}
// Towards the sky.
CHIARO_LANE void environmentSample(const Sky& sky, double edge, const WidePoint& at, const WidePick& pick, Mask m,
                                   WideLightSample& s) noexcept {
    if (sky.black()) return;
    const WideSkyTables tables = skyTables(sky);
    const Int cell = select(m, skyCell(tables, edge, pick), Int(0u));
    const WideSkySample sample = skySample(tables, cell, pick.u);
    s.wi = select(m, sample.wi, s.wi);
    s.d = select(m, sample.wi, s.d);
    s.o = select(m, offset(at.p, at.ng, at.error, sample.wi), s.o);
    s.radiance = select(m, sample.radiance, s.radiance);
    s.pdfW = select(m, fault(Fault::lightChoiceForgotten) ? sample.pdfW : sample.pdfW * Float(float(edge)), s.pdfW);
    s.tfar = select(m, Float(infinity), s.tfar);
    s.arrives = s.arrives | (m & notBlack(sample.radiance));
}

// Lanes that are answered one by one, by Lights itself.
CHIARO_LANE void askSample(const WideLights& lights, LightLanes& l, Mask m, WideLightSample& s) noexcept {
    lights.sample(l, m.bits());
    s.wi = select(m, {Float(l.wx), Float(l.wy), Float(l.wz)}, s.wi);
    s.radiance = select(m, {Float(l.r), Float(l.g), Float(l.b)}, s.radiance);
    s.pdfW = select(m, Float(l.pdfW), s.pdfW);
    s.o = select(m, {Float(l.ox), Float(l.oy), Float(l.oz)}, s.o);
    s.d = select(m, {Float(l.dx), Float(l.dy), Float(l.dz)}, s.d);
    s.tfar = select(m, Float(l.tfar), s.tfar);
    s.delta = s.delta | (m & (Int(l.delta) != Int(0u)));
    s.arrives = s.arrives | (m & (s.pdfW > Float(0.f)) & notBlack(s.radiance));
}

// time: of the rays. m: lanes that want a sample; the others hold nothing of use.
CHIARO_LANE WideLightSample sampleTowards(const WideLights& lights, const WidePoint& at, Float time, Mask m,
                                          const WidePick& pick) noexcept {
    WideLightSample s;
    LightLanes l;
    if (lights.edge() > 0 || lights.byTree()) pick.pick.store(l.pick);
    const bool finite = lights.finite() > 0;
    constexpr uint32_t members = WideLights::members;
    const float(*const fields)[WideLights::few] = lights.fields();
    const auto tell = [&](Float ux) { // the receiver, for lanes that are asked one by one
        at.p.x.store(l.px), at.p.y.store(l.py), at.p.z.store(l.pz);
        at.ng.x.store(l.nx), at.ng.y.store(l.ny), at.ng.z.store(l.nz);
        at.error.store(l.error), time.store(l.time);
        ux.store(l.ux), pick.u.y.store(l.uy);
    };
    Float ux = pick.u.x, pmf(float(lights.edge()));
    Int light(lights.environment() ? LightLanes::sky : LightLanes::unchosen);
    if (finite && lights.edge() == 0) { // the same cells without doubles: the product is exact either way
        light = mulHigh(pick.pick, Int(lights.finite()));
    } else if (finite) {
        cells(lights, l);
        light = Int(l.light);
    }
    const Mask sky = m & (light == Int(LightLanes::sky));
    Mask chosen = andNot(m, sky) & (light != Int(LightLanes::unchosen));
    if (lights.byTree()) {
        const Double u = (toDouble(pick.pick) * 0x1p-32 - lights.edge()) / (1 - lights.edge());
        const Mask inTree = chosen & (u < lights.treeShare());
        const WideTreePick tree = chooseInTree(lights.tree(), at.p, at.ng, inTree, u / lights.treeShare());
        light = select(inTree, tree.light, light);
        pmf = select(inTree, tree.pmf * Float(float(1 - lights.edge()) * float(lights.treeShare())), pmf);
        if (const Mask others = andNot(chosen, inTree); any(others)) {
            tell(ux);
            light.store(l.light), pmf.store(l.pmf);
            lights.choose(l, others.bits());
            light = Int(l.light), ux = Float(l.ux), pmf = Float(l.pmf);
        }
        static_assert(LightTree::none == LightLanes::sky && LightLanes::unchosen != LightLanes::sky);
        chosen = chosen & (light < Int(LightLanes::unchosen)) & (pmf > Float(0.f));
    } else if (any(chosen)) {
        Float keep, alias, own, other;
        if (fields) {
            keep = lookUp(fields[members], light), alias = lookUp(fields[members + 1], light);
            own = lookUp(fields[members + 2], light), other = lookUp(fields[members + 3], light);
        } else {
            alignas(64) uint32_t cell[laneCount];
            select(chosen, light << 2, Int(0u)).store(cell);
            loadFour(lights.cells(), cell, keep, alias, own, other);
        }
        const Mask stays = ux < keep;
        const Float left = min(select(stays, ux, ux - keep) / select(stays, keep, Float(1.f) - keep), Float(oneMinusEpsilon));
        light = select(chosen, select(stays, light, floatAsBits(alias)), light);
        pmf = select(chosen, select(stays, own, other), pmf);
        ux = select(chosen, left, ux);
        chosen = chosen & (pmf > Float(0.f));
    }
    Mask asked;
    const auto nothing = [&] { s = {at.ng, Rgbw(Float(0.f)), Float(0.f), at.p, at.ng, Float(0.f), Mask(), Mask()}; };
    if (none(chosen)) {
        nothing();
    } else {
        Float w[members];
        if (fields) {
#pragma GCC unroll 32
            for (uint32_t i = 0; i < members; ++i) w[i] = lookUp(fields[i], light);
        } else {
            alignas(64) uint32_t record[laneCount];
            select(chosen, light << 4, Int(0u)).store(record);
#pragma GCC unroll 8
            for (uint32_t i = 0; i < members; i += 4) loadFour(lights.records() + i, record, w[i], w[i + 1], w[i + 2], w[i + 3]);
        }
        const Int flags = floatAsBits(w[15]);
        const auto has = [&](uint32_t flag) { return chosen & ((flags & Int(flag)) != Int(0u)); };
        asked = asked | has(WideLight::ask);
        const Mask punctual = has(WideLight::punctual), triangle = andNot(chosen, punctual | asked);
        if (any(triangle))
            triangleSample(w, at, {ux, pick.u.y}, triangle, s);
        else
            nothing();
        if (any(andNot(punctual, asked))) punctualSample(w, at, andNot(punctual, asked), s);
        if (!fault(Fault::lightChoiceForgotten)) s.pdfW = s.pdfW * pmf;
    }
    if (any(sky)) environmentSample(*lights.sky(), lights.edge(), at, pick, sky, s);
    if (any(asked)) {
        tell(ux);
        light.store(l.light), pmf.store(l.pmf);
        askSample(lights, l, asked, s);
    }
    s.arrives = s.arrives & (s.pdfW > Float(0.f));
    return s;
}

} // namespace chiaro::CHIARO_ISA
