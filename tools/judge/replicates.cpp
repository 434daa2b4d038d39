#include "tools/judge/replicates.h"
#include "core/math/vec.h"
#include "core/render/error.h"
#include "tools/judge/pairwise.h"
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace chiaro::judge {

namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

uint32_t tilesAlong(uint32_t size, uint32_t tile) noexcept { return (size + tile - 1) / tile; }

using Values = std::array<double, meanCount>;
Values valuesAt(const std::vector<float>& plane, std::size_t pixel) noexcept {
    const double r = plane[3 * pixel], g = plane[3 * pixel + 1], b = plane[3 * pixel + 2];
    return {luminance(Rgb<double>(r, g, b)), r, g, b};
}

Evidence blank(uint32_t width, uint32_t height, uint32_t tile) {
    Evidence e;
    e.width = width, e.height = height, e.tile = tile;
    e.tilesX = tilesAlong(width, tile), e.tilesY = tilesAlong(height, tile);
    e.pixels.assign(std::size_t(width) * height, {nan, 0, 0});
    e.tiles.assign(std::size_t(e.tilesX) * e.tilesY, {nan, 0, 0});
    return e;
}

std::size_t tileIndex(std::size_t pixel, uint32_t width, uint32_t tile) noexcept {
    return pixel / width / tile * tilesAlong(width, tile) + pixel % width / tile;
}
} // namespace

const char* meanName(Mean m) noexcept {
    constexpr const char* names[] = {"Y", "R", "G", "B"};
    return names[std::size_t(m)];
}

Replicates::Replicates(uint32_t width, uint32_t height, const Region& region, uint32_t tile)
    : width_(width), height_(height), tile_(tile < 1 ? 1 : tile), tilesX_(tilesAlong(width, tile_)), tilesY_(tilesAlong(height, tile_)),
      keep_(selected(width, height, region)), bad_(keep_.size(), 0), pixels_(keep_.size()), tileCounts_(std::size_t(tilesX_) * tilesY_, 0) {
    for (std::size_t i = 0; i < keep_.size(); ++i) tileCounts_[tileOf(i)] += keep_[i];
}

std::size_t Replicates::tileOf(std::size_t pixel) const noexcept { return tileIndex(pixel, width_, tile_); }

void Replicates::add(const Picture& p) {
    if (p.width != width_ || p.height != height_ || p.rgb.size() != p.pixels() * 3)
        throw Error(Exit::unsupported, fmt::format("{} is {}x{}, the other replicates are {}x{}; render all at one size.", p.name, p.width,
                                                   p.height, width_, height_));
    sums_.emplace_back(tileCounts_.size());
    const double n = double(sums_.size());
    for (std::size_t i = 0; i < keep_.size(); ++i) {
        if (!keep_[i]) continue;
        const Values v = valuesAt(p.rgb, i);
        if (!std::isfinite(v[1]) || !std::isfinite(v[2]) || !std::isfinite(v[3])) {
            bad_[i] = 1;
            continue;
        }
        Running& at = pixels_[i];
        const double delta = v[0] - at.mean, step = delta / n, term = delta * step * (n - 1);
        at.m3 += term * step * (n - 2) - 3 * step * at.m2;
        at.m2 += term;
        at.mean += step;
        Values& sum = sums_.back()[tileOf(i)];
        for (std::size_t k = 0; k < meanCount; ++k) sum[k] += v[k];
    }
}

std::size_t Replicates::nonFinitePixels() const noexcept {
    std::size_t count = 0;
    for (const uint8_t b : bad_) count += b;
    return count;
}

std::vector<uint8_t> Replicates::badTiles() const {
    std::vector<uint8_t> bad(tileCounts_.size(), 0);
    for (std::size_t i = 0; i < bad_.size(); ++i) bad[tileOf(i)] |= bad_[i];
    return bad;
}

// Third cumulant over second, of the means of the pixels of each tile: (m3/n^3) / (m2/(n (n - 1))).
std::vector<double> Replicates::eventHeights(const std::vector<uint8_t>& leftOut) const {
    struct Sums {
        double second = 0, third = 0;
        double height(double n) const noexcept { return second > 0 && third > 0 ? third / second * (n - 1) / (n * n) : 0; }
    };
    std::vector<Sums> tiles(tileCounts_.size());
    Sums whole;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        if (!keep_[i] || leftOut[tileOf(i)]) continue;
        for (Sums* s : {&tiles[tileOf(i)], &whole}) s->second += pixels_[i].m2, s->third += pixels_[i].m3;
    }
    std::vector<double> heights;
    for (const Sums& s : tiles) heights.push_back((s.second > 0 ? s : whole).height(double(count())));
    return heights;
}

std::array<double, meanCount> Replicates::means(std::size_t replicate, const std::vector<uint8_t>& leftOut) const {
    const std::vector<Values>& tiles = sums_[replicate];
    std::size_t compared = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) compared += leftOut[t] ? 0 : tileCounts_[t];
    Values whole;
    for (std::size_t k = 0; k < meanCount; ++k)
        whole[k] = pairwiseSum(0, tiles.size(), [&](std::size_t t) { return leftOut[t] ? 0.0 : tiles[t][k]; }) / double(compared);
    return whole;
}

