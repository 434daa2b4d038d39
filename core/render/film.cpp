#include "core/render/film.h"
#include "core/math/wide_isa.h"
#include "core/render/fault.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <immintrin.h>
#include <tuple>

namespace chiaro {
namespace {

constexpr double aovUnit = 0x1p30;
constexpr std::size_t ledgerLength = 16; // dropped samples that are located; all are counted

// Below this a multiple of 2^-48 fits 64 bits, and the conversion of a double, which holds it exactly, rounds to nearest, ties to even.
constexpr float smallFixed = 0x1p14f;
int64_t smallToFixed(float v) noexcept { return std::llrint(double(v) * 0x1p48); }

bool fits(const Spectrum& s) noexcept {
    return std::fabs(s[0]) < fixedLimit && std::fabs(s[1]) < fixedLimit && std::fabs(s[2]) < fixedLimit; // false for NaN
}

// What a few samples of one pixel sum up to, in 64 bits: at most `most` of them, their light below `limit`.
struct ShortSums {
    static constexpr std::size_t most = 32;
    static constexpr float limit = 0x1p9f;
    int64_t light[2][3] = {}, aovs[3 * aovCount] = {};
    static constexpr double magic = 0x1.8p52; // plus an integer below 2^51: rounds to nearest, ties to even, and shows the integer
    // False where a sample is too bright, or not finite.
    bool add(std::span<const Outputs> outs, uint32_t first) noexcept {
        if (!addWidest(*this, outs, first)) return false;
        for (int64_t& a : aovs) a -= int64_t(uint64_t(outs.size()) * std::bit_cast<uint64_t>(magic));
        return true;
    }

private:
    // With the magic numbers still in.
    bool addMagic(std::span<const Outputs> outs, uint32_t first) noexcept {
        for (std::size_t k = 0; k < outs.size(); ++k) {
            const Outputs& out = outs[k];
            int64_t(&sum)[3] = light[(first + k) & 1];
            bool good = true;
            for (std::size_t c = 0; c < 3; ++c) {
                good &= std::fabs(out.layer[0].c[c]) < limit;
                sum[c] += smallToFixed(out.layer[0].c[c]);
            }
            for (std::size_t a = 0; a < aovCount; ++a)
                for (std::size_t c = 0; c < 3; ++c) {
                    const float v = out.aovs[a].c[c];
                    good &= std::fabs(v) < fixedLimit;
                    aovs[3 * a + c] += std::bit_cast<int64_t>(double(min(max(v, -1.f), 1.f)) * aovUnit + magic);
                }
            if (!good) return false;
        }
        return true;
    }
    static bool addPlain(ShortSums& s, std::span<const Outputs> outs, uint32_t first) noexcept { return s.addMagic(outs, first); }
    // The same bits, a sample's numbers side by side.
    CHIARO_TARGET_AVX512 static bool addAvx512(ShortSums& s, std::span<const Outputs> outs, uint32_t first) noexcept {
        static_assert(sizeof(Outputs::aovs) == 6 * sizeof(float) && sizeof(Spectrum) == 3 * sizeof(float));
        __m512i six = _mm512_setzero_si512();
        __m256i three[2] = {_mm256_setzero_si256(), _mm256_setzero_si256()};
        const __m256 one = _mm256_set1_ps(1), minus = _mm256_set1_ps(-1), most6 = _mm256_set1_ps(fixedLimit), sign8 = _mm256_set1_ps(-0.f);
        const __m128 most3 = _mm_set1_ps(limit), sign4 = _mm_set1_ps(-0.f);
        uint32_t bad = 0;
        for (std::size_t k = 0; k < outs.size(); ++k) {
            const __m256 a = _mm256_maskz_loadu_ps(0x3f, outs[k].aovs[0].c.data());
            const __m128 l = _mm_maskz_loadu_ps(0x7, outs[k].layer[0].c.data());
            bad |= uint32_t(_mm256_cmp_ps_mask(_mm256_andnot_ps(sign8, a), most6, _CMP_NLT_UQ)) |
                   uint32_t(_mm_cmp_ps_mask(_mm_andnot_ps(sign4, l), most3, _CMP_NLT_UQ));
            const __m512d d = _mm512_maskz_cvtps_pd(0xff, _mm256_min_ps(_mm256_max_ps(a, minus), one));
            const __m512d shown = _mm512_add_pd(_mm512_mul_pd(d, _mm512_set1_pd(aovUnit)), _mm512_set1_pd(magic));
            six = _mm512_add_epi64(six, _mm512_castpd_si512(shown));
            __m256i& sum = three[(first + k) & 1];
            sum = _mm256_add_epi64(sum, _mm256_cvtpd_epi64(_mm256_mul_pd(_mm256_cvtps_pd(l), _mm256_set1_pd(0x1p48))));
        }
        _mm512_mask_storeu_epi64(s.aovs, 0x3f, six);
        for (std::size_t h = 0; h < 2; ++h) _mm256_mask_storeu_epi64(s.light[h], 0x7, three[h]);
        return bad == 0;
    }
    static inline auto* const addWidest = widest(addPlain, addPlain, addAvx512);
};

} // namespace

Int128 toFixed(float v) noexcept {
    const auto bits = std::bit_cast<uint32_t>(v);
    const int exponent = int(bits >> 23 & 0xff);
    if (exponent == 0) return 0; // zero; denormals are far below half a unit
    const uint32_t mantissa = (bits & 0x7fffff) | 0x800000;
    const int shift = exponent - 150 + 48;
    Int128 magnitude = 0;
    if (shift >= 0) {
        magnitude = Int128(mantissa) << shift;
    } else if (shift >= -25) {
        const uint32_t down = uint32_t(-shift), kept = mantissa >> down, rest = mantissa & ((1u << down) - 1), tie = 1u << (down - 1);
        magnitude = kept + (rest > tie || (rest == tie && (kept & 1)));
    }
    return bits >> 31 ? -magnitude : magnitude;
}

double fromFixed(Int128 v) noexcept {
    const auto low = int64_t(v);
    return (Int128(low) == v ? double(low) : double(v)) * 0x1p-48; // the short conversion is one instruction, with the same rounding
}

std::size_t FilmLayout::bytes() const noexcept {
    const std::size_t planes = std::max<std::size_t>(1, layers.size());
    return crop.area() * (planes * (sizeof(Int128) * 6 + (splats ? sizeof(int64_t) * 18 : 0)) + sizeof(int64_t) * (costs ? 9 : 6) +
                          (photons ? 3 * sizeof(Int128) : 0) + 12 + sizeof(float));
}

Spectrum Outputs::total() const noexcept {
    Spectrum sum(0);
    for (int i = 0; i < layers(); ++i) sum += layer[i];
    return sum;
}

Film::Film(const FilmLayout& layout, uint32_t begin)
    : layout_(layout), planes_(int(std::max<std::size_t>(1, layout.layers.size()))), sums_(layout.crop.area() * planes_),
      aovs_(layout.crop.area()), counts_(layout.crop.area(), {begin, {}}), begin_(begin), done_(begin) {
    if (layout.costs) costs_.resize(layout.crop.area());
    if (layout.photons) gathered_.resize(layout.crop.area());
    if (layout.splats) splats_ = std::make_unique<Digits[]>(layout.crop.area() * planes_);
}

uint32_t Film::next(Pixel p) const noexcept { return counts_[at(p)].next; }

void Film::drop(Pixel p, uint32_t sample) noexcept {
    droppedCount_.fetch_add(1);
    const std::lock_guard lock(mutex_);
    const auto before = [](const DroppedSample& a, const DroppedSample& b) {
        return std::tie(a.sample, a.pixel.y, a.pixel.x) < std::tie(b.sample, b.pixel.y, b.pixel.x);
    };
    const DroppedSample d{p, sample};
    dropped_.insert(std::upper_bound(dropped_.begin(), dropped_.end(), d, before), d);
    if (dropped_.size() > ledgerLength) dropped_.pop_back();
}

bool Film::usable(const Outputs& out) const noexcept {
    bool good = true;
    for (int l = 0; l < planes_; ++l) good = good && fits(out.layer[l]);
    for (const Spectrum& a : out.aovs) good = good && fits(a);
    return good;
}

void Film::addExtras(std::size_t i, const Outputs& out) noexcept {
    if (!costs_.empty()) {
        costs_[i][0] += uint64_t(double(out.microseconds) * 1e3);
        costs_[i][1] += out.rays + 1;
        costs_[i][2] += out.depth;
    }
    if (!gathered_.empty()) {
        gathered_[i][0] += toFixed(out.gathered.density);
        gathered_[i][1] += toFixed(out.gathered.radius);
        gathered_[i][2] += toFixed(out.gathered.count);
    }
}

void Film::add(Pixel p, uint32_t sample, const Outputs& out) noexcept { add(p, sample, {&out, 1}); }

void Film::add(Pixel p, uint32_t first, std::span<const Outputs> outs) noexcept {
    const std::size_t i = at(p), plane = layout_.crop.area();
    Counts& counts = counts_[i];
    counts.next = first + uint32_t(outs.size());
    const bool extras = !costs_.empty() || !gathered_.empty();
    if (planes_ == 1 && !extras && outs.size() <= ShortSums::most && !fault(Fault::sumsInFloat))
        if (ShortSums sums; sums.add(outs, first)) {
            const auto n = uint32_t(outs.size()), odd = (n + (first & 1)) / 2;
            counts.kept[0] += n - odd;
            counts.kept[1] += odd;
            for (int h = 0; h < 2; ++h)
                for (int c = 0; c < 3; ++c) sums_[i].half[h][c] += sums.light[h][c];
            for (std::size_t c = 0; c < 6; ++c) aovs_[i][c] += sums.aovs[c];
            return;
        }
    std::array<int64_t, 6> aovs = aovs_[i];
    for (std::size_t k = 0; k < outs.size(); ++k) {
        const Outputs& out = outs[k];
        if (!usable(out)) {
            drop(p, first + uint32_t(k));
            continue;
        }
        const int half = int((first + k) & 1);
        ++counts.kept[half];
        if (extras) addExtras(i, out);
        for (int l = 0; l < planes_; ++l)
            for (int c = 0; c < 3; ++c) {
                const float v = out.layer[l][std::size_t(c)];
                if (v == 0) continue;
                Int128& sum = sums_[i + std::size_t(l) * plane].half[half][c];
                sum += std::fabs(v) < smallFixed ? Int128(smallToFixed(v)) : toFixed(v);
                if (fault(Fault::sumsInFloat)) sum = toFixed(float(fromFixed(sum)));
            }
        for (int a = 0; a < aovCount; ++a)
            for (int c = 0; c < 3; ++c)
                aovs[std::size_t(3 * a + c)] +=
                    std::llrint(double(std::clamp(out.aovs[a][std::size_t(c)], -1.f, 1.f)) * aovUnit); // to nearest, ties to even
    }
    aovs_[i] = aovs;
}

void Film::splat(Pixel p, Layer layer, const Spectrum& v, Half half) noexcept {
    const Rect& crop = layout_.crop;
    if (layer == 0 || p.x < crop.x0 || p.x >= crop.x1 || p.y < crop.y0 || p.y >= crop.y1) return;
    if (!fits(v)) return drop(p, 0);
    const std::size_t plane = planes_ == 1 ? 0 : layer - 1u;
    Digits& digits = splats_[at(p) + plane * crop.area()];
    for (int c = 0; c < 3; ++c) {
        // Carry-save: three digits of 32 bits, each in a counter of 64, so that 2^31 additions need no carry between them.
        const Int128 fixed = toFixed(v[std::size_t(c)]);
        auto& d = digits.digit[int(half)][c];
        d[0].fetch_add(int64_t(uint32_t(fixed)), std::memory_order_relaxed);
        d[1].fetch_add(int64_t(uint32_t(fixed >> 32)), std::memory_order_relaxed);
        d[2].fetch_add(int64_t(fixed >> 64), std::memory_order_relaxed);
    }
}

void Film::lightPaths(double count, Half half) noexcept {
    const std::lock_guard lock(mutex_);
    lightPaths_[int(half)] += count;
}

Spectrum Film::value(std::size_t pixel, int firstLayer, int endLayer, int half) const noexcept {
    const Counts& n = counts_[pixel];
    const double count = half == 2 ? double(n.kept[0]) + n.kept[1] : double(n.kept[half]);
    const double paths = half == 2 ? lightPaths_[0] + lightPaths_[1] : lightPaths_[half];
    const int firstHalf = half == 2 ? 0 : half, endHalf = half == 2 ? 2 : half + 1;
    Spectrum result(0);
    for (std::size_t c = 0; c < 3; ++c) {
        Int128 sum = 0, splatted = 0; // over layers too, as integers: the beauty is their sum to the last bit
        for (int l = firstLayer; l < endLayer; ++l)
            for (int h = firstHalf; h < endHalf; ++h) {
                const std::size_t i = pixel + std::size_t(l) * layout_.crop.area();
                sum += sums_[i].half[h][c];
                if (!splats_) continue;
                const auto& d = splats_[i].digit[h][c];
                splatted += Int128(d[0].load()) + (Int128(d[1].load()) << 32) + (Int128(d[2].load()) << 64);
            }
        double v = 0;
        if (count > 0) v += fromFixed(sum) / count;
        if (paths > 0) v += fromFixed(splatted) / paths;
        result[c] = float(v);
    }
    return result;
}

Spectrum Film::mean(Pixel p, int layer) const noexcept { return value(at(p), layer, layer + 1, 2); }
Spectrum Film::mean(Pixel p) const noexcept { return value(at(p), 0, planes_, 2); }
Spectrum Film::halfMean(Pixel p, Half half) const noexcept { return value(at(p), 0, planes_, int(half)); }

Spectrum Film::aov(Pixel p, Aov which) const noexcept {
    const double n = count(p);
    if (n == 0) return Spectrum(0);
    const auto& a = aovs_[at(p)];
    const auto value = [&](int c) { return float(double(a[std::size_t(3 * int(which) + c)]) / aovUnit / n); };
    return {value(0), value(1), value(2)};
}

Cost Film::cost(Pixel p) const noexcept {
    const double n = count(p);
    if (n == 0 || costs_.empty()) return {};
    const auto& c = costs_[at(p)];
    return {float(double(c[0]) / 1e3 / n), float(double(c[1]) / n), float(double(c[2]) / n)};
}

Gathered Film::gathered(Pixel p) const noexcept {
    const double n = count(p);
    if (n == 0 || gathered_.empty()) return {};
    const auto& g = gathered_[at(p)];
    return {float(fromFixed(g[0]) / n), float(fromFixed(g[1]) / n), float(fromFixed(g[2]) / n)};
}

uint32_t Film::count(Pixel p) const noexcept {
    const Counts& c = counts_[at(p)];
    return c.kept[0] + c.kept[1];
}

bool Film::complete(uint32_t samples) const noexcept {
    return std::all_of(counts_.begin(), counts_.end(), [samples](const Counts& c) { return c.next >= samples; });
}

bool Film::even() const noexcept {
    return std::all_of(counts_.begin(), counts_.end(), [this](const Counts& c) { return c.next == done_; });
}

std::vector<DroppedSample> Film::droppedSamples() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
}

