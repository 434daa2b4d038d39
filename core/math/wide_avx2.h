// Sixteen lanes in pairs of AVX2 registers. Included by core/math/wide_lanes.h; the answers are those of core/math/wide_avx512.h to the
// last bit, but for inverseSqrtGuess().
#pragma once
#include <cstddef>
#include <cstdint>
#include <immintrin.h>

#define CHIARO_LANE [[gnu::always_inline]] inline

namespace chiaro::avx2 {

struct Mask { // all bits of a lane or none
    __m256i a, b;
    CHIARO_LANE Mask() noexcept : a(_mm256_setzero_si256()), b(a) {}
    CHIARO_LANE Mask(__m256i x, __m256i y) noexcept : a(x), b(y) {}
    CHIARO_LANE Mask(__m256 x, __m256 y) noexcept : a(_mm256_castps_si256(x)), b(_mm256_castps_si256(y)) {}
    CHIARO_LANE explicit Mask(uint32_t bits) noexcept {
        const __m256i each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        const auto spread = [&](uint32_t eight) { return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(int(eight)), each), each); };
        a = spread(bits & 0xff);
        b = spread(bits >> 8 & 0xff);
    }
    CHIARO_LANE uint32_t bits() const noexcept {
        return uint32_t(_mm256_movemask_ps(_mm256_castsi256_ps(a))) | uint32_t(_mm256_movemask_ps(_mm256_castsi256_ps(b))) << 8;
    }
};
struct Int {
    using value_type = uint32_t;
    __m256i a, b;
    CHIARO_LANE Int() noexcept {}
    CHIARO_LANE Int(__m256i x, __m256i y) noexcept : a(x), b(y) {}
    CHIARO_LANE Int(uint32_t x) noexcept : a(_mm256_set1_epi32(int(x))), b(a) {}
    CHIARO_LANE explicit Int(const uint32_t* p) noexcept
        : a(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))), b(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + 8))) {}
    CHIARO_LANE void store(uint32_t* p) const noexcept {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(p + 8), b);
    }
};
struct Float {
    using value_type = float;
    __m256 a, b;
    CHIARO_LANE Float() noexcept {}
    CHIARO_LANE Float(__m256 x, __m256 y) noexcept : a(x), b(y) {}
    CHIARO_LANE Float(float x) noexcept : a(_mm256_set1_ps(x)), b(a) {}
    CHIARO_LANE explicit Float(const float* p) noexcept : a(_mm256_loadu_ps(p)), b(_mm256_loadu_ps(p + 8)) {}
    CHIARO_LANE void store(float* p) const noexcept {
        _mm256_storeu_ps(p, a);
        _mm256_storeu_ps(p + 8, b);
    }
};
struct Long { // 64 bits a lane, four lanes a register
    __m256i q[4];
};
struct Double {
    __m256d q[4];
    CHIARO_LANE Double() noexcept {}
    CHIARO_LANE Double(double x) noexcept {
        for (__m256d& v : q) v = _mm256_set1_pd(x);
    }
};

CHIARO_LANE Mask operator&(Mask x, Mask y) noexcept { return {_mm256_and_si256(x.a, y.a), _mm256_and_si256(x.b, y.b)}; }
CHIARO_LANE Mask operator|(Mask x, Mask y) noexcept { return {_mm256_or_si256(x.a, y.a), _mm256_or_si256(x.b, y.b)}; }
CHIARO_LANE Mask operator^(Mask x, Mask y) noexcept { return {_mm256_xor_si256(x.a, y.a), _mm256_xor_si256(x.b, y.b)}; }
CHIARO_LANE Mask operator~(Mask x) noexcept { return x ^ Mask(_mm256_set1_epi32(-1), _mm256_set1_epi32(-1)); }

