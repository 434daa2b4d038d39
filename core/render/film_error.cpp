// What a film knows of its own error.
//
// A pixel (standardError): half the difference of its even and its odd samples, pooled over 8 x 8 pixels. Under a scrambled sequence the
// halves repel each other, so that this errs on the safe side, on smooth pixels by a factor of several.
//
// The whole picture (noise, meanLuminance): how far every pixel moved when its samples doubled. If V(n) is the variance after n samples of
// an unbiased sequence whose prefixes are nets, the movement d from n / 2 to n has E d^2 = V(n/2) - V(n), since Cov(m(n/2), m(n)) = V(n)
// (m(n) is the mean of two exchangeable halves of which m(n/2) is one). Where V falls by q a doubling, V(n) = E d^2 q / (1 - q); q is what
// the movements of the last two doublings say, within 1/4 (smooth, n^-2) and 1/2 (independent samples, n^-1: then V(n) = E d^2). Between
// powers of two the error falls by n^-1/2. Without two doublings the halves speak.
//
// Noise: the root mean square of d in cells of 2 x 2 pixels, over its mean for normal deviates; the sum of these has a variance of half the
// sum of d^2. Larger cells would let edges speak for their surroundings, single pixels would not hear what is rare.
//
// Each pixel gives one degree of freedom. Their sum has the effective number of Satterthwaite (1946) with the correction for estimated
// fourth powers of normal deviates, 3 (sum d^2)^2 / sum d^4 - 2: a picture whose error lies in a few pixels knows little about it. Where
// pixels share samples (splats, photons), blocks of pixels move more than their pixels would alone: then the blocks speak.
#include "core/render/film.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace chiaro {
namespace {

constexpr uint32_t cell = 2, block = 8;               // pixels along an edge, over which errors are pooled and correlations are looked for
constexpr double smoothest = 0.25, independent = 0.5; // what is left of the variance when samples double

// The mean of the root of a mean square of n normal deviates, in sigma: sqrt(2 / n) Gamma((n + 1) / 2) / Gamma(n / 2).
double rootOfMean(uint32_t n) noexcept {
    static const auto table = [] {
        std::array<double, cell * cell + 1> all{};
        for (std::size_t i = 1; i < all.size(); ++i) {
            const double k = double(i);
            all[i] = std::sqrt(2 / k) * std::tgamma((k + 1) / 2) / std::tgamma(k / 2);
        }
        return all;
    }();
    return table[n];
}

double effectiveNumber(double squares, double fourths, double most) noexcept {
    return fourths > 0 ? std::clamp(3 * squares * squares / fourths - 2, 1.0, std::max(1.0, most)) : std::max(1.0, most);
}

// The one-sided 95 % point of Student's t; expansion in 1/nu about the normal's (Abramowitz and Stegun 26.7.5), exact for one degree.
double student95(double nu) noexcept {
    constexpr double z = 1.6448536, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
    if (nu < 2) return 6.3138;
    return z + (z3 + z) / (4 * nu) + (5 * z5 + 16 * z3 + 3 * z) / (96 * nu * nu) +
           (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * nu * nu * nu);
}

double ratio(double now, double before) noexcept { return before > 0 ? std::clamp(now / before, smoothest, independent) : independent; }

} // namespace

std::vector<Spectrum> Film::standardError() const {
    const Rect& crop = layout_.crop;
    const uint32_t columns = (crop.width() + block - 1) / block, rows = (crop.height() + block - 1) / block;
    std::vector<Rgb<double>> sums(std::size_t(columns) * rows);
    std::vector<uint32_t> counts(sums.size());
    const auto blockOf = [&](uint32_t x, uint32_t y) { return std::size_t(y / block) * columns + x / block; };
    for (uint32_t y = 0; y < crop.height(); ++y)
        for (uint32_t x = 0; x < crop.width(); ++x) {
            const Pixel p{crop.x0 + x, crop.y0 + y};
            const Counts& n = counts_[at(p)];
            if (n.kept[0] == 0 || n.kept[1] == 0) continue;
            const Spectrum a = halfMean(p, Half::even), b = halfMean(p, Half::odd);
            for (std::size_t c = 0; c < 3; ++c) sums[blockOf(x, y)][c] += sqr((double(a[c]) - double(b[c])) / 2);
            ++counts[blockOf(x, y)];
        }
    std::vector<Spectrum> result(crop.area());
    for (uint32_t y = 0; y < crop.height(); ++y)
        for (uint32_t x = 0; x < crop.width(); ++x) {
            const std::size_t k = blockOf(x, y);
            for (std::size_t c = 0; c < 3; ++c)
                result[std::size_t(y) * crop.width() + x][c] = counts[k] ? float(std::sqrt(sums[k][c] / counts[k])) : 0.f;
        }
    return result;
}

