// Sampler: the only source of random numbers. Every number is a pure function of (seed, stream, path index, sample index, dimension), so
// that a picture does not depend on threads, tiles or the cut of its passes, and any single sample can be replayed.
//
// sobol: Owen-scrambled Sobol' points, padded: each 1D or 2D request takes its own scramble and its own shuffle of the sample index
// (Burley, Practical Hash-based Owen Scrambling, JCGT 2020; Owen 1995). Each 2D request is a (0,2)-sequence: 2^k samples of one pixel put
// one point into every elementary interval. independent: hashed uniform numbers, for comparison.
#pragma once
#include "core/math/vec.h"
#include <cstdint>
#include <span>

namespace chiaro {

// A choice and what is done with the chosen: `pick` with 32 random bits, since 24 would leave the rare ones among many a coarse share.
struct PickAndPoint {
    double pick = 0; // [0, 1)
    Point2 u;        // [0, 1)^2
};

enum class SamplerKind : uint8_t { sobol, independent };
enum class Stream : uint32_t { pixel, light, chain, prepass };

uint64_t hashMix(uint64_t x) noexcept; // a full-avalanche permutation of 64 bits
inline uint64_t hashCombine(uint64_t a, uint64_t b) noexcept { return hashMix(a ^ (hashMix(b + 0x9e3779b97f4a7c15ull))); }

class Sampler {
public:
    Sampler(uint64_t seed, SamplerKind, Stream, uint64_t pathIndex, uint32_t sample) noexcept;
    // Numbers from a given vector first (a Markov chain's state), from `beyond` afterwards.
    static Sampler replay(std::span<const float> vector, Sampler beyond) noexcept;

    float get1D() noexcept;    // [0, 1)
    double getPick() noexcept; // [0, 1) with 32 random bits
    Point2 get2D() noexcept;   // [0, 1)^2
    // Three dimensions stratified together (Sobol' 1, 2 and 3): every light or lobe that is picked gets well-spread points of its own.
    PickAndPoint get3D() noexcept;
    void skip(uint32_t dimensions) noexcept { dimension_ += dimensions; } // keeps one meaning a dimension where a path needs fewer
    // The j-th of n continuations, stratified together over all samples; n = 1 continues unchanged.
    Sampler split(uint32_t j, uint32_t n) const noexcept;
    uint32_t dimension() const noexcept { return dimension_; }
    // The same numbers of another sample of this path.
    Sampler at(uint32_t sample) const noexcept {
        Sampler s = *this;
        s.index_ = sample;
        return s;
    }
    // What get2D() makes of any sample here: for whoever draws many samples of one path at once (core/math/sobol.h). Not of a vector.
    struct PairSeeds {
        uint32_t index = 0, x = 0, y = 0;
    };
    PairSeeds pairSeeds() const noexcept;
    SamplerKind kind() const noexcept { return kind_; }
    // What all numbers of a path are made of, for whoever draws those of many paths at once (core/math/wide_sampler.h).
    uint64_t key() const noexcept { return key_; }
    uint32_t index() const noexcept { return index_; }

private:
    uint32_t bits(uint32_t dimension) const noexcept;
    uint64_t key_ = 0;
    uint32_t index_ = 0, dimension_ = 0;
    SamplerKind kind_ = SamplerKind::sobol;
    const float* vector_ = nullptr;
    uint32_t vectorSize_ = 0;
};

} // namespace chiaro
