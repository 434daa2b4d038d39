// The loop of WidePaths for one instruction set: Path::radiance (integrators/path.cpp) in lanes, step by step.
#pragma once
#include "integrators/wide/path_meet.h"
#include <cstddef>

namespace chiaro::CHIARO_ISA {

// Light that the rays have found: emitters where they hit, the sky where they did not.
template <bool classed> void PathFollower::find(PathPacket& p, Mask m, const HitPacket& hits, Vertex& v) noexcept {
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
        const Int record = v.at.light << 4;
        const Float density = inverseArea(gather(lights.records() + 9, record, found)), pmf = gather(lights.records() + 10, record, found);
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
    if constexpr (!classed) return add(p.slot, found, p.throughput * light * weight);
    const Int layer = v.states.layer(select(sky, Int(WideStates::environment), Int(WideStates::area)));
    add(sum(p.slot, layer), found & (layer != Int(0u)), p.throughput * light * weight);
}

// Where the sum of a slot and a wanted layer is.
CHIARO_LANE Int PathFollower::sum(Int slots, Int layers) const noexcept {
    return samples_.layers == 1 ? slots : slots * Int(samples_.layers) + layers - Int(1u);
}

// Shadow rays of paths with states: what they bring goes to the layers of its classes, to two sums where these differ.
CHIARO_LANE void PathFollower::bring(const PathPacket& p, Mask m, const Vec3w& o, const Vec3w& d, Float tfar,
                                     const Parted& light) noexcept {
    const Mask diffuse = m & (light.diffuseLayer != Int(0u)) & notBlack(light.diffuse),
               glossy = m & (light.glossyLayer != Int(0u)) & notBlack(light.glossy), lit = diffuse | glossy;
    if (none(lit)) return;
    const Mask both = diffuse & glossy, parted = both & (light.diffuseLayer != light.glossyLayer) & Mask(shadows_.two ? 0xffffu : 0u);
    const Int to = sum(p.slot, select(diffuse, light.diffuseLayer, light.glossyLayer));
    const Rgbw first = select(andNot(both, parted), light.diffuse + light.glossy, select(diffuse, light.diffuse, light.glossy));
    const uint32_t at = shadows_.append(lit, o, d, tfar, p.time, first, to, needs_.time);
    if (!shadows_.two) return;
    shadows_.appendSecond(at, lit, select(parted, light.glossy, Rgbw(Float(0.f))), select(parted, sum(p.slot, light.glossyLayer), to));
}

// Next-event estimation: shadow rays to one light each.
template <bool classed> void PathFollower::direct(PathPacket& p, const Vertex& v, Mask m, const WidePick& pick) noexcept {
    const WideLightSample s = sampleTowards(paths_.lights(), v.at, p.time, m, pick);
    const Vec3w wi = v.frame.toLocal(s.wi);
    Rgbw glossy;
    const WideLobeValue value = v.lobes.evaluate(wi, classed ? &glossy : nullptr);
    Mask lit = m & s.arrives & (value.pdfW > Float(0.f)) & (dot(s.wi, v.ng) > Float(0.f));
    if constexpr (!classed) lit = lit & notBlack(value.f);
    if (none(lit)) return;
    const Float other = settings_.mis ? select(s.delta, Float(0.f), value.pdfW) : Float(0.f);
    const Float cosine = fault(Fault::receiverCosineMissing) ? Float(1.f) : abs(wi.z);
    const Float factor = cosine * weightOverPdf(s.pdfW, other);
    const Rgbw brings = p.throughput * value.f * s.radiance * factor;
    if constexpr (classed) {
        // Only the sky is so far away and no delta light.
        const Int far = select(s.tfar == Float(infinity), Int(WideStates::environment), Int(WideStates::area));
        const Int kind = select(s.delta, Int(WideStates::delta), far);
        const Int diffuseLayer = WideStates::layer(rows_, WideStates::reflected(v.states.diffuse), kind, lit);
        const Mask sorted = lit & v.states.are(WideClass::sorts) & v.lobes.glossy;
        const Int glossyLayer =
            any(sorted) ? select(sorted, WideStates::layer(rows_, WideStates::reflected(v.states.glossy), kind, sorted), diffuseLayer)
                        : diffuseLayer;
        return bring(p, lit, s.o, s.d, s.tfar, {brings, p.throughput * glossy * s.radiance * factor, diffuseLayer, glossyLayer});
    }
    shadows_.append(lit, s.o, s.d, s.tfar, p.time, brings, p.slot, needs_.time);
}

// Where classes still matter, the one of an event is drawn as by turn() of integrators/transport.h. f: the light of both, or of the one
// that was drawn, over its probability. next: the states that follow. The lanes that end, since no such path is wanted.
CHIARO_LANE Mask PathFollower::turn(const WideStates& states, Mask sorted, const Rgbw& diffuse, const Rgbw& glossy, Float uClass, Rgbw& f,
                                    Int& next) noexcept {
    const Rgbw both = diffuse + glossy;
    if (none(sorted)) {
        f = both;
        return Mask();
    }
    const Int nextDiffuse = WideStates::reflected(states.diffuse), nextGlossy = WideStates::reflected(states.glossy);
    const Float shareDiffuse = select(nextDiffuse != Int(0u), luminance(diffuse), Float(0.f)),
                shareGlossy = select(nextGlossy != Int(0u), luminance(glossy), Float(0.f)), shares = shareDiffuse + shareGlossy;
    const Mask first = uClass * shares < shareDiffuse;
    const Rgbw drawn = select(first, diffuse, glossy) * (shares / select(first, shareDiffuse, shareGlossy));
    f = select(sorted, drawn, both);
    next = select(sorted, select(first, nextDiffuse, nextGlossy), next);
    return andNot(sorted, shares > Float(0.f));
}

// The next rays; the lanes that have one.
template <bool classed>
Mask PathFollower::scatter(PathPacket& p, const HitPacket& hits, const Vertex& v, Mask m, const WidePick& pick, Float uClass) noexcept {
    // As float(double(bits) 2^-32) rounds, but never to 1.
    const Float uLobe = min(wholeToFloat(pick.pick) * Float(0x1p-32f), Float(oneMinusEpsilon));
    const WideLobeSample s = v.lobes.sample(uLobe, pick.u);
    const Vec3w wi = toWorld(v.frame, s.wi);
    const Float side = dot(wi, v.ng);
    Mask alive = m & s.drawn & select(s.wi.z > Float(0.f), side > Float(0.f), side < Float(0.f));
    // Of a diffuse base alone: the cosine and its density cancel out.
    Rgbw weight = v.lobes.diffuseColor * Float(fault(Fault::diffuseBias) ? 1.01f : 1.f);
    Float pdfW = cosineHemispherePdfW(s.wi.z);
    Int next(0u);
    if constexpr (classed) next = WideStates::reflected(v.states.diffuse);
    if (const Mask others = m & v.lobes.others(); any(others)) {
        Rgbw glossy;
        WideLobeValue value = v.lobes.evaluate(s.wi, classed ? &glossy : nullptr);
        if constexpr (classed) {
            const Mask sorted = andNot(others & v.states.are(WideClass::sorts), s.delta);
            alive = andNot(alive, turn(v.states, sorted, value.f, glossy, uClass, value.f, next));
        }
        weight = select(others, value.f * (abs(s.wi.z) / value.pdfW), weight);
        pdfW = select(others, value.pdfW, pdfW);
    }
    alive = alive & (s.delta | (pdfW > Float(0.f)));
    if (any(s.delta)) weight = select(s.delta, s.weight * (Float(1.f) / s.pmf), weight);
    alive = alive & notBlack(weight);
    if constexpr (classed) {
        if (any(s.delta)) {
            const Int states = v.states.specular;
            next = select(s.delta, select(s.transmitted, WideStates::transmitted(states), WideStates::reflected(states)), next);
        }
        alive = alive & (next != Int(0u));
        p.state = next;
    }
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
template <bool classed>
Mask PathFollower::alone(PathPacket& p, const Vertex& v, const WidePick& uLight, const WidePick& uBsdf, Float uClass, Rgbw& albedo,
                         Vec3w& normal) noexcept {
    const Mask m = v.alone;
    const WidePick* const picks[] = {&uLight, &uBsdf};
    for (int i = 0; i < 2; ++i) {
        picks[i]->pick.store(told_.pick[i]);
        picks[i]->u.x.store(told_.u[i][0]), picks[i]->u.y.store(told_.u[i][1]);
    }
    if constexpr (classed) uClass.store(told_.uClass);
    const auto rgb = [](const float(&values)[3][laneCount]) { return Rgbw(Float(values[0]), Float(values[1]), Float(values[2])); };
    const Rgbw before = rgb(told_.throughput);
    const Mask alive(paths_.vertex(told_, m.bits(), wanted_));
    const auto vec = [](const float* x, const float* y, const float* z) { return Vec3w{Float(x), Float(y), Float(z)}; };
    albedo = select(m, rgb(told_.albedo), albedo);
    normal = select(m, vec(told_.normal[0], told_.normal[1], told_.normal[2]), normal);
    const RayPacket &s = told_.shadow, &n = told_.next;
    if (const Mask lit = m & (Float(s.tfar) >= Float(0.f)); any(lit)) {
        const Vec3w from = vec(s.ox, s.oy, s.oz), way = vec(s.dx, s.dy, s.dz);
        const Rgbw brings = before * rgb(told_.arriving[0]);
        if constexpr (classed)
            bring(p, lit, from, way, Float(s.tfar), {brings, before * rgb(told_.arriving[1]), Int(told_.layer[0]), Int(told_.layer[1])});
        else
            shadows_.append(lit, from, way, Float(s.tfar), p.time, brings, p.slot, needs_.time);
    }
    if constexpr (classed) p.state = select(alive, Int(told_.state), p.state);
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

// squaredIndexInside() of the materials whose inside the rays cross.
CHIARO_LANE Float PathFollower::squaredIndex(Int medium, Mask m) const noexcept {
    static_assert(sizeof(WideMaterial) == 32 * sizeof(float));
    const Int material = (medium & Int(~VertexLanes::absorbs)) - Int(1u);
    return gather(materials_ + offsetof(WideMaterial, squaredIndex) / sizeof(float), material << 5, m);
}

// What follows once the surfaces are known. plain: no lane has more than a diffuse base, none is alone.
template <bool plain, bool classed>
CHIARO_LANE void PathFollower::shade(PathPacket& p, Mask m, const HitPacket& hits, Vertex& v, bool first) noexcept {
    if constexpr (plain) {
        v.alone = Mask();
        v.lobes.diffuseAlone();
    }
    Mask more = v.hit;
    if constexpr (classed) {
        v.states.load(rows_, p.state, m);
        more = more & v.states.are(WideClass::continues);
    } else {
        more = more & (p.depth < Int(maxDepth_));
    }
    find<classed>(p, m, hits, v);
    if (classed && !first && none(more)) return; // nothing is wanted but what has been found
    face(p, v);
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
    Float uClass(0.f);
    Mask asks = more & v.lanes & v.lobes.smooth();
    if constexpr (classed) {
        asks = asks & v.states.are(WideClass::connects);
        if (any(more & v.states.are(WideClass::sorts) & (v.alone | v.lobes.others())))
            uClass = sampler.get1D(mixedAt<startDimensions + 6, 8>(p.depth, shallow));
    }
    if (fault(Fault::bounceDropped)) asks = asks & (p.depth != Int(1u));
    if (settings_.nee && any(asks)) direct<classed>(p, v, asks, uLight);
    Mask alive;
    if (const Mask here = more & v.lanes; any(here)) alive = scatter<classed>(p, hits, v, here, uBsdf, uClass);
    if (any(v.alone)) alive = alive | alone<classed>(p, v, uLight, uBsdf, uClass, v.albedo, normal);
    if (first) {
        for (std::size_t c = 0; c < 3; ++c) v.albedo.c[c].store(samples_.albedo[c] + firstSlot_);
        normal.x.store(samples_.normal[0] + firstSlot_);
        normal.y.store(samples_.normal[1] + firstSlot_);
        normal.z.store(samples_.normal[2] + firstSlot_);
    }
    if (const Mask risk = alive & (p.depth >= Int(settings_.rouletteDepth)); any(risk)) {
        Float carried = maxComponent(p.throughput);
        if (const Mask inside = risk & (p.medium != Int(0u)); any(inside))
            carried = select(inside, carried * squaredIndex(p.medium, inside), carried);
        const Float survive = min(carried, Float(0.95f));
        alive = andNot(alive, andNot(risk, sampler.get1D(mixedAt<startDimensions + 7, 8>(p.depth, shallow)) < survive));
        if (!fault(Fault::rouletteUnweighted)) p.throughput = select(risk, p.throughput * (Float(1.f) / survive), p.throughput);
    }
    p.depth = p.depth + Int(1u);
    p.append(stream_, kept_, alive, needs_);
    kept_ += count(alive);
    while (shadows_.count >= laneCount) shadows_.flush(hierarchy_, samples_, needs_.time);
}

// One vertex of sixteen paths, whose rays have been traced. What goes on is packed into the stream.
template <bool classed> [[gnu::flatten]] void PathFollower::group(PathPacket& p, Mask m, const HitPacket& hits, bool first) noexcept {
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
        shade<true, classed>(p, m, hits, v, first);
    else
        shade<false, classed>(p, m, hits, v, first);
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
    p.state = Int(uint32_t(eye_));
    p.keyLow = Int(start.keyLow), p.keyHigh = Int(start.keyHigh), p.sample = Int(start.sample);
    firstSlot_ = start.first;
    needs_.state ? group<true>(p, firstLanes(start.count), start.traced.hits, true)
                 : group<false>(p, firstLanes(start.count), start.traced.hits, true);
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
            needs_.state ? group<true>(p, firstLanes(lanes(at)), traced_[turn].hits, false)
                         : group<false>(p, firstLanes(lanes(at)), traced_[turn].hits, false);
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
