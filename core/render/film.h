// Film: all mutable state of a picture. Sums are exact, so that any order of additions, any cut into passes and any number of threads give
// the same bits: a sample is rounded to a multiple of 2^-48 and added as an integer of 128 bits. The error of a pixel is estimated from
// half-films (even and odd samples), that of the whole picture from how far it moved when its samples doubled (film_error.cpp). Filter
// weights are 1 (filter importance sampling): a pixel is sum over count.
#pragma once
#include "core/math/ray.h"
#include "core/render/path_classes.h"
#include "core/render/path_log.h"
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace chiaro {

__extension__ typedef __int128 Int128;

// v as a multiple of 2^-48, rounded to nearest, ties to even; |v| must be below 2^36.
Int128 toFixed(float v) noexcept;
double fromFixed(Int128) noexcept;
inline constexpr float fixedLimit = 0x1p36f;

enum class Half : uint8_t { even, odd };
enum class Aov : uint8_t { albedo, normal };
inline constexpr int aovCount = 2;
// What a sample costs: microseconds of one thread, rays traced (shadow rays too), depth of its longest path.
struct Cost {
    float microseconds = 0, rays = 0, depth = 0;
};

// What a density estimate found at the sample's gathering points: photons per square metre, radius in metres, how many photons.
struct Gathered {
    float density = 0, radius = 0, count = 0;
};

struct FilmLayout {
    uint32_t width = 0, height = 0;  // of the whole picture
    Rect crop;                       // the part that this film holds
    std::vector<std::string> layers; // names of the layers 1, 2, ...; empty: beauty alone
    bool splats = false;
    bool costs = false;                 // keep the cost of every pixel
    bool photons = false;               // keep what density estimates found
    std::size_t bytes() const noexcept; // that a film of this layout takes
    friend bool operator==(const FilmLayout&, const FilmLayout&) = default;
};

// What one path gives: a plain value. Scaled and splatted by a chain, or added to the film by the tile loop.
class Outputs {
public:
    static constexpr int maxLayers = 32;
    Spectrum aovs[aovCount];
    uint32_t lightPaths = 0; // shot for this sample; summed into the film's divisor of splats
    uint32_t rays = 0;       // traced for this sample beyond the first
    uint32_t depth = 0;      // scatterings of its longest path
    float microseconds = 0;  // set by the tile loop where the film keeps costs
    Gathered gathered;       // of the first density estimate along the path; kept where the film wants it
    PathLog* log = nullptr;  // who wants to see the path

    explicit Outputs(const FilmLayout& layout) noexcept : last_(layout.layers.empty() ? 0 : uint8_t(layout.layers.size() - 1)) {
        for (int i = 0; i <= last_; ++i) std::construct_at(layer + i);
    }
    void add(Layer l, const Spectrum& v) noexcept {
        if (l != 0) layer[last_ == 0 ? 0 : l - 1] += v;
    }
    void aov(Aov which, const Spectrum& v) noexcept { aovs[int(which)] = v; }
    void traced(uint32_t n, uint32_t atDepth) noexcept {
        rays += n;
        depth = depth > atDepth ? depth : atDepth;
    }
    int layers() const noexcept { return last_ + 1; }
    Spectrum total() const noexcept;

private:
    uint8_t last_;

public:
    union { // the first layers() of them live: few are used, and clearing all would cost more than what a simple path takes
        Spectrum layer[maxLayers]; // without layers everything is in 0
    };
};

// A sample that was not finite (or beyond 2^36) and was left out.
struct DroppedSample {
    Pixel pixel;
    uint32_t sample = 0;
    friend bool operator==(const DroppedSample&, const DroppedSample&) = default;
};

class Writer;
class Reader;

class Film {
public:
    explicit Film(const FilmLayout&, uint32_t begin = 0); // begin: the first sample index that it is to hold
    const FilmLayout& layout() const noexcept { return layout_; }

    uint32_t next(Pixel) const noexcept;                                // the sample index that this pixel takes next
    void add(Pixel, uint32_t sample, const Outputs&) noexcept;          // one thread a pixel
    void add(Pixel, uint32_t first, std::span<const Outputs>) noexcept; // consecutive samples from `first` on: the same bits, in less time
    void splat(Pixel, Layer, const Spectrum&, Half) noexcept;           // any thread
    void lightPaths(double count, Half) noexcept;                       // the divisor of splats; any thread, between passes

    Spectrum mean(Pixel) const noexcept;
    Spectrum mean(Pixel, int layer) const noexcept; // layer: index into layout().layers
    Spectrum halfMean(Pixel, Half) const noexcept;
    Spectrum aov(Pixel, Aov) const noexcept;
    Cost cost(Pixel) const noexcept;         // mean of a sample
    Gathered gathered(Pixel) const noexcept; // mean of a sample
    uint32_t count(Pixel) const noexcept;
    // Standard error of mean(), per channel: |even - odd| / 2, pooled (root mean square) over the 8 x 8 block of the pixel. 0 with one half
    // only.
    std::vector<Spectrum> standardError() const;
    // Relative error of the picture: the average standard error of a pixel's luminance over the average luminance. The average of cells of
    // 2 x 2 pixels, the root mean square within them: a few fireflies must not speak for all pixels, nor go unheard. NaN while there is
    // none.
    double noise() const;
    double noiseBound() const; // what noise() stays below with 95 % confidence: it is an estimate itself
    // Mean luminance over the crop, its standard error, and the degrees of freedom of that error for Student's t.
    struct Mean {
        double value = 0, error = 0, dof = 1;
    };
    Mean meanLuminance() const;

    uint32_t begin() const noexcept { return begin_; }
    uint32_t done() const noexcept { return done_; } // samples that every pixel has
    bool complete(uint32_t samples) const noexcept;  // has every pixel been given all before this sample?
    bool even() const noexcept;                      // does every pixel have the samples [begin, done) and no others?
    void setDone(uint32_t samples);                  // where they are a power of two, every pixel must have just so many
    uint64_t dropped() const noexcept { return droppedCount_.load(); }
    std::vector<DroppedSample> droppedSamples() const; // the first few by (sample, y, x)
    void merge(const Film&);                           // of disjoint samples
    // All of it, exactly. load() throws as Reader does, also where the film would take more than `memory` bytes.
    void save(Writer&) const;
    static std::unique_ptr<Film> load(Reader&, std::size_t memory = ~std::size_t(0));

private:
    struct Sums {
        Int128 half[2][3] = {};
    };
    struct Digits {
        std::atomic<int64_t> digit[2][3][3];
    }; // half, channel, 32-bit digit
    struct Counts {
        uint32_t next = 0, kept[2] = {};
    };
    // One standard error d of every pixel's luminance, from one degree of freedom each, summed up over pixels and over blocks of them.
    struct Spread {
        double light = 0;                          // of the picture: the sum of its luminances
        double pooled = 0;                         // over cells: pixels x root mean square of d
        double squares = 0, fourths = 0;           // over pixels
        double blockSquares = 0, blockFourths = 0; // over blocks: of the sum of d
    };
    struct Growth {
        uint32_t samples = 0; // after doubling; 0: it never did
        Spread spread;
        double pooledBefore = 0, squaresBefore = 0; // of the doubling before it; 0: none
    };
    struct Uncertainty { // of the picture as it stands
        Spread spread;
        double pooled = 1, square = 1; // factors that bring it to the present number of samples
        double moreThanPixels = 1;     // blockSquares / squares, where pixels share samples
        double dof = 1;
    };
    std::size_t at(Pixel p) const noexcept { return std::size_t(p.y - layout_.crop.y0) * layout_.crop.width() + (p.x - layout_.crop.x0); }
    Spectrum value(std::size_t pixel, int firstLayer, int endLayer, int half) const noexcept; // half 2: both
    double halfDeviation(Pixel) const noexcept; // (even - odd) / 2 in luminance: one standard error, from one degree of freedom
    template <class Deviation> Spread spread(Deviation&&) const;
    Uncertainty uncertainty() const;
    void grow();
    void drop(Pixel, uint32_t sample) noexcept;
    bool usable(const Outputs&) const noexcept;
    void addExtras(std::size_t pixel, const Outputs&) noexcept; // cost and what density estimates found, where the film keeps them

    FilmLayout layout_;
    int planes_;
    std::vector<Sums> sums_;                   // plane by plane
    std::vector<std::array<int64_t, 6>> aovs_; // multiples of 2^-30
    std::vector<Counts> counts_;
    std::vector<std::array<uint64_t, 3>> costs_;  // nanoseconds, rays, depths; empty: not kept
    std::vector<std::array<Int128, 3>> gathered_; // density, radius, count; empty: not kept
    std::unique_ptr<Digits[]> splats_;
    double lightPaths_[2] = {};
    uint32_t begin_ = 0, done_ = 0;
    Growth growth_;
    std::vector<float> grown_; // every pixel's luminance when it had grownAt_ samples
    uint32_t grownAt_ = 0;     // 0: it never had a power of two
    std::atomic<uint64_t> droppedCount_{0};
    mutable std::mutex mutex_;
    std::vector<DroppedSample> dropped_;
};

} // namespace chiaro
