#include "integrators/photon_store.h"
#include "core/render/archive.h"
#include "integrators/octahedral.h"
#include <array>
#include <bit>
#include <fmt/format.h>
#include <memory>
#include <utility>
#include <vector>

namespace chiaro {
namespace {

constexpr uint32_t partitionBits = 13; // a partition has at least so many buckets: their counters stay in the cache of a core
constexpr uint32_t mostPartitions = 512;
constexpr std::size_t blockSize = 1 << 16; // photons of one task, at least
constexpr float mostCells = 1 << 20;       // along one axis: floats number them exactly

// Exclusive prefix sums in the order partition, block: the place of every block's photons of a partition.
void placeBlocks(std::vector<uint32_t>& count, std::size_t blocks, std::size_t partitions, std::vector<uint32_t>& begin) {
    uint32_t sum = 0;
    for (std::size_t p = 0; p < partitions; ++p) {
        begin[p] = sum;
        for (std::size_t b = 0; b < blocks; ++b) sum += std::exchange(count[b * partitions + p], sum);
    }
    begin[partitions] = sum;
}

std::size_t blocksOf(std::size_t photons) noexcept { return std::clamp<std::size_t>(photons / blockSize, 1, 256); }
std::size_t blockBegin(std::size_t block, std::size_t photons, std::size_t blocks) noexcept { return photons * block / blocks; }
constexpr std::size_t mostPhotons = 0x7fffffff;

} // namespace

uint32_t packDirection(const Vec3& v) noexcept { return octahedralCode<fineSteps, 16>(v); }
Vec3 unpackDirection(uint32_t c) noexcept {
    return fromOctahedron({octahedralPlace<fineSteps>(c & 0xffff), octahedralPlace<fineSteps>(c >> 16)});
}
uint16_t packNormal(const Vec3& v) noexcept { return uint16_t(octahedralCode<coarseSteps, 8>(v)); }
Vec3 unpackNormal(uint16_t c) noexcept {
    return fromOctahedron({octahedralPlace<coarseSteps>(c & 0xffu), octahedralPlace<coarseSteps>(uint32_t(c) >> 8)});
}

PhotonStore::PhotonStore(const Executor& run, PhotonList photons, float cell) : photons_(std::move(photons)) { sort(run, cell); }

std::size_t PhotonStore::bytes() const noexcept { return photons_.capacity() * sizeof(Photon) + begin_.capacity() * sizeof(uint32_t); }

// Where the photons are, and cells of (about) that size over it.
PhotonStore::Grid PhotonStore::gridOver(const Executor& run, float cell) const {
    const std::size_t n = photons_.size(), blocks = blocksOf(n);
    std::vector<std::array<Vec3, 2>> boxes(blocks);
    const auto measure = [&](uint64_t b) {
        Vec3 low{infinity, infinity, infinity}, high = -low;
        for (std::size_t i = blockBegin(b, n, blocks); i < blockBegin(b + 1, n, blocks); ++i) {
            const Vec3& p = photons_[i].p;
            low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
            high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
        }
        boxes[b] = {low, high};
    };
    run.chunks(blocks, measure, nullptr);
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (const auto& [l, h] : boxes) {
        low = {min(low.x, l.x), min(low.y, l.y), min(low.z, l.z)};
        high = {max(high.x, h.x), max(high.y, h.y), max(high.z, h.z)};
    }
    const Vec3 extent = high - low;
    const float side = max(cell, max(maxAbs(extent) / mostCells, std::numeric_limits<float>::min()));
    const auto cells = [side](float length) { return int32_t(length / side) + 1; };
    Grid g{.low = low, .inverse = 1 / side, .nx = cells(extent.x), .ny = cells(extent.y), .nz = cells(extent.z)};
    const double all = double(g.nx) * g.ny * g.nz;
    g.hashed = all > std::min(2 * double(n) + 4096, 0x1p31);
    g.buckets = g.hashed ? std::bit_ceil(uint32_t(n / 2 + 1024)) : uint32_t(all);
    return g;
}

// Two moves a photon, both along few streams: into partitions of neighbouring buckets, and inside each partition into its buckets.
void PhotonStore::sort(const Executor& run, float cell) {
    if (photons_.size() >= mostPhotons) throw Error(Exit::resources, "a photon map holds at most 2,147,483,647 photons; ask for fewer");
    if (!(cell > 0) || !std::isfinite(cell)) throw Error(Exit::internal, fmt::format("a photon map with cells of {} m", cell));
    cell_ = cell;
    const std::size_t n = photons_.size(), blocks = blocksOf(n);
    begin_.clear();
    if (n == 0) return;
    grid_ = gridOver(run, cell);
    const uint32_t shift = std::max(partitionBits, uint32_t(std::bit_width((grid_.buckets - 1) / mostPartitions)));
    const std::size_t partitions = ((grid_.buckets - 1) >> shift) + 1;

    std::vector<uint32_t> places(blocks * partitions), begin(partitions + 1);
    const auto count = [&](uint64_t b) {
        for (std::size_t i = blockBegin(b, n, blocks); i < blockBegin(b + 1, n, blocks); ++i)
            ++places[b * partitions + (grid_.bucket(photons_[i].p) >> shift)];
    };
    run.chunks(blocks, count, nullptr);
    placeBlocks(places, blocks, partitions, begin);
    PhotonList parted(n); // untouched: its pages come in parallel
    const auto part = [&](uint64_t b) {
        for (std::size_t i = blockBegin(b, n, blocks); i < blockBegin(b + 1, n, blocks); ++i)
            parted[places[b * partitions + (grid_.bucket(photons_[i].p) >> shift)]++] = photons_[i];
    };
    run.chunks(blocks, part, nullptr);

    begin_.resize(std::size_t(grid_.buckets) + 1);
    begin_[grid_.buckets] = uint32_t(n);
    const auto arrange = [&](uint64_t p) {
        const std::size_t first = p << shift, last = std::min<std::size_t>((p + 1) << shift, grid_.buckets);
        for (uint32_t i = begin[p]; i < begin[p + 1]; ++i) ++begin_[grid_.bucket(parted[i].p)];
        uint32_t sum = begin[p];
        for (std::size_t b = first; b < last; ++b) sum += std::exchange(begin_[b], sum);
        for (uint32_t i = begin[p]; i < begin[p + 1]; ++i) photons_[begin_[grid_.bucket(parted[i].p)]++] = parted[i];
        for (std::size_t b = last - 1; b > first; --b) begin_[b] = begin_[b - 1]; // each was moved on to its end
        begin_[first] = begin[p];
    };
    run.chunks(partitions, arrange, nullptr);
}

void PhotonStore::save(Writer& to) const {
    to.value(cell_);
    to.array(photons());
}

void PhotonStore::load(const Executor& run, Reader& from, const PathClasses& classes) {
    const auto cell = from.value<float>();
    if (!(cell > 0) || !std::isfinite(cell)) from.refuse("its photon map has no cells; make it again");
    auto photons = from.array<Photon>();
    if (photons.size() >= mostPhotons) from.refuse("its photon map has more photons than one can hold; make it again");
    for (const Photon& photon : photons)
        if (!finite(photon.p) || !finite(photon.flux) || photon.state >= classes.states())
            from.refuse("it has a photon that is nowhere, of no finite flux or of no known path; make it again");
    photons_.assign(photons.begin(), photons.end());
    sort(run, cell);
}

} // namespace chiaro
