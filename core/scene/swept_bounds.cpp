#include "core/scene/swept_bounds.h"
#include <algorithm>

namespace chiaro {

// Between two keys a corner leaves the straight way by the height of its arc at most, and by what
// turning and stretching at once add to it.
void addSwept(Bounds& world, const Bounds& box, const Motion& motion) {
    const std::span<const Motion::Key> keys = motion.keys();
    const auto stretched = [](const Motion::Key& k, const Vec3d& p) {
        const auto& s = k.stretch;
        return Vec3d{s[0][0] * p.x + s[0][1] * p.y + s[0][2] * p.z, s[1][1] * p.y + s[1][2] * p.z, s[2][2] * p.z};
    };
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
        double cosine = 0;
        for (int c = 0; c < 4; ++c) cosine += keys[i].rotation[c] * keys[i + 1].rotation[c];
        const double half = std::acos(std::clamp(cosine, -1.0, 1.0)); // of the turn
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d p = box.corner(corner), from = stretched(keys[i], p), to = stretched(keys[i + 1], p);
            const double bulge = std::max(length(from), length(to)) * (1 - std::cos(half)) + length(to - from) * half / 2;
            for (const Motion::Key* k : {&keys[i], &keys[i + 1]}) {
                const Vec3d q = Motion::compose(*k).point(p), pad{bulge, bulge, bulge};
                world.add(q - pad);
                world.add(q + pad);
            }
        }
    }
}

} // namespace chiaro
