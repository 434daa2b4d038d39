#include "tools/cli/info_image.h"
#include "io/picture.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Range {
    double low = INFINITY, high = -INFINITY, mean = 0;
    uint64_t notFinite = 0;
};
Range rangeOf(const std::vector<float>& plane) {
    Range r;
    uint64_t count = 0;
    for (float v : plane) {
        if (!std::isfinite(v)) {
            ++r.notFinite;
            continue;
        }
        r.low = std::min(r.low, double(v));
        r.high = std::max(r.high, double(v));
        r.mean += v;
        ++count;
    }
    if (count)
        r.mean /= double(count);
    else
        r.low = r.high = 0;
    return r;
}

std::string asText(const MetadataValue& value) {
    return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

} // namespace

void printImageInfo(const std::string& file, bool json) {
    const Picture picture = readPicture(file);
    const Rect& w = picture.window;
    Json info{{"image", file}, {"size", {picture.width, picture.height}}, {"window", {w.x0, w.y0, w.width(), w.height()}}};
    for (std::size_t c = 0; c < picture.names.size(); ++c) {
        const Range r = rangeOf(picture.planes[c]);
        info["channels"].push_back(
            {{"name", picture.names[c]}, {"least", r.low}, {"most", r.high}, {"mean", r.mean}, {"notFinite", r.notFinite}});
    }
    for (const auto& [name, value] : picture.metadata) info["metadata"][name] = asText(value);
    if (json) {
        fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    fmt::print("{:<12} {}   {}x{}", "image", file, picture.width, picture.height);
    if (w.width() != picture.width || w.height() != picture.height) fmt::print(", window {}x{}+{}+{}", w.width(), w.height(), w.x0, w.y0);
    fmt::print("\n{:<12} {}\n", "channels", picture.names.size());
    for (const Json& c : info["channels"])
        fmt::print("{:<12}   {:<12} {:.5g} to {:.5g}, mean {:.5g}{}\n", "", c["name"].get<std::string>(), c["least"].get<double>(),
                   c["most"].get<double>(), c["mean"].get<double>(),
                   c["notFinite"].get<uint64_t>() ? fmt::format(", {} not finite", c["notFinite"].get<uint64_t>()) : "");
    if (picture.metadata.empty()) return;
    fmt::print("{:<12}\n", "metadata");
    for (const auto& [name, value] : picture.metadata) fmt::print("{:<12}   {:<22} {}\n", "", name, asText(value));
}

} // namespace chiaro::cli
