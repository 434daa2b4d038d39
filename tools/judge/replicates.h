// What one side of a comparison knows: luminance a pixel and a tile, luminance and R, G, B of the whole, each with the standard error of
// its mean. It comes from independent replicates (own seeds), because the samples of one pixel under a scrambled sequence say nothing about
// their error, or from one picture with an error layer (normal approximation).
#pragma once
#include "tools/judge/picture.h"
#include "tools/judge/statistics.h"
#include <array>

namespace chiaro::judge {

enum class Mean { luminance, red, green, blue };
inline constexpr std::size_t meanCount = 4;
const char* meanName(Mean) noexcept; // "Y", "R", "G", "B"

struct Evidence {
    uint32_t width = 0, height = 0, tile = 0, tilesX = 0, tilesY = 0;
    std::vector<Estimate> pixels, tiles; // luminance; a NaN mean: left out
    std::vector<double> events;          // a tile: height of one bright event in the mean of a pixel (rare_events.h); empty: unknown
    std::array<Estimate, meanCount> image;
    double skewness = 0; // of the luminance means of the replicates
    double replicates = 1;
    std::size_t compared = 0; // pixels
    bool pooled = false;      // the errors of pixels are those of their neighbourhood: no pixel can be tested alone
};

// Accumulates replicate after replicate: three doubles a pixel, and four a tile and replicate.
class Replicates {
public:
    Replicates(uint32_t width, uint32_t height, const Region& = {}, uint32_t tile = 8);
    void add(const Picture&); // throws Exit::unsupported where its size is another one
    uint32_t width() const noexcept { return width_; }
    uint32_t height() const noexcept { return height_; }
    uint32_t tile() const noexcept { return tile_; }
    std::size_t count() const noexcept { return sums_.size(); }
    std::size_t nonFinitePixels() const noexcept; // of any replicate
    std::vector<uint8_t> badTiles() const;        // those that hold a non-finite pixel
    // Tiles marked in `leftOut` count at no scale: give both sides the union of their bad tiles.
    Evidence evidence(const std::vector<uint8_t>& leftOut) const;

    // Luminance, R, G, B of the picture of one replicate.
    std::array<double, meanCount> means(std::size_t replicate, const std::vector<uint8_t>& leftOut) const;

    // All that was accumulated, as plain values: to be kept in a file, and to go on from there.
    struct State {
        std::vector<uint8_t> bad;                                     // a pixel
        std::vector<double> mean, m2, m3;                             // a pixel: luminance, and sums of its deviations, squared and cubed
        std::vector<std::vector<std::array<double, meanCount>>> sums; // [replicate][tile]
    };
    State state() const;
    // Of the same size, region and tile; throws Exit::unsupported where the lengths do not fit.
    void restore(State);

private:
    std::size_t tileOf(std::size_t pixel) const noexcept;
    std::vector<double> eventHeights(const std::vector<uint8_t>& leftOut) const;
    struct Running {
        double mean = 0, m2 = 0, m3 = 0;
    };
    uint32_t width_, height_, tile_, tilesX_, tilesY_;
    std::vector<uint8_t> keep_, bad_; // a pixel
    std::vector<Running> pixels_;
    std::vector<uint32_t> tileCounts_;
    std::vector<std::vector<std::array<double, meanCount>>> sums_; // [replicate][tile]
};

// Of replicates that were made in pairs: the mean of the differences test - reference, and its error by their spread. Throws
// Exit::unsupported where one side has more.
std::array<Estimate, meanCount> pairedDifferences(const Replicates& test, const Replicates& reference, const std::vector<uint8_t>& leftOut);

// Tiles with a value or an error that is not finite.
std::vector<uint8_t> badTiles(const Picture&, const Region&, uint32_t tile = 8);
// Needs Picture::error (else Exit::unsupported). Errors of different pixels are independent; those of a pixel's channels are added up.
Evidence evidenceOf(const Picture&, const Region&, const std::vector<uint8_t>& leftOut, uint32_t tile = 8);

} // namespace chiaro::judge