CHIARO_LANE Float operator+(Float x, Float y) noexcept { return {_mm256_add_ps(x.a, y.a), _mm256_add_ps(x.b, y.b)}; }
CHIARO_LANE Float operator-(Float x, Float y) noexcept { return {_mm256_sub_ps(x.a, y.a), _mm256_sub_ps(x.b, y.b)}; }
CHIARO_LANE Float operator*(Float x, Float y) noexcept { return {_mm256_mul_ps(x.a, y.a), _mm256_mul_ps(x.b, y.b)}; }
CHIARO_LANE Float operator/(Float x, Float y) noexcept { return {_mm256_div_ps(x.a, y.a), _mm256_div_ps(x.b, y.b)}; }
CHIARO_LANE Float operator-(Float x) noexcept {
    const __m256 s = _mm256_set1_ps(-0.f);
    return {_mm256_xor_ps(x.a, s), _mm256_xor_ps(x.b, s)};
}
template <int how> CHIARO_LANE Mask compare(Float x, Float y) noexcept {
    return {_mm256_cmp_ps(x.a, y.a, how), _mm256_cmp_ps(x.b, y.b, how)};
}
CHIARO_LANE Mask operator<(Float x, Float y) noexcept { return compare<_CMP_LT_OQ>(x, y); }
CHIARO_LANE Mask operator>(Float x, Float y) noexcept { return compare<_CMP_GT_OQ>(x, y); }
CHIARO_LANE Mask operator<=(Float x, Float y) noexcept { return compare<_CMP_LE_OQ>(x, y); }
CHIARO_LANE Mask operator>=(Float x, Float y) noexcept { return compare<_CMP_GE_OQ>(x, y); }
CHIARO_LANE Mask operator==(Float x, Float y) noexcept { return compare<_CMP_EQ_OQ>(x, y); }
CHIARO_LANE Mask operator!=(Float x, Float y) noexcept { return compare<_CMP_NEQ_UQ>(x, y); }
CHIARO_LANE Float min(Float x, Float y) noexcept { return {_mm256_min_ps(y.a, x.a), _mm256_min_ps(y.b, x.b)}; }
CHIARO_LANE Float max(Float x, Float y) noexcept { return {_mm256_max_ps(y.a, x.a), _mm256_max_ps(y.b, x.b)}; }
CHIARO_LANE Float abs(Float x) noexcept {
    const __m256 s = _mm256_set1_ps(-0.f);
    return {_mm256_andnot_ps(s, x.a), _mm256_andnot_ps(s, x.b)};
}
CHIARO_LANE Float sqrt(Float x) noexcept { return {_mm256_sqrt_ps(x.a), _mm256_sqrt_ps(x.b)}; }
CHIARO_LANE Float mulAdd(Float x, Float y, Float z) noexcept { return {_mm256_fmadd_ps(x.a, y.a, z.a), _mm256_fmadd_ps(x.b, y.b, z.b)}; }
CHIARO_LANE Float mulSub(Float x, Float y, Float z) noexcept { return {_mm256_fmsub_ps(x.a, y.a, z.a), _mm256_fmsub_ps(x.b, y.b, z.b)}; }
CHIARO_LANE Float subMul(Float z, Float x, Float y) noexcept { return {_mm256_fnmadd_ps(x.a, y.a, z.a), _mm256_fnmadd_ps(x.b, y.b, z.b)}; }
CHIARO_LANE Float inverseSqrtGuess(Float x) noexcept { return {_mm256_rsqrt_ps(x.a), _mm256_rsqrt_ps(x.b)}; }
CHIARO_LANE Float roundNearest(Float x) noexcept {
    constexpr int how = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
    return {_mm256_round_ps(x.a, how), _mm256_round_ps(x.b, how)};
}
CHIARO_LANE Float floor(Float x) noexcept { return {_mm256_floor_ps(x.a), _mm256_floor_ps(x.b)}; }
CHIARO_LANE Float copysign(Float x, Float y) noexcept {
    const __m256 s = _mm256_set1_ps(-0.f);
    const auto one = [&](__m256 m, __m256 n) { return _mm256_or_ps(_mm256_andnot_ps(s, m), _mm256_and_ps(s, n)); };
    return {one(x.a, y.a), one(x.b, y.b)};
}
CHIARO_LANE Float select(Mask m, Float yes, Float no) noexcept {
    return {_mm256_blendv_ps(no.a, yes.a, _mm256_castsi256_ps(m.a)), _mm256_blendv_ps(no.b, yes.b, _mm256_castsi256_ps(m.b))};
}
CHIARO_LANE Int select(Mask m, Int yes, Int no) noexcept {
    return {_mm256_blendv_epi8(no.a, yes.a, m.a), _mm256_blendv_epi8(no.b, yes.b, m.b)};
}

