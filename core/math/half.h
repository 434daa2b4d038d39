// Numbers of 16 bits, IEEE 754 binary16, as OpenEXR stores them: what a picture keeps in memory where its file has no more. Plain integer
// arithmetic, the same on every machine, and none of it depends on how denormal floats are treated.
#pragma once
#include <bit>
#include <cstdint>

namespace chiaro {

// Exact.
inline float halfToFloat(uint16_t code) noexcept {
    const uint32_t sign = uint32_t(code & 0x8000u) << 16, exponent = code >> 10 & 0x1fu, mantissa = code & 0x3ffu;
    if (exponent == 0) return float(mantissa) * (sign ? -0x1p-24f : 0x1p-24f);
    if (exponent == 31) return std::bit_cast<float>(sign | 0x7f800000u | mantissa << 13);
    return std::bit_cast<float>(sign | (exponent + 112) << 23 | mantissa << 13);
}

// The nearest, to even where two are as near; infinite from 65520 on. What is no number stays none.
inline uint16_t floatToHalf(float v) noexcept {
    const uint32_t bits = std::bit_cast<uint32_t>(v), sign = bits >> 16 & 0x8000u, size = bits & 0x7fffffffu;
    if (size > 0x7f800000u) return uint16_t(sign | 0x7e00u);
    if (size >= std::bit_cast<uint32_t>(65520.f)) return uint16_t(sign | 0x7c00u);
    if (size < std::bit_cast<uint32_t>(0x1p-14f)) // the sum rounds where its last place is 2^-24, and that is where denormal halves end
        return uint16_t(sign | (std::bit_cast<uint32_t>(std::bit_cast<float>(size) + 0.5f) - std::bit_cast<uint32_t>(0.5f)));
    return uint16_t(sign | ((size + 0xfffu + (size >> 13 & 1u) - (112u << 23)) >> 13));
}

} // namespace chiaro
