// Sixteen lanes in AVX-512 registers. Included by core/math/wide_lanes.h.
#pragma once
#include <cstddef>
#include <cstdint>
#include <immintrin.h>

#define CHIARO_LANE [[gnu::always_inline]] inline

namespace chiaro::avx512 {

struct Mask {
    __mmask16 m;
    CHIARO_LANE Mask() noexcept : m(0) {}
    CHIARO_LANE explicit Mask(uint32_t bits) noexcept : m(__mmask16(bits)) {}
    CHIARO_LANE uint32_t bits() const noexcept { return m; }
};
struct Int {
    using value_type = uint32_t;
    __m512i v;
    CHIARO_LANE Int() noexcept {}
    CHIARO_LANE Int(__m512i a) noexcept : v(a) {}
    CHIARO_LANE Int(uint32_t a) noexcept : v(_mm512_set1_epi32(int(a))) {}
    CHIARO_LANE explicit Int(const uint32_t* p) noexcept : v(_mm512_loadu_si512(p)) {}
    CHIARO_LANE void store(uint32_t* p) const noexcept { _mm512_storeu_si512(p, v); }
};
struct Float {
    using value_type = float;
    __m512 v;
    CHIARO_LANE Float() noexcept {}
    CHIARO_LANE Float(__m512 a) noexcept : v(a) {}
    CHIARO_LANE Float(float a) noexcept : v(_mm512_set1_ps(a)) {}
    CHIARO_LANE explicit Float(const float* p) noexcept : v(_mm512_loadu_ps(p)) {}
    CHIARO_LANE void store(float* p) const noexcept { _mm512_storeu_ps(p, v); }
};
struct Long { // 64 bits a lane: the first eight lanes, the last eight
    __m512i a, b;
};
struct Double { // likewise
    __m512d a, b;
    CHIARO_LANE Double() noexcept {}
    CHIARO_LANE Double(__m512d x, __m512d y) noexcept : a(x), b(y) {}
    CHIARO_LANE Double(double x) noexcept : a(_mm512_set1_pd(x)), b(a) {}
};

CHIARO_LANE Mask operator&(Mask a, Mask b) noexcept { return Mask(uint32_t(a.m & b.m)); }
CHIARO_LANE Mask operator|(Mask a, Mask b) noexcept { return Mask(uint32_t(a.m | b.m)); }
CHIARO_LANE Mask operator^(Mask a, Mask b) noexcept { return Mask(uint32_t(a.m ^ b.m)); }
CHIARO_LANE Mask operator~(Mask a) noexcept { return Mask(uint32_t(~a.m)); }

CHIARO_LANE Float operator+(Float a, Float b) noexcept { return _mm512_add_ps(a.v, b.v); }
CHIARO_LANE Float operator-(Float a, Float b) noexcept { return _mm512_sub_ps(a.v, b.v); }
CHIARO_LANE Float operator*(Float a, Float b) noexcept { return _mm512_mul_ps(a.v, b.v); }
CHIARO_LANE Float operator/(Float a, Float b) noexcept { return _mm512_div_ps(a.v, b.v); }
CHIARO_LANE Float operator-(Float a) noexcept { return _mm512_xor_ps(a.v, _mm512_set1_ps(-0.f)); }
CHIARO_LANE Mask operator<(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ))); }
CHIARO_LANE Mask operator>(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ))); }
CHIARO_LANE Mask operator<=(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ))); }
CHIARO_LANE Mask operator>=(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ))); }
CHIARO_LANE Mask operator==(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ))); }
CHIARO_LANE Mask operator!=(Float a, Float b) noexcept { return Mask(uint32_t(_mm512_cmp_ps_mask(a.v, b.v, _CMP_NEQ_UQ))); }
// With NaN the first argument is returned, as by the scalar functions of core/math/number.h.
CHIARO_LANE Float min(Float a, Float b) noexcept { return _mm512_min_ps(b.v, a.v); }
CHIARO_LANE Float max(Float a, Float b) noexcept { return _mm512_max_ps(b.v, a.v); }
CHIARO_LANE Float abs(Float a) noexcept { return _mm512_andnot_ps(_mm512_set1_ps(-0.f), a.v); }
CHIARO_LANE Float sqrt(Float a) noexcept { return _mm512_sqrt_ps(a.v); }
CHIARO_LANE Float mulAdd(Float a, Float b, Float c) noexcept { return _mm512_fmadd_ps(a.v, b.v, c.v); } // a b + c, rounded once
CHIARO_LANE Float mulSub(Float a, Float b, Float c) noexcept { return _mm512_fmsub_ps(a.v, b.v, c.v); }
CHIARO_LANE Float subMul(Float c, Float a, Float b) noexcept { return _mm512_fnmadd_ps(a.v, b.v, c.v); } // c - a b
CHIARO_LANE Float inverseSqrtGuess(Float a) noexcept { return _mm512_rsqrt14_ps(a.v); }
CHIARO_LANE Float roundNearest(Float a) noexcept { return _mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
CHIARO_LANE Float floor(Float a) noexcept { return _mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
CHIARO_LANE Float copysign(Float a, Float b) noexcept {
    return _mm512_castsi512_ps(
        _mm512_ternarylogic_epi32(_mm512_set1_epi32(int(0x80000000u)), _mm512_castps_si512(b.v), _mm512_castps_si512(a.v), 0xca));
}
CHIARO_LANE Float select(Mask m, Float yes, Float no) noexcept { return _mm512_mask_blend_ps(m.m, no.v, yes.v); }
CHIARO_LANE Int select(Mask m, Int yes, Int no) noexcept { return _mm512_mask_blend_epi32(m.m, no.v, yes.v); }

CHIARO_LANE Int operator+(Int a, Int b) noexcept { return _mm512_add_epi32(a.v, b.v); }
CHIARO_LANE Int operator-(Int a, Int b) noexcept { return _mm512_sub_epi32(a.v, b.v); }
CHIARO_LANE Int operator*(Int a, Int b) noexcept { return _mm512_mullo_epi32(a.v, b.v); }
CHIARO_LANE Int operator&(Int a, Int b) noexcept { return _mm512_and_si512(a.v, b.v); }
CHIARO_LANE Int operator|(Int a, Int b) noexcept { return _mm512_or_si512(a.v, b.v); }
CHIARO_LANE Int operator^(Int a, Int b) noexcept { return _mm512_xor_si512(a.v, b.v); }
CHIARO_LANE Int operator>>(Int a, uint32_t n) noexcept { return _mm512_srli_epi32(a.v, n); }
CHIARO_LANE Int operator<<(Int a, uint32_t n) noexcept { return _mm512_slli_epi32(a.v, n); }
CHIARO_LANE Int operator>>(Int a, Int n) noexcept { return _mm512_srlv_epi32(a.v, n.v); }
CHIARO_LANE Int mulHigh(Int a, Int b) noexcept { // the upper half of the product
    const __m512i even = _mm512_srli_epi64(_mm512_mul_epu32(a.v, b.v), 32);
    const __m512i odd = _mm512_mul_epu32(_mm512_srli_epi64(a.v, 32), _mm512_srli_epi64(b.v, 32));
    return _mm512_mask_blend_epi32(__mmask16(0xaaaa), even, odd);
}
CHIARO_LANE Mask operator==(Int a, Int b) noexcept { return Mask(uint32_t(_mm512_cmpeq_epi32_mask(a.v, b.v))); }
CHIARO_LANE Mask operator!=(Int a, Int b) noexcept { return Mask(uint32_t(_mm512_cmpneq_epi32_mask(a.v, b.v))); }
CHIARO_LANE Mask operator<(Int a, Int b) noexcept { return Mask(uint32_t(_mm512_cmplt_epu32_mask(a.v, b.v))); }
CHIARO_LANE Mask operator>=(Int a, Int b) noexcept { return ~(a < b); }
CHIARO_LANE Float bitsAsFloat(Int a) noexcept { return _mm512_castsi512_ps(a.v); }
CHIARO_LANE Int floatAsBits(Float a) noexcept { return _mm512_castps_si512(a.v); }
CHIARO_LANE Float toFloat(Int a) noexcept { return _mm512_cvtepi32_ps(a.v); } // below 2^31
CHIARO_LANE Float wholeToFloat(Int a) noexcept { return _mm512_cvtepu32_ps(a.v); }
CHIARO_LANE Int truncated(Float a) noexcept { return _mm512_cvttps_epi32(a.v); }

CHIARO_LANE Int byBytes(Int a, uint64_t matrix) noexcept { // every byte times a matrix over bits
    return _mm512_gf2p8affine_epi64_epi8(a.v, _mm512_set1_epi64(int64_t(matrix)), 0);
}
CHIARO_LANE Int reverseBits(Int a) noexcept { // in each byte, then the bytes
    const __m512i turned = _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    return _mm512_shuffle_epi8(byBytes(a, 0x8040201008040201ull).v, turned);
}
// In each byte: bit i of the result is the parity of the bits of a whose places hold all bits of i (three steps of Pascal's triangle).
CHIARO_LANE Int xorDownBytes(Int a) noexcept { return byBytes(a, 0xffaacc88f0a0c080ull); }
CHIARO_LANE Float lookUp(const float (&table)[16], Int i) noexcept { return _mm512_permutexvar_ps(i.v, _mm512_load_ps(table)); }
CHIARO_LANE Int lookUp(const uint32_t (&table)[16], Int i) noexcept { return _mm512_permutexvar_epi32(i.v, _mm512_load_si512(table)); }

// Lanes that are not asked read nothing and give 0.
CHIARO_LANE Float gather(const float* p, Int i, Mask m) noexcept { return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), m.m, i.v, p, 4); }
CHIARO_LANE Int gather(const uint32_t* p, Int i, Mask m) noexcept {
    return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), m.m, i.v, p, 4);
}
// The lanes of m side by side; sixteen elements are written. Compressed in registers: to memory it is slow on many processors.
CHIARO_LANE void storePacked(float* p, Mask m, Float a) noexcept { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.m, a.v)); }
CHIARO_LANE void storePacked(uint32_t* p, Mask m, Int a) noexcept { _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.m, a.v)); }

