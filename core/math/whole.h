// Whole numbers out of floating-point ones, for code written once for one path and for sixteen lanes (core/math/number.h). Whole numbers
// are 32 bits without a sign; what is negative counts down from 2^32, as in lanes.
#pragma once
#include "core/math/number.h"

namespace chiaro {

template <std::floating_point T> T floor(T x) noexcept { return std::floor(x); }
inline uint32_t truncated(float x) noexcept { return uint32_t(int32_t(x)); } // towards zero; below 2^31
inline float toFloat(uint32_t x) noexcept { return float(int32_t(x)); }
inline uint32_t floatAsBits(float x) noexcept { return std::bit_cast<uint32_t>(x); }
inline float bitsAsFloat(uint32_t x) noexcept { return std::bit_cast<float>(x); }

} // namespace chiaro