CHIARO_LANE Int operator+(Int x, Int y) noexcept { return {_mm256_add_epi32(x.a, y.a), _mm256_add_epi32(x.b, y.b)}; }
CHIARO_LANE Int operator-(Int x, Int y) noexcept { return {_mm256_sub_epi32(x.a, y.a), _mm256_sub_epi32(x.b, y.b)}; }
CHIARO_LANE Int operator*(Int x, Int y) noexcept { return {_mm256_mullo_epi32(x.a, y.a), _mm256_mullo_epi32(x.b, y.b)}; }
CHIARO_LANE Int operator&(Int x, Int y) noexcept { return {_mm256_and_si256(x.a, y.a), _mm256_and_si256(x.b, y.b)}; }
CHIARO_LANE Int operator|(Int x, Int y) noexcept { return {_mm256_or_si256(x.a, y.a), _mm256_or_si256(x.b, y.b)}; }
CHIARO_LANE Int operator^(Int x, Int y) noexcept { return {_mm256_xor_si256(x.a, y.a), _mm256_xor_si256(x.b, y.b)}; }
CHIARO_LANE Int operator>>(Int x, uint32_t n) noexcept { return {_mm256_srli_epi32(x.a, int(n)), _mm256_srli_epi32(x.b, int(n))}; }
CHIARO_LANE Int operator<<(Int x, uint32_t n) noexcept { return {_mm256_slli_epi32(x.a, int(n)), _mm256_slli_epi32(x.b, int(n))}; }
CHIARO_LANE Int operator>>(Int x, Int n) noexcept { return {_mm256_srlv_epi32(x.a, n.a), _mm256_srlv_epi32(x.b, n.b)}; }
CHIARO_LANE Int mulHigh(Int x, Int y) noexcept { // the upper half of the product
    const auto half = [](__m256i m, __m256i n) {
        const __m256i even = _mm256_srli_epi64(_mm256_mul_epu32(m, n), 32);
        const __m256i odd = _mm256_mul_epu32(_mm256_srli_epi64(m, 32), _mm256_srli_epi64(n, 32));
        return _mm256_blend_epi32(even, odd, 0xaa);
    };
    return {half(x.a, y.a), half(x.b, y.b)};
}
CHIARO_LANE Mask operator==(Int x, Int y) noexcept { return {_mm256_cmpeq_epi32(x.a, y.a), _mm256_cmpeq_epi32(x.b, y.b)}; }
CHIARO_LANE Mask operator!=(Int x, Int y) noexcept { return ~(x == y); }
CHIARO_LANE Mask operator>=(Int x, Int y) noexcept { // unsigned
    return {_mm256_cmpeq_epi32(_mm256_max_epu32(x.a, y.a), x.a), _mm256_cmpeq_epi32(_mm256_max_epu32(x.b, y.b), x.b)};
}
CHIARO_LANE Mask operator<(Int x, Int y) noexcept { return ~(x >= y); }
CHIARO_LANE Float bitsAsFloat(Int x) noexcept { return {_mm256_castsi256_ps(x.a), _mm256_castsi256_ps(x.b)}; }
CHIARO_LANE Int floatAsBits(Float x) noexcept { return {_mm256_castps_si256(x.a), _mm256_castps_si256(x.b)}; }
CHIARO_LANE Float toFloat(Int x) noexcept { return {_mm256_cvtepi32_ps(x.a), _mm256_cvtepi32_ps(x.b)}; }
// By way of doubles, which hold them exactly: one rounding.
CHIARO_LANE Float wholeToFloat(Int x) noexcept {
    const auto half = [](__m256i v) {
        const __m256i turned = _mm256_xor_si256(v, _mm256_set1_epi32(int(0x80000000u)));
        const __m256d back = _mm256_set1_pd(0x1p31);
        const __m128 l = _mm256_cvtpd_ps(_mm256_add_pd(_mm256_cvtepi32_pd(_mm256_castsi256_si128(turned)), back));
        const __m128 h = _mm256_cvtpd_ps(_mm256_add_pd(_mm256_cvtepi32_pd(_mm256_extracti128_si256(turned, 1)), back));
        return _mm256_insertf128_ps(_mm256_castps128_ps256(l), h, 1);
    };
    return {half(x.a), half(x.b)};
}
CHIARO_LANE Int truncated(Float x) noexcept { return {_mm256_cvttps_epi32(x.a), _mm256_cvttps_epi32(x.b)}; }

