// chiaro scenes: what can be rendered without any file.
#include "scenes/builtin.h"
#include "tools/cli/command.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {

int runScenes(const Arguments& arguments) {
    if (arguments.on("json")) {
        nlohmann::ordered_json all = nlohmann::ordered_json::array();
        for (const BuiltinScene& s : builtinScenes())
            all.push_back({{"name", s.name}, {"summary", s.summary}, {"size", {s.width, s.height}}, {"spp", s.spp}});
        fmt::print("{}\n", all.dump(2));
        return 0;
    }
    for (const BuiltinScene& s : builtinScenes())
        fmt::print("{:<18} {:>4}x{:<4} {:>6} spp   {}\n", s.name, s.width, s.height, s.spp, s.summary);
    return 0;
}

} // namespace chiaro::cli
