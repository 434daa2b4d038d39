// --aov LIST: the layers that a picture carries beside its beauty.
#include "tools/cli/settings.h"
#include <fmt/format.h>

namespace chiaro::cli {

LayerChoice readLayers(const std::string& list) {
    LayerChoice chosen{.albedo = false, .normal = false, .depth = false};
    std::size_t names = 0;
    bool none = false;
    for (std::size_t begin = 0; begin <= list.size(); ++names) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string name = list.substr(begin, end - begin);
        begin = end + 1;
        switch (parseChoice("aov", name, {"albedo", "normal", "Z", "cost", "photons", "all", "none"})) {
        case 0: chosen.albedo = true; break;
        case 1: chosen.normal = true; break;
        case 2: chosen.depth = true; break;
        case 3: chosen.cost = true; break;
        case 4: chosen.photons = true; break;
        case 5: chosen.albedo = chosen.normal = chosen.depth = chosen.cost = chosen.all = true; break;
        default: none = true;
        }
    }
    if (none && names > 1) throw Error(Exit::usage, fmt::format("--aov {}: none stands alone", list));
    return chosen;
}

} // namespace chiaro::cli