CHIARO_LANE Int reverseBits(Int x) noexcept { // by halves of bytes, then the bytes
    const __m256i half = _mm256_set1_epi8(15);
    const __m256i table = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
    const __m256i turned = _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    const auto one = [&](__m256i v) {
        const __m256i low = _mm256_shuffle_epi8(table, _mm256_and_si256(v, half));
        const __m256i high = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi16(v, 4), half));
        return _mm256_shuffle_epi8(_mm256_or_si256(_mm256_slli_epi16(low, 4), high), turned);
    };
    return {one(x.a), one(x.b)};
}
CHIARO_LANE Int xorDownBytes(Int i) noexcept {
    i = i ^ ((i & Int(0xaaaaaaaau)) >> 1);
    i = i ^ ((i & Int(0xccccccccu)) >> 2);
    return i ^ ((i & Int(0xf0f0f0f0u)) >> 4);
}
CHIARO_LANE Float lookUp(const float (&table)[16], Int i) noexcept { // two tables of eight and the choice between them
    const __m256 low = _mm256_load_ps(table), high = _mm256_load_ps(table + 8);
    const auto one = [&](__m256i at) {
        return _mm256_blendv_ps(_mm256_permutevar8x32_ps(low, at), _mm256_permutevar8x32_ps(high, at),
                                _mm256_castsi256_ps(_mm256_slli_epi32(at, 28)));
    };
    return {one(i.a), one(i.b)};
}
CHIARO_LANE Int lookUp(const uint32_t (&table)[16], Int i) noexcept {
    const __m256i low = _mm256_load_si256(reinterpret_cast<const __m256i*>(table));
    const __m256i high = _mm256_load_si256(reinterpret_cast<const __m256i*>(table + 8));
    const auto one = [&](__m256i at) {
        const __m256 l = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(low, at)),
                     h = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(high, at));
        return _mm256_castps_si256(_mm256_blendv_ps(l, h, _mm256_castsi256_ps(_mm256_slli_epi32(at, 28))));
    };
    return {one(i.a), one(i.b)};
}

CHIARO_LANE Float gather(const float* p, Int i, Mask m) noexcept {
    const __m256 z = _mm256_setzero_ps();
    return {_mm256_mask_i32gather_ps(z, p, i.a, _mm256_castsi256_ps(m.a), 4),
            _mm256_mask_i32gather_ps(z, p, i.b, _mm256_castsi256_ps(m.b), 4)};
}
CHIARO_LANE Int gather(const uint32_t* p, Int i, Mask m) noexcept {
    const __m256i z = _mm256_setzero_si256();
    const int* q = reinterpret_cast<const int*>(p);
    return {_mm256_mask_i32gather_epi32(z, q, i.a, m.a, 4), _mm256_mask_i32gather_epi32(z, q, i.b, m.b, 4)};
}
// Where each lane of a half goes when the lanes of a mask move together: three bits a lane.
CHIARO_LANE __m256i packing(uint32_t eight) noexcept {
    uint64_t wide = 0, at = 0;
    for (uint32_t b = eight; b; b &= b - 1, at += 8) wide |= uint64_t(uint32_t(__builtin_ctz(b))) << at;
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(int64_t(wide)));
}
CHIARO_LANE void storePacked(uint32_t* p, Mask m, Int x) noexcept {
    const uint32_t bits = m.bits(), low = bits & 0xff;
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm256_permutevar8x32_epi32(x.a, packing(low)));
    p += __builtin_popcount(low);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm256_permutevar8x32_epi32(x.b, packing(bits >> 8)));
}
CHIARO_LANE void storePacked(float* p, Mask m, Float x) noexcept { storePacked(reinterpret_cast<uint32_t*>(p), m, floatAsBits(x)); }

CHIARO_LANE void loadFour(const float* p, const uint32_t* at, Float& a, Float& b, Float& c, Float& d) noexcept {
    asm("" : "+m"(*reinterpret_cast<uint32_t(*)[16]>(const_cast<uint32_t*>(at))));
    const auto half = [&](const uint32_t* i, __m256& ra, __m256& rb, __m256& rc, __m256& rd) {
        __m256 r[4];
        for (int k = 0; k < 4; ++k)
            r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p + i[k])), _mm_loadu_ps(p + i[4 + k]), 1);
        const __m256 t0 = _mm256_unpacklo_ps(r[0], r[1]), t1 = _mm256_unpackhi_ps(r[0], r[1]), t2 = _mm256_unpacklo_ps(r[2], r[3]),
                     t3 = _mm256_unpackhi_ps(r[2], r[3]);
        ra = _mm256_shuffle_ps(t0, t2, 0x44);
        rb = _mm256_shuffle_ps(t0, t2, 0xee);
        rc = _mm256_shuffle_ps(t1, t3, 0x44);
        rd = _mm256_shuffle_ps(t1, t3, 0xee);
    };
    half(at, a.a, b.a, c.a, d.a);
    half(at + 8, a.b, b.b, c.b, d.b);
}

