// Surface points of sixteen hits at once: Scene::point() over lanes, from the tables of WideSurfaces. Positions, geometric normals and
// error bounds are Scene::point()'s to the last bit; interpolated normals go through 24 bits a number. For files compiled for one
// instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "core/scene/ray_packet.h"
#include "core/scene/surface_math.h"
#include "core/scene/wide_surfaces.h"

namespace chiaro::CHIARO_ISA {

struct WidePoint {
    Vec3w p, ng, ns;
    Float error;         // of the position, metres
    Int material, light; // light: ~0u none, WideSurfaces::askLight: not known here
    Mask smooth;         // ns is not simply ng
};

struct WideTables { // of WideSurfaces
    const uint32_t* firsts;
    const float* triangles;
    const float* instances;              // null: there are none
    const uint32_t (*few)[16] = nullptr; // firsts again, where there are no more than sixteen
};

CHIARO_LANE Vec3w octahedral(Int x, Int y) noexcept {
    const Float scale(2 / WideSurfaces::normalSteps), one(1.f);
    Vec3w v{toFloat(x) * scale - one, toFloat(y) * scale - one, Float(0.f)};
    v.z = one - abs(v.x) - abs(v.y);
    const Float below = max(-v.z, Float(0.f));
    v.x = v.x - copysign(below, v.x);
    v.y = v.y - copysign(below, v.y);
    return normalize(v);
}
CHIARO_LANE Vec3w unitOr(const Vec3w& v, const Vec3w& otherwise) noexcept {
    const Float l = lengthSquared(v);
    const Mask good = (l > Float(0.f)) & (l < Float(std::numeric_limits<float>::infinity()));
    return select(good, v * inverseSqrt(l), otherwise);
}
// As SurfacePoint's: where a ray begins that leaves along w.
CHIARO_LANE Vec3w offset(const Vec3w& p, const Vec3w& ng, Float error, const Vec3w& w) noexcept {
    const Float reach = fault(Fault::offsetAbsolute) ? Float(1e-4f) : error * (abs(ng.x) + abs(ng.y) + abs(ng.z));
    return mulAdd(ng, copysign(reach, dot(w, ng)), p);
}

struct WideCorners {
    Vec3w a, e1, e2, ns; // ns: before its length is made one
    Mask smooth;
};
CHIARO_LANE WideCorners corners(const float* triangles, const uint32_t* at, Float u, Float v, Mask m, WidePoint& to) noexcept {
    Float w[12];
    loadFour(triangles, at, w[0], w[1], w[2], w[3]);
    loadFour(triangles + 4, at, w[4], w[5], w[6], w[7]);
    Float normal0;
    loadFour(triangles + 8, at, w[8], w[9], w[10], normal0);
    WideCorners c;
    c.a = {w[0], w[1], w[2]};
    c.e1 = Vec3w{w[3], w[4], w[5]} - c.a;
    c.e2 = Vec3w{w[6], w[7], w[8]} - c.a;
    to.error = max(maxAbs(c.a), max(maxAbs(Vec3w{w[3], w[4], w[5]}), maxAbs(Vec3w{w[6], w[7], w[8]}))); // for the moment: magnitude
    const Int material = floatAsBits(w[9]);
    to.material = material & Int(~WideSurfaces::smoothBit);
    to.light = floatAsBits(w[10]);
    c.smooth = m & ((material & Int(WideSurfaces::smoothBit)) != Int(0u));
    c.ns = {Float(0.f), Float(0.f), Float(1.f)};
    if (none(c.smooth)) return c;
    Float n1, n2, n3, n4;
    loadFour(triangles + 12, at, n1, n2, n3, n4);
    const Int q0 = floatAsBits(normal0), q1 = floatAsBits(n1), q2 = floatAsBits(n2), low(0xffffffu);
    const Int third = (q0 >> 24) | ((q1 >> 24) << 8) | ((q2 >> 24) << 16);
    const Vec3w na = octahedral(q0 & low, q1 & low), nb = octahedral(q2 & low, floatAsBits(n3) & low),
                nc = octahedral(third, floatAsBits(n4) & low);
    c.ns = mulAdd(nc, v, mulAdd(nb, u, na * (Float(1.f) - u - v)));
    return c;
}

// Into the world, for the lanes that an instance holds; to.error: as in corners().
CHIARO_LANE void place(const float* instances, const uint32_t* at, Mask m, WideCorners& c, WidePoint& to) noexcept {
    Float r[3][4], side, unused;
    for (int i = 0; i < 3; ++i) loadFour(instances + 4 * i, at, r[i][0], r[i][1], r[i][2], r[i][3]);
    loadFour(instances + 12, at, side, unused, unused, unused);
    const Vec3w r0{r[0][0], r[0][1], r[0][2]}, r1{r[1][0], r[1][1], r[1][2]}, r2{r[2][0], r[2][1], r[2][2]};
    const Vec3w x0 = cross(r1, r2), x1 = cross(r2, r0), x2 = cross(r0, r1);
    const auto vector = [&](const Vec3w& v) {
        return Vec3w{r0.x * v.x + r0.y * v.y + r0.z * v.z, r1.x * v.x + r1.y * v.y + r1.z * v.z, r2.x * v.x + r2.y * v.y + r2.z * v.z};
    };
    const auto point = [&](const Vec3w& p) {
        return Vec3w{r0.x * p.x + r0.y * p.y + r0.z * p.z + r[0][3], r1.x * p.x + r1.y * p.y + r1.z * p.z + r[1][3],
                     r2.x * p.x + r2.y * p.y + r2.z * p.z + r[2][3]};
    };
    const auto normal = [&](const Vec3w& n) { return Vec3w{dot(x0, n), dot(x1, n), dot(x2, n)} * side; };
    to.p = select(m, point(to.p), to.p);
    to.ng = select(m, normal(to.ng), to.ng);
    c.ns = select(m, normal(c.ns), c.ns);
    c.e1 = select(m, vector(c.e1), c.e1);
    c.e2 = select(m, vector(c.e2), c.e2);
    Float world(0.f);
    for (auto& row : r) world = max(world, (abs(row[0]) + abs(row[1]) + abs(row[2])) * to.error + abs(row[3]));
    to.error = select(m, world, to.error);
}

// The records of hits, on their way.
CHIARO_LANE void fetchTriangles(const WideTables& tables, const HitPacket& hits) noexcept {
    for (uint32_t k = 0; k < laneCount; ++k) {
        if (hits.geometry[k] == Hit::none) continue;
        const uint32_t first = tables.firsts[hits.geometry[k]];
        if (first != WideSurfaces::none) __builtin_prefetch(tables.triangles + (std::size_t(first + hits.triangle[k]) << 4));
    }
}

// Which of the hits in m are in the tables; their points. The other lanes hold nothing of use.
CHIARO_LANE Mask widePoint(const WideTables& tables, const HitPacket& hits, Mask m, WidePoint& to) noexcept {
    const Int geometry(hits.geometry), instance(hits.instance);
    const Int first = tables.few ? lookUp(*tables.few, geometry) : gather(tables.firsts, geometry, m);
    Mask known = m & (first != Int(WideSurfaces::none));
    alignas(64) uint32_t at[laneCount];
    select(known, (first + Int(hits.triangle)) << 4, Int(0u)).store(at);
    const Float u(hits.u), v(hits.v);
    WideCorners c = corners(tables.triangles, at, u, v, known, to);
    to.p = mulAdd(c.e2, v, mulAdd(c.e1, u, c.a));
    to.ng = cross(c.e1, c.e2);
    if (const Mask inInstance = known & (instance != Int(WideSurfaces::none)); any(inInstance)) {
        select(inInstance, instance << 4, Int(0u)).store(at);
        place(tables.instances, at, inInstance, c, to);
        const Float moves = gather(tables.instances + 13, instance << 4, inInstance);
        known = andNot(known, inInstance & (moves != Float(0.f)));
    }
    to.error = to.error * Float(gamma8);
    // At an edge? First by squares, with room for rounding: no root, no quotient.
    const Float shortest = min(u, min(v, Float(1.f) - u - v)),
                sides = lengthSquared(c.e1) + lengthSquared(c.e2); // twice that is at least the longest side, squared
    const Mask near =
        known & ((shortest <= Float(0.f)) | (sqr(shortest) * lengthSquared(to.ng) < Float(8.2f) * (to.error * to.error) * sides));
    if (any(near)) {
        const Float longest = max(lengthSquared(c.e1), max(lengthSquared(c.e2), lengthSquared(c.e2 - c.e1)));
        const Float height = length(to.ng) / sqrt(longest);
        const Mask edge = near & (shortest * height < Float(2.f) * to.error);
        const Vec3w way = c.e1 * (Float(1 / 3.f) - u) + c.e2 * (Float(1 / 3.f) - v);
        const Float far = length(way), share = min(Float(1.f), Float(6.f) * to.error / height);
        const Vec3w pulled = to.p + way * min(share, Float(4.f) * to.error / far);
        to.p = select(edge & (far > Float(0.f)), pulled, to.p);
    }
    to.ng = unitOr(to.ng, {Float(0.f), Float(0.f), Float(1.f)});
    to.ns = to.ng;
    to.smooth = c.smooth;
    if (none(c.smooth)) return known;
    to.ns = select(c.smooth, unitOr(c.ns, to.ng), to.ng);
    to.ns = select(dot(to.ns, to.ng) < Float(0.f), -to.ns, to.ns);
    return known;
}

} // namespace chiaro::CHIARO_ISA
