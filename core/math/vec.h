// Vectors, points and RGB spectra: plain values over the number type of core/math/number.h.
#pragma once
#include "core/math/number.h"
#include <array>
#include <cstddef>

namespace chiaro {

template <class T> struct Vec2T {
    T x{}, y{};
};
using Point2 = Vec2T<float>;

template <class T> struct Vec3T {
    T x{}, y{}, z{};
    Vec3T operator-() const noexcept { return {-x, -y, -z}; }
    Vec3T& operator+=(const Vec3T& o) noexcept { return *this = *this + o; }
    Vec3T& operator*=(T s) noexcept { return *this = *this * s; }
    friend Vec3T operator+(const Vec3T& a, const Vec3T& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3T operator-(const Vec3T& a, const Vec3T& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3T operator*(const Vec3T& a, T s) noexcept { return {a.x * s, a.y * s, a.z * s}; }
    friend Vec3T operator*(T s, const Vec3T& a) noexcept { return a * s; }
    friend bool operator==(const Vec3T&, const Vec3T&) = default;
};
using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

struct Vec4 {
    float x = 0, y = 0, z = 0, w = 0;
    friend bool operator==(const Vec4&, const Vec4&) = default;
};

template <class T> T dot(const Vec3T<T>& a, const Vec3T<T>& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class T> T absDot(const Vec3T<T>& a, const Vec3T<T>& b) noexcept { return abs(dot(a, b)); }
template <class T> Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T> T lengthSquared(const Vec3T<T>& a) noexcept { return dot(a, a); }
template <class T> T length(const Vec3T<T>& a) noexcept { return sqrt(dot(a, a)); }
template <class T> Vec3T<T> normalize(const Vec3T<T>& a) noexcept { return a * (T(Real<T>(1)) / length(a)); }
template <class T> T maxAbs(const Vec3T<T>& a) noexcept { return max(abs(a.x), max(abs(a.y), abs(a.z))); }
template <class To, class From> Vec3T<To> cast(const Vec3T<From>& v) noexcept { return {To(v.x), To(v.y), To(v.z)}; }
inline bool finite(const Vec3& v) noexcept { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// A spectral quantity: linear RGB, Rec.709 primaries, D65. Radiance in cd/m2 a channel, or a dimensionless reflectance.
template <class T> struct Rgb {
    std::array<T, 3> c{};
    Rgb() = default;
    constexpr explicit Rgb(T v) noexcept : c{v, v, v} {}
    constexpr Rgb(T r, T g, T b) noexcept : c{r, g, b} {}
    T& operator[](std::size_t i) noexcept { return c[i]; }
    const T& operator[](std::size_t i) const noexcept { return c[i]; }
    Rgb& operator+=(const Rgb& o) noexcept { return *this = *this + o; }
    Rgb& operator*=(const Rgb& o) noexcept { return *this = *this * o; }
    Rgb& operator*=(T s) noexcept { return *this = *this * s; }
    friend Rgb operator+(const Rgb& a, const Rgb& b) noexcept { return {a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}; }
    friend Rgb operator-(const Rgb& a, const Rgb& b) noexcept { return {a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}; }
    friend Rgb operator*(const Rgb& a, const Rgb& b) noexcept { return {a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]}; }
    friend Rgb operator*(const Rgb& a, T s) noexcept { return {a.c[0] * s, a.c[1] * s, a.c[2] * s}; }
    friend Rgb operator*(T s, const Rgb& a) noexcept { return a * s; }
    friend bool operator==(const Rgb&, const Rgb&) = default;
};
using Spectrum = Rgb<float>;

template <class T> T maxComponent(const Rgb<T>& s) noexcept { return max(s.c[0], max(s.c[1], s.c[2])); }
template <class T> T average(const Rgb<T>& s) noexcept { return (s.c[0] + s.c[1] + s.c[2]) * T(Real<T>(1.0 / 3)); }
// The Y row of linear Rec.709 (ITU-R BT.709-6, 2015).
template <class T> T luminance(const Rgb<T>& s) noexcept {
    return s.c[0] * T(Real<T>(0.2126)) + s.c[1] * T(Real<T>(0.7152)) + s.c[2] * T(Real<T>(0.0722));
}
inline bool black(const Spectrum& s) noexcept { return s.c[0] == 0 && s.c[1] == 0 && s.c[2] == 0; }
inline bool finite(const Spectrum& s) noexcept { return std::isfinite(s.c[0]) && std::isfinite(s.c[1]) && std::isfinite(s.c[2]); }

// An orthonormal frame about z = n (Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017).
template <class T> struct FrameT {
    Vec3T<T> x, y, z;
    static FrameT about(const Vec3T<T>& n) noexcept {
        const T one = Real<T>(1), sign = copysign(one, n.z), a = -one / (sign + n.z), b = n.x * n.y * a;
        return {{one + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }
    Vec3T<T> toLocal(const Vec3T<T>& v) const noexcept { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3T<T> toWorld(const Vec3T<T>& v) const noexcept { return x * v.x + y * v.y + z * v.z; }
};
using Frame = FrameT<float>;

// Affine map, rows of a 3x4 matrix. Doubles describe a scene, floats trace it.
template <class T> struct AffineT {
    T m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    Vec3T<T> point(const Vec3T<T>& p) const noexcept {
        return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3], m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
    }
    Vec3T<T> vector(const Vec3T<T>& v) const noexcept {
        return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
    }
    // Cofactors of the linear part: what a normal is multiplied by (det times the inverse transpose); its sign is that of the determinant.
    Vec3T<T> normal(const Vec3T<T>& n) const noexcept {
        const Vec3T<T> r0{m[0][0], m[0][1], m[0][2]}, r1{m[1][0], m[1][1], m[1][2]}, r2{m[2][0], m[2][1], m[2][2]};
        return {dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)};
    }
    T determinant() const noexcept {
        return dot(Vec3T<T>{m[0][0], m[0][1], m[0][2]}, cross(Vec3T<T>{m[1][0], m[1][1], m[1][2]}, Vec3T<T>{m[2][0], m[2][1], m[2][2]}));
    }
    friend AffineT operator*(const AffineT& a, const AffineT& b) noexcept {
        AffineT r;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j)
                r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : T(0));
        return r;
    }
    friend bool operator==(const AffineT&, const AffineT&) = default;
};
using Affine = AffineT<double>;

} // namespace chiaro
