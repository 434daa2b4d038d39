#include "io/picture.h"
#include "tools/cli/diff.h"
#include "tools/cli/values.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

Rect common(const Rect& a, const Rect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}
std::string shown(const Rect& r) { return fmt::format("{}x{}+{}+{}", r.width(), r.height(), r.x0, r.y0); }
bool inside(const Rect& r, const Rect& of) { return r.x0 >= of.x0 && r.y0 >= of.y0 && r.x1 <= of.x1 && r.y1 <= of.y1; }

// What both pictures have, and of it the crop.
void findArea(DiffInputs& in, const Picture& a, const Picture& b, const DiffSettings& s) {
    const bool sameSize = a.width == b.width && a.height == b.height;
    if (!s.fit && s.crop.empty() && !sameSize)
        throw Error(Exit::unsupported, fmt::format("{} is {}x{}, {} is {}x{}; use --crop or --fit to compare.", s.fileA, a.width, a.height,
                                                   s.fileB, b.width, b.height));
    if (!s.fit && s.crop.empty() && a.window != b.window)
        throw Error(Exit::unsupported, fmt::format("{} has the window {}, {} has {}; use --crop or --fit to compare.", s.fileA,
                                                   shown(a.window), s.fileB, shown(b.window)));
    in.area = common(a.window, b.window);
    if (in.area.x0 >= in.area.x1 || in.area.y0 >= in.area.y1)
        throw Error(Exit::unsupported,
                    fmt::format("{} has the window {}, {} has {}: no pixel in common", s.fileA, shown(a.window), s.fileB, shown(b.window)));
    if (s.crop.empty()) return;
    const Rect crop = parseCrop("crop", s.crop, {std::min(a.width, b.width), std::min(a.height, b.height)});
    if (!inside(crop, in.area))
        throw Error(Exit::unsupported, fmt::format("--crop {}: both pictures have pixels in {} alone", s.crop, shown(in.area)));
    in.region.crop = Rect{crop.x0 - in.area.x0, crop.y0 - in.area.y0, crop.x1 - in.area.x0, crop.y1 - in.area.y0};
}

void nameChannels(DiffInputs& in) {
    using judge::Channel;
    in.told.assign(judge::channels.begin(), judge::channels.end());
    in.columns = {"rgb", "Y", "R", "G", "B"};
    if (!in.color) {
        in.told = {Channel::all, Channel::red, Channel::green, Channel::blue};
        in.columns = {"all", "", "X", "Y", "Z"};
    }
    if (in.a.channels.size() > 1 || in.b.channels.size() > 1) return;
    in.told = {Channel::all};
    in.columns.fill(in.a.channels.front());
}

void readMask(DiffInputs& in, const DiffSettings& s) {
    const Picture mask = readPicture(s.mask);
    const auto fits = [&](const PictureSide& side) { return mask.width == side.width && mask.height == side.height; };
    if ((!fits(in.a) && !fits(in.b)) || !inside(in.area, mask.window))
        throw Error(Exit::unsupported, fmt::format("--mask {} is {}x{}, {} is {}x{}; make the mask of that size.", s.mask,
                                                   mask.window.width(), mask.window.height(), s.fileA, in.a.width, in.a.height));
    const std::vector<float> rgb = cutChannels(mask, chooseColor(mask, s.mask, {}).channels, in.area, false);
    in.region.mask.resize(in.area.area());
    for (std::size_t i = 0; i < in.region.mask.size(); ++i) in.region.mask[i] = (rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2]) / 3 >= 0.5f;
}

} // namespace

std::string DiffInputs::unit(const std::string& ofTable) const {
    return ofTable.find("cd/m2") == std::string::npos ? ofTable : color && linear() ? ofTable : "1";
}

DiffInputs loadDiffInputs(const DiffSettings& s, Diagnostics& notes) {
    const Picture a = readPicture(s.fileA), b = readPicture(s.fileB);
    DiffInputs in;
    findArea(in, a, b, s);
    const ChosenChannels ofA = chooseColor(a, s.fileA, s.layer), ofB = chooseColor(b, s.fileB, s.layer);
    in.color = ofA.color && ofB.color;
    in.a = makeSide(a, s.fileA, ofA, in.area, s.layer.empty());
    in.b = makeSide(b, s.fileB, ofB, in.area, s.layer.empty());
    nameChannels(in);
    if (in.a.encoded != in.b.encoded)
        notes.warn(fmt::format("{} holds encoded colours for a screen, {} linear radiance: exposure alone makes them differ",
                               in.a.encoded ? s.fileA : s.fileB, in.a.encoded ? s.fileB : s.fileA));
    if (!s.mask.empty()) readMask(in, s);
    const std::vector<uint8_t> keep = judge::selected(in.area.width(), in.area.height(), in.region);
    if (std::find(keep.begin(), keep.end(), 1) == keep.end())
        throw Error(Exit::unsupported, fmt::format("--mask {} leaves no pixel to compare; white pixels are compared.", s.mask));
    return in;
}

} // namespace chiaro::cli
