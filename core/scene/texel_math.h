// Which texels a look-up reads, written over the number type of core/math/number.h: one path and sixteen lanes read the same texels with
// the same weights to the last bit. Whole numbers are 32 bits without a sign (core/math/whole.h).
#pragma once
#include "core/math/vec.h"
#include "core/math/whole.h"
#include "core/scene/desc.h"

namespace chiaro {

template <class T> using WholeOf = decltype(truncated(T{}));

// Texture coordinates far outside any sensible range would overflow the texel index. Two pictures are a period of every mode: the rest is
// that of std::fmod(v, 2), exact. What is not finite is 0.
template <class T> [[gnu::always_inline]] inline T tame(const T& v, Wrap mode) noexcept {
    using R = Real<T>;
    const T zero = R(0);
    if (mode == Wrap::clamp) return select(abs(v) < T(std::numeric_limits<R>::infinity()), min(max(v, T(R(-1))), T(R(2))), zero);
    const auto near = abs(v) < T(R(0x1p24)); // beyond, every number is even
    const T safe = select(near, v, zero);
    return safe - toFloat(truncated(safe * T(R(0.5)))) * T(R(2));
}

// i: from -2 n - 1 to 2 n.
template <class I> [[gnu::always_inline]] inline I wrapped(I i, const I& n, Wrap mode) noexcept {
    const I negative(0x80000000u), twice = n + n;
    if (mode == Wrap::clamp) return select(i >= negative, I(0u), select(i >= n, n - I(1u), i));
    i = select(i >= negative, i + twice, i);
    if (mode == Wrap::repeat) {
        i = select(i >= negative, i + n, i);
        i = select(i >= n, i - n, i);
        return select(i >= n, i - n, i);
    }
    i = select(i >= negative, i + twice, i);
    i = select(i >= twice, i - twice, i);
    return select(i >= n, twice - I(1u) - i, i);
}

// Four texels and how far the place lies between their centres.
template <class T> struct TexelQuad {
    WholeOf<T> x0, x1, y0, y1;
    T fx, fy;
};
template <class T>
[[gnu::always_inline]] inline TexelQuad<T> texelQuad(const Vec2T<T>& uv, const WholeOf<T>& width, const WholeOf<T>& height, Wrap s,
                                                     Wrap t) noexcept {
    using R = Real<T>;
    const T half = R(0.5), x = tame(uv.x, s) * toFloat(width), y = tame(uv.y, t) * toFloat(height);
    const T left = floor(x - half), top = floor(y - half);
    const WholeOf<T> i = truncated(left), j = truncated(top), one(1u);
    return {wrapped(i, width, s), wrapped(i + one, width, s), wrapped(j, height, t), wrapped(j + one, height, t), x - half - left,
            y - half - top};
}
template <class T> [[gnu::always_inline]] inline T mixed(const TexelQuad<T>& q, const T& a, const T& b, const T& c, const T& d) noexcept {
    const T one = Real<T>(1);
    return (a * (one - q.fx) + b * q.fx) * (one - q.fy) + (c * (one - q.fx) + d * q.fx) * q.fy;
}

// The number of a texel in its store. first: of the level; across: tiles in a row; tiles are 2^tx by 2^ty texels.
template <class I>
[[gnu::always_inline]] inline I texelNumber(const I& first, const I& across, const I& x, const I& y, uint32_t tx, uint32_t ty) noexcept {
    const I tile = (y >> ty) * across + (x >> tx);
    return first + (tile << (tx + ty)) + ((y & I((1u << ty) - 1)) << tx) + (x & I((1u << tx) - 1));
}

// Between which two levels a filter of this width lies, in texels of the first, and the share of the second: linear in the width.
template <class T> struct LevelPair {
    WholeOf<T> level;
    T share;
};
template <class T> [[gnu::always_inline]] inline LevelPair<T> levelsOf(const T& width, uint32_t last) noexcept {
    using I = WholeOf<T>;
    const I bits = floatAsBits(width), level = (bits >> 23u) - I(127u);
    const auto coarsest = level >= I(last);
    return {select(coarsest, I(last), level), select(coarsest, T(Real<T>(0)), toFloat(bits & I(0x7fffffu)) * T(Real<T>(0x1p-23)))};
}

} // namespace chiaro
