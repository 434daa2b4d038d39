// Photons and how they are found again. A photon is a particle at a surface: where, which way it came, how much flux it carries, what its
// path was so far. The store sorts them by the cells of a uniform grid (counting, in parallel, no atomics), so that whoever gathers reads
// whole cells: a disc about a point touches 2 x 2 x 2 to 3 x 3 x 3 of them. The order of the photons, hence every sum over them, is a
// function of the photons alone, not of threads. 32 bytes each (Jensen, Realistic Image Synthesis Using Photon Mapping, 2001, has 20).
#pragma once
#include "core/render/integrator.h"
#include "integrators/bulk_allocator.h"
#include <algorithm>
#include <functional>

namespace chiaro {

struct Photon {
    Vec3 p;
    Spectrum flux;       // lumen on arrival, of all the light if it were the only path: divide by the number of paths
    uint32_t wi = 0;     // towards where it came from: octahedral, 16 bits a coordinate
    PathState state = 0; // of its path on arrival
    uint16_t normal = 0; // the geometric normal of its surface on the side that it came to: octahedral, 8 bits a coordinate
};
static_assert(sizeof(Photon) == 32);
using PhotonList = std::vector<Photon, BulkAllocator<Photon>>; // grown without a value: whatever was there

// Octahedral codes (Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014): within 1e-4 and 2e-2
// radians.
uint32_t packDirection(const Vec3&) noexcept;
Vec3 unpackDirection(uint32_t) noexcept; // unit length
uint16_t packNormal(const Vec3&) noexcept;
Vec3 unpackNormal(uint16_t) noexcept;

class PhotonStore {
public:
    PhotonStore() = default;
    // cell: side of a grid cell in metres; a radius of the searches is served best by a cell of its size. Positions must be finite.
    // Takes as much memory again while it sorts. Throws Error(Exit::resources) beyond 2^31 - 1 photons.
    PhotonStore(const Executor&, PhotonList, float cell);
    std::size_t size() const noexcept { return photons_.size(); }
    std::span<const Photon> photons() const noexcept { return photons_; } // sorted
    float cell() const noexcept { return cell_; }
    std::size_t bytes() const noexcept;

    // f(photon, squared distance) for every photon nearer than radius, cell by cell in an order that is always the same. F must not throw.
    template <class F> void within(const Vec3& p, float radius, F&& f) const noexcept;
    // The k nearest of those that keep(photon) accepts, nearer than radius: into `found` (room for k) as (squared distance, index), the
    // farthest first, the others in no order that matters. Returns how many. Of photons equally far, the first of the store are taken.
    struct Near {
        float distance2 = 0;
        uint32_t photon = 0;
        friend bool operator<(const Near& a, const Near& b) noexcept {
            return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.photon < b.photon);
        }
    };
    template <class Keep> uint32_t nearest(const Vec3& p, uint32_t k, float radius, std::span<Near> found, Keep&& keep) const noexcept;

    void save(Writer&) const;
    void load(const Executor&, Reader&, const PathClasses&); // those of the photons' states

private:
    // Cells are numbered from the lowest photon. Each has a bucket; where the box of the photons has too many cells for a table, several
    // cells share one by hashing (Teschner et al. 2003), and photons of other cells are passed over.
    struct Grid {
        Vec3 low;
        float inverse = 1;              // 1 / side, 1/m
        int32_t nx = 1, ny = 1, nz = 1; // cells
        uint32_t buckets = 1;           // of hashing a power of two
        bool hashed = false;
        int32_t along(float x, float from, int32_t n) const noexcept { // clamped: the box has all photons
            return std::clamp(int32_t(std::clamp((x - from) * inverse, -1.f, 0x1p30f)), 0, n - 1);
        }
        uint32_t bucket(int32_t x, int32_t y, int32_t z) const noexcept {
            if (!hashed) return uint32_t((z * ny + y) * nx + x);
            const uint32_t row = uint32_t(x >> 3) * 73856093u ^ uint32_t(y) * 19349663u ^ uint32_t(z) * 83492791u;
            return (row & (buckets / 8 - 1)) * 8 + (uint32_t(x) & 7); // eight neighbours along x lie side by side
        }
        bool inRun(const Vec3& p, int32_t xFrom, int32_t xTo, int32_t y, int32_t z) const noexcept {
            const int32_t x = along(p.x, low.x, nx);
            return xFrom <= x && x <= xTo && along(p.y, low.y, ny) == y && along(p.z, low.z, nz) == z;
        }
        uint32_t bucket(const Vec3& p) const noexcept {
            return bucket(along(p.x, low.x, nx), along(p.y, low.y, ny), along(p.z, low.z, nz));
        }
    };
    // f(index of photon, squared distance), limit2() being asked again for every run of cells.
    template <class Limit, class F> void visit(const Vec3& p, float radius, Limit&& limit2, F&& f) const noexcept;
    Grid gridOver(const Executor&, float cell) const;
    void sort(const Executor&, float cell);