// Four floats at p + at[lane], transposed.
CHIARO_LANE void loadFour(const float* p, const uint32_t* at, Float& a, Float& b, Float& c, Float& d) noexcept {
    asm("" : "+m"(*reinterpret_cast<uint32_t(*)[16]>(const_cast<uint32_t*>(at))));
    __m512 r[4];
    for (int k = 0; k < 4; ++k) {
        __m512 x = _mm512_castps128_ps512(_mm_loadu_ps(p + at[k]));
        x = _mm512_insertf32x4(x, _mm_loadu_ps(p + at[4 + k]), 1);
        x = _mm512_insertf32x4(x, _mm_loadu_ps(p + at[8 + k]), 2);
        r[k] = _mm512_insertf32x4(x, _mm_loadu_ps(p + at[12 + k]), 3);
    }
    const __m512 t0 = _mm512_unpacklo_ps(r[0], r[1]), t1 = _mm512_unpackhi_ps(r[0], r[1]), t2 = _mm512_unpacklo_ps(r[2], r[3]),
                 t3 = _mm512_unpackhi_ps(r[2], r[3]);
    a = _mm512_shuffle_ps(t0, t2, 0x44);
    b = _mm512_shuffle_ps(t0, t2, 0xee);
    c = _mm512_shuffle_ps(t1, t3, 0x44);
    d = _mm512_shuffle_ps(t1, t3, 0xee);
}

