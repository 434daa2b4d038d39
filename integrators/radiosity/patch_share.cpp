#include "integrators/radiosity/patch_share.h"
#include "integrators/radiosity/patch_corners.h"
#include <algorithm>
#include <array>

namespace chiaro::radiosity {
namespace {

constexpr float lift = 2e-3f; // of the rays off the surface, of the distance of the middles
constexpr uint64_t perChunk = 256;
constexpr std::size_t most = 32; // patches at a point; the tip of a cone of more keeps one value

class Sharing {
public:
    Sharing(const Work& work, const std::vector<Patch>& patches, float time) : work_(work), patches_(patches), time_(time) {}
    // Which side each patch at a point belongs to, 0 of the first; how many there are.
    uint32_t sides(std::span<const uint32_t> at, std::span<uint8_t> side) const {
        std::fill(side.begin(), side.end(), uint8_t(0));
        std::array<uint32_t, most> open{};
        std::array<uint8_t, most> group{}; // of those
        std::size_t n = 0;
        if (at.size() < 2 || at.size() > most) return 1;
        for (uint32_t k = 0; k < at.size(); ++k)
            if (patches_[at[k]].open >= leastOpen) open[n++] = k;
        if (n < 2) return 1;
        for (std::size_t k = 0; k < n; ++k) group[k] = uint8_t(k);
        firstWithAll(at, {open.data(), n}, group);
        for (std::size_t i = 1; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                if (group[i] != group[j] && !blocked(at[open[i]], at[open[j]])) join(group, n, group[i], group[j]);
        uint32_t found = 0;
        std::array<uint8_t, most> name{};
        for (std::size_t k = 0; k < n; ++k) {
            if (group[k] == k) name[k] = uint8_t(found++); // the least of a group names it
            side[open[k]] = name[group[k]];
        }
        return found;
    }

private:
    static void join(std::array<uint8_t, most>& group, std::size_t n, uint8_t a, uint8_t b) noexcept {
        const uint8_t low = std::min(a, b), high = std::max(a, b);
        for (std::size_t k = 0; k < n; ++k)
            if (group[k] == high) group[k] = low;
    }
    // What settles nearly every point: rays from the first to all others, sixteen at a time.
    void firstWithAll(std::span<const uint32_t> at, std::span<const uint32_t> open, std::array<uint8_t, most>& group) const {
        constexpr std::size_t width = 16;
        Ray rays[width];
        uint8_t hidden[width];
        for (std::size_t begin = 1; begin < open.size(); begin += width) {
            const std::size_t n = std::min(width, open.size() - begin);
            for (std::size_t k = 0; k < n; ++k) rays[k] = between(at[open[0]], at[open[begin + k]]);
            work_.scene.occluded({rays, n}, {hidden, n});
            for (std::size_t k = 0; k < n; ++k)
                if (!hidden[k]) group[begin + k] = 0;
        }
    }
    bool blocked(uint32_t i, uint32_t j) const {
        const Ray ray = between(i, j);
        uint8_t hidden = 0;
        work_.scene.occluded({&ray, 1}, {&hidden, 1});
        return hidden != 0;
    }
    // From the middle of one to that of the other, off the surface by so much that it clears what bulges between them.
    Ray between(uint32_t i, uint32_t j) const noexcept {
        const Patch &a = patches_[std::min(i, j)], &b = patches_[std::max(i, j)];
        const Vec3 sum = a.normal + b.normal, n = lengthSquared(sum) > 1e-6f ? normalize(sum) : a.normal;
        float bulge = 0;
        for (const Patch* p : {&a, &b})
            for (uint32_t k = 0; k < p->corners; ++k)
                bulge = max(bulge, max(dot(p->corner[k] - a.centre, n), dot(p->corner[k] - b.centre, n)));
        const float high = bulge + max(lift * length(b.centre - a.centre), 4 * max(a.error, b.error));
        const Vec3 from = a.centre + n * high, way = b.centre - a.centre;
        const float l = length(way);
        return {from, 0, l > 0 ? way * (1 / l) : n, l, time_};
    }

    const Work& work_;
    const std::vector<Patch>& patches_;
    float time_;
};

} // namespace

uint32_t partPoints(const Work& work, std::vector<Patch>& patches, uint32_t& points, float time) {
    if (work.scene.lights().count() == 0) return 0;
    const Corners corners(patches, points);
    std::vector<uint8_t> side(corners.patch.size(), 0), sides(points, 1);
    const Sharing sharing(work, patches, time);
    work.run.chunks((points + perChunk - 1) / perChunk,
                    [&](uint64_t chunk) {
                        for (uint32_t i = uint32_t(chunk * perChunk); i < std::min<uint64_t>(points, (chunk + 1) * perChunk); ++i)
                            sides[i] = uint8_t(sharing.sides(corners.at(i), {side.data() + corners.begin[i], corners.at(i).size()}));
                    },
                    &work.stop);
    uint32_t parted = 0;
    const uint32_t before = points;
    for (uint32_t i = 0; i < before; ++i) {
        if (sides[i] < 2) continue;
        ++parted;
        for (uint32_t k = corners.begin[i]; k < corners.begin[i + 1]; ++k) {
            if (side[k] == 0) continue;
            Patch& p = patches[corners.patch[k]];
            for (uint32_t c = 0; c < p.corners; ++c)
                if (p.vertex[c] == i) p.vertex[c] = points + side[k] - 1u;
        }
        points += sides[i] - 1u;
    }
    return parted;
}

} // namespace chiaro::radiosity
