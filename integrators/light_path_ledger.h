// LightPathLedger: an integrator whose light lands on pixels that no camera sample chose. A splat that is no number is located by the path
// of light that brought it; chiaro trace follows that path again. Found by dynamic_cast, as PathSource is (core/render/path_log.h).
#pragma once
#include <cstdint>
#include <optional>

namespace chiaro {

class LightPathLedger {
public:
    virtual ~LightPathLedger() = default;
    // The lowest number of a path that brought light which no film can hold.
    virtual std::optional<uint64_t> brokenPath() const = 0;
};

} // namespace chiaro
