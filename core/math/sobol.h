// The arithmetic of Sampler's points, for loops that draw one request of many samples at once: straight-line code that compilers turn into
// lanes. Owen-scrambled Sobol' points by hashes (Laine and Karras 2011; Burley, JCGT 2020).
#pragma once
#include "core/math/sampler.h"

namespace chiaro {

[[gnu::always_inline]] inline uint32_t reverseBits(uint32_t x) noexcept {
    x = x >> 16 | x << 16;
    x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

// A nested uniform scramble on reversed bits: each bit is flipped by a hash of the bits below it only (Laine and Karras 2011, with the
// constants that Vegdahl published in 2021 for full avalanche).
[[gnu::always_inline]] inline uint32_t laineKarras(uint32_t x, uint32_t seed) noexcept {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Second dimension of Sobol' (direction numbers of the polynomial x + 1) in reversed-bit form: bit i of the point's reversal is the parity
// of the index masked by a row of Pascal's triangle modulo 2, which five shift-and-xor steps multiply by (Ahmed 2024; Quilez' xor-shift
// form).
[[gnu::always_inline]] inline uint32_t sobolSecondReversed(uint32_t index) noexcept {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    return index ^ index >> 16;
}

[[gnu::always_inline]] inline float toUnit(uint32_t bits) noexcept { return float(int32_t(bits >> 8)) * 0x1p-24f; } // int: lanes convert it

// An index in Owen's shuffled order.
[[gnu::always_inline]] inline uint32_t shuffledIndex(uint32_t index, uint32_t seed) noexcept {
    return reverseBits(laineKarras(reverseBits(index), seed));
}

// The first two dimensions of the point of a shuffled index. Owen's scramble of a reversed number is the reversal of Laine and Karras' hash
// of the number itself.
[[gnu::always_inline]] inline Point2 sobolPair(uint32_t shuffled, uint32_t seedX, uint32_t seedY) noexcept {
    return {toUnit(reverseBits(laineKarras(shuffled, seedX))), toUnit(reverseBits(laineKarras(sobolSecondReversed(shuffled), seedY)))};
}

} // namespace chiaro
