// Sixteen paths in registers, and how they lie in a stream. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "integrators/path_wide.h"

namespace chiaro::CHIARO_ISA {

struct PathPacket {
    Vec3w o, d, from, fromNg; // origin and direction of the ray; the point that it left and the geometric normal there
    Rgbw throughput;
    Float pdfW; // of the direction; negative: of a delta lobe, or the camera's
    Float time;
    Int slot, depth, medium, keyLow, keyHigh, sample;

    template <class F, class I> CHIARO_LANE void each(F&& real, I&& whole) noexcept {
        int k = 0;
        for (Vec3w* v : {&o, &d, &from, &fromNg}) real(k++, v->x), real(k++, v->y), real(k++, v->z);
        for (Float& c : throughput.c) real(k++, c);
        real(k++, pdfW);
        real(k++, time);
        k = 0;
        for (Int* i : {&slot, &depth, &medium, &keyLow, &keyHigh, &sample}) whole(k++, *i);
    }
    CHIARO_LANE void load(const PathStream& s, uint32_t at) noexcept {
        each([&](int k, Float& v) { v = Float(s.f[k] + at); }, [&](int k, Int& v) { v = Int(s.i[k] + at); });
    }
    // The lanes of a mask, side by side. Fifteen more elements are written.
    CHIARO_LANE void append(PathStream& s, uint32_t at, Mask m) noexcept {
        each([&](int k, Float& v) { storePacked(s.f[k] + at, m, v); }, [&](int k, Int& v) { storePacked(s.i[k] + at, m, v); });
    }
};

// Shadow rays that wait for company, and what they bring where nothing stops them.
struct ShadowQueue {
    static constexpr uint32_t room = 4 * laneCount;
    alignas(64) float f[11][room]; // origin, direction, tfar, time, RGB
    alignas(64) uint32_t slot[room];
    uint32_t count = 0;

    CHIARO_LANE void append(Mask m, const Vec3w& o, const Vec3w& d, Float tfar, Float time, const Rgbw& brings, Int slots) noexcept {
        int k = 0;
        for (const Float& v : {o.x, o.y, o.z, d.x, d.y, d.z, tfar, time, brings.c[0], brings.c[1], brings.c[2]})
            storePacked(f[k++] + count, m, v);
        storePacked(slot + count, m, slots);
        count += chiaro::CHIARO_ISA::count(m);
    }
    // Traces the first sixteen, or what there is.
    CHIARO_LANE void flush(const Scene& scene, SampleLanes& to) noexcept {
        const uint32_t n = count < laneCount ? count : laneCount;
        RayPacket rays;
        float* const at[] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz, rays.tfar, rays.time};
        for (int k = 0; k < 8; ++k) Float(f[k]).store(at[k]);
        Float(0.f).store(rays.tnear);
        const uint32_t stopped = scene.occluded(rays, n);
        for (uint32_t b = ~stopped & ((1u << n) - 1); b; b &= b - 1) {
            const auto k = uint32_t(__builtin_ctz(b));
            float* const sum = to.direct[slot[k]];
            for (int c = 0; c < 3; ++c) sum[c] += f[8 + c][k];
        }
        count -= n;
        for (uint32_t first = 0; first < count; first += laneCount) {
            for (auto& values : f) Float(values + n + first).store(values + first);
            Int(slot + n + first).store(slot + first);
        }
    }
};

} // namespace chiaro::CHIARO_ISA
