#include "tools/judge/rare_events.h"
#include <algorithm>
#include <cmath>

namespace chiaro::judge {

namespace {
// Variance-weighted mean of variance/mean.
struct Height {
    double weighted = 0, variance = 0;
    void add(const Estimate& e) noexcept {
        const double v = e.error * e.error, m = std::abs(e.mean);
        if (!(v > 0) || !(m > 0)) return; // also what is left out
        weighted += v * (v / m);
        variance += v;
    }
    void add(const Height& other) noexcept {
        weighted += other.weighted;
        variance += other.variance;
    }
    double value() const noexcept { return variance > 0 ? weighted / variance : 0; }
};
Height all(const std::vector<Height>& parts) noexcept {
    Height sum;
    for (const Height& h : parts) sum.add(h);
    return sum;
}

// Heights of events at every tile's pixels.
std::vector<double> pixelHeights(const Evidence& e) {
    std::vector<Height> tiles(e.tiles.size());
    for (std::size_t i = 0; i < e.pixels.size(); ++i) tiles[i / e.width / e.tile * e.tilesX + i % e.width / e.tile].add(e.pixels[i]);
    const double whole = all(tiles).value();
    std::vector<double> heights;
    for (const Height& h : tiles) heights.push_back(h.variance > 0 ? h.value() : whole);
    return heights;
}

// Heights of events in the means of tiles.
std::vector<double> tileHeights(const Evidence& e) {
    std::vector<Height> tiles(e.tiles.size());
    for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t].add(e.tiles[t]);
    const double whole = all(tiles).value();
    std::vector<double> heights;
    for (uint32_t y = 0; y < e.tilesY; ++y)
        for (uint32_t x = 0; x < e.tilesX; ++x) {
            Height around;
            for (uint32_t v = y > 0 ? y - 1 : 0; v < std::min(y + 2, e.tilesY); ++v)
                for (uint32_t u = x > 0 ? x - 1 : 0; u < std::min(x + 2, e.tilesX); ++u) around.add(tiles[v * e.tilesX + u]);
            heights.push_back(around.variance > 0 ? around.value() : whole);
        }
    return heights;
}

void raise(Estimate& e, double height, double mean) noexcept {
    if (mean < enoughEvents * height) e.error = std::max(e.error, std::sqrt(height * mean));
}
void raise(Estimate& a, double heightA, Estimate& b, double heightB) noexcept {
    if (std::isnan(a.mean) || std::isnan(b.mean)) return;
    if (a.mean == b.mean && a.error == 0 && b.error == 0) return; // nothing to test
    const double mean = std::max(std::abs(a.mean), std::abs(b.mean));
    raise(a, heightA, mean);
    raise(b, heightB, mean);
}
} // namespace

double missedP(double difference, double height) noexcept {
    return height > 0 && difference != 0 ? std::exp(-std::abs(difference) / height) : 0;
}

double eventHeight(const Evidence& e) noexcept {
    Height whole;
    for (const Estimate& p : e.pixels) whole.add(p);
    return e.compared > 0 ? whole.value() / double(e.compared) : 0;
}

void floorRareEvents(Evidence& a, Evidence& b) {
    if (!a.pooled && !b.pooled && a.pixels.size() == b.pixels.size()) {
        const std::vector<double> heightsA = pixelHeights(a), heightsB = pixelHeights(b);
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
            const std::size_t t = i / a.width / a.tile * a.tilesX + i % a.width / a.tile;
            raise(a.pixels[i], heightsA[t], b.pixels[i], heightsB[t]);
        }
    }
    const std::vector<double> heightsA = tileHeights(a), heightsB = tileHeights(b);
    for (std::size_t t = 0; t < a.tiles.size(); ++t) raise(a.tiles[t], heightsA[t], b.tiles[t], heightsB[t]);
}

} // namespace chiaro::judge
