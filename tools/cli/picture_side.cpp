#include "tools/cli/picture_side.h"
#include "core/render/error.h"
#include "core/scene/texture.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>

namespace chiaro::cli {
namespace {

std::string lower(std::string s) {
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return s;
}

// "albedo" of "albedo.R"; a name without a layer is its own.
std::string layerOf(const std::string& channel) { return channel.substr(0, channel.rfind('.')); }

std::vector<std::string> layersOf(const std::vector<std::string>& channels) {
    std::vector<std::string> layers;
    for (const std::string& c : channels)
        if (std::find(layers.begin(), layers.end(), layerOf(c)) == layers.end()) layers.push_back(layerOf(c));
    return layers;
}

using Triple = std::array<std::size_t, 3>;

std::optional<Triple> named(const std::vector<std::string>& names, const std::string& layer, const char* const (&ends)[3]) {
    Triple found{};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string wanted = lower(layer.empty() ? ends[c] : layer + "." + ends[c]);
        const auto at = std::find_if(names.begin(), names.end(), [&](const std::string& n) { return lower(n) == wanted; });
        if (at == names.end()) return std::nullopt;
        found[c] = std::size_t(at - names.begin());
    }
    return found;
}

} // namespace

ChosenChannels chooseColor(const Picture& p, const std::string& file, const std::string& layer) {
    if (!layer.empty()) {
        if (const auto xyz = named(p.names, layer, {"X", "Y", "Z"})) return {*xyz, false};
        for (std::size_t i = 0; i < p.names.size(); ++i)
            if (lower(p.names[i]) == lower(layer)) return {{i, i, i}, false};
    }
    const judge::ChannelChoice choice = judge::chooseChannels(p.names, layer);
    if (choice.red && choice.green && choice.blue) return {{*choice.red, *choice.green, *choice.blue}, true};
    const std::vector<std::string> have = layersOf(p.names);
    if (layer.empty())
        throw Error(Exit::unsupported,
                    fmt::format("{} has no R, G, B and no Y but {}; compare one of them with --layer NAME.", file, fmt::join(have, ", ")));
    const std::string near = nearest(layer, have);
    throw Error(Exit::unsupported, fmt::format("{} has no layer \"{}\"; have {}{}", file, layer, fmt::join(have, ", "),
                                               near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

std::vector<float> cutChannels(const Picture& p, const std::array<std::size_t, 3>& channels, const Rect& area, bool decode) {
    std::vector<float> rgb;
    rgb.reserve(area.area() * 3);
    for (uint32_t y = area.y0; y < area.y1; ++y)
        for (uint32_t x = area.x0; x < area.x1; ++x)
            for (const std::size_t c : channels) {
                const float v = p.planes[c][std::size_t(y - p.window.y0) * p.window.width() + (x - p.window.x0)];
                rgb.push_back(decode ? srgbToLinear(v) : v);
            }
    return rgb;
}

PictureSide makeSide(const Picture& p, const std::string& file, const ChosenChannels& chosen, const Rect& area, bool errors) {
    PictureSide side;
    side.file = file;
    side.width = p.width;
    side.height = p.height;
    side.encoded = p.integer && chosen.color;
    side.picture.width = area.width();
    side.picture.height = area.height();
    side.picture.name = file;
    side.picture.rgb = cutChannels(p, chosen.channels, area, side.encoded);
    std::vector<bool> used(p.names.size());
    for (const std::size_t c : chosen.channels) {
        if (!used[c]) side.channels.push_back(p.names[c]);
        used[c] = true;
    }
    const auto error = errors ? named(p.names, "error", {"R", "G", "B"}) : std::nullopt;
    if (error) {
        side.picture.error = cutChannels(p, *error, area, false);
        for (const std::size_t c : *error) used[c] = true;
    }
    std::vector<std::string> rest;
    for (std::size_t c = 0; c < used.size(); ++c)
        if (!used[c]) rest.push_back(p.names[c]);
    side.ignored = layersOf(rest);
    return side;
}

} // namespace chiaro::cli