// Adds the lanes of a mask to the sums that they name, one after the other. all: every lane names a sum.
template <bool all = false> CHIARO_LANE void addTo(float (*sums)[4], const uint32_t* at, Mask m, Float r, Float g, Float b) noexcept {
    if constexpr (all) {
        const Float none(0.f);
        r = select(m, r, none), g = select(m, g, none), b = select(m, b, none);
    }
    alignas(64) float each[2][4][8]; // lane 8 h + 4 j + e at [h][e][4 j]
    const auto half = [](float(&to)[4][8], __m256 x, __m256 y, __m256 z) {
        const __m256 zero = _mm256_setzero_ps(), xz0 = _mm256_unpacklo_ps(x, z), xz1 = _mm256_unpackhi_ps(x, z),
                     y0 = _mm256_unpacklo_ps(y, zero), y1 = _mm256_unpackhi_ps(y, zero);
        _mm256_store_ps(to[0], _mm256_unpacklo_ps(xz0, y0));
        _mm256_store_ps(to[1], _mm256_unpackhi_ps(xz0, y0));
        _mm256_store_ps(to[2], _mm256_unpacklo_ps(xz1, y1));
        _mm256_store_ps(to[3], _mm256_unpackhi_ps(xz1, y1));
    };
    half(each[0], r.a, g.a, b.a);
    half(each[1], r.b, g.b, b.b);
    const auto add = [&](uint32_t k) {
        float* const sum = sums[at[k]];
        _mm_store_ps(sum, _mm_add_ps(_mm_load_ps(sum), _mm_load_ps(&each[k >> 3][k & 3][k & 4])));
    };
    if constexpr (all) {
#pragma GCC unroll 16
        for (uint32_t k = 0; k < 16; ++k) add(k);
    } else {
        for (uint32_t bits = m.bits(); bits; bits &= bits - 1) add(uint32_t(__builtin_ctz(bits)));
    }
}

CHIARO_LANE Long longs(Int l, Int h) noexcept {
    const auto quarter = [](__m128i x, __m128i y) {
        return _mm256_or_si256(_mm256_cvtepu32_epi64(x), _mm256_slli_epi64(_mm256_cvtepu32_epi64(y), 32));
    };
    return {{quarter(_mm256_castsi256_si128(l.a), _mm256_castsi256_si128(h.a)),
             quarter(_mm256_extracti128_si256(l.a, 1), _mm256_extracti128_si256(h.a, 1)),
             quarter(_mm256_castsi256_si128(l.b), _mm256_castsi256_si128(h.b)),
             quarter(_mm256_extracti128_si256(l.b, 1), _mm256_extracti128_si256(h.b, 1))}};
}
CHIARO_LANE Long longs(uint64_t x) noexcept {
    const __m256i v = _mm256_set1_epi64x(int64_t(x));
    return {{v, v, v, v}};
}
CHIARO_LANE Int low(Long x) noexcept {
    const __m256i even = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    const auto half = [&](__m256i p, __m256i q) {
        return _mm256_inserti128_si256(_mm256_permutevar8x32_epi32(p, even), _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(q, even)),
                                       1);
    };
    return {half(x.q[0], x.q[1]), half(x.q[2], x.q[3])};
}
CHIARO_LANE Long operator>>(Long x, uint32_t n) noexcept {
    for (__m256i& q : x.q) q = _mm256_srli_epi64(q, int(n));
    return x;
}
CHIARO_LANE Int high(Long x) noexcept { return low(x >> 32); }
CHIARO_LANE Long operator^(Long x, Long y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_xor_si256(x.q[i], y.q[i]);
    return x;
}
CHIARO_LANE Long operator+(Long x, Long y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_add_epi64(x.q[i], y.q[i]);
    return x;
}
// The low half of a product, from products of 32 bits.
CHIARO_LANE Long operator*(Long x, uint64_t k) noexcept {
    const __m256i l = _mm256_set1_epi64x(int64_t(k & 0xffffffffu)), h = _mm256_set1_epi64x(int64_t(k >> 32));
    for (__m256i& q : x.q) {
        const __m256i across = _mm256_add_epi64(_mm256_mul_epu32(_mm256_srli_epi64(q, 32), l), _mm256_mul_epu32(q, h));
        q = _mm256_add_epi64(_mm256_mul_epu32(q, l), _mm256_slli_epi64(across, 32));
    }
    return x;
}