void Film::merge(const Film& other) {
    for (std::size_t i = 0; i < sums_.size(); ++i)
        for (int h = 0; h < 2; ++h)
            for (int c = 0; c < 3; ++c) sums_[i].half[h][c] += other.sums_[i].half[h][c];
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        counts_[i].next = std::max(counts_[i].next, other.counts_[i].next);
        for (int h = 0; h < 2; ++h) counts_[i].kept[h] += other.counts_[i].kept[h];
        for (std::size_t c = 0; c < 6; ++c) aovs_[i][c] += other.aovs_[i][c];
        if (!costs_.empty() && !other.costs_.empty())
            for (std::size_t c = 0; c < 3; ++c) costs_[i][c] += other.costs_[i][c];
        if (!gathered_.empty() && !other.gathered_.empty())
            for (std::size_t c = 0; c < 3; ++c) gathered_[i][c] += other.gathered_[i][c];
    }
    if (splats_)
        for (std::size_t i = 0; i < sums_.size(); ++i)
            for (int h = 0; h < 2; ++h)
                for (int c = 0; c < 3; ++c)
                    for (int d = 0; d < 3; ++d) splats_[i].digit[h][c][d].fetch_add(other.splats_[i].digit[h][c][d].load());
    for (int h = 0; h < 2; ++h) lightPaths_[h] += other.lightPaths_[h];
    if (other.begin_ < begin_) { // what is known of the error belongs to the first samples
        growth_ = other.growth_;
        grown_ = other.grown_;
        grownAt_ = other.grownAt_;
        begin_ = other.begin_;
    }
    done_ = std::max(done_, other.done_);
    droppedCount_.fetch_add(other.droppedCount_.load());
    for (const DroppedSample& d : other.droppedSamples()) {
        drop(d.pixel, d.sample);
        droppedCount_.fetch_sub(1);
    }
}

} // namespace chiaro
