#include "tools/report/fit.h"
#include "core/render/error.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace chiaro::report {
namespace {

constexpr float largestHalf = 65504;
constexpr std::size_t mostPixels = std::size_t(1) << 22; // what a browser shows fluently, six times

// One picture or map at the present factor.
struct Source {
    uint32_t width = 0, height = 0, channels = 3;
    const std::vector<float>* values = nullptr;
    std::vector<float> reduced; // owns the values where factor > 1
    double low = 0, high = 1;   // maps
};
constexpr std::size_t mapLevels = 3; // as they are, means of 2 x 2, means of 4 x 4
struct Sources {
    std::vector<Source> pictures;
    std::array<std::vector<Source>, mapLevels> maps;
};
// A rung: mantissa bits of pictures, steps of maps on either side of the middle, level of maps.
struct Quality {
    int mantissa, steps;
    std::size_t level;
};
constexpr Quality ladder[] = {{10, 127, 0}, {10, 127, 1}, {9, 63, 1}, {8, 31, 1}, {7, 15, 1}, {6, 15, 2}, {5, 15, 1}, {5, 15, 2}};
constexpr Quality least = ladder[std::size(ladder) - 1];

Source sourceOf(const Image& image) {
    if (image.rgb.size() != std::size_t(image.width) * image.height * 3)
        throw Error(Exit::internal,
                    fmt::format("report: {} is {}x{} with {} values", image.name, image.width, image.height, image.rgb.size()));
    return {image.width, image.height, 3, &image.rgb, {}, 0, 1};
}

std::vector<Sources> sourcesOf(const Report& report) {
    std::vector<Sources> all;
    for (const Entry& e : report.entries) {
        Sources s;
        s.pictures.push_back(sourceOf(e.picture));
        for (const Image& layer : e.layers) s.pictures.push_back(sourceOf(layer));
        for (const Map& m : e.maps) {
            if (m.values.size() != std::size_t(e.picture.width) * e.picture.height)
                throw Error(Exit::internal, fmt::format("report: map {} of {} has {} values", m.name, e.name, m.values.size()));
            s.maps[0].push_back({e.picture.width, e.picture.height, 1, &m.values, {}, m.low, m.high});
        }
        all.push_back(std::move(s));
    }
    return all;
}

// Means of 2 x 2, of what there is at the borders. A picture's pixel that is not finite stays visible; a map's is left out of the mean.
Source halved(const Source& from) {
    Source to{(from.width + 1) / 2, (from.height + 1) / 2, from.channels, nullptr, {}, from.low, from.high};
    const bool picture = from.channels == 3;
    to.reduced.resize(std::size_t(to.width) * to.height * to.channels);
    for (uint32_t y = 0; y < to.height; ++y)
        for (uint32_t x = 0; x < to.width; ++x)
            for (uint32_t c = 0; c < to.channels; ++c) {
                double sum = 0;
                int count = 0;
                float odd = std::numeric_limits<float>::quiet_NaN();
                bool strange = false;
                for (uint32_t v = 2 * y; v < std::min(2 * y + 2, from.height); ++v)
                    for (uint32_t u = 2 * x; u < std::min(2 * x + 2, from.width); ++u) {
                        const float value = (*from.values)[(std::size_t(v) * from.width + u) * from.channels + c];
                        if (std::isfinite(value)) {
                            sum += value;
                            ++count;
                        } else {
                            if (!strange || std::isnan(value)) odd = value;
                            strange = true;
                        }
                    }
                const bool show = count == 0 || (picture && strange);
                to.reduced[(std::size_t(y) * to.width + x) * to.channels + c] = show ? odd : float(sum / count);
            }
    return to;
}

std::vector<Source> halved(const std::vector<Source>& from) {
    std::vector<Source> to;
    for (const Source& source : from) to.push_back(halved(source));
    for (Source& source : to) source.values = &source.reduced;
    return to;
}

// The levels of maps beyond the first.
void reduceMaps(std::vector<Sources>& all) {
    for (Sources& s : all)
        for (std::size_t level = 1; level < mapLevels; ++level) s.maps[level] = halved(s.maps[level - 1]);
}

void halve(std::vector<Sources>& all) {
    for (Sources& s : all) {
        s.pictures = halved(s.pictures);
        s.maps[0] = std::move(s.maps[1]);
    }
    reduceMaps(all);
}

Planes planes(const Source& s, Quality q, int exponent) {
    if (s.channels == 1) return planesOf(*s.values, s.width, s.height, s.low, s.high, q.steps);
    std::vector<uint16_t> halves(s.values->size());
    const float scale = std::ldexp(1.0f, -exponent);
    for (std::size_t i = 0; i < halves.size(); ++i) {
        const float v = (*s.values)[i] * scale;
        halves[i] = toHalf(std::isfinite((*s.values)[i]) ? std::clamp(v, -largestHalf, largestHalf) : v);
    }
    return planesOf(halves, s.width, s.height, q.mantissa);
}

std::uintmax_t characters(std::uintmax_t bytes) { return (bytes * 8 + 12) / 13 * 2; }

// The power of two that lets the largest value fit, as long as the median of what is lit keeps all its digits.
struct Range {
    int exponent = 0;
    std::size_t clipped = 0;
};
Range rangeOf(const std::vector<Sources>& all) {
    double largest = 0;
    std::vector<float> some;
    for (const Sources& s : all)
        for (const Source& p : s.pictures)
            for (std::size_t i = 0; i < p.values->size(); ++i) {
                const float v = std::abs((*p.values)[i]);
                if (!std::isfinite(v)) continue;
                largest = std::max(largest, double(v));
                if (v > 0 && i % 61 == 0) some.push_back(v);
            }
    if (some.empty()) some.push_back(1);
    std::nth_element(some.begin(), some.begin() + std::ptrdiff_t(some.size() / 2), some.end());
    const int median = int(std::floor(std::log2(some[some.size() / 2])));
    const int fits = largest > 0 ? int(std::ceil(std::log2(largest / largestHalf))) : 0;
    Range range;
    if (fits > 0) range.exponent = std::min(fits, std::max(0, median + 10));
    if (fits < 0 && median < -6) range.exponent = std::min(0, std::max(fits, median + 4));
    range.exponent = std::clamp(range.exponent, -100, 100);
    const double limit = std::ldexp(double(largestHalf), range.exponent);
    for (const Sources& s : all)
        for (const Source& p : s.pictures)
            for (const float v : *p.values) range.clipped += std::isfinite(v) && std::abs(double(v)) > limit;
    return range;
}

class Fitter {
public:
    Fitter(const Report& report, std::uintmax_t budget) : budget_(budget), sources_(sourcesOf(report)) {
        reduceMaps(sources_);
        for (const Entry& e : report.entries) mostLayers_ = std::max(mostLayers_, e.layers.size());
    }

