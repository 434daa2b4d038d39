// The loop of WidePaths for one instruction set: Path::radiance (integrators/path.cpp) in lanes, step by step.
#pragma once
#include "integrators/wide/path_meet.h"

namespace chiaro::CHIARO_ISA {

// Light that the rays have found: emitters where they hit, the sky where they did not.
void PathFollower::find(PathPacket& p, Mask m, const HitPacket& hits, Vertex& v) noexcept {
    const WideLights& lights = paths_.lights();
    const Mask sky = lights.environment() ? andNot(m, v.hit) : Mask();
    const Mask shines = v.lanes & ((v.flags & Int(WideMaterial::emits)) != Int(0u)) & (v.at.light != Int(WideSurfaces::none));
    const Mask asked = v.alone | (shines & (((v.flags & Int(WideMaterial::askEmission)) != Int(0u)) |
                                            (v.at.light == Int(WideSurfaces::askLight)) | (lights.byTree() ? Mask(0xffffu) : Mask())));
    if (none(sky | shines | asked)) return;
    Rgbw light = v.emission;
    Float lightPdf(0.f);
    Mask found = andNot(shines, asked);
    if (any(found)) {
        const Float cosine = -dot(p.d, v.at.ng);
        const Mask bothSides = (v.flags & Int(WideMaterial::doubleSided)) != Int(0u);
        found = found & ((cosine > Float(0.f)) | (bothSides & (cosine < Float(0.f))));
        const Int record = v.at.light * Int(20u);
        const Float density = gather(lights.records() + 10, record, found), pmf = gather(lights.records() + 11, record, found);
        const Float pdf = pmf * areaToSolidAngle(density, lengthSquared(v.at.p - p.from), cosine);
        lightPdf = select(found, fault(Fault::misOtherMeasure) ? pmf * density : pdf, Float(0.f));
    }
    if (any(asked)) {
        tell(p, hits);
        paths_.found(told_, asked.bits());
        for (std::size_t c = 0; c < 3; ++c) light.c[c] = select(asked, Float(told_.light[c]), light.c[c]);
        lightPdf = select(asked, Float(told_.lightPdfW), lightPdf);
        found = found | asked;
    }
    if (any(sky)) {
        const WideSkyValue value = skyAt(skyTables(*lights.sky()), p.d, sky);
        light = select(sky, value.radiance, light);
        lightPdf = select(sky, select(p.depth != Int(0u), value.pdfW * Float(float(lights.edge())), Float(0.f)), lightPdf);
        found = found | sky;
        for (std::size_t c = 0; c < 3; ++c) v.albedo.c[c] = select(sky, clamp01(light.c[c]), v.albedo.c[c]);
    }
    found = found & notBlack(light);
    const Mask delta = p.pdfW < Float(0.f);
    const Mask alone = (p.depth == Int(0u)) | (fault(Fault::deltaWeighted) ? Mask() : delta) | (lightPdf == Float(0.f));
    Float weight = settings_.mis ? powerHeuristic(abs(p.pdfW), lightPdf) : Float(0.f);
    weight = settings_.nee && !fault(Fault::emissionTwice) ? select(alone, Float(1.f), weight) : Float(1.f);
    add(p, found, p.throughput * light * weight);
}

// Next-event estimation: shadow rays to one light each.
void PathFollower::direct(PathPacket& p, const Vertex& v, Mask m, const WidePick& pick) noexcept {
    const WideLightSample s = sampleTowards(paths_.lights(), v.at, p.time, m, pick);
    const Vec3w wi = v.frame.toLocal(s.wi);
    const WideLobeValue value = v.lobes.evaluate(wi);
    const Mask lit = m & s.arrives & (value.pdfW > Float(0.f)) & (dot(s.wi, v.ng) > Float(0.f)) & notBlack(value.f);
    if (none(lit)) return;
    const Float other = settings_.mis ? select(s.delta, Float(0.f), value.pdfW) : Float(0.f);
    const Float cosine = fault(Fault::receiverCosineMissing) ? Float(1.f) : abs(wi.z);
    const Rgbw brings = p.throughput * value.f * s.radiance * (cosine * weightOverPdf(s.pdfW, other));
    shadows_.append(lit, s.o, s.d, s.tfar, p.time, brings, p.slot, needs_.time);
}

// The next rays; the lanes that have one.
Mask PathFollower::scatter(PathPacket& p, const HitPacket& hits, const Vertex& v, Mask m, const WidePick& pick) noexcept {
    // As float(double(bits) 2^-32) rounds, but never to 1.
    const Float uLobe = min(wholeToFloat(pick.pick) * Float(0x1p-32f), Float(oneMinusEpsilon));
    const WideLobeSample s = v.lobes.sample(uLobe, pick.u);
    const Vec3w wi = toWorld(v.frame, s.wi);
    const Float side = dot(wi, v.ng);
    Mask alive = m & s.drawn & select(s.wi.z > Float(0.f), side > Float(0.f), side < Float(0.f));
    // Of a diffuse base alone: the cosine and its density cancel out.
    Rgbw weight = v.lobes.diffuseColor * Float(fault(Fault::diffuseBias) ? 1.01f : 1.f);
    Float pdfW = cosineHemispherePdfW(s.wi.z);
    if (const Mask others = m & v.lobes.others(); any(others)) {
        const WideLobeValue value = v.lobes.evaluate(s.wi);
        weight = select(others, value.f * (abs(s.wi.z) / value.pdfW), weight);
        pdfW = select(others, value.pdfW, pdfW);
    }
    alive = alive & (s.delta | (pdfW > Float(0.f)));
    if (any(s.delta)) weight = select(s.delta, s.weight * (Float(1.f) / s.pmf), weight);
    alive = alive & notBlack(weight);
    // Lanes that end here may hold anything from now on; those that are alone read what they were told.
    p.throughput = p.throughput * weight;
    p.pdfW = any(s.delta) ? select(s.delta, -s.pmf, pdfW) : pdfW;
    if (needs_.cone) widen(p, hits, v, alive, s);
    p.o = offset(v.at.p, v.at.ng, v.at.error, wi);
    p.d = wi;
    p.from = v.at.p;
    p.fromNg = v.at.ng;
    if (!needs_.medium) return alive;
    const auto is = [&](uint32_t flag) { return (v.flags & Int(flag)) != Int(0u); };
    const Mask within = is(WideMaterial::volume) & (dot(v.at.ng, wi) < Float(0.f));
    const Int medium = (v.at.material + Int(1u)) | select(is(WideMaterial::absorbs), Int(VertexLanes::absorbs), Int(0u));
    p.medium = select(within, medium, Int(0u));
    return alive;
}

// Lanes that the scalar closure answers for.
Mask PathFollower::alone(PathPacket& p, const Vertex& v, const WidePick& uLight, const WidePick& uBsdf, Rgbw& albedo,
                         Vec3w& normal) noexcept {
    const Mask m = v.alone;
    const WidePick* const picks[] = {&uLight, &uBsdf};
    for (int i = 0; i < 2; ++i) {
        picks[i]->pick.store(told_.pick[i]);
        picks[i]->u.x.store(told_.u[i][0]), picks[i]->u.y.store(told_.u[i][1]);
    }
    const auto rgb = [](const float(&values)[3][laneCount]) { return Rgbw(Float(values[0]), Float(values[1]), Float(values[2])); };
    const Rgbw before = rgb(told_.throughput);
    const Mask alive(paths_.vertex(told_, m.bits(), maxDepth_));
    const auto vec = [](const float* x, const float* y, const float* z) { return Vec3w{Float(x), Float(y), Float(z)}; };
    albedo = select(m, rgb(told_.albedo), albedo);
    normal = select(m, vec(told_.normal[0], told_.normal[1], told_.normal[2]), normal);
    const RayPacket &s = told_.shadow, &n = told_.next;
    if (const Mask lit = m & (Float(s.tfar) >= Float(0.f)); any(lit))
        shadows_.append(lit, vec(s.ox, s.oy, s.oz), vec(s.dx, s.dy, s.dz), Float(s.tfar), p.time, before * rgb(told_.arriving), p.slot,
                        needs_.time);
    p.throughput = select(alive, rgb(told_.throughput), p.throughput);
    p.pdfW = select(alive, Float(told_.pdfW), p.pdfW);
    p.spread = select(alive, Float(told_.spread), p.spread);
    p.hero = select(alive, Float(told_.hero), p.hero);
    p.o = select(alive, vec(n.ox, n.oy, n.oz), p.o);
    p.d = select(alive, vec(n.dx, n.dy, n.dz), p.d);
    p.from = select(alive, vec(told_.fromP[0], told_.fromP[1], told_.fromP[2]), p.from);
    p.fromNg = select(alive, vec(told_.fromNg[0], told_.fromNg[1], told_.fromNg[2]), p.fromNg);
    p.medium = select(alive, Int(told_.medium), p.medium);
    return alive;
}

// What follows once the surfaces are known. plain: no lane has more than a diffuse base, none is alone.
template <bool plain> CHIARO_LANE void PathFollower::shade(PathPacket& p, Mask m, const HitPacket& hits, Vertex& v, bool first) noexcept {
    if constexpr (plain) {
        v.alone = Mask();
        v.lobes.diffuseAlone();
    }
    find(p, m, hits, v);
    face(p, v);
    const Mask more = v.hit & (p.depth < Int(maxDepth_));
    Vec3w normal{Float(0.f), Float(0.f), Float(0.f)};
    if (first) {
        v.albedo = select(v.lanes, v.lobes.albedo(), v.albedo);
        normal = select(v.lanes, v.frame.z, normal);
    }
    const WideSampler sampler(p.keyLow, p.keyHigh, p.sample);
    const bool shallow = none(p.depth >= Int(16u));
    // Together: the processor works on both at once.
    const WidePick uLight = sampler.get3D(mixedAt<startDimensions, 8>(p.depth, shallow), !oneLight_ || any(v.alone));
    const WidePick uBsdf = sampler.get3D(mixedAt<startDimensions + 3, 8>(p.depth, shallow), any(v.alone | v.lobes.others()));
    Mask asks = more & v.lanes & v.lobes.smooth();
    if (fault(Fault::bounceDropped)) asks = asks & (p.depth != Int(1u));
    if (settings_.nee && any(asks)) direct(p, v, asks, uLight);
    Mask alive;
    if (const Mask here = more & v.lanes; any(here)) alive = scatter(p, hits, v, here, uBsdf);
    if (any(v.alone)) alive = alive | alone(p, v, uLight, uBsdf, v.albedo, normal);
    if (first) {
        for (std::size_t c = 0; c < 3; ++c) v.albedo.c[c].store(samples_.albedo[c] + firstSlot_);
        normal.x.store(samples_.normal[0] + firstSlot_);
        normal.y.store(samples_.normal[1] + firstSlot_);
        normal.z.store(samples_.normal[2] + firstSlot_);
    }
    if (const Mask risk = alive & (p.depth >= Int(settings_.rouletteDepth)); any(risk)) {
        const Float survive = min(maxComponent(p.throughput), Float(0.95f));
        alive = andNot(alive, andNot(risk, sampler.get1D(mixedAt<startDimensions + 7, 8>(p.depth, shallow)) < survive));
        if (!fault(Fault::rouletteUnweighted)) p.throughput = select(risk, p.throughput * (Float(1.f) / survive), p.throughput);
    }
    p.depth = p.depth + Int(1u);
    p.append(stream_, kept_, alive, needs_);
    kept_ += count(alive);
    while (shadows_.count >= laneCount) shadows_.flush(hierarchy_, samples_, needs_.time);
}

// One vertex of sixteen paths, whose rays have been traced. What goes on is packed into the stream.
[[gnu::flatten]] void PathFollower::group(PathPacket& p, Mask m, const HitPacket& hits, bool first) noexcept {
    Vertex v;
    v.albedo = Rgbw(Float(0.f));
    v.hit = m & (Int(hits.geometry) != Int(Hit::none));
    if (distantSky_) { // what light samples will read of it comes while the hits are looked at
        const WideSkyTables sky = skyTables(*distantSky_);
        const bool shallow = none(p.depth >= Int(16u));
        const WidePick uLight = WideSampler(p.keyLow, p.keyHigh, p.sample).get3D(mixedAt<startDimensions, 8>(p.depth, shallow));
        const Int cell = skyCell(sky, paths_.lights().edge(), uLight);
        fetchSkyCells(sky, cell, v.hit);
        meet(p, hits, v);
        fetchSkyTexels(sky, cell, uLight.u, v.hit);
    } else {
        meet(p, hits, v);
    }
    if (none(v.alone | (v.lanes & ((v.flags & Int(WideMaterial::lobes)) != Int(0u)))))
        shade<true>(p, m, hits, v, first);
    else
        shade<false>(p, m, hits, v, first);
}

void PathFollower::begin(const StartPacket& start) noexcept {
    PathPacket p;
    p.o = {Float(start.traced.rays.ox), Float(start.traced.rays.oy), Float(start.traced.rays.oz)};
    p.d = {Float(start.traced.rays.dx), Float(start.traced.rays.dy), Float(start.traced.rays.dz)};
    p.from = p.o;
    p.fromNg = p.d;
    p.throughput = Rgbw(Float(1.f));
    p.pdfW = Float(-1.f);
    p.hero = Float(0.f);
    p.time = Float(start.traced.rays.time);
    p.width = Float(pixel_.width), p.spread = Float(pixel_.spread);
    alignas(64) uint32_t slots[laneCount];
    for (uint32_t k = 0; k < laneCount; ++k) slots[k] = start.first + k;
    p.slot = Int(slots);
    p.depth = p.medium = Int(0u);
    p.keyLow = Int(start.keyLow), p.keyHigh = Int(start.keyHigh), p.sample = Int(start.sample);
    firstSlot_ = start.first;
    group(p, firstLanes(start.count), start.traced.hits, true);
}

// The next packet is traced before one is shaded: what shading will read comes meanwhile.
CHIARO_LANE void PathFollower::traceNext(uint32_t at, uint32_t n, TracePacket& to) noexcept {
    PathPacket p;
    p.load(stream_, at, needs_);
    lay(p, to.rays);
    hierarchy_.trace(to, n, false);
    if (manyTriangles_) fetchTriangles(tables_, to.hits);
}

void PathFollower::follow(StartSource& source) noexcept {
    const uint32_t length = paths_.length();
    bool open = true;
    PathPacket p;
    StartPacket start;
    for (uint32_t under = 0; open || under > 0; under = kept_) {
        kept_ = 0;
        // While starts are left, a packet that is not full waits for them.
        const uint32_t end = open ? under & ~(laneCount - 1) : under;
        const auto lanes = [&](uint32_t at) { return end - at < laneCount ? end - at : laneCount; };
        uint32_t turn = 0;
        if (end > 0) traceNext(0, lanes(0), traced_[0]);
        for (uint32_t at = 0; at < end; at += laneCount, turn ^= 1) {
            if (at + laneCount < end) traceNext(at + laneCount, lanes(at + laneCount), traced_[turn ^ 1]);
            p.load(stream_, at, needs_);
            group(p, firstLanes(lanes(at)), traced_[turn].hits, false);
        }
        if (end < under) {
            p.load(stream_, end, needs_);
            p.append(stream_, kept_, firstLanes(under - end), needs_);
            kept_ += under - end;
        }
        while (open && kept_ + laneCount <= length) {
            open = source.next(start);
            if (open) begin(start);
        }
    }
    while (shadows_.count > 0) shadows_.flush(hierarchy_, samples_, needs_.time);
}

} // namespace chiaro::CHIARO_ISA
