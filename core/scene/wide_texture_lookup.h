// Texture look-ups in sixteen lanes: those of Textures (core/scene/texture.h) from the records of WideTextures, to the last bit. Lanes of
// one call read one texture, each at its own level; whoever has several calls once for each. For files compiled for one instruction set
// (core/math/wide_lanes.h).
#pragma once
#include "core/scene/ray_cone.h"
#include "core/scene/texel_math.h"
#include "core/scene/wide_point.h"
#include "core/scene/wide_textures.h"

namespace chiaro::CHIARO_ISA {

// Texture coordinates at the hits of a packet, and how they change along the edges of the triangles.
struct WideUv {
    Vec2w at;
    UvEdges<Float> edges;
};
CHIARO_LANE WideUv uvAt(const WideTextures& textures, const HitPacket& hits, Mask m) noexcept {
    const Int first = gather(textures.firsts(), Int(hits.geometry), m);
    const Mask mapped = m & (first != Int(WideTextures::none));
    alignas(64) uint32_t at[laneCount];
    select(mapped, (first + Int(hits.triangle)) << 3, Int(0u)).store(at);
    Float c[8];
    loadFour(textures.corners(), at, c[0], c[1], c[2], c[3]);
    loadFour(textures.corners() + 4, at, c[4], c[5], c[6], c[7]);
    for (Float& x : c) x = select(mapped, x, Float(0.f));
    const Float u(hits.u), v(hits.v), w = Float(1.f) - u - v;
    return {{c[0] * w + c[2] * u + c[4] * v, c[1] * w + c[3] * u + c[5] * v}, {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}}};
}
// The cones' ellipses on the triangles that were hit.
CHIARO_LANE ConeSectionT<Float> sectionAt(const WideTables& tables, const HitPacket& hits, const Vec3w& d, Float width, Mask m) noexcept {
    const Int first = gather(tables.firsts, Int(hits.geometry), m), instance(hits.instance);
    alignas(64) uint32_t at[laneCount];
    select(m, (first + Int(hits.triangle)) << 4, Int(0u)).store(at);
    WidePoint unused;
    WideCorners c = corners(tables.triangles, at, Float(0.f), Float(0.f), Mask(), unused);
    if (const Mask placed = m & (instance != Int(WideSurfaces::none)); any(placed)) {
        select(placed, instance << 4, Int(0u)).store(at);
        const auto turn = [&](const Vec3w& v, const Float(&r)[3][4]) {
            return Vec3w{r[0][0] * v.x + r[0][1] * v.y + r[0][2] * v.z, r[1][0] * v.x + r[1][1] * v.y + r[1][2] * v.z,
                         r[2][0] * v.x + r[2][1] * v.y + r[2][2] * v.z};
        };
        Float r[3][4];
        for (int i = 0; i < 3; ++i) loadFour(tables.instances + 4 * i, at, r[i][0], r[i][1], r[i][2], r[i][3]);
        c.e1 = select(placed, turn(c.e1, r), c.e1);
        c.e2 = select(placed, turn(c.e2, r), c.e2);
    }
    return coneSection(c.e1, c.e2, d, width * Float(footprintShare));
}
// Per metre, in the world.
CHIARO_LANE Float curvatureAt(const WideTextures& textures, const WideTables& tables, const HitPacket& hits, Mask m) noexcept {
    const Int first = gather(tables.firsts, Int(hits.geometry), m), instance(hits.instance);
    Float curvature = gather(textures.curvatures(), first + Int(hits.triangle), m);
    if (const Mask placed = m & (instance != Int(WideSurfaces::none)); any(placed)) {
        const auto column = [&](uint32_t row) { return gather(tables.instances + 4 * row, instance << 4, placed); };
        curvature = select(placed, curvature / length(Vec3w{column(0), column(1), column(2)}), curvature);
    }
    return curvature;
}