CHIARO_LANE Double toDouble(Float x) noexcept {
    Double d;
    d.q[0] = _mm256_cvtps_pd(_mm256_castps256_ps128(x.a)), d.q[1] = _mm256_cvtps_pd(_mm256_extractf128_ps(x.a, 1));
    d.q[2] = _mm256_cvtps_pd(_mm256_castps256_ps128(x.b)), d.q[3] = _mm256_cvtps_pd(_mm256_extractf128_ps(x.b, 1));
    return d;
}
CHIARO_LANE Double toDouble(Int x) noexcept { // unsigned
    Double d;
    const auto half = [](__m256i v, __m256d& l, __m256d& h) {
        const __m256i turned = _mm256_xor_si256(v, _mm256_set1_epi32(int(0x80000000u)));
        const __m256d back = _mm256_set1_pd(0x1p31);
        l = _mm256_add_pd(_mm256_cvtepi32_pd(_mm256_castsi256_si128(turned)), back);
        h = _mm256_add_pd(_mm256_cvtepi32_pd(_mm256_extracti128_si256(turned, 1)), back);
    };
    half(x.a, d.q[0], d.q[1]);
    half(x.b, d.q[2], d.q[3]);
    return d;
}
CHIARO_LANE Float toFloat(Double x) noexcept {
    const auto half = [](__m256d l, __m256d h) {
        return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(l)), _mm256_cvtpd_ps(h), 1);
    };
    return {half(x.q[0], x.q[1]), half(x.q[2], x.q[3])};
}
CHIARO_LANE Double operator+(Double x, Double y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_add_pd(x.q[i], y.q[i]);
    return x;
}
CHIARO_LANE Double operator-(Double x, Double y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_sub_pd(x.q[i], y.q[i]);
    return x;
}
CHIARO_LANE Double operator*(Double x, Double y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_mul_pd(x.q[i], y.q[i]);
    return x;
}
CHIARO_LANE Double operator/(Double x, Double y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_div_pd(x.q[i], y.q[i]);
    return x;
}
CHIARO_LANE Double min(Double x, Double y) noexcept {
    for (int i = 0; i < 4; ++i) x.q[i] = _mm256_min_pd(y.q[i], x.q[i]);
    return x;
}
template <int how> CHIARO_LANE Mask compare(Double x, Double y) noexcept {
    Long all;
    for (int i = 0; i < 4; ++i) all.q[i] = _mm256_castpd_si256(_mm256_cmp_pd(x.q[i], y.q[i], how));
    const Int each = low(all);
    return {each.a, each.b};
}
CHIARO_LANE Mask operator<(Double x, Double y) noexcept { return compare<_CMP_LT_OQ>(x, y); }
CHIARO_LANE Mask operator>(Double x, Double y) noexcept { return compare<_CMP_GT_OQ>(x, y); }
CHIARO_LANE Mask operator>=(Double x, Double y) noexcept { return compare<_CMP_GE_OQ>(x, y); }
CHIARO_LANE Double select(Mask m, Double yes, Double no) noexcept {
    const __m128i quarter[4] = {_mm256_castsi256_si128(m.a), _mm256_extracti128_si256(m.a, 1), _mm256_castsi256_si128(m.b),
                                _mm256_extracti128_si256(m.b, 1)};
    for (int i = 0; i < 4; ++i) no.q[i] = _mm256_blendv_pd(no.q[i], yes.q[i], _mm256_castsi256_pd(_mm256_cvtepi32_epi64(quarter[i])));
    return no;
}

// For what has eight parts: two of them side by side, one number for each of the two, either of them alone.
CHIARO_LANE Float eightAndEight(const float* x, const float* y) noexcept { return {_mm256_loadu_ps(x), _mm256_loadu_ps(y)}; }
CHIARO_LANE Float twoByEight(float x, float y) noexcept { return {_mm256_set1_ps(x), _mm256_set1_ps(y)}; }
CHIARO_LANE void storeEights(float* x, float* y, Float a) noexcept { _mm256_storeu_ps(x, a.a), _mm256_storeu_ps(y, a.b); }
CHIARO_LANE Float upperEight(Float a) noexcept { return {a.b, a.b}; } // twice

} // namespace chiaro::avx2
