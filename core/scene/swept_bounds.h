// Bounds of what is placed in the world, also of what moves. Metres, in double: they come before the scene is recentred.
#pragma once
#include "core/scene/motion.h"

namespace chiaro {

struct Bounds {
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void add(const Vec3d& p) noexcept {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    bool empty() const noexcept { return low.x > high.x; }
    Vec3d corner(int i) const noexcept { return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; }
};

// Where a box is at any time of a motion.
void addSwept(Bounds& world, const Bounds& box, const Motion& motion);

} // namespace chiaro
