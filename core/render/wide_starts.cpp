#include "core/render/wide_starts.h"
#include "core/math/sobol.h"
#include "core/math/wide_isa.h"

namespace chiaro {
namespace {

constexpr std::size_t width = RayPacket::size;

[[gnu::always_inline]] inline void directions(const StartLanes& lanes, std::size_t first, const Filter& filter, const Camera& camera,
                                              RayPacket& rays) noexcept {
    alignas(64) float u[width], v[width];
    for (std::size_t k = 0; k < width; ++k) {
        const std::size_t i = first + k;
        const Point2 p = sobolPair(shuffledIndex(lanes.sample[i], lanes.index[i]), lanes.x[i], lanes.y[i]);
        u[k] = p.x;
        v[k] = p.y;
    }
    for (std::size_t k = 0; k < width; ++k) {
        u[k] = lanes.centreX[first + k] + filter.offset(u[k]);
        v[k] = lanes.centreY[first + k] + filter.offset(v[k]);
    }
    for (std::size_t k = 0; k < width; ++k) {
        const Vec3 d = camera.plainDirection({u[k], v[k]});
        rays.dx[k] = d.x;
        rays.dy[k] = d.y;
        rays.dz[k] = d.z;
    }
}

void baseline(const StartLanes& l, std::size_t first, const Filter& f, const Camera& c, RayPacket& r) noexcept {
    directions(l, first, f, c, r);
}
CHIARO_TARGET_AVX2 void avx2(const StartLanes& l, std::size_t first, const Filter& f, const Camera& c, RayPacket& r) noexcept {
    directions(l, first, f, c, r);
}
CHIARO_TARGET_AVX512 void avx512(const StartLanes& l, std::size_t first, const Filter& f, const Camera& c, RayPacket& r) noexcept {
    directions(l, first, f, c, r);
}

} // namespace

void plainDirections(const StartLanes& lanes, std::size_t first, const Filter& filter, const Camera& camera, RayPacket& rays) noexcept {
    static auto* const chosen = widest(baseline, avx2, avx512);
    chosen(lanes, first, filter, camera, rays);
}

} // namespace chiaro
