// The numbers of Sampler for sixteen paths at once, of one pixel or of many, each at a dimension of its own: the same bits. Sobol' only.
// For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"

namespace chiaro::CHIARO_ISA {

CHIARO_LANE Long hashMix(Long x) noexcept {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
CHIARO_LANE Long hashCombine(Long a, Long b) noexcept { return hashMix(a ^ hashMix(b + longs(0x9e3779b97f4a7c15ull))); }

CHIARO_LANE Int laineKarras(Int x, Int seed) noexcept {
    x = x ^ (x * Int(0x3d20adeau));
    x = x + seed;
    x = x * ((seed >> 16) | Int(1u));
    x = x ^ (x * Int(0x05526c56u));
    return x ^ (x * Int(0x53a22864u));
}
CHIARO_LANE Int sobolSecondReversed(Int i) noexcept {
    i = xorDownBytes(i);
    i = i ^ ((i & Int(0xff00ff00u)) >> 8);
    return i ^ (i >> 16);
}
CHIARO_LANE Float toUnit(Int bits) noexcept { return toFloat(bits >> 8) * Float(0x1p-24f); }

// The third dimension of Sobol' in reversed bits, a table for each four bits of the index: primitive polynomial x^2 + x + 1, first
// direction numbers 1 and 3 (Joe and Kuo 2008).
struct ThirdTables {
    alignas(64) uint32_t of[8][16] = {};
    constexpr ThirdTables() {
        uint32_t v[32] = {0x80000000u, 0xc0000000u};
        for (int i = 2; i < 32; ++i) v[i] = v[i - 1] ^ v[i - 2] ^ v[i - 2] >> 2;
        for (int four = 0; four < 8; ++four)
            for (uint32_t value = 0; value < 16; ++value) {
                uint32_t x = 0, reversed = 0;
                for (int bit = 0; bit < 4; ++bit)
                    if (value >> bit & 1) x ^= v[four * 4 + bit];
                for (int bit = 0; bit < 32; ++bit) reversed |= (x >> bit & 1) << (31 - bit);
                of[four][value] = reversed;
            }
    }
};
inline constexpr ThirdTables thirdTables;
CHIARO_LANE Int sobolThirdReversed(Int index) noexcept {
    Int x = lookUp(thirdTables.of[0], index & Int(15u));
    for (uint32_t four = 1; four < 8; ++four) x = x ^ lookUp(thirdTables.of[four], (index >> (4 * four)) & Int(15u));
    return x;
}

struct WidePick {
    Int pick; // 32 random bits
    Vec2w u;
};
struct WideSampler {
    Long key;
    Int reversed; // the sample's index, its bits reversed
    WideSampler(Int keyLow, Int keyHigh, Int index) noexcept : key(longs(keyLow, keyHigh)), reversed(reverseBits(index)) {}

    CHIARO_LANE Int shuffled(Int seed) const noexcept { return reverseBits(laineKarras(reversed, seed)); }
    CHIARO_LANE Float get1D(Long dimension) const noexcept {
        const Long h = hashMix(key ^ dimension);
        return toUnit(reverseBits(laineKarras(shuffled(low(h)), high(h))));
    }
    // pick: false where nobody asks for the first number, which is 0 then.
    CHIARO_LANE WidePick get3D(Long dimension, bool pick = true) const noexcept {
        const Long h = hashMix(key ^ dimension), g = hashMix(h ^ longs(0x6a09e667f3bcc909ull));
        const Int index = shuffled(low(h));
        WidePick p{
            Int(0u),
            {toUnit(reverseBits(laineKarras(index, high(h)))), toUnit(reverseBits(laineKarras(sobolSecondReversed(index), low(g))))}};
        if (pick) p.pick = reverseBits(laineKarras(sobolThirdReversed(index), high(g)));
        return p;
    }
};

// What hashCombine() makes of a dimension, for get1D() and get3D().
CHIARO_LANE Long mixed(Int dimension) noexcept { return hashMix(longs(dimension, Int(0u)) + longs(0x9e3779b97f4a7c15ull)); }
// The same of the dimensions first + step depth, for the first sixteen depths as a table.
template <uint32_t first, uint32_t step> struct MixedDimensions {
    alignas(64) uint32_t low[16] = {}, high[16] = {};
    constexpr MixedDimensions() {
        for (uint32_t depth = 0; depth < 16; ++depth) {
            uint64_t x = first + step * depth + 0x9e3779b97f4a7c15ull;
            x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
            x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
            x ^= x >> 31;
            low[depth] = uint32_t(x), high[depth] = uint32_t(x >> 32);
        }
    }
};
template <uint32_t first, uint32_t step> CHIARO_LANE Long mixedAt(Int depth, bool shallow) noexcept {
    static constexpr MixedDimensions<first, step> table;
    return shallow ? longs(lookUp(table.low, depth), lookUp(table.high, depth)) : mixed(Int(first) + depth * Int(step));
}

} // namespace chiaro::CHIARO_ISA
