// Ray cones: what a ray stands for, as wide as the pixel or the lobe that it was drawn from, so that a texture is read at the sharpness
// that can be seen and no sharper (Amanatides 1984; Igehy 1999; Akenine-Moeller et al., Ray Tracing Gems 20, 2019, and Improved Shader and
// Texture Level of Detail Using Ray Cones, JCGT 10(1), 2021). A Footprint (core/math/ray.h) is carried along the path: it widens with the
// distance, mirrors and lenses bend it, a lobe opens it. Where it arrives it cuts an ellipse out of the triangle; in the coordinates of a
// texture that is an ellipse again. Written over the number type of core/math/number.h.
#pragma once
#include "core/math/ray.h"
#include "core/math/whole.h"

namespace chiaro {

// Two diameters of the ellipse, perpendicular in space, as steps of the weights of the second and third vertex. All zero: a point.
template <class T> struct ConeSectionT {
    Vec2T<T> major, minor;
};
struct ConeSection : ConeSectionT<float> {
    bool none() const noexcept { return major.x == 0 && major.y == 0; }
};

// e1, e2: edges from the first corner; d: along the ray; width: of the cone across d at the hit. The long diameter lies where d leans,
// width / cos long, at most `reach` times the width; where d meets the plane at a right angle any direction serves.
template <class T>
[[gnu::always_inline]] inline ConeSectionT<T> coneSection(const Vec3T<T>& e1, const Vec3T<T>& e2, const Vec3T<T>& d,
                                                          const T& width) noexcept {
    using R = Real<T>;
    const T least = R(1e-3), zero = R(0), one = R(1);
    const Vec3T<T> twice = cross(e1, e2);
    const T area = dot(twice, twice), safe = select(area > zero, area, one);
    const Vec3T<T> n = twice * (one / sqrt(safe));
    const T cosine = dot(n, d);
    const Vec3T<T> lean = d - n * cosine;
    const T leaning = dot(lean, lean), edge = dot(e1, e1);
    const auto upright = leaning < T(R(1e-8));
    const T scale = one / sqrt(max(select(upright, edge, leaning), T(R(1e-37))));
    const Vec3T<T> along{select(upright, e1.x, lean.x) * scale, select(upright, e1.y, lean.y) * scale,
                         select(upright, e1.z, lean.z) * scale};
    const Vec3T<T> across = cross(n, along);
    const T major = width / max(abs(cosine), least), inverse = select(area > zero, one / safe, zero);
    const auto steps = [&](const Vec3T<T>& a, const T& l) {
        return Vec2T<T>{dot(cross(a, e2), twice) * (l * inverse), dot(cross(e1, a), twice) * (l * inverse)};
    };
    return {steps(along, major), steps(across, width)};
}

// Texture coordinates along the two edges of a triangle.
template <class T> struct UvEdges {
    Vec2T<T> b, c;
    [[gnu::always_inline]] UvEdges(const Vec2T<T>& uv0, const Vec2T<T>& uv1, const Vec2T<T>& uv2) noexcept
        : b{uv1.x - uv0.x, uv1.y - uv0.y}, c{uv2.x - uv0.x, uv2.y - uv0.y} {}
    // A step on the triangle in coordinates of a texture, under the map of its slot.
    [[gnu::always_inline]] Vec2T<T> step(const Vec2T<T>& weights, const float (&m)[2][3]) const noexcept {
        const T x = b.x * weights.x + c.x * weights.y, y = b.y * weights.x + c.y * weights.y;
        return {x * T(Real<T>(m[0][0])) + y * T(Real<T>(m[0][1])), x * T(Real<T>(m[1][0])) + y * T(Real<T>(m[1][1]))};
    }
};

// A lobe drawn from with this density opens the cone to the share of the lobe that falls to one of some sixty paths (Suykens and Willems,
// Path Differentials and Applications, 2001): wide enough that bounces read small levels of a texture, narrow enough that what lies close
// by keeps its place.
inline constexpr float lobeShare = 1 / 64.f, widestLobe = 0.25f;
template <class T> [[gnu::always_inline]] inline T lobeSpread(const T& pdfW) noexcept {
    using R = Real<T>;
    const T solidAngle = T(R(lobeShare / pi)) / max(pdfW, T(R(1e-12)));
    return min(T(R(widestLobe)), sqrt(solidAngle) * T(R(2)));
}
// bend: curvature on the side of the ray times the width of the cone; eta: index beyond over index here.
template <class T> [[gnu::always_inline]] inline T boundedSpread(const T& s) noexcept { return min(max(s, T(Real<T>(-1))), T(Real<T>(1))); }
template <class T> [[gnu::always_inline]] inline T mirroredSpread(const T& spread, const T& bend) noexcept {
    return boundedSpread(spread + bend + bend);
}
template <class T> [[gnu::always_inline]] inline T refractedSpread(const T& spread, const T& bend, const T& eta) noexcept {
    return boundedSpread((spread + bend) / eta - bend);
}

class Scene;
struct SurfacePoint;
// The footprint of the ray that leaves a point towards wi, of a path that came along -wo with the footprint `here` at the point. pdfW: of
// wi, without meaning where delta. What filters nothing goes on filtering nothing.
Footprint scattered(const Scene&, const SurfacePoint&, const Footprint& here, const Vec3& wo, const Vec3& wi, bool delta,
                    float pdfW) noexcept;
// Of a path that begins with this footprint: none in a scene whose textures have nothing to filter.
Footprint cone(const Scene&, const Footprint& start) noexcept;
// From the corners' unit normals (Akenine-Moeller et al. 2021, eq. 13, its mean over the edges), positive where the front is convex.
float meanCurvature(const Vec3 (&corners)[3], const Vec3 (&normals)[3]) noexcept;

// What a texture is asked for: the mean over an ellipse, as so many trilinear look-ups along its long axis, each at the level where the
// short axis is one texel. Lengths in texels of the first level.
template <class T> struct TexelEllipse {
    T width;       // of each look-up, at least 1
    T probes;      // how many, a whole number from 1
    Vec2T<T> step; // from one to the next, in texture coordinates
};
inline constexpr float mostProbes = 16;
// A sample is filtered over half of what it stands for: the pixel's own filter does the rest, and the two together stay as sharp as the
// filter alone.
inline constexpr float footprintShare = 0.5f;

// p, q: the diameters in texture coordinates; size of the picture in texels. The axes are those of the matrix (p q): its singular values.
template <class T>
[[gnu::always_inline]] inline TexelEllipse<T> texelEllipse(const Vec2T<T>& p, const Vec2T<T>& q, const T& sizeX, const T& sizeY) noexcept {
    using R = Real<T>;
    const T one = R(1), zero = R(0), half = R(0.5);
    const T px = p.x * sizeX, py = p.y * sizeY, qx = q.x * sizeX, qy = q.y * sizeY;
    const T a = px * px + qx * qx, b = px * py + qx * qy, c = py * py + qy * qy;
    const T middle = (a + c) * half, skew = (a - c) * half, root = sqrt(skew * skew + b * b);
    const T longest = middle + root, major = sqrt(longest);
    const T minor = abs(px * qy - py * qx) / max(major, T(R(1e-30)));
    const T width = max(one, max(minor, major * T(R(1 / mostProbes))));
    TexelEllipse<T> e;
    e.width = width;
    const T ratio = min(major / width, T(R(mostProbes)));
    e.probes = max(one, -floor(-(ratio - T(R(1e-3)))));
    // The eigenvector of the larger eigenvalue, from the row that does not cancel.
    const auto flat = a > c;
    const T vx = select(flat, skew + root, b), vy = select(flat, b, root - skew), length = vx * vx + vy * vy;
    const T reach = max(major - width, zero) / (max(e.probes - one, one) * sqrt(max(length, T(R(1e-30)))));
    const auto one1 = e.probes > one;
    e.step = {select(one1, vx * reach / sizeX, zero), select(one1, vy * reach / sizeY, zero)};
    return e;
}

} // namespace chiaro