// Texels by their numbers: red, green and blue, decoded.
CHIARO_LANE Rgbw texels(const WideTexture& t, Int number, Mask m) noexcept {
    const auto* const words = reinterpret_cast<const uint32_t*>(t.data);
    if (t.type == PixelType::f32) {
        const auto* const floats = reinterpret_cast<const float*>(t.data);
        if (t.channels <= 2) return Rgbw(gather(floats, t.channels == 2 ? number << 1 : number, m));
        alignas(64) uint32_t at[laneCount];
        select(m, number << 2, Int(0u)).store(at);
        Rgbw c;
        Float unused;
        loadFour(floats, at, c.c[0], c.c[1], c.c[2], unused);
        return c;
    }
    const uint32_t bits = t.type == PixelType::u8 ? 8 : 16;
    const Int code(t.type == PixelType::u8 ? 0xffu : 0xffffu);
    const auto value = [&](Int c) { return t.decoded ? gather(t.decoded, c, m) : toFloat(c) / toFloat(code); };
    if (t.texelBytes == 1) return Rgbw(value((gather(words, number >> 2, m) >> ((number & Int(3u)) << 3)) & code));
    if (t.texelBytes == 2) return Rgbw(value((gather(words, number >> 1, m) >> ((number & Int(1u)) << 4)) & code));
    if (t.texelBytes == 8) {
        const Int low = gather(words, number << 1, m), high = gather(words + 1, number << 1, m);
        return {value(low & code), value(low >> 16), value(high & code)};
    }
    const Int four = gather(words, number, m);
    if (t.channels <= 2) return Rgbw(value(four & code));
    return {value(four & code), value((four >> bits) & code), value((four >> (2 * bits)) & code)};
}

CHIARO_LANE Rgbw bilinear(const WideTexture& t, Int level, const Vec2w& uv, Mask m) noexcept {
    const Int first = lookUp(t.first, level), across = lookUp(t.across, level);
    const TexelQuad<Float> q = texelQuad(uv, lookUp(t.width, level), lookUp(t.height, level), t.wrapS, t.wrapT);
    const auto at = [&](Int x, Int y) { return texels(t, texelNumber(first, across, x, y, t.tileX, t.tileY), m); };
    const Rgbw a = at(q.x0, q.y0), b = at(q.x1, q.y0), c = at(q.x0, q.y1), d = at(q.x1, q.y1);
    Rgbw r;
    for (std::size_t i = 0; i < 3; ++i) r.c[i] = mixed(q, a.c[i], b.c[i], c.c[i], d.c[i]);
    return r;
}
CHIARO_LANE Rgbw nearest(const WideTexture& t, const Vec2w& uv, Mask m) noexcept {
    const Int width(t.width[0]), height(t.height[0]);
    const Float x = tame(uv.x, t.wrapS) * toFloat(width), y = tame(uv.y, t.wrapT) * toFloat(height);
    return texels(t,
                  texelNumber(Int(t.first[0]), Int(t.across[0]), wrapped(truncated(floor(x)), width, t.wrapS),
                              wrapped(truncated(floor(y)), height, t.wrapT), t.tileX, t.tileY),
                  m);
}