double Film::halfDeviation(Pixel p) const noexcept {
    const Counts& n = counts_[at(p)];
    if (n.kept[0] == 0 || n.kept[1] == 0) return 0;
    return (double(luminance(halfMean(p, Half::even))) - double(luminance(halfMean(p, Half::odd)))) / 2;
}

// deviation(pixel, its luminance)
template <class Deviation> Film::Spread Film::spread(Deviation&& deviation) const {
    struct Pool {
        uint32_t pixels = 0;
        double sum = 0, squares = 0;
    };
    const Rect& crop = layout_.crop;
    Spread s;
    std::vector<Pool> cells((crop.width() + cell - 1) / cell), blocks((crop.width() + block - 1) / block);
    for (uint32_t y = crop.y0; y < crop.y1; ++y) {
        for (uint32_t x = crop.x0; x < crop.x1; ++x) {
            const double light = double(luminance(mean({x, y}))), d = deviation(Pixel{x, y}, light);
            s.light += light;
            s.squares += d * d;
            s.fourths += sqr(d * d);
            Pool& c = cells[(x - crop.x0) / cell];
            ++c.pixels;
            c.squares += d * d;
            blocks[(x - crop.x0) / block].sum += d;
        }
        const uint32_t rows = y - crop.y0 + 1;
        if (rows % cell == 0 || y + 1 == crop.y1)
            for (Pool& c : cells) {
                s.pooled += std::sqrt(c.pixels * c.squares) / rootOfMean(c.pixels);
                c = {};
            }
        if (rows % block == 0 || y + 1 == crop.y1)
            for (Pool& b : blocks) {
                s.blockSquares += sqr(b.sum);
                s.blockFourths += sqr(sqr(b.sum));
                b = {};
            }
    }
    return s;
}

void Film::setDone(uint32_t samples) {
    done_ = samples;
    if (done_ > begin_ && std::has_single_bit(done_ - begin_) && done_ - begin_ != grownAt_) grow();
}

void Film::grow() {
    const uint32_t n = done_ - begin_;
    const bool doubled = grownAt_ > 0 && n == 2 * grownAt_;
    std::vector<float> now(layout_.crop.area());
    const Spread s = spread([&](Pixel p, double light) {
        const std::size_t i = at(p);
        now[i] = float(light);
        return doubled ? light - double(grown_[i]) : 0.0;
    });
    if (doubled) {
        const bool follows = growth_.samples == grownAt_;
        growth_ = {n, s, follows ? growth_.spread.pooled : 0, follows ? growth_.spread.squares : 0};
    }
    grown_ = std::move(now);
    grownAt_ = n;
}

Film::Uncertainty Film::uncertainty() const {
    Uncertainty e;
    if (growth_.samples > 0) {
        e.spread = growth_.spread;
        const double since = double(growth_.samples) / std::max(growth_.samples, done_ - begin_);
        const double q = ratio(e.spread.squares, growth_.squaresBefore), r = ratio(sqr(e.spread.pooled), sqr(growth_.pooledBefore));
        e.square = q / (1 - q) * since;
        e.pooled = std::sqrt(r / (1 - r) * since);
    } else {
        e.spread = spread([this](Pixel p, double) { return halfDeviation(p); });
    }
    const Spread& s = e.spread;
    const Rect& crop = layout_.crop;
    const double blocks = double((crop.width() + block - 1) / block) * ((crop.height() + block - 1) / block);
    const double ofBlocks = effectiveNumber(s.blockSquares, s.blockFourths, blocks);
    // Blocks speak where they are beyond what chance makes of independent pixels.
    const bool shared = s.blockSquares > s.squares * (1 + 2 * std::sqrt(2 / ofBlocks));
    e.moreThanPixels = shared ? s.blockSquares / s.squares : 1;
    e.dof = shared ? ofBlocks : effectiveNumber(s.squares, s.fourths, double(crop.area()));
    return e;
}

Film::Mean Film::meanLuminance() const {
    const Rect& crop = layout_.crop;
    double sum = 0;
    for (uint32_t y = crop.y0; y < crop.y1; ++y)
        for (uint32_t x = crop.x0; x < crop.x1; ++x) sum += double(luminance(mean({x, y})));
    const Uncertainty e = uncertainty();
    const double n = double(crop.area());
    return {sum / n, std::sqrt(e.spread.squares * e.moreThanPixels * e.square) / n, e.dof};
}

double Film::noise() const {
    if (done_ - begin_ < 2) return std::nan("");
    const Uncertainty e = uncertainty();
    return e.spread.pooled == 0 ? 0 : e.pooled * e.spread.pooled / e.spread.light;
}

double Film::noiseBound() const {
    if (done_ - begin_ < 2) return std::nan("");
    const Uncertainty e = uncertainty();
    const double own = std::sqrt(0.5 * e.spread.squares * e.moreThanPixels);
    return e.spread.pooled == 0 ? 0 : e.pooled * (e.spread.pooled + student95(e.dof) * own) / e.spread.light;
}

} // namespace chiaro
