// LightTree::choose() for sixteen points at once. What costs is weighing the eight children of a node: while all points are at one node,
// at the root at least, sixteen points are weighed against a child; below it two points against the eight children of theirs each. The
// choice among the weights is then made for all points together. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "core/scene/light_tree_view.h"
#include <cstddef>

namespace chiaro::CHIARO_ISA {

struct WideTreePick {
    Int light; // LightTree::none: nothing here can reach the point
    Float pmf;
};

// A child, or eight: the members of LightTree::Node in their order, but for the last.
struct WideTreeChild {
    Float x, y, z, radius, axisX, axisY, axisZ, cosSpread, sinSpread, cosReach, intensity;
};
CHIARO_LANE Float rootOf(Float x) noexcept { return x * inverseSqrt(max(x, Float(1e-36f))); }
// weigh() of light_tree.cpp; roots to two units in the last place.
CHIARO_LANE Float weigh(const WideTreeChild& n, const Vec3w& p, const Vec3w& normal) noexcept {
    const Float slack(0x1p-10f), zero(0.f), one(1.f);
    const Vec3w d{n.x - p.x, n.y - p.y, n.z - p.z}, axis{n.axisX, n.axisY, n.axisZ};
    const Float r2 = n.radius * n.radius, d2 = lengthSquared(d), over = one / max(d2, r2 * Float(0.25f));
    const Mask inside = d2 <= r2;
    const Float ball = rootOf(max(d2 - r2, zero));
    const Float along = -dot(d, axis), facing = select(n.intensity < zero, abs(along), along);
    const Float across = rootOf(max(subMul(d2, facing, facing), zero));
    const Float cosFace = mulAdd(across, n.sinSpread, facing * n.cosSpread), sinFace = mulSub(across, n.cosSpread, facing * n.sinSpread);
    const Mask faces = inside | (sinFace <= zero) | (sinFace * ball <= cosFace * n.radius);
    const Float cosLight = select(faces, one, mulAdd(cosFace, ball, sinFace * n.radius) * over);
    const Float up = abs(dot(d, normal)), beside = rootOf(max(subMul(d2, up, up), zero));
    const Float cosHere = select(inside | (beside * ball <= up * n.radius), one, mulAdd(up, ball, beside * n.radius) * over);
    const Float value = abs(n.intensity) * max(cosLight, slack) * max(cosHere, slack) * over;
    return select(cosLight > n.cosReach - slack, value, zero);
}
inline constexpr std::size_t treeWidth = LightTree::width, treeMembers = 11;
static_assert(offsetof(LightTree::Node, child) == treeMembers * treeWidth * sizeof(float));

// All points at one node.
CHIARO_LANE void weighOne(const LightTree::Node& node, const Vec3w& p, const Vec3w& normal, Float (&weight)[treeWidth]) noexcept {
    for (std::size_t i = 0; i < treeWidth; ++i) {
        const float* const c = node.x + i;
        const auto at = [&](std::size_t member) { return Float(c[member * treeWidth]); };
        weight[i] = weigh({at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9), at(10)}, p, normal);
    }
}
// Each at its own.
CHIARO_LANE void weighEach(const LightTree::Node* nodes, const uint32_t* at, uint32_t lanes, const Vec3w& p, const Vec3w& normal,
                           Float (&weight)[treeWidth]) noexcept {
    alignas(64) float rows[laneCount * treeWidth], point[6][laneCount];
    p.x.store(point[0]), p.y.store(point[1]), p.z.store(point[2]);
    normal.x.store(point[3]), normal.y.store(point[4]), normal.z.store(point[5]);
    while (lanes) { // the next two that ask, or the last twice
        const auto i = uint32_t(__builtin_ctz(lanes));
        lanes &= lanes - 1;
        const auto k = lanes ? uint32_t(__builtin_ctz(lanes)) : i;
        lanes &= lanes - 1;
        const float *const a = nodes[at[i]].x, *const b = nodes[at[k]].x;
        const auto both = [&](std::size_t member) { return eightAndEight(a + member * treeWidth, b + member * treeWidth); };
        const auto of = [&](const float(&values)[laneCount]) { return twoByEight(values[i], values[k]); };
        const Vec3w here{of(point[0]), of(point[1]), of(point[2])}, up{of(point[3]), of(point[4]), of(point[5])};
        storeEights(rows + treeWidth * i, rows + treeWidth * k,
                    weigh({both(0), both(1), both(2), both(3), both(4), both(5), both(6), both(7), both(8), both(9), both(10)}, here, up));
    }
    alignas(64) static constexpr uint32_t row[laneCount] = {0, 8, 16, 24, 32, 40, 48, 56, 64, 72, 80, 88, 96, 104, 112, 120};
    alignas(64) uint32_t first[laneCount];
    Int(row).store(first);
    asm("" : "+m"(rows)); // written above, read below through pointers
    loadFour(rows, first, weight[0], weight[1], weight[2], weight[3]);
    loadFour(rows + 4, first, weight[4], weight[5], weight[6], weight[7]);
}

