#include "tools/bake/layout.h"
#include "core/render/error.h"
#include "tools/bake/pack.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unordered_map>

namespace chiaro::bake {
namespace {

using Triangle2 = std::array<Point2, 3>;
constexpr uint32_t keepCells = 1024; // along a layout, to see whether it overlaps itself
constexpr uint32_t standardSize = 512;
constexpr float slack = 1e-4f; // of coordinates about the unit square

double areaOf(const Scene& scene, const DrawnPart& part, float time) {
    double sum = 0;
    for (uint32_t t = 0; t < part.triangles; ++t) {
        const auto c = scene.corners(part, t, time);
        sum += 0.5 * double(length(cross(c[1] - c[0], c[2] - c[0])));
    }
    return sum;
}
double areaOf(std::span<const Triangle2> triangles) {
    double sum = 0;
    for (const Triangle2& t : triangles) sum += std::fabs(cross2(t[0], t[1], t[2])) / 2;
    return sum;
}

std::vector<Triangle2> cornersOfSet(const Scene& scene, const DrawnPart& part, int set) {
    std::vector<Triangle2> all(part.triangles);
    for (uint32_t t = 0; t < part.triangles; ++t)
        for (int k = 0; k < 3; ++k)
            all[t][k] = scene.attributes({part.geometry, t, part.instance, k == 1 ? 1.f : 0.f, k == 2 ? 1.f : 0.f, 0}).uv[set];
    return all;
}

// What a part brings along, if it can be kept.
struct Brought {
    int set = -1;
    uint64_t overlapping = 0; // of the best set, where none can be kept
    bool outside = false, absent = true;
    std::vector<Triangle2> corners;
};
// A surface squeezed onto a line of the texture has no room for light.
bool squeezed(const Scene& scene, const DrawnPart& part, std::span<const Triangle2> corners, float time) {
    for (uint32_t t = 0; t < part.triangles; ++t) {
        if (cross2(corners[t][0], corners[t][1], corners[t][2]) != 0) continue;
        const auto c = scene.corners(part, t, time);
        if (length(cross(c[1] - c[0], c[2] - c[0])) > 0) return true;
    }
    return false;
}
Brought broughtBy(const Scene& scene, const DrawnPart& part, float time) {
    Brought b;
    for (const int set : {1, 0}) {
        std::vector<Triangle2> corners = cornersOfSet(scene, part, set);
        if (!(areaOf(corners) > 1e-12)) continue;
        b.absent = false;
        const bool inside = std::all_of(corners.begin(), corners.end(), [](const Triangle2& t) {
            return std::all_of(t.begin(), t.end(),
                               [](Point2 p) { return p.x >= -slack && p.y >= -slack && p.x <= 1 + slack && p.y <= 1 + slack; });
        });
        const bool flat = squeezed(scene, part, corners, time);
        b.outside = b.outside || !inside;
        const uint64_t twice = overlaps(corners, keepCells);
        if (b.set < 0) b.overlapping = twice;
        if (!inside || flat || twice > 0) continue;
        return {.set = set, .corners = std::move(corners)};
    }
    return b;
}

[[noreturn]] void failKeep(const Scene& scene, const DrawnPart& part, const Brought& b) {
    const std::string what = b.absent        ? "has no texture coordinates"
                             : b.outside     ? "repeats its textures (coordinates outside 0 to 1)"
                             : b.overlapping ? fmt::format("has texture coordinates that overlap ({} of 1024x1024 cells)", b.overlapping)
                                             : "has triangles without room in its texture coordinates";
    throw Error(Exit::unsupported, fmt::format("--uv keep: a surface with material \"{}\" {}; use --uv auto or new",
                                               scene.material(part.material).name, what));
}

class LayoutMaker {
public:
    LayoutMaker(const Scene& scene, std::span<const uint32_t> parts, const LayoutSettings& s, float time)
        : scene_(scene), settings_(s), time_(time) {
        for (const uint32_t p : parts) {
            PartLayout& l = layout_.parts.emplace_back();
            l.part = p;
            l.corners.resize(scene.parts()[p].triangles);
            l.chart.resize(l.corners.size(), noChart);
            area_ += areaOf(scene, scene.parts()[p], time);
        }
        if (!(area_ > 0)) throw Error(Exit::unsupported, "there is no surface to bake: all triangles are without area");
    }
    Layout run() {
        if (!keepAll()) {
            chart();
            place();
        }
        return std::move(layout_);
    }

private:
    // All layouts to the letter; false where that cannot be.
    bool keepAll() {
        brought_.resize(layout_.parts.size());
        if (settings_.uv == UvChoice::fresh) return false;
        std::vector<Triangle2> all;
        std::unordered_map<uint32_t, std::size_t> looked; // of each geometry: the first of brought_
        bool every = true;
        for (std::size_t i = 0; i < brought_.size(); ++i) {
            const DrawnPart& part = scene_.parts()[layout_.parts[i].part];
            // Instances of one mesh bring the same.
            const auto [first, isNew] = looked.try_emplace(part.geometry, i);
            brought_[i] = isNew ? broughtBy(scene_, part, time_) : brought_[first->second];
            layout_.parts[i].overlapping = brought_[i].overlapping;
            if (brought_[i].set < 0 && settings_.uv == UvChoice::keep) failKeep(scene_, part, brought_[i]);
            every = every && brought_[i].set >= 0 && brought_[i].set == brought_[0].set;
            if (every) all.insert(all.end(), brought_[i].corners.begin(), brought_[i].corners.end());
        }
        if (!every || overlaps(all, 2 * keepCells) > 0) return false;
        const double perTexel = std::sqrt(areaOf(all) / area_); // of the unit square, a metre
        layout_.size = settings_.size > 0      ? settings_.size
                       : settings_.density > 0 ? checked(std::ceil(settings_.density / perTexel))
                                               : standardSize;
        layout_.density = perTexel * layout_.size;
        layout_.literal = true;
        for (std::size_t i = 0; i < brought_.size(); ++i) {
            PartLayout& l = layout_.parts[i];
            l.kept = brought_[i].set;
            l.literal = true;
            std::fill(l.chart.begin(), l.chart.end(), layout_.charts);
            ++layout_.charts;
            ++layout_.keptParts;
            for (std::size_t t = 0; t < l.corners.size(); ++t)
                for (int k = 0; k < 3; ++k)
                    l.corners[t][k] = {brought_[i].corners[t][k].x * float(layout_.size),
                                       brought_[i].corners[t][k].y * float(layout_.size)};
        }
        return true;
    }
    void chart() {
        for (std::size_t i = 0; i < brought_.size(); ++i) {
            PartLayout& l = layout_.parts[i];
            const DrawnPart& part = scene_.parts()[l.part];
            if (brought_[i].set >= 0) {
                const float scale = float(std::sqrt(areaOf(scene_, part, time_) / areaOf(brought_[i].corners)));
                for (Triangle2& t : brought_[i].corners)
                    for (Point2& p : t) p = {p.x * scale, p.y * scale};
                std::vector<uint32_t> triangles(part.triangles);
                for (uint32_t t = 0; t < part.triangles; ++t) triangles[t] = t;
                charts_.push_back(chartOf(l.part, std::move(triangles), std::move(brought_[i].corners)));
                l.kept = brought_[i].set;
                ++layout_.keptParts;
                owner_.push_back(i);
            } else {
                for (Chart& c : growCharts(scene_, l.part, time_)) {
                    charts_.push_back(std::move(c));
                    owner_.push_back(i);
                }
            }
        }
        brought_.clear();
        layout_.charts = uint32_t(charts_.size());
    }
    // Rooms for the charts at a density, padding on two sides; their places in a map of this size.
    std::optional<std::vector<Pixel>> fits(double density, uint32_t size) {
        extents_.resize(charts_.size());
        for (std::size_t i = 0; i < charts_.size(); ++i) {
            const double w = std::ceil(charts_[i].width * density) + 1, h = std::ceil(charts_[i].height * density) + 1;
            if (w > size || h > size) return {};
            extents_[i] = {uint32_t(w) + settings_.padding, uint32_t(h) + settings_.padding};
        }
        return pack(extents_, size + settings_.padding); // the last padding may lie outside
    }
    uint32_t checked(double size) const {
        if (size > settings_.most)
            throw Error(Exit::resources,
                        fmt::format("a light map of {:g} texels a metre would be larger than {}x{}; try --density {:.3g}, or "
                                    "bake parts of the scene apart",
                                    settings_.density, settings_.most, settings_.most, settings_.density * settings_.most / size));
        return uint32_t(std::max(size, 1.0));
    }
    struct Fit {
        double density = 0; // 0: none
        std::vector<Pixel> places;
    };
    // The most texels a metre that a map of this size holds.
    Fit finest(uint32_t size) {
        Fit best;
        double low = 0, high = std::sqrt(double(size) * size / area_);
        for (int i = 0; i < 14; ++i) {
            const double middle = (low + high) / 2;
            if (auto places = fits(middle, size)) {
                low = middle;
                best = {middle, std::move(*places)};
            } else {
                high = middle;
            }
        }
        return best;
    }
    // Of a map of no given size: as large as it takes for charts to fill a fifth of it, where the rest is not padding alone.
    Fit byItself() {
        constexpr double leastUse = 0.2;
        constexpr uint32_t mostByItself = 4096;
        for (uint32_t size = standardSize; size <= settings_.most; size *= 2) {
            Fit fit = finest(size);
            const double use = fit.density * fit.density * area_ / (double(size) * size);
            if (fit.density == 0 || (use < leastUse && size < mostByItself)) continue;
            layout_.size = size;
            return fit;
        }
        throw Error(Exit::resources, fmt::format("{} charts do not fit into a light map of {}x{}; use --to vertex", charts_.size(),
                                                 settings_.most, settings_.most));
    }
    Fit bySize() {
        layout_.size = settings_.size;
        Fit fit = finest(settings_.size);
        if (fit.density == 0)
            throw Error(Exit::usage, fmt::format("--size {}: {} charts do not fit into the light map; give a larger one", settings_.size,
                                                 charts_.size()));
        return fit;
    }
    Fit byDensity() {
        const double least = std::sqrt(area_) * settings_.density;
        for (uint64_t size = 64;; size *= 2) {
            if (size > settings_.most) checked(std::max(double(size), least));
            if (double(size) < least) continue;
            if (auto places = fits(settings_.density, uint32_t(size))) {
                layout_.size = uint32_t(size);
                return {settings_.density, std::move(*places)};
            }
        }
    }
    void place() {
        const Fit fit = settings_.size > 0 ? bySize() : settings_.density > 0 ? byDensity() : byItself();
        layout_.density = fit.density;
        fits(layout_.density, layout_.size); // the extents of this density
        for (std::size_t i = 0; i < charts_.size(); ++i) settle(i, fit.places[i]);
    }
    void settle(std::size_t i, Pixel at) {
        const Chart& c = charts_[i];
        PartLayout& l = layout_.parts[owner_[i]];
        const double d = layout_.density, w = extents_[i].w - settings_.padding, h = extents_[i].h - settings_.padding;
        const double x0 = at.x + (w - c.width * d) / 2, y0 = at.y + (h - c.height * d) / 2;
        for (std::size_t k = 0; k < c.triangles.size(); ++k) {
            l.chart[c.triangles[k]] = uint32_t(i);
            for (int v = 0; v < 3; ++v)
                l.corners[c.triangles[k]][v] = {float(x0 + c.corners[k][v].x * d), float(y0 + c.corners[k][v].y * d)};
        }
    }

    const Scene& scene_;
    const LayoutSettings& settings_;
    float time_;
    double area_ = 0; // square metres
    std::vector<Brought> brought_;
    std::vector<Chart> charts_;
    std::vector<std::size_t> owner_; // of each chart: its part in layout_
    std::vector<Extent> extents_;
    Layout layout_;
};

} // namespace

Layout makeLayout(const Scene& scene, std::span<const uint32_t> parts, const LayoutSettings& settings, float time) {
    return LayoutMaker(scene, parts, settings, time).run();
}

} // namespace chiaro::bake