    PhotonList photons_;
    std::vector<uint32_t> begin_; // of each bucket, and the end
    Grid grid_;
    float cell_ = 1;
};

template <class Limit, class F> void PhotonStore::visit(const Vec3& p, float radius, Limit&& limit2, F&& f) const noexcept {
    if (photons_.empty() || !(radius > 0)) return;
    const Grid& g = grid_;
    // A photon in the next cell by rounding is still within: the box is a little wider than the ball.
    const float reach = radius * 1.0001f + maxAbs(p) * 1e-6f;
    const int32_t x0 = g.along(p.x - reach, g.low.x, g.nx), x1 = g.along(p.x + reach, g.low.x, g.nx);
    const int32_t y0 = g.along(p.y - reach, g.low.y, g.ny), y1 = g.along(p.y + reach, g.low.y, g.ny);
    const int32_t z0 = g.along(p.z - reach, g.low.z, g.nz), z1 = g.along(p.z + reach, g.low.z, g.nz);
    const auto run = [&](uint32_t begin, uint32_t end, auto&& accept) {
        const Photon* photons = photons_.data();
        for (uint32_t i = begin; i < end; ++i)
            if (const float d2 = lengthSquared(photons[i].p - p); d2 < limit2() && accept(photons[i].p)) f(i, d2);
    };
    if (double(x1 - x0 + 1) * (y1 - y0 + 1) * (z1 - z0 + 1) > double(photons_.size())) // more cells than photons
        return run(0, uint32_t(photons_.size()), [](const Vec3&) { return true; });
    for (int32_t z = z0; z <= z1; ++z)
        for (int32_t y = y0; y <= y1; ++y) {
            if (!g.hashed) { // neighbours along x lie one behind the other
                run(begin_[g.bucket(x0, y, z)], begin_[g.bucket(x1, y, z) + 1], [](const Vec3&) { return true; });
                continue;
            }
            for (int32_t x = x0, last; x <= x1; x = last + 1) {
                last = std::min(x1, x | 7);
                run(begin_[g.bucket(x, y, z)], begin_[g.bucket(last, y, z) + 1],
                    [&, last](const Vec3& q) { return g.inRun(q, x, last, y, z); });
            }
        }
}

template <class F> void PhotonStore::within(const Vec3& p, float radius, F&& f) const noexcept {
    const float limit = radius * radius;
    visit(
        p, radius, [limit] { return limit; }, [&](uint32_t i, float d2) { f(photons_[i], d2); });
}

template <class Keep>
uint32_t PhotonStore::nearest(const Vec3& p, uint32_t k, float radius, std::span<Near> found, Keep&& keep) const noexcept {
    k = uint32_t(std::min<std::size_t>(k, found.size()));
    if (k == 0) return 0;
    uint32_t n = 0;
    float limit = radius * radius;
    const auto take = [&](uint32_t i, float d2) {
        const Near one{d2, i};
        if (!keep(photons_[i])) return;
        if (n < k) {
            found[n++] = one;
            if (n == k) {
                std::make_heap(found.begin(), found.begin() + k);
                limit = std::nextafter(found[0].distance2, infinity); // equally far ones are compared by number
            }
            return;
        }
        if (!(one < found[0])) return;
        // Sift the new one down from the top.
        uint32_t hole = 0;
        for (uint32_t child = 1; child < k; child = 2 * hole + 1) {
            if (child + 1 < k && found[child] < found[child + 1]) ++child;
            if (!(one < found[child])) break;
            found[hole] = found[child];
            hole = child;
        }
        found[hole] = one;
        limit = std::nextafter(found[0].distance2, infinity);
    };
    visit(
        p, radius, [&] { return limit; }, take);
    if (n > 0 && n < k) std::iter_swap(found.begin(), std::max_element(found.begin(), found.begin() + n));
    return n;
}

} // namespace chiaro