// For the lanes of m; u in [0, 1), with 32 random bits. A function of its own, that two loops may call it.
[[gnu::noinline]] inline WideTreePick chooseInTree(const LightTreeView& tree, const Vec3w& p, const Vec3w& normal, Mask m,
                                                   Double u) noexcept {
    const Int children(tree.patch);
    alignas(64) uint32_t at[laneCount];
    Int node(0u), end(LightTree::none);
    Double pmf(1.0);
    while (any(m)) {
        const uint32_t bits = m.bits();
        select(m, node, Int(0u)).store(at);
        const uint32_t first = at[__builtin_ctz(bits)];
        Float weight[treeWidth];
        if (none(m & (node != Int(first))))
            weighOne(tree.nodes[first], p, normal, weight);
        else
            weighEach(tree.nodes, at, bits, p, normal, weight);
        Double w[treeWidth];
        for (std::size_t i = 0; i < treeWidth; ++i) w[i] = toDouble(weight[i]);
        const Double pair[4] = {w[0] + w[1], w[2] + w[3], w[4] + w[5], w[6] + w[7]};
        const Double half[2] = {pair[0] + pair[1], pair[2] + pair[3]}, all = half[0] + half[1];
        const Double zero(0.0);
        m = m & (all > zero);
        // To the second of two where u lies beyond the first; never to what has no weight, should rounding have moved u.
        Double rest = u * all;
        const auto step = [&](const Double& one, const Double& other) {
            const Mask on = (rest >= one) & (other > zero);
            rest = select(on, rest - one, rest);
            return on;
        };
        const Mask a = step(half[0], half[1]);
        const Mask b = step(select(a, pair[2], pair[0]), select(a, pair[3], pair[1]));
        const Double left = select(a, select(b, w[6], w[4]), select(b, w[2], w[0])),
                     right = select(a, select(b, w[7], w[5]), select(b, w[3], w[1]));
        const Mask c = step(left, right);
        const Double own = select(c, right, left);
        u = select(m, min(rest / own, Double(1 - 0x1p-53)), u);
        pmf = select(m, pmf * (own / all), pmf);
        const Int place = select(a, Int(4u), Int(0u)) + select(b, Int(2u), Int(0u)) + select(c, Int(1u), Int(0u));
        const Int child = gather(tree.nodes[0].child, node * Int(uint32_t(sizeof(LightTree::Node) / sizeof(float))) + place, m);
        const Mask ends = m & (child >= children);
        end = select(ends, child, end);
        m = andNot(m, ends);
        node = child;
    }
    WideTreePick pick{end - Int(tree.leaf), toFloat(pmf)};
    const Mask lost = end == Int(LightTree::none);
    if (Mask patches = andNot(end < Int(tree.leaf), lost); any(patches)) { // the first member whose share, added up, is beyond u
        const uint32_t* const lights = &tree.members[0].light;
        const float* const upTo = &tree.members[0].upTo;
        Int member = (end - children) << 1, count = gather(lights, member - Int(2u), patches);
        for (Mask going = patches & (count >= Int(2u)); any(going); going = going & (count >= Int(2u))) {
            const Int half = count >> 1, beyond = member + (half << 1);
            const Mask on = going & (u >= toDouble(gather(upTo, beyond - Int(2u), going)));
            member = select(on, beyond, member);
            count = select(on, count - half, half);
        }
        const Float share = gather(upTo, member, patches), before = gather(upTo, member - Int(2u), patches);
        pick.light = select(patches, gather(lights, member, patches), pick.light);
        pick.pmf = select(patches, toFloat(pmf * (toDouble(share) - toDouble(before))), pick.pmf);
    }
    pick.light = select(lost, Int(LightTree::none), pick.light);
    return pick;
}

} // namespace chiaro::CHIARO_ISA
