// Points of one patch, uniform over its polygon, and the rays that leave from them: what a loop makes once and then asks many times.
#pragma once
#include "core/math/warp.h"
#include "core/scene/ray_packet.h"
#include "integrators/radiosity/patches.h"

namespace chiaro::radiosity {

// A parallelogram by its edges; anything else as one triangle or two, chosen by their areas. All drawn towards the centre by what rounding
// may move a point, so that none lies beyond a neighbouring wall.
struct PatchPlaces {
    Vec3 origin, first, second, diagonal;
    float share = 1; // of the triangle of `first` and `diagonal`
    bool parallelogram = false;

    explicit PatchPlaces(const Patch& p) noexcept {
        const Vec3 e1 = p.corner[1] - p.corner[0], e2 = p.corner[p.corners - 1] - p.corner[0], d = p.corner[2] - p.corner[0];
        const Vec3 twist = d - e1 - e2;
        const float longest = max(lengthSquared(e1), max(lengthSquared(e2), p.corners == 3 ? lengthSquared(e2 - e1) : 0));
        parallelogram = p.corners == 4 && lengthSquared(twist) < 1e-10f * longest;
        if (p.corners == 4) {
            const float lower = length(cross(e1, d)), upper = length(cross(d, e2));
            share = lower / (lower + upper);
        }
        // The centre is at least a third of the height over the longest edge away from every edge.
        const float height = p.area / (p.coverage * p.open) / std::sqrt(longest), pull = min(0.5f, 24 * p.error / height), rest = 1 - pull;
        Vec3 centre{};
        for (uint32_t k = 0; k < p.corners; ++k) centre += p.corner[k] * (1 / float(p.corners));
        origin = p.corner[0] + (centre - p.corner[0]) * pull;
        first = e1 * rest, second = e2 * rest, diagonal = d * rest;
    }
    [[gnu::always_inline]] Vec3 at(float x, float y) const noexcept {
        if (parallelogram) return origin + first * x + second * y;
        const bool lower = x < share;
        const float within = lower ? x / share : (x - share) / (1 - share), half = within * 0.5f, other = y * 0.5f;
        const bool below = within < y; // Heitz 2019, as uniformTriangle()
        const float a = below ? half : within - other, b = below ? y - half : other;
        return origin + (lower ? first : second) * a + diagonal * b;
    }
};

// Cosine-distributed rays from points of a patch, sixteen at a time: places by the sampler's first pair of numbers, directions by its
// second.
class PatchRays {
public:
    PatchRays(const Patch&, Sampler, float time) noexcept;
    // The rays of samples first ... first + 15.
    void fill(uint32_t first, RayPacket&) const noexcept;

    PatchPlaces places;
    Frame frame;
    Sampler sampler;
    Sampler::PairSeeds place, way;
    float time;
};

} // namespace chiaro::radiosity
