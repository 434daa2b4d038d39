// What paths in lanes have met (WidePaths): points, materials, textures, insides of solids, frames, and the cones of the rays that go on.
#pragma once
#include "integrators/wide/path_follower.h"

namespace chiaro::CHIARO_ISA {

// The ray's packet as Embree takes it.
CHIARO_LANE void PathFollower::lay(const PathPacket& p, RayPacket& rays) noexcept {
    p.o.x.store(rays.ox), p.o.y.store(rays.oy), p.o.z.store(rays.oz);
    p.d.x.store(rays.dx), p.d.y.store(rays.dy), p.d.z.store(rays.dz);
    Float(0.f).store(rays.tnear), Float(infinity).store(rays.tfar), p.time.store(rays.time);
}
CHIARO_LANE void PathFollower::add(Int sums, Mask m, const Rgbw& light) noexcept {
    alignas(64) uint32_t at[laneCount];
    sums.store(at);
    addTo(samples_.found, at, m, light.c[0], light.c[1], light.c[2]);
}
void PathFollower::tell(const PathPacket& p, const HitPacket& hits) noexcept {
    lay(p, told_.rays);
    told_.hits = hits;
    int k = 0;
    for (const Float& v : {p.from.x, p.from.y, p.from.z}) v.store(told_.fromP[k++]);
    k = 0;
    for (const Float& v : {p.fromNg.x, p.fromNg.y, p.fromNg.z}) v.store(told_.fromNg[k++]);
    for (std::size_t c = 0; c < 3; ++c) p.throughput.c[c].store(told_.throughput[c]);
    p.pdfW.store(told_.pdfW), p.depth.store(told_.depth), p.medium.store(told_.medium);
    p.width.store(told_.width), p.spread.store(told_.spread), p.hero.store(told_.hero), p.state.store(told_.state);
}

// Points and materials; what the inside of a solid lets through.
void PathFollower::meet(PathPacket& p, const HitPacket& hits, Vertex& v) noexcept {
    const Mask known = widePoint(tables_, hits, v.hit, v.at);
    alignas(64) uint32_t record[laneCount];
    select(known, v.at.material << 5, Int(0u)).store(record);
    v.flags = v.lobes.load(materials_, paths_.materials().columns(), record, known);
    const auto has = [&](uint32_t flag) { return known & ((v.flags & Int(flag)) != Int(0u)); };
    v.alone = andNot(v.hit, known) | has(WideMaterial::scalar);
    v.lanes = andNot(known, v.alone);
    v.lobes.lanes = v.lanes;
    Float column(0.f);
    v.emission = Rgbw(Float(0.f));
    if (any(has(WideMaterial::emits | WideMaterial::lobes)))
        loadFour(materials_ + 16, record, v.emission.c[0], v.emission.c[1], v.emission.c[2], column);
    v.column = floatAsBits(column);
    const Mask absorbed = v.hit & (((p.medium & Int(VertexLanes::absorbs)) != Int(0u)) | v.alone |
                                   ((p.medium == Int(0u)) & has(WideMaterial::absorbs) & (dot(v.at.ng, p.d) > Float(0.f))));
    if (needs_.cone) { // Footprint::at()
        const Float width = p.width + p.spread * Float(hits.t);
        const Mask crossed = width < Float(0.f);
        p.width = select(crossed, -width, width);
        p.spread = select(crossed, -p.spread, p.spread);
    }
    const Mask textured = v.lanes & has(WideMaterial::textured);
    if (any(absorbed)) {
        tell(p, hits);
        paths_.attenuate(told_, absorbed.bits());
        for (std::size_t c = 0; c < 3; ++c) p.throughput.c[c] = Float(told_.throughput[c]);
    }
    if (any(textured)) read(p, hits, textured, v);
}

// The base colours of textured materials, one texture after the other.
void PathFollower::read(const PathPacket& p, const HitPacket& hits, Mask m, Vertex& v) noexcept {
    const WideUv uv = uvAt(paths_.textures(), hits, m);
    ConeSectionT<Float> cone;
    if (needs_.cone) cone = sectionAt(tables_, hits, p.d, p.width, m);
    alignas(64) uint32_t material[laneCount];
    v.at.material.store(material);
    Mask asked;
    for (Mask left = m; any(left);) {
        const uint32_t id = material[__builtin_ctz(left.bits())];
        const Mask here = left & (v.at.material == Int(id));
        left = andNot(left, here);
        const WideTexture& t = paths_.textures().of(id);
        if (t.alone) {
            asked = asked | here;
            continue;
        }
        const Rgbw texel = needs_.cone ? textureAt(t, uv, cone, here) : textureAt(t, uv, here);
        for (std::size_t c = 0; c < 3; ++c)
            v.lobes.baseColor.c[c] = select(here, clamp01(v.lobes.baseColor.c[c] * texel.c[c]), v.lobes.baseColor.c[c]);
    }
    if (none(asked)) return;
    tell(p, hits);
    paths_.texture(told_, asked.bits());
    for (std::size_t c = 0; c < 3; ++c) v.lobes.baseColor.c[c] = select(asked, Float(told_.baseColor[c]), v.lobes.baseColor.c[c]);
}

// The cones of the next rays: scattered() of core/scene/ray_cone.h.
void PathFollower::widen(PathPacket& p, const HitPacket& hits, const Vertex& v, Mask m, const WideLobeSample& s) noexcept {
    Float spread = max(p.spread, lobeSpread(p.pdfW));
    if (const Mask delta = m & s.delta; any(delta)) {
        const Mask bent = delta & andNot(Mask(0xffffu), s.transmitted & v.lobes.straight);
        const Float curvature = curvatureAt(paths_.textures(), tables_, hits, bent);
        const Float bend = select(v.outside, curvature, -curvature) * p.width;
        const Float eta = select(v.outside, v.lobes.ior, Float(1.f) / v.lobes.ior);
        spread = select(delta, select(s.transmitted, refractedSpread(p.spread, bend, eta), mirroredSpread(p.spread, bend)), spread);
        spread = select(andNot(delta, bent), p.spread, spread);
    }
    p.spread = select(m, spread, p.spread);
}

// The closures, seen from where the paths come.
void PathFollower::face(PathPacket& p, Vertex& v) noexcept {
    const Vec3w wo = -p.d;
    v.outside = fault(Fault::backNormalKept) ? Mask(0xffffu) : dot(v.at.ng, wo) >= Float(0.f);
    v.ng = select(v.outside, v.at.ng, -v.at.ng);
    Vec3w n = v.ng;
    if (any(v.at.smooth)) {
        n = select(v.outside, v.at.ns, -v.at.ns);
        // A shading normal that wo does not see is turned towards it, as little as needed (Bsdf).
        const Float have = dot(n, wo), need = min(Float(0.01f), dot(v.ng, wo));
        const Mask same = (n.x == v.ng.x) & (n.y == v.ng.y) & (n.z == v.ng.z), hidden = v.lanes & andNot(have < need, same);
        if (any(hidden)) {
            const Vec3w across = n - wo * have;
            const Float l = length(across);
            const Vec3w turned = normalize(across * (sqrt(Float(1.f) - need * need) / l) + wo * need);
            n = select(hidden, select(l > Float(1e-6f), turned, v.ng), n);
        }
    }
    v.frame = frameAbout(n);
    v.wo = wo;
    v.lobes.look(v.frame.toLocal(wo), v.outside, v.column);
}

} // namespace chiaro::CHIARO_ISA
