// The number type of the leaf mathematics. Frames, warps, Fresnel terms, microfacets and hashes are written once, as templates over T:
// float for one path at a time, double for the quadratures that check them, std::experimental::simd (core/math/lanes.h) for 16 paths at
// once. Such code has no branches on T: it computes both sides and picks one with select().
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

namespace chiaro {

template <class T>
    requires std::is_arithmetic_v<T>
constexpr T select(bool condition, T yes, T no) noexcept {
    return condition ? yes : no;
}

// Spelled like the std:: functions so that unqualified calls inside templates find these for float and double, and the library's own by
// argument-dependent look-up for lanes.
template <std::floating_point T> T sqrt(T x) noexcept { return std::sqrt(x); }
template <std::floating_point T> T abs(T x) noexcept { return std::fabs(x); }
template <std::floating_point T> T sin(T x) noexcept { return std::sin(x); }
template <std::floating_point T> T cos(T x) noexcept { return std::cos(x); }
template <std::floating_point T> T min(T a, T b) noexcept { return b < a ? b : a; }
template <std::floating_point T> T max(T a, T b) noexcept { return a < b ? b : a; }
template <std::floating_point T> T copysign(T a, T b) noexcept { return std::copysign(a, b); }

// The floating type behind T: T itself, or the type of one lane. Constants are written Real<T>(0.5f).
template <class T> struct RealOf {
    using type = typename T::value_type;
};
template <std::floating_point T> struct RealOf<T> {
    using type = T;
};
template <class T> using Real = typename RealOf<T>::type;

template <class T> T sqr(T x) noexcept { return x * x; }
template <class T> T safeSqrt(T x) noexcept { return sqrt(max(x, T(Real<T>(0)))); }
template <class T> T clamp01(T x) noexcept { return min(max(x, T(Real<T>(0))), T(Real<T>(1))); }

inline constexpr float pi = std::numbers::pi_v<float>;
inline constexpr float oneMinusEpsilon = 0x1.fffffep-1f; // the largest float below 1

} // namespace chiaro
