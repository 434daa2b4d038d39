#include "core/math/sobol.h"
#include "core/math/wide_isa.h"
#include "integrators/radiosity/patch_places.h"

namespace chiaro::radiosity {
namespace {

constexpr uint32_t width = RayPacket::size;

struct Numbers { // two pairs for each of sixteen samples
    alignas(64) float px[width], py[width], wx[width], wy[width];
};

[[gnu::always_inline]] inline void draw(const PatchRays& r, uint32_t first, Numbers& n) noexcept {
    for (uint32_t k = 0; k < width; ++k) {
        const Point2 p = sobolPair(shuffledIndex(first + k, r.place.index), r.place.x, r.place.y);
        n.px[k] = p.x;
        n.py[k] = p.y;
    }
    for (uint32_t k = 0; k < width; ++k) {
        const Point2 w = sobolPair(shuffledIndex(first + k, r.way.index), r.way.x, r.way.y);
        n.wx[k] = w.x;
        n.wy[k] = w.y;
    }
}

// The disc of core/math/warp.h (Shirley and Chiu 1997). Its angle stays within pi/4, where the series are exact to rounding.
[[gnu::always_inline]] inline Vec3 cosineDirection(float u, float v) noexcept {
    const float x = u + u - 1, y = v + v - 1;
    const bool wide = std::fabs(x) > std::fabs(y);
    const float r = wide ? x : y, num = wide ? y : x, den = r == 0 ? 1.f : r, phi = pi / 4 * (num / den), q = phi * phi;
    const float sine = phi * (1 - q * (1 / 6.f - q * (1 / 120.f - q * (1 / 5040.f - q / 362880.f))));
    const float cosine = 1 - q * (1 / 2.f - q * (1 / 24.f - q * (1 / 720.f - q / 40320.f)));
    const float s = r * sine, c = r * cosine, dx = wide ? c : s, dy = wide ? s : c, left = 1 - dx * dx - dy * dy;
    return {dx, dy, std::sqrt(left > 0 ? left : 0.f)};
}

[[gnu::always_inline]] inline void aim(const PatchRays& r, const Numbers& n, RayPacket& rays) noexcept {
    const Frame f = r.frame;
    for (uint32_t k = 0; k < width; ++k) {
        const Vec3 d = cosineDirection(n.wx[k], n.wy[k]);
        rays.dx[k] = f.x.x * d.x + f.y.x * d.y + f.z.x * d.z;
        rays.dy[k] = f.x.y * d.x + f.y.y * d.y + f.z.y * d.z;
        rays.dz[k] = f.x.z * d.x + f.y.z * d.y + f.z.z * d.z;
    }
    const PatchPlaces p = r.places;
    if (p.parallelogram) {
        for (uint32_t k = 0; k < width; ++k) {
            rays.ox[k] = p.origin.x + p.first.x * n.px[k] + p.second.x * n.py[k];
            rays.oy[k] = p.origin.y + p.first.y * n.px[k] + p.second.y * n.py[k];
            rays.oz[k] = p.origin.z + p.first.z * n.px[k] + p.second.z * n.py[k];
        }
    } else {
        for (uint32_t k = 0; k < width; ++k) {
            const Vec3 o = p.at(n.px[k], n.py[k]);
            rays.ox[k] = o.x, rays.oy[k] = o.y, rays.oz[k] = o.z;
        }
    }
    for (uint32_t k = 0; k < width; ++k) {
        rays.tnear[k] = 0;
        rays.tfar[k] = infinity;
        rays.time[k] = r.time;
    }
}

[[gnu::always_inline]] inline void make(const PatchRays& r, uint32_t first, RayPacket& rays) noexcept {
    Numbers n;
    draw(r, first, n);
    aim(r, n, rays);
}
void baseline(const PatchRays& r, uint32_t first, RayPacket& rays) noexcept { make(r, first, rays); }
CHIARO_TARGET_AVX2 void avx2(const PatchRays& r, uint32_t first, RayPacket& rays) noexcept { make(r, first, rays); }
CHIARO_TARGET_AVX512 void avx512(const PatchRays& r, uint32_t first, RayPacket& rays) noexcept { make(r, first, rays); }

} // namespace

PatchRays::PatchRays(const Patch& p, Sampler s, float when) noexcept
    : places(p), frame(Frame::about(p.normal)), sampler(s), place(s.pairSeeds()), time(when) {
    s.skip(2);
    way = s.pairSeeds();
    places.origin = p.outside(places.origin);
}

void PatchRays::fill(uint32_t first, RayPacket& rays) const noexcept {
    if (sampler.kind() == SamplerKind::sobol) {
        static auto* const chosen = widest(baseline, avx2, avx512);
        chosen(*this, first, rays);
        return;
    }
    Numbers n;
    for (uint32_t k = 0; k < width; ++k) {
        Sampler s = sampler.at(first + k);
        const Point2 p = s.get2D(), w = s.get2D();
        n.px[k] = p.x, n.py[k] = p.y, n.wx[k] = w.x, n.wy[k] = w.y;
    }
    aim(*this, n, rays);
}

} // namespace chiaro::radiosity
