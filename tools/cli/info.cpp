// chiaro info SCENE | IMAGE: what is in it, what Chiaro will use, approximate, ignore, add.
#include "tools/cli/command.h"
#include "tools/cli/info_image.h"
#include "tools/cli/info_scene.h"
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

bool looksLikeScene(const std::string& operand) {
    std::string extension = std::filesystem::path(operand).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return operand.starts_with('@') || extension == ".gltf" || extension == ".glb" || extension.empty();
}

} // namespace

int runInfo(const Arguments& arguments) {
    Diagnostics notes;
    const std::string& operand = arguments.operands[0];
    const bool json = arguments.on("json");
    if (!looksLikeScene(operand)) {
        printImageInfo(operand, json);
        return 0;
    }
    const Json info = describeScene(readSceneRequest(arguments), notes);
    if (json)
        fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
    else
        printScene(info);
    return arguments.on("strict") && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