    Fitted run() {
        const Range range = rangeOf(sources_);
        exponent_ = range.exponent;
        for (uint32_t factor = 1;; factor *= 2) {
            for (const Quality& q : ladder) {
                if (largest() > mostPixels) break;
                const std::size_t layers = fittingLayers(q);
                if (layers == none) continue;
                std::optional<Fitted> done;
                for (std::size_t keep = layers; !done; --keep) { // the estimate may be a little low
                    done = packed(q, keep);
                    if (keep == 0) break;
                }
                if (!done) continue;
                done->factor = factor;
                done->mapFactor = factor << q.level;
                describe(*done, range.clipped);
                return *std::move(done);
            }
            if (largest() <= 1) {
                Fitted last = packed(least, 0, true).value();
                last.factor = last.mapFactor = factor; // one pixel: its maps are one too
                describe(last, range.clipped);
                return last;
            }
            halve(sources_);
        }
    }

private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    std::size_t largest() const {
        std::size_t most = 0;
        for (const Sources& s : sources_)
            for (const Source& p : s.pictures) most = std::max(most, std::size_t(p.width) * p.height);
        return most;
    }

    // How many layers an entry may keep, by the estimated sizes; none: not even the pictures fit.
    std::size_t fittingLayers(Quality q) const {
        std::uintmax_t size = 0;
        const auto add = [&](const Source& s) { size += characters(packedSize(planes(s, q, exponent_))); };
        for (const Sources& s : sources_) {
            add(s.pictures[0]);
            for (const Source& m : s.maps[q.level]) add(m);
            if (size > budget_) return none;
        }
        for (std::size_t layer = 1; layer <= mostLayers_; ++layer) {
            for (const Sources& s : sources_)
                if (layer < s.pictures.size()) add(s.pictures[layer]);
            if (size > budget_) return layer - 1;
        }
        return mostLayers_;
    }

    std::optional<Fitted> packed(Quality q, std::size_t layers, bool always = false) const {
        Fitted out;
        out.exponent = exponent_;
        out.mantissa = q.mantissa;
        out.mapSteps = q.steps;
        out.layers = layers;
        std::uintmax_t size = 0;
        for (const Sources& s : sources_) {
            Fitted::Entry entry;
            const auto add = [&](std::vector<Block>& list, const Source& source) {
                list.push_back({source.width, source.height, {}});
                if (source.width == 0 || source.height == 0) return true;
                list.back().packed = pack(planes(source, q, exponent_));
                size += characters(list.back().packed.bytes.size());
                return always || size <= budget_;
            };
            for (std::size_t i = 0; i < std::min(layers + 1, s.pictures.size()); ++i)
                if (!add(entry.pictures, s.pictures[i])) return {};
            for (const Source& m : s.maps[q.level])
                if (!add(entry.maps, m)) return {};
            out.entries.push_back(std::move(entry));
        }
        return out;
    }

    void describe(Fitted& f, std::size_t clipped) const {
        if (f.layers < mostLayers_)
            f.reductions.push_back(f.layers == 0 ? fmt::format("the {} layers are left out", mostLayers_)
                                                 : fmt::format("only the first {} of {} layers are kept", f.layers, mostLayers_));
        if (f.factor > 1)
            f.reductions.push_back(
                fmt::format("pictures are reduced to means of {0} x {0} pixels; numbers and maps were computed before", f.factor));
        if (f.mapFactor > f.factor) f.reductions.push_back(fmt::format("maps are reduced to means of {0} x {0} pixels", f.mapFactor));
        if (f.mantissa < 10)
            f.reductions.push_back(fmt::format("pictures' values are kept to {:.2g} % ({} bits of mantissa instead of 10)",
                                               100 * std::ldexp(1.0, -f.mantissa - 1), f.mantissa));
        if (f.mapSteps < 127) f.reductions.push_back(fmt::format("maps are kept to {} levels", 2 * f.mapSteps + 1));
        if (clipped > 0)
            f.reductions.push_back(
                fmt::format("{} values above {:.4g} are kept as that", clipped, std::ldexp(double(largestHalf), f.exponent)));
    }

    std::uintmax_t budget_;
    std::vector<Sources> sources_;
    std::size_t mostLayers_ = 0;
    int exponent_ = 0;
};

} // namespace

Fitted fit(const Report& report, std::uintmax_t budget) { return Fitter(report, budget).run(); }

} // namespace chiaro::report
