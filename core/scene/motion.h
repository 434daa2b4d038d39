// Motion: where a moving instance, camera or light is at a time. The maps at equal steps of the shutter are taken apart into translation,
// rotation and stretch; translation and stretch are interpolated linearly, rotation along the great arc (Shoemake 1985; Shoemake and Duff
// 1992), so that what turns keeps its size: half way through a quarter turn it has turned 45 degrees. Matrices interpolated entry by entry
// would shrink it to 0.7071.
#pragma once
#include "core/math/ray.h"
#include "core/math/vec.h"
#include <span>
#include <vector>

namespace chiaro {

class Motion {
public:
    Motion() = default; // at rest at the identity
    // Two maps or more, over the interval. Every map must be invertible.
    Motion(std::span<const Affine>, Interval);
    // Translation, a unit quaternion (w, x, y, z) and the stretch that goes before the rotation: M = T R S.
    struct Key {
        Vec3d translation;
        double rotation[4] = {1, 0, 0, 0};
        double stretch[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // upper triangular
    };
    std::span<const Key> keys() const noexcept { return keys_; }
    Affine exact(double time) const noexcept; // times outside the interval: its nearest end
    AffineT<float> at(float time) const noexcept;

private:
    std::vector<Key> keys_;
    Interval over_;
};

} // namespace chiaro
