// Sixteen paths in registers, and how they lie in a stream. For files compiled for one instruction set (core/math/wide_lanes.h).
#pragma once
#include "core/math/wide_lanes.h"
#include "core/scene/accel.h"
#include "integrators/path_wide.h"

namespace chiaro::CHIARO_ISA {

struct PathPacket {
    Vec3w o, d, from, fromNg; // origin and direction of the ray; the point that it left and the geometric normal there
    Rgbw throughput;
    Float pdfW; // of the direction; negative: of a delta lobe, or the camera's
    Float time;
    Float hero;          // the wavelength of a path that dispersion has parted
    Float width, spread; // of the ray cone: where the ray began, and once it has met something there; opening angle
    Int slot, depth, medium, keyLow, keyHigh, sample, state;

    // What this scene needs of it: a light tree the normal, an inside that light crosses its material, filtered textures the cone, what
    // moves the time, dispersion the wavelength; and path classes that ask for more than a depth the state.
    struct Needs {
        bool normal = false, medium = false, cone = false, time = false, hero = false, state = false;
    };
    template <class F, class I> CHIARO_LANE void each(Needs needs, F&& real, I&& whole) noexcept {
        real(0, o.x), real(1, o.y), real(2, o.z);
        real(3, d.x), real(4, d.y), real(5, d.z);
        real(6, from.x), real(7, from.y), real(8, from.z);
        real(9, throughput.c[0]), real(10, throughput.c[1]), real(11, throughput.c[2]);
        real(12, pdfW);
        if (needs.time) real(13, time);
        if (needs.normal) real(14, fromNg.x), real(15, fromNg.y), real(16, fromNg.z);
        if (needs.cone) real(17, width), real(18, spread);
        if (needs.hero) real(19, hero);
        whole(0, slot), whole(1, depth), whole(2, keyLow), whole(3, keyHigh), whole(4, sample);
        if (needs.medium) whole(5, medium);
        if (needs.state) whole(6, state);
    }
    CHIARO_LANE void load(const PathStream& s, uint32_t at, Needs needs) noexcept {
        fromNg = {Float(0.f), Float(0.f), Float(1.f)};
        medium = state = Int(0u);
        width = spread = time = hero = Float(0.f);
        each(
            needs, [&](int k, Float& v) { v = Float(s.f[k] + at); }, [&](int k, Int& v) { v = Int(s.i[k] + at); });
    }
    // The lanes of a mask, side by side. Fifteen more elements are written.
    CHIARO_LANE void append(PathStream& s, uint32_t at, Mask m, Needs needs) noexcept {
        each(
            needs, [&](int k, Float& v) { storePacked(s.f[k] + at, m, v); }, [&](int k, Int& v) { storePacked(s.i[k] + at, m, v); });
    }
};

// Shadow rays that wait for company, and what they bring where nothing stops them: to one sum, or where layers part what a lobe scatters to
// two.
struct ShadowQueue {
    static constexpr uint32_t room = 8 * laneCount;
    alignas(64) float f[11][room]; // origin, direction, tfar, time, RGB
    alignas(64) uint32_t slot[room];
    alignas(64) float second[3][room]; // RGB
    alignas(64) uint32_t secondSlot[room];
    TracePacket packet{};
    uint32_t first = 0, count = 0; // those that wait begin at a multiple of sixteen
    bool two = false;              // every ray has a second sum to which it brings something, be it nothing

    // Answers where the first of them is until the next call.
    CHIARO_LANE uint32_t append(Mask m, const Vec3w& o, const Vec3w& d, Float tfar, Float time, const Rgbw& brings, Int slots,
                                bool moves) noexcept {
        if (first + count > room - 2 * laneCount) rewind();
        const uint32_t end = first + count;
        const auto put = [&](int k, Float v) { storePacked(f[k] + end, m, v); };
        put(0, o.x), put(1, o.y), put(2, o.z), put(3, d.x), put(4, d.y), put(5, d.z), put(6, tfar);
        if (moves) put(7, time);
        put(8, brings.c[0]), put(9, brings.c[1]), put(10, brings.c[2]);
        storePacked(slot + end, m, slots);
        count += chiaro::CHIARO_ISA::count(m);
        return end;
    }
    CHIARO_LANE void appendSecond(uint32_t at, Mask m, const Rgbw& brings, Int slots) noexcept {
        for (int c = 0; c < 3; ++c) storePacked(second[c] + at, m, brings.c[std::size_t(c)]);
        storePacked(secondSlot + at, m, slots);
    }
    // Traces the first sixteen, or what there is.
    CHIARO_LANE void flush(const Accel& hierarchy, SampleLanes& to, bool moves) noexcept {
        const uint32_t n = count < laneCount ? count : laneCount;
        RayPacket& rays = packet.rays;
        const auto take = [&](int k, float* ray) { Float(f[k] + first).store(ray); };
        take(0, rays.ox), take(1, rays.oy), take(2, rays.oz), take(3, rays.dx), take(4, rays.dy), take(5, rays.dz), take(6, rays.tfar);
        if (moves) take(7, rays.time);
        const uint32_t stopped = hierarchy.stopped(packet, n);
        const Mask lit(~stopped & ((1u << n) - 1));
        const Float r(f[8] + first), g(f[9] + first), b(f[10] + first);
        if (two && any(lit & parted()))
            addBoth(to.direct, lit);
        else if (n == laneCount)
            addTo<true>(to.direct, slot + first, lit, r, g, b);
        else
            addTo(to.direct, slot + first, lit, r, g, b);
        first += n;
        count -= n;
    }

private:
    CHIARO_LANE Mask parted() const noexcept {
        return notBlack({Float(second[0] + first), Float(second[1] + first), Float(second[2] + first)});
    }
    // Ray after ray: two rays of one path may wait here, and their order may not depend on what waits beside them.
    CHIARO_LANE void addBoth(float (*sums)[4], Mask lit) const noexcept {
        for (uint32_t bits = lit.bits(); bits; bits &= bits - 1) {
            const uint32_t k = first + uint32_t(__builtin_ctz(bits));
            for (uint32_t c = 0; c < 3; ++c) sums[slot[k]][c] += f[8 + c][k];
            for (uint32_t c = 0; c < 3; ++c) sums[secondSlot[k]][c] += second[c][k];
        }
    }
    // To the beginning of the room, sixteen after sixteen: what is written over has been read.
    void rewind() noexcept {
        for (uint32_t k = 0; k < count; k += laneCount) {
            for (auto& values : f) Float(values + first + k).store(values + k);
            Int(slot + first + k).store(slot + k);
            if (!two) continue;
            for (auto& values : second) Float(values + first + k).store(values + k);
            Int(secondSlot + first + k).store(secondSlot + k);
        }
        first = 0;
    }
};

} // namespace chiaro::CHIARO_ISA
