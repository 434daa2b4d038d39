// Lanes: the number type that runs the leaf mathematics for several paths at once, std::experimental::simd. Arithmetic, sqrt, min, max,
// sin, cos and copysign are the library's and found by argument-dependent look-up; select() is what it lacks.
#pragma once
#include "core/math/number.h"
#include <experimental/simd>

namespace chiaro {

template <int N> using Lanes = std::experimental::fixed_size_simd<float, N>;

template <class T, class Abi>
std::experimental::simd<T, Abi> select(const std::experimental::simd_mask<T, Abi>& mask, const std::experimental::simd<T, Abi>& yes,
                                       const std::experimental::simd<T, Abi>& no) noexcept {
    std::experimental::simd<T, Abi> r = no;
    std::experimental::where(mask, r) = yes;
    return r;
}

} // namespace chiaro
