// Which instruction set the loops over lanes run in. They are plain loops, written once as always_inline functions, compiled for each set
// by a function with that target and chosen at run time: the program itself is built for every x86-64. Nothing is fused or reordered
// (-ffp-contract=off), so all sets give the same bits.
#pragma once

#define CHIARO_TARGET_AVX2 [[gnu::target("avx2")]]
#ifdef __clang__ // has no such width, and would leave out the whole target
#define CHIARO_TARGET_AVX512 [[gnu::target("avx512f,avx512dq,avx512bw,avx512vl")]]
#else
#define CHIARO_TARGET_AVX512 [[gnu::target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")]]
#endif

namespace chiaro {

template <class F> F* widest(F* baseline, F* avx2, F* avx512) noexcept {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl"))
        return avx512;
    return __builtin_cpu_supports("avx2") ? avx2 : baseline;
}

} // namespace chiaro