Evidence Replicates::evidence(const std::vector<uint8_t>& leftOut) const {
    Evidence e = blank(width_, height_, tile_);
    const double n = double(count()), dof = n - 1;
    e.replicates = n;
    for (std::size_t i = 0; i < pixels_.size(); ++i)
        if (keep_[i] && !leftOut[tileOf(i)]) e.pixels[i] = {pixels_[i].mean, std::sqrt(pixels_[i].m2 / (n * dof)), dof}, ++e.compared;
    e.events = eventHeights(leftOut);
    std::array<Moments, meanCount> image;
    std::vector<Moments> tiles(tileCounts_.size());
    for (std::size_t r = 0; r < sums_.size(); ++r) {
        for (std::size_t t = 0; t < tiles.size(); ++t)
            if (tileCounts_[t] > 0) tiles[t].add(sums_[r][t][0] / tileCounts_[t]);
        const Values whole = means(r, leftOut);
        for (std::size_t k = 0; k < meanCount; ++k) image[k].add(whole[k]);
    }
    for (std::size_t t = 0; t < tiles.size(); ++t)
        if (tileCounts_[t] > 0 && !leftOut[t]) e.tiles[t] = estimate(tiles[t]);
    for (std::size_t k = 0; k < meanCount; ++k) e.image[k] = estimate(image[k]);
    e.skewness = image[0].skewness();
    return e;
}

Replicates::State Replicates::state() const {
    State s{bad_, {}, {}, {}, sums_};
    for (const Running& p : pixels_) {
        s.mean.push_back(p.mean);
        s.m2.push_back(p.m2);
        s.m3.push_back(p.m3);
    }
    return s;
}

void Replicates::restore(State s) {
    bool fits = s.bad.size() == bad_.size() && s.mean.size() == bad_.size() && s.m2.size() == bad_.size() && s.m3.size() == bad_.size();
    for (const auto& replicate : s.sums) fits &= replicate.size() == tileCounts_.size();
    if (!fits) throw Error(Exit::unsupported, "replicates of another size cannot be gone on with");
    bad_ = std::move(s.bad);
    sums_ = std::move(s.sums);
    for (std::size_t i = 0; i < pixels_.size(); ++i) pixels_[i] = {s.mean[i], s.m2[i], s.m3[i]};
}

std::array<Estimate, meanCount> pairedDifferences(const Replicates& test, const Replicates& reference,
                                                  const std::vector<uint8_t>& leftOut) {
    if (test.count() != reference.count())
        throw Error(Exit::unsupported, fmt::format("{} and {} replicates are no pairs", test.count(), reference.count()));
    std::array<Moments, meanCount> differences;
    for (std::size_t r = 0; r < test.count(); ++r) {
        const Values a = test.means(r, leftOut), b = reference.means(r, leftOut);
        for (std::size_t k = 0; k < meanCount; ++k) differences[k].add(a[k] - b[k]);
    }
    std::array<Estimate, meanCount> all;
    for (std::size_t k = 0; k < meanCount; ++k) all[k] = estimate(differences[k]);
    return all;
}

std::vector<uint8_t> badTiles(const Picture& p, const Region& region, uint32_t tile) {
    Replicates one(p.width, p.height, region, tile);
    one.add(p);
    std::vector<uint8_t> bad = one.badTiles();
    const std::vector<uint8_t> keep = selected(p.width, p.height, region);
    for (std::size_t i = 0; i < keep.size() && !p.error.empty(); ++i)
        for (std::size_t k = 3 * i; keep[i] && k < 3 * i + 3; ++k)
            if (!std::isfinite(p.error[k]) || p.error[k] < 0) bad[tileIndex(i, p.width, tile)] = 1;
    return bad;
}

Evidence evidenceOf(const Picture& p, const Region& region, const std::vector<uint8_t>& leftOut, uint32_t tile) {
    if (p.error.size() != p.rgb.size())
        throw Error(Exit::unsupported,
                    fmt::format("{}: no error layer; render it with one, or compare replicates of other seeds.", p.name));
    Evidence e = blank(p.width, p.height, tile);
    e.pooled = true;
    const std::vector<uint8_t> keep = selected(p.width, p.height, region);
    struct Sum {
        double value = 0, variance = 0;
    };
    std::vector<Sum> tiles(e.tiles.size());
    std::vector<std::size_t> counts(e.tiles.size(), 0);
    std::array<Sum, meanCount> image;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        const std::size_t t = tileIndex(i, p.width, tile);
        if (!keep[i] || leftOut[t]) continue;
        const Values value = valuesAt(p.rgb, i), error = valuesAt(p.error, i);
        e.pixels[i] = {value[0], error[0], infinity};
        tiles[t].value += value[0], tiles[t].variance += error[0] * error[0];
        for (std::size_t k = 0; k < meanCount; ++k) image[k].value += value[k], image[k].variance += error[k] * error[k];
        ++counts[t], ++e.compared;
    }
    const auto mean = [](const Sum& s, std::size_t n) {
        return Estimate{s.value / double(n), std::sqrt(s.variance) / double(n), infinity};
    };
    for (std::size_t t = 0; t < tiles.size(); ++t)
        if (counts[t] > 0) e.tiles[t] = mean(tiles[t], counts[t]);
    for (std::size_t k = 0; k < meanCount; ++k) e.image[k] = mean(image[k], e.compared);
    return e;
}

} // namespace chiaro::judge