// Adds the lanes of a mask to the sums that they name, one after the other. all: every lane names a sum.
template <bool all = false> CHIARO_LANE void addTo(float (*sums)[4], const uint32_t* at, Mask m, Float r, Float g, Float b) noexcept {
    if constexpr (all) {
        const Float none(0.f);
        r = select(m, r, none), g = select(m, g, none), b = select(m, b, none);
    }
    const __m512 zero = _mm512_setzero_ps(), rb0 = _mm512_unpacklo_ps(r.v, b.v), rb1 = _mm512_unpackhi_ps(r.v, b.v),
                 g0 = _mm512_unpacklo_ps(g.v, zero), g1 = _mm512_unpackhi_ps(g.v, zero);
    alignas(64) float each[4][16]; // lane 4 j + e at [e][4 j]
    _mm512_store_ps(each[0], _mm512_unpacklo_ps(rb0, g0));
    _mm512_store_ps(each[1], _mm512_unpackhi_ps(rb0, g0));
    _mm512_store_ps(each[2], _mm512_unpacklo_ps(rb1, g1));
    _mm512_store_ps(each[3], _mm512_unpackhi_ps(rb1, g1));
    const auto add = [&](uint32_t k) {
        float* const sum = sums[at[k]];
        _mm_store_ps(sum, _mm_add_ps(_mm_load_ps(sum), _mm_load_ps(&each[k & 3][k & ~3u])));
    };
    if constexpr (all) {
#pragma GCC unroll 16
        for (uint32_t k = 0; k < 16; ++k) add(k);
    } else {
        for (uint32_t bits = m.bits(); bits; bits &= bits - 1) add(uint32_t(__builtin_ctz(bits)));
    }
}