// At the sharpness of the picture.
CHIARO_LANE Rgbw textureAt(const WideTexture& t, const WideUv& uv, Mask m) noexcept {
    const auto& f = t.transform;
    const Vec2w at{uv.at.x * Float(f[0][0]) + uv.at.y * Float(f[0][1]) + Float(f[0][2]),
                   uv.at.x * Float(f[1][0]) + uv.at.y * Float(f[1][1]) + Float(f[1][2])};
    return t.nearest ? nearest(t, at, m) : bilinear(t, Int(0u), at, m);
}
// The mean over the probes of ellipses. Few lanes ask, and of these few for many probes: the probes of all are looked up eight at a time,
// in the first eight lanes at the one level, in the others at the next; a lane's own are added in their order.
CHIARO_LANE Rgbw overProbes(const WideTexture& t, const Vec2w& centre, const TexelEllipse<Float>& e, const LevelPair<Float>& pair,
                            Mask m) noexcept {
    alignas(64) float x[laneCount], y[laneCount], stepX[laneCount], stepY[laneCount], share[laneCount];
    alignas(64) uint32_t level[laneCount];
    const Float first = Float(0.5f) - Float(0.5f) * e.probes;
    centre.x.store(x), centre.y.store(y), e.step.x.store(stepX), e.step.y.store(stepY), pair.share.store(share), pair.level.store(level);
    alignas(64) float number[laneCount], begin[laneCount], sums[laneCount][4] = {};
    e.probes.store(number), first.store(begin);
    constexpr auto most = uint32_t(mostProbes);
    alignas(64) uint32_t lane[laneCount / 8 * most][laneCount]; // eight probes in a row, twice: whose, and where along the ellipse
    alignas(64) float place[laneCount / 8 * most][laneCount];
    uint32_t probes = 0;
    const auto put = [&](uint32_t at, uint32_t k, float along) {
        lane[at / 8][at % 8] = lane[at / 8][at % 8 + 8] = k;
        place[at / 8][at % 8] = place[at / 8][at % 8 + 8] = along;
    };
    for (uint32_t bits = m.bits(); bits; bits &= bits - 1) {
        const auto k = uint32_t(__builtin_ctz(bits));
        const uint32_t own = number[k] < mostProbes ? uint32_t(number[k]) : most;
        for (uint32_t i = 0; i < own; ++i) put(probes++, k, begin[k] + float(i));
    }
    for (uint32_t end = probes; end % 8 != 0; ++end) put(end, 0, 0); // the rest of the row is not looked up
    const Mask lower(0xffu), upper(0xff00u);
    for (uint32_t at = 0; at < probes; at += 8) {
        const Int of(lane[at / 8]);
        const Float along(place[at / 8]), s = lookUp(share, of);
        const Vec2w uv{lookUp(x, of) + lookUp(stepX, of) * along, lookUp(y, of) + lookUp(stepY, of) * along};
        const uint32_t here = probes - at < 8 ? (1u << (probes - at)) - 1 : 0xffu;
        const Mask some(here | here << 8), blended = some & (s > Float(0.f));
        const Rgbw v = bilinear(t, lookUp(level, of) + select(upper, Int(1u), Int(0u)), uv, (some & lower) | (blended & upper));
        Rgbw both;
        for (std::size_t i = 0; i < 3; ++i) both.c[i] = select(blended, v.c[i] * (Float(1.f) - s) + upperEight(v.c[i]) * s, v.c[i]);
        addTo(sums, lane[at / 8], some & lower, both.c[0], both.c[1], both.c[2]);
    }
    alignas(64) static constexpr uint32_t row[laneCount] = {0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60};
    alignas(64) uint32_t rows[laneCount];
    Int(row).store(rows);
    asm("" : "+m"(sums)); // written above, read below through pointers
    Rgbw sum;
    Float unused;
    loadFour(sums[0], rows, sum.c[0], sum.c[1], sum.c[2], unused);
    return sum * (Float(1.f) / e.probes);
}
// Over the cones' ellipses.
CHIARO_LANE Rgbw textureAt(const WideTexture& t, const WideUv& uv, const ConeSectionT<Float>& cone, Mask m) noexcept {
    if (t.nearest || t.last == 0) return textureAt(t, uv, m);
    const auto& f = t.transform;
    const TexelEllipse<Float> e =
        texelEllipse(uv.edges.step(cone.major, f), uv.edges.step(cone.minor, f), Float(float(t.width[0])), Float(float(t.height[0])));
    const LevelPair<Float> pair = levelsOf(e.width, t.last);
    const Mask two = m & (pair.share > Float(0.f)), sharp = m & (pair.level == Int(0u)) & (e.probes == Float(1.f));
    if (none(andNot(m, sharp) | two)) return textureAt(t, uv, m);
    const Vec2w centre{uv.at.x * Float(f[0][0]) + uv.at.y * Float(f[0][1]) + Float(f[0][2]),
                       uv.at.x * Float(f[1][0]) + uv.at.y * Float(f[1][1]) + Float(f[1][2])};
    return overProbes(t, centre, e, pair, m);
}

} // namespace chiaro::CHIARO_ISA
