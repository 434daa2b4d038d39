// Rays, hits and the small values that travel with a path.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

struct Interval {
    float open = 0, close = 0; // seconds
};
struct Pixel {
    uint32_t x = 0, y = 0;
    friend bool operator==(const Pixel&, const Pixel&) = default;
};
// Half-open rectangle of pixels.
struct Rect {
    uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    uint32_t width() const noexcept { return x1 - x0; }
    uint32_t height() const noexcept { return y1 - y0; }
    uint64_t area() const noexcept { return uint64_t(width()) * height(); }
    friend bool operator==(const Rect&, const Rect&) = default;
};
// The cone a ray stands for: its width in metres at the origin and its full opening angle in radians. Zero filters nothing.
struct Footprint {
    float width = 0, spread = 0;
    // Where the ray has gone t metres. A cone that converges opens again beyond its waist.
    Footprint at(float t) const noexcept {
        const float w = width + spread * t;
        return w < 0 ? Footprint{-w, -spread} : Footprint{w, spread};
    }
};
// The wavelength that a dispersive event picked, in nanometres; 0: none, the path carries all of RGB.
struct Wavelengths {
    float hero = 0;
};
inline constexpr float infinity = std::numeric_limits<float>::infinity();
struct Ray {
    Vec3 o;
    float tnear = 0;
    Vec3 d; // unit length
    float tfar = infinity;
    float time = 0; // seconds
};
// The nearest intersection: which geometry of the compiled scene, which triangle of it, under which instance, where on it. u and v weigh
// the second and third vertex.
struct Hit {
    static constexpr uint32_t none = ~0u;
    uint32_t geometry = none, triangle = 0, instance = none;
    float u = 0, v = 0, t = infinity;
    explicit operator bool() const noexcept { return geometry != none; }
};

} // namespace chiaro