CHIARO_LANE Long longs(Int low, Int high) noexcept {
    const __m512i first = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const __m512i last = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    return {_mm512_permutex2var_epi32(low.v, first, high.v), _mm512_permutex2var_epi32(low.v, last, high.v)};
}
CHIARO_LANE Long longs(uint64_t x) noexcept { return {_mm512_set1_epi64(int64_t(x)), _mm512_set1_epi64(int64_t(x))}; }
CHIARO_LANE Int low(Long x) noexcept {
    return _mm512_permutex2var_epi32(x.a, _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), x.b);
}
CHIARO_LANE Int high(Long x) noexcept {
    return _mm512_permutex2var_epi32(x.a, _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31), x.b);
}
CHIARO_LANE Long operator>>(Long x, uint32_t n) noexcept { return {_mm512_srli_epi64(x.a, n), _mm512_srli_epi64(x.b, n)}; }
CHIARO_LANE Long operator^(Long x, Long y) noexcept { return {_mm512_xor_si512(x.a, y.a), _mm512_xor_si512(x.b, y.b)}; }
CHIARO_LANE Long operator+(Long x, Long y) noexcept { return {_mm512_add_epi64(x.a, y.a), _mm512_add_epi64(x.b, y.b)}; }
CHIARO_LANE Long operator*(Long x, uint64_t k) noexcept {
    const __m512i f = _mm512_set1_epi64(int64_t(k));
    return {_mm512_mullo_epi64(x.a, f), _mm512_mullo_epi64(x.b, f)};
}

CHIARO_LANE Double toDouble(Float x) noexcept {
    return {_mm512_cvtps_pd(_mm512_castps512_ps256(x.v)), _mm512_cvtps_pd(_mm512_extractf32x8_ps(x.v, 1))};
}
CHIARO_LANE Double toDouble(Int x) noexcept { // unsigned
    return {_mm512_cvtepu32_pd(_mm512_castsi512_si256(x.v)), _mm512_cvtepu32_pd(_mm512_extracti32x8_epi32(x.v, 1))};
}
CHIARO_LANE Float toFloat(Double x) noexcept {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(x.a)), _mm512_cvtpd_ps(x.b), 1);
}
CHIARO_LANE Double operator+(Double x, Double y) noexcept { return {_mm512_add_pd(x.a, y.a), _mm512_add_pd(x.b, y.b)}; }
CHIARO_LANE Double operator-(Double x, Double y) noexcept { return {_mm512_sub_pd(x.a, y.a), _mm512_sub_pd(x.b, y.b)}; }
CHIARO_LANE Double operator*(Double x, Double y) noexcept { return {_mm512_mul_pd(x.a, y.a), _mm512_mul_pd(x.b, y.b)}; }
CHIARO_LANE Double operator/(Double x, Double y) noexcept { return {_mm512_div_pd(x.a, y.a), _mm512_div_pd(x.b, y.b)}; }
CHIARO_LANE Double min(Double x, Double y) noexcept { return {_mm512_min_pd(y.a, x.a), _mm512_min_pd(y.b, x.b)}; }
template <int how> CHIARO_LANE Mask compare(Double x, Double y) noexcept {
    return Mask(uint32_t(_mm512_cmp_pd_mask(x.a, y.a, how)) | uint32_t(_mm512_cmp_pd_mask(x.b, y.b, how)) << 8);
}
CHIARO_LANE Mask operator<(Double x, Double y) noexcept { return compare<_CMP_LT_OQ>(x, y); }
CHIARO_LANE Mask operator>(Double x, Double y) noexcept { return compare<_CMP_GT_OQ>(x, y); }
CHIARO_LANE Mask operator>=(Double x, Double y) noexcept { return compare<_CMP_GE_OQ>(x, y); }
CHIARO_LANE Double select(Mask m, Double yes, Double no) noexcept {
    return {_mm512_mask_blend_pd(__mmask8(m.m), no.a, yes.a), _mm512_mask_blend_pd(__mmask8(m.m >> 8), no.b, yes.b)};
}

// For what has eight parts: two of them side by side, one number for each of the two, either of them alone.
CHIARO_LANE Float eightAndEight(const float* x, const float* y) noexcept {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(x)), _mm256_loadu_ps(y), 1);
}
CHIARO_LANE Float twoByEight(float x, float y) noexcept {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_set1_ps(x)), _mm256_set1_ps(y), 1);
}
CHIARO_LANE void storeEights(float* x, float* y, Float a) noexcept {
    _mm256_storeu_ps(x, _mm512_castps512_ps256(a.v)), _mm256_storeu_ps(y, _mm512_extractf32x8_ps(a.v, 1));
}
CHIARO_LANE Float upperEight(Float a) noexcept { return _mm512_shuffle_f32x4(a.v, a.v, 0xee); } // twice

} // namespace chiaro::avx512
