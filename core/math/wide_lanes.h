// Float, Int, Mask, Long: the number types of loops over sixteen paths, written for one instruction set each in a namespace of its own
// (CHIARO_ISA: avx2 or avx512). A file that includes this is compiled for that set (CMakeLists.txt, "wide"); whatever template it
// instantiates carries the namespace in its name, so that the linker cannot mix the sets. It may call nothing else that is inline: the
// test build.wide-symbols looks.
//
// Float is a number type in the sense of core/math/number.h: the leaf mathematics of shading runs on it unchanged. Products are fused with
// sums only where mulAdd() and its like say so, never by the compiler: what a lane computes does not depend on the code around it. Both
// sets give the same bits but for inverseSqrtGuess().
#pragma once
#if defined(__AVX512F__)
#include "core/math/wide_avx512.h"
#define CHIARO_ISA avx512
#elif defined(__AVX2__)
#include "core/math/wide_avx2.h"
#define CHIARO_ISA avx2
#else
#error "compile this file for AVX2 or AVX-512"
#endif
#include "core/math/vec.h"

namespace chiaro::CHIARO_ISA {

constexpr uint32_t laneCount = 16;
using Vec3w = Vec3T<Float>;
using Vec2w = Vec2T<Float>;
using Rgbw = Rgb<Float>;

CHIARO_LANE Float& operator+=(Float& a, Float b) noexcept { return a = a + b; }

CHIARO_LANE bool any(Mask m) noexcept { return m.bits() != 0; }
CHIARO_LANE bool none(Mask m) noexcept { return m.bits() == 0; }
CHIARO_LANE uint32_t count(Mask m) noexcept { return uint32_t(__builtin_popcount(m.bits())); }
CHIARO_LANE Mask firstLanes(uint32_t n) noexcept { return Mask((1u << n) - 1); }
CHIARO_LANE Mask andNot(Mask a, Mask b) noexcept { return a & ~b; }

CHIARO_LANE Mask select(Mask m, Mask yes, Mask no) noexcept { return (m & yes) | andNot(no, m); }
CHIARO_LANE Vec3w select(Mask m, const Vec3w& yes, const Vec3w& no) noexcept {
    return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}
CHIARO_LANE Rgbw select(Mask m, const Rgbw& yes, const Rgbw& no) noexcept {
    return {select(m, yes.c[0], no.c[0]), select(m, yes.c[1], no.c[1]), select(m, yes.c[2], no.c[2])};
}
CHIARO_LANE Mask notBlack(const Rgbw& s) noexcept { return (s.c[0] != Float(0.f)) | (s.c[1] != Float(0.f)) | (s.c[2] != Float(0.f)); }

// About 1 / sqrt(x) to within two units in the last place, for what is neither 0 nor infinite: a guess of the processor, one step of
// Newton's.
CHIARO_LANE Float inverseSqrt(Float x) noexcept {
    const Float y = inverseSqrtGuess(x);
    return mulAdd(y, subMul(Float(0.5f), Float(0.5f) * x * y, y), y);
}
// Of vectors, in the place of the templates of core/math/vec.h: sums of products rounded once a term.
CHIARO_LANE Float dot(const Vec3w& a, const Vec3w& b) noexcept { return mulAdd(a.z, b.z, mulAdd(a.y, b.y, a.x * b.x)); }
CHIARO_LANE Vec3w cross(const Vec3w& a, const Vec3w& b) noexcept {
    return {mulSub(a.y, b.z, a.z * b.y), mulSub(a.z, b.x, a.x * b.z), mulSub(a.x, b.y, a.y * b.x)};
}
CHIARO_LANE Float lengthSquared(const Vec3w& a) noexcept { return dot(a, a); }
CHIARO_LANE Vec3w normalize(const Vec3w& a) noexcept { return a * inverseSqrt(dot(a, a)); }
CHIARO_LANE Vec3w mulAdd(const Vec3w& a, Float b, const Vec3w& c) noexcept {
    return {mulAdd(a.x, b, c.x), mulAdd(a.y, b, c.y), mulAdd(a.z, b, c.z)};
}
CHIARO_LANE Vec3w toWorld(const FrameT<Float>& f, const Vec3w& v) noexcept { return mulAdd(f.z, v.z, mulAdd(f.y, v.y, f.x * v.x)); }

// Sine and cosine for moderate angles: reduction by quarter turns in two steps (Cody and Waite 1980), then minimax polynomials on an eighth
// of a turn (those of Cephes, Moshier 1992). Error below 2 units in the last place for |x| < 100.
struct SineCosine {
    Float sine, cosine;
};
CHIARO_LANE SineCosine sinCos(Float x) noexcept {
    const Float k = roundNearest(x * Float(0.636619772f));
    const Float r = ((x - k * Float(1.5703125f)) - k * Float(4.837512969970703125e-4f)) - k * Float(7.5497899548918821e-8f);
    const Float r2 = r * r;
    const Float s = r + r * r2 * (Float(-1.6666654611e-1f) + r2 * (Float(8.3321608736e-3f) + r2 * Float(-1.9515295891e-4f)));
    const Float c = Float(1.f) - Float(0.5f) * r2 +
                    r2 * r2 * (Float(4.166664568298827e-2f) + r2 * (Float(-1.388731625493765e-3f) + r2 * Float(2.443315711809948e-5f)));
    const Int q = truncated(k);
    const Mask swapped = (q & Int(1u)) != Int(0u);
    const Float sine = select(swapped, c, s), cosine = select(swapped, s, c);
    return {bitsAsFloat(floatAsBits(sine) ^ ((q & Int(2u)) << 30)), bitsAsFloat(floatAsBits(cosine) ^ (((q + Int(1u)) & Int(2u)) << 30))};
}
CHIARO_LANE Float sin(Float x) noexcept { return sinCos(x).sine; }
CHIARO_LANE Float cos(Float x) noexcept { return sinCos(x).cosine; }

// Warps and frames of core/math/warp.h and vec.h in fewer steps.
CHIARO_LANE FrameT<Float> frameAbout(const Vec3w& n) noexcept {
    const Float sign = copysign(Float(1.f), n.z), a = Float(-1.f) / (sign + n.z), xa = n.x * a, b = xa * n.y, x = sign * n.x;
    return {{mulAdd(x, xa, Float(1.f)), sign * b, -x}, {b, mulAdd(n.y * n.y, a, sign), -n.y}, n};
}
// The angles of the concentric map are an eighth of a turn at most: the polynomials of sinCos() without its reduction.
CHIARO_LANE Vec3w cosineHemisphere(const Vec2w& u) noexcept {
    const Float one(1.f), x = u.x + u.x - one, y = u.y + u.y - one;
    const Mask wide = abs(x) > abs(y);
    const Float r = select(wide, x, y), num = select(wide, y, x), den = select(r == Float(0.f), one, r);
    const Float phi = num / den * Float(0.785398163f), p = phi * phi;
    const Float sine =
                    mulAdd(mulAdd(mulAdd(Float(-1.9515295891e-4f), p, Float(8.3321608736e-3f)), p, Float(-1.6666654611e-1f)), p * phi, phi),
                cosine = mulAdd(
                    mulAdd(mulAdd(mulAdd(Float(2.443315711809948e-5f), p, Float(-1.388731625493765e-3f)), p, Float(4.166664568298827e-2f)),
                           p, Float(-0.5f)),
                    p, one);
    const Float s = r * sine, c = r * cosine;
    return {select(wide, c, s), select(wide, s, c), sqrt(max(subMul(one, r, r), Float(0.f)))};
}
// Of light that a light sample brings: the weight against a density of the other strategy, over its own.
CHIARO_LANE Float weightOverPdf(Float pdf, Float other) noexcept {
    const Float inverse = Float(1.f) / pdf, ratio = other * inverse;
    return inverse / mulAdd(ratio, ratio, Float(1.f));
}

} // namespace chiaro::CHIARO_ISA
