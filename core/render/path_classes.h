// PathClasses: which light paths are wanted, and in which layer each belongs, as one automaton that a path walks along event by event:
// forward on light paths, backward on eye paths. Masks, layers, bounces and the depth limit are all in its states. State 0: no wanted path
// begins like this, stop. Layer 0: not wanted. Depth counts scatterings: 0 emission, 1 direct light.
#pragma once
#include "core/render/events.h"
#include <cstdint>
#include <string>
#include <vector>

namespace chiaro {

using PathState = uint16_t;
using Layer = uint8_t;
inline constexpr uint32_t unlimitedDepth = 0xffff - 1;

class PathClasses {
public:
    explicit PathClasses(uint32_t maxDepth = unlimitedDepth) : maxDepth_(maxDepth) {}

    PathState eye() const noexcept { return 1; }
    PathState eye(PathState s, Event) const noexcept { return s > maxDepth_ ? PathState(0) : s == unlimitedDepth ? s : PathState(s + 1); }
    PathState light(LightKind) const noexcept { return 1; }
    PathState light(PathState s, Event e) const noexcept { return eye(s, e); }
    // Do D, G and S part from here on? If not, nobody throws dice for a class.
    bool sorts(PathState) const noexcept { return false; }
    Layer reached(PathState eyeState, LightKind) const noexcept { return eyeState ? 1 : 0; }
    // Both ends stand at the same vertex or at the ends of one connection, each with its event there already taken.
    Layer meet(PathState lightState, PathState eyeState) const noexcept {
        return lightState && eyeState && uint32_t(lightState) + eyeState - 2 <= maxDepth_ ? 1 : 0;
    }
    // False where no further scattering can be wanted: the path may stop without asking for a closure.
    bool continues(PathState s) const noexcept { return s != 0 && s <= maxDepth_; }
    uint32_t maxDepth() const noexcept { return maxDepth_; }

private:
    uint32_t maxDepth_;
};

} // namespace chiaro
