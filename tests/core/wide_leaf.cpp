// The leaf code of lanes gives what scalar code gives: random numbers and whole numbers bit for bit, warps and roots but for rounding.
#include "tests/core/wide_leaf.h"
#include "core/math/sobol.h"
#include "core/math/warp.h"
#include "tests/statistics.h"
#include <bit>
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Isa {
    const char* name;
    LeafProgram* run;
};
std::vector<Isa> isas() {
    std::vector<Isa> all;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) all.push_back({"avx2", leafAvx2});
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("gfni"))
        all.push_back({"avx512", leafAvx512});
    if (all.empty()) MESSAGE("SKIPPED: this machine has neither AVX2 nor AVX-512");
    return all;
}

// Sixteen samplers at vertices of any depth up to `deepest`.
std::vector<Sampler> fill(LeafLanes& l, stats::Random& u, uint32_t deepest) {
    const auto word = [&] { return uint32_t(u() * 0x1p32); };
    std::vector<Sampler> samplers;
    l = {};
    l.lanes = word() & 0xffff;
    for (uint32_t k = 0; k < LeafLanes::size; ++k) {
        l.x[k] = float(word() >> 8) * 0x1p-24f;
        l.y[k] = float(word() >> 8) * 0x1p-24f;
        l.bits[k] = word();
        l.depth[k] = word() % (deepest + 1);
        l.sample[k] = word() >> (word() & 31);
        Sampler s(word(), SamplerKind::sobol, Stream::pixel, word(), l.sample[k]);
        l.keyLow[k] = uint32_t(s.key());
        l.keyHigh[k] = uint32_t(s.key() >> 32);
        samplers.push_back(s);
    }
    return samplers;
}

} // namespace

TEST_SUITE("wide-leaf") {

    TEST_CASE("random numbers of any depth are the sampler's, to the last bit") {
        for (const Isa& isa : isas())
            for (const uint32_t deepest : {15u, 40u, 8000u}) {
                CAPTURE(isa.name);
                CAPTURE(deepest);
                stats::Random u(deepest);
                int wrong = 0;
                for (int round = 0; round < 500; ++round) {
                    LeafLanes l;
                    std::vector<Sampler> samplers = fill(l, u, deepest);
                    isa.run(l);
                    for (uint32_t k = 0; k < LeafLanes::size; ++k) {
                        Sampler& s = samplers[k];
                        s.skip(5 + 8 * l.depth[k]);
                        const PickAndPoint p = s.get3D();
                        s.skip(4);
                        wrong += p.pick != double(l.pick[k]) * 0x1p-32 || p.u.x != l.u[k] || p.u.y != l.v[k] || s.get1D() != l.one[k];
                    }
                }
                CHECK(wrong == 0);
            }
    }

    TEST_CASE("whole numbers, packing and sums, to the last bit") {
        for (const Isa& isa : isas()) {
            CAPTURE(isa.name);
            stats::Random u(7);
            int wrong = 0;
            for (int round = 0; round < 500; ++round) {
                LeafLanes l;
                fill(l, u, 3);
                isa.run(l);
                for (uint32_t k = 0, at = 0; k < LeafLanes::size; ++k) {
                    const bool on = l.lanes >> k & 1;
                    const float sum[] = {l.x[k], l.y[k], l.x[k] * l.y[k]};
                    wrong += l.reversed[k] != reverseBits(l.bits[k]) || l.high[k] != uint32_t(uint64_t(l.bits[k]) * 12345 >> 32);
                    if (on) wrong += l.packed[at++] != l.x[k];
                    for (int c = 0; c < 3; ++c) wrong += l.sums[15 - k][c] != (on ? 2 * sum[c] : 0.f);
                }
            }
            CHECK(wrong == 0);
        }
    }

    TEST_CASE("reciprocal roots and the hemisphere but for rounding") {
        for (const Isa& isa : isas()) {
            CAPTURE(isa.name);
            stats::Random u(8);
            double root = 0, warp = 0;
            for (int round = 0; round < 2000; ++round) {
                LeafLanes l;
                fill(l, u, 3);
                isa.run(l);
                for (uint32_t k = 0; k < LeafLanes::size; ++k) {
                    if (l.y[k] > 0) root = std::max(root, std::fabs(double(l.inverseRoot[k]) * std::sqrt(double(l.y[k])) - 1));
                    const Vec3d h = cosineHemisphere(Vec2T<double>{double(l.x[k]), double(l.y[k])});
                    const Vec3d d = h - Vec3d{double(l.hx[k]), double(l.hy[k]), double(l.hz[k])};
                    // Where the height is a difference of nearly equal numbers, its square is what is exact.
                    warp = std::max({warp, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z) * h.z});
                }
            }
            CHECK(root < 3e-7);
            CHECK(warp < 3e-7);
        }
    }
}
