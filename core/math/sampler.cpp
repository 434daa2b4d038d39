#include "core/math/sampler.h"
#include "core/math/sobol.h"
#include <array>

namespace chiaro {
namespace {

uint32_t owenScramble(uint32_t x, uint32_t seed) noexcept { return reverseBits(laineKarras(reverseBits(x), seed)); }

// Third dimension: primitive polynomial x^2 + x + 1, first direction numbers 1 and 3 (Joe and Kuo 2008), a table for each byte of the
// index.
using ByteTables = std::array<std::array<uint32_t, 256>, 4>;
constexpr ByteTables thirdTables() {
    std::array<uint32_t, 32> v{0x80000000u, 0xc0000000u};
    for (std::size_t i = 2; i < 32; ++i) v[i] = v[i - 1] ^ v[i - 2] ^ v[i - 2] >> 2;
    ByteTables tables{};
    for (std::size_t byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value)
            for (std::size_t bit = 0; bit < 8; ++bit)
                if (value >> bit & 1) tables[byte][value] ^= v[byte * 8 + bit];
    return tables;
}
uint32_t sobolThird(uint32_t index) noexcept {
    static constexpr ByteTables tables = thirdTables();
    return tables[0][index & 255] ^ tables[1][index >> 8 & 255] ^ tables[2][index >> 16 & 255] ^ tables[3][index >> 24];
}

} // namespace

uint64_t hashMix(uint64_t x) noexcept { // the finaliser of splitmix64 (Stafford's variant 13)
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebull;
    return x ^ x >> 31;
}

Sampler::Sampler(uint64_t seed, SamplerKind kind, Stream stream, uint64_t pathIndex, uint32_t sample) noexcept
    : key_(hashCombine(hashCombine(seed, uint64_t(stream) << 1 | uint64_t(kind)), pathIndex)), index_(sample), kind_(kind) {}

Sampler Sampler::replay(std::span<const float> vector, Sampler beyond) noexcept {
    beyond.vector_ = vector.data();
    beyond.vectorSize_ = uint32_t(vector.size());
    return beyond;
}

uint32_t Sampler::bits(uint32_t d) const noexcept {
    const uint64_t h = hashCombine(key_, d);
    if (kind_ == SamplerKind::independent) return uint32_t(hashCombine(h, index_) >> 32);
    // Van der Corput (the reversal) of the Owen-shuffled index, scrambled again.
    return reverseBits(laineKarras(shuffledIndex(index_, uint32_t(h)), uint32_t(h >> 32)));
}

float Sampler::get1D() noexcept {
    const uint32_t d = dimension_++;
    return d < vectorSize_ ? vector_[d] : toUnit(bits(d));
}

double Sampler::getPick() noexcept {
    const uint32_t d = dimension_++;
    return d < vectorSize_ ? double(vector_[d]) : double(bits(d)) * 0x1p-32;
}

Sampler::PairSeeds Sampler::pairSeeds() const noexcept {
    const uint64_t h = hashCombine(key_, dimension_), g = hashMix(h ^ 0x6a09e667f3bcc909ull);
    return {uint32_t(h), uint32_t(h >> 32), uint32_t(g)};
}

Point2 Sampler::get2D() noexcept {
    if (dimension_ + 1 < vectorSize_) {
        const float x = get1D();
        return {x, get1D()};
    }
    if (kind_ == SamplerKind::independent) {
        const uint64_t r = hashCombine(hashCombine(key_, dimension_), index_);
        dimension_ += 2;
        return {toUnit(uint32_t(r >> 32)), toUnit(uint32_t(r))};
    }
    const PairSeeds seeds = pairSeeds();
    dimension_ += 2;
    return sobolPair(shuffledIndex(index_, seeds.index), seeds.x, seeds.y);
}

PickAndPoint Sampler::get3D() noexcept {
    if (dimension_ < vectorSize_ || kind_ == SamplerKind::independent) {
        const double pick = getPick();
        return {pick, get2D()};
    }
    const uint64_t h = hashCombine(key_, dimension_), g = hashMix(h ^ 0x6a09e667f3bcc909ull);
    dimension_ += 3;
    const uint32_t index = shuffledIndex(index_, uint32_t(h)), third = owenScramble(sobolThird(index), uint32_t(g >> 32));
    return {double(third) * 0x1p-32, sobolPair(index, uint32_t(h >> 32), uint32_t(g))};
}

Sampler Sampler::split(uint32_t j, uint32_t n) const noexcept {
    Sampler s = *this;
    if (n <= 1) return s;
    s.key_ = hashCombine(key_, 0x517cc1b727220a95ull + dimension_); // other scrambles than the parent's later requests
    s.index_ = index_ * n + j;
    s.dimension_ = 0;
    s.vector_ = nullptr;
    s.vectorSize_ = 0;
    return s;
}

} // namespace chiaro
