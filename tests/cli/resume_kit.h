// Interrupted renders for tests: every integrator with little work, pictures compared to the last bit.
#pragma once
#include "io/picture.h"
#include "tests/cli/program.h"
#include <algorithm>
#include <cstring>

namespace resume {

inline bool samePixels(const chiaro::Picture& a, const chiaro::Picture& b, bool times = false) {
    if (a.names != b.names || !(a.window == b.window)) return false;
    for (std::size_t c = 0; c < a.planes.size(); ++c) {
        if (!times && a.names[c] == "cost.time") continue;
        if (a.planes[c].size() != b.planes[c].size() ||
            std::memcmp(a.planes[c].data(), b.planes[c].data(), a.planes[c].size() * sizeof(float)) != 0)
            return false;
    }
    return true;
}
inline bool samePixels(const program::Folder& folder, const std::string& a, const std::string& b) {
    return samePixels(chiaro::readPicture(folder / a), chiaro::readPicture(folder / b));
}

// Every attribute but those that tell of time and of the command.
inline bool sameRecipe(const chiaro::Picture& a, const chiaro::Picture& b) {
    const auto rest = [](const chiaro::Picture& p) {
        chiaro::Metadata m = p.metadata;
        std::erase_if(m, [](const auto& entry) { return entry.first == "chiaro:seconds" || entry.first == "chiaro:command"; });
        return m;
    };
    return rest(a) == rest(b);
}

// The registry's integrators, with few photons and coarse patches.
inline std::string small(std::string_view name) {
    if (name == "photon") return "photon:count=3k,caustic-count=1k,gather=0";
    if (name == "sppm") return "sppm:count=2k,caustic-count=500";
    return std::string(name);
}

} // namespace resume
