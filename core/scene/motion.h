// Motion: where a moving instance, camera or light is at a time. The maps at equal steps of the shutter are taken apart into translation,
// rotation and stretch; translation and stretch are interpolated linearly, rotation along the great arc (Shoemake 1985; Shoemake and Duff
// 1992), so that what turns keeps its size: half way through a quarter turn it has turned 45 degrees. Matrices interpolated entry by entry
// would shrink it to 0.7071.
#pragma once
#include "core/math/ray.h"
#include "core/math/vec.h"
#include "core/render/fault.h"
#include <span>
#include <vector>

namespace chiaro {

// A time in seconds as a share of the shutter, in [0, 1]: what the ray tracer counts in. Of a shutter that opens for an instant: 0.
class ShutterClock {
public:
    ShutterClock() = default;
    explicit ShutterClock(Interval over) noexcept : open_(over.open), rate_(over.close > over.open ? 1 / (over.close - over.open) : 0) {}
    float share(float time) const noexcept { return fault(Fault::shutterStuck) ? 0 : clamp01((time - open_) * rate_); }

private:
    float open_ = 0, rate_ = 0;
};

class Motion {
public:
    static constexpr std::size_t mostKeys = 129; // Embree's limit

    Motion() = default; // at rest at the identity
    // Two maps or more, at equal steps over the interval, which is longer than an instant. Every map must be invertible, all with
    // determinants of one sign: between them it is then invertible at every time.
    Motion(std::span<const Affine>, Interval);
    // Translation, a unit quaternion (w, x, y, z) and the stretch that goes before the rotation: M = T R S. A reflection is in S.
    struct Key {
        Vec3d translation;
        double rotation[4] = {1, 0, 0, 0};
        double stretch[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // upper triangular
    };
    // At equal steps: those given, and between them as many more on the same arcs as keep each turn below 3.2 degrees, to mostKeys at most.
    std::span<const Key> keys() const noexcept { return keys_; }
    Affine exact(double time) const noexcept; // times outside the interval: its nearest end
    // As the ray tracer has it, from the same keys by the same formulas.
    AffineT<float> at(float time) const noexcept;
    // How far the ray tracer may be from at(), as a share of the length of what is mapped (its origin apart).
    float slack() const noexcept { return slack_; }
    // A key as a map.
    static Affine compose(const Key&) noexcept;

private:
    std::vector<Key> keys_;
    Interval over_;
    ShutterClock clock_;
    float slack_ = 0;
};

} // namespace chiaro
