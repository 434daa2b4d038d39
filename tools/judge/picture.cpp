#include "tools/judge/picture.h"
#include "core/render/error.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace chiaro::judge {

namespace {
std::string lower(std::string s) {
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return s;
}

void requirePlanes(const Picture& p) {
    if (p.rgb.size() != p.pixels() * 3)
        throw Error(Exit::unsupported, fmt::format("{}: {}x{} with {} values, needs {} (RGB, interleaved)", p.name, p.width, p.height,
                                                   p.rgb.size(), p.pixels() * 3));
    if (!p.error.empty() && p.error.size() != p.rgb.size())
        throw Error(Exit::unsupported,
                    fmt::format("{}: the error layer has {} values, the picture {}", p.name, p.error.size(), p.rgb.size()));
}
} // namespace

ChannelChoice chooseChannels(const std::vector<std::string>& names, const std::string& layer) {
    ChannelChoice choice;
    const std::string prefix = layer.empty() ? std::string{} : lower(layer) + ".";
    const auto find = [&](const std::vector<std::string>& wanted) -> std::optional<std::size_t> {
        for (std::size_t i = 0; i < names.size(); ++i)
            for (const std::string& w : wanted)
                if (lower(names[i]) == prefix + w) return i;
        return {};
    };
    choice.red = find({"r", "red"});
    choice.green = find({"g", "green"});
    choice.blue = find({"b", "blue"});
    if (!choice.red || !choice.green || !choice.blue) {
        std::optional<std::size_t> grey = find({"y", "l", "luminance"});
        if (!grey && names.size() == 1 && layer.empty()) grey = 0;
        choice.red = choice.green = choice.blue = grey;
    }
    for (std::size_t i = 0; i < names.size(); ++i)
        if (i != choice.red && i != choice.green && i != choice.blue) choice.ignored.push_back(names[i]);
    return choice;
}

void requireComparable(const Picture& test, const Picture& reference, const Region& region) {
    if (test.width != reference.width || test.height != reference.height)
        throw Error(Exit::unsupported, fmt::format("{} is {}x{}, {} is {}x{}; use --crop or --fit to compare.", test.name, test.width,
                                                   test.height, reference.name, reference.width, reference.height));
    requirePlanes(test);
    requirePlanes(reference);
    if (!region.mask.empty() && region.mask.size() != reference.pixels())
        throw Error(Exit::unsupported, fmt::format("the mask has {} pixels, the pictures {}; make it {}x{}.", region.mask.size(),
                                                   reference.pixels(), reference.width, reference.height));
    if (!region.crop) return;
    const Rect& c = *region.crop;
    if (c.x0 > c.x1 || c.y0 > c.y1 || c.x1 > reference.width || c.y1 > reference.height)
        throw Error(Exit::unsupported,
                    fmt::format("--crop {},{} to {},{} does not lie inside the {}x{} pictures; give WxH+X+Y within them.", c.x0, c.y0, c.x1,
                                c.y1, reference.width, reference.height));
}

std::vector<uint8_t> selected(uint32_t width, uint32_t height, const Region& region) {
    std::vector<uint8_t> keep(std::size_t(width) * height, 0);
    const Rect c = region.crop.value_or(Rect{0, 0, width, height});
    for (uint32_t y = c.y0; y < std::min(c.y1, height); ++y)
        for (uint32_t x = c.x0; x < std::min(c.x1, width); ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            keep[i] = region.mask.empty() || region.mask[i] != 0;
        }
    return keep;
}

} // namespace chiaro::judge
