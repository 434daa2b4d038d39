#include "tools/cli/compare_input.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

struct Frame { // what a picture covers
    std::string name, fix;
    uint32_t width = 0, height = 0;
    Rect window;
};

std::string shown(const Rect& r) { return fmt::format("{}x{}+{}+{}", r.width(), r.height(), r.x0, r.y0); }
bool inside(const Rect& r, const Rect& of) { return r.x0 >= of.x0 && r.y0 >= of.y0 && r.x1 <= of.x1 && r.y1 <= of.y1; }
Rect common(const Rect& a, const Rect& b) {
    const Rect r{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
    return r.x0 < r.x1 && r.y0 < r.y1 ? r : Rect{};
}

void requireSame(const Frame& first, const Frame& other) {
    if (first.width != other.width || first.height != other.height)
        throw Error(Exit::unsupported, fmt::format("{} is {}x{}, {} is {}x{}; use {}--crop or --fit to compare.", first.name, first.width,
                                                   first.height, other.name, other.width, other.height,
                                                   first.fix.empty() ? "" : fmt::format("--size {}x{}, ", other.width, other.height)));
    if (first.window != other.window)
        throw Error(Exit::unsupported, fmt::format("{} has the window {}, {} has {}; use --crop or --fit to compare.", first.name,
                                                   shown(first.window), other.name, shown(other.window)));
}

Rect areaOf(const std::vector<Frame>& frames, const CompareSettings& s) {
    Rect area = frames[0].window;
    uint32_t width = frames[0].width, height = frames[0].height;
    for (const Frame& f : frames) {
        if (!s.fit && s.base.crop.empty()) requireSame(frames[0], f);
        const Rect both = common(area, f.window);
        if (both.area() == 0)
            throw Error(Exit::unsupported, fmt::format("{} has the window {}, {} has {}: no pixel in common", frames[0].name,
                                                       shown(frames[0].window), f.name, shown(f.window)));
        area = both;
        width = std::min(width, f.width);
        height = std::min(height, f.height);
    }
    if (s.base.crop.empty()) return area;
    const Rect crop = parseCrop("crop", s.base.crop, {width, height});
    if (!inside(crop, area))
        throw Error(Exit::unsupported, fmt::format("--crop {}: all pictures have pixels in {} alone", s.base.crop, shown(area)));
    return crop;
}

std::size_t notFinite(const judge::Picture& p) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < p.rgb.size(); i += 3)
        n += !std::isfinite(p.rgb[i]) || !std::isfinite(p.rgb[i + 1]) || !std::isfinite(p.rgb[i + 2]);
    return n;
}

} // namespace

FilePictures loadPictures(const CompareSettings& s, const View* view, Diagnostics& notes) {
    std::vector<std::string> files = s.images;
    if (s.reference == ReferenceKind::file) files.push_back(s.referenceFile);
    std::vector<Picture> pictures;
    std::vector<Frame> frames;
    if (view)
        frames.push_back({s.base.scene.operand, "--size", view->width, view->height,
                          s.base.crop.empty() ? view->crop : Rect{0, 0, view->width, view->height}});
    for (const std::string& file : files) {
        pictures.push_back(readPicture(file));
        frames.push_back({file, "", pictures.back().width, pictures.back().height, pictures.back().window});
    }
    FilePictures all;
    all.width = frames[0].width;
    all.height = frames[0].height;
    all.area = areaOf(frames, s);
    std::vector<std::string> encoded, linear;
    if (view) linear.push_back(s.base.scene.operand);
    for (std::size_t i = 0; i < files.size(); ++i) {
        const ChosenChannels chosen = chooseColor(pictures[i], files[i], s.layer);
        PictureSide side = makeSide(pictures[i], files[i], chosen, all.area, s.layer.empty());
        pictures[i] = {};
        (side.encoded ? encoded : linear).push_back(files[i]);
        if (const std::size_t n = notFinite(side.picture))
            notes.warn(fmt::format("{}: {} of {} pixels are not finite; left out of the metrics", files[i], n, all.area.area()));
        if (i == s.images.size())
            all.reference = std::move(side);
        else
            all.pictures.push_back(std::move(side));
    }
    if (!encoded.empty() && !linear.empty())
        notes.warn(fmt::format("{} holds encoded colours for a screen, {} linear radiance: exposure alone makes them differ", encoded[0],
                               linear[0]));
    return all;
}

} // namespace chiaro::cli
