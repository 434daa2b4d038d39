#include "integrators/photon_lanes.h"
#include "core/math/sobol.h"
#include "core/math/warp.h"
#include "core/math/wide_isa.h"
#include "integrators/octahedral.h"

namespace chiaro {
namespace {

struct Seeds {
    Sampler::PairSeeds direction, roulette;
};

[[gnu::always_inline]] inline void draw(const Seeds& seeds, const uint32_t* path, bool roulette, PlainHits& h, std::size_t begin) noexcept {
#pragma GCC ivdep
    for (std::size_t k = 0, i = begin; k < laneWidth; ++k, ++i) {
        const Point2 u = sobolPair(shuffledIndex(path[k], seeds.direction.index), seeds.direction.x, seeds.direction.y);
        h.ux[i] = u.x;
        h.uy[i] = u.y;
    }
    if (!roulette) return;
#pragma GCC ivdep
    for (std::size_t k = 0, i = begin; k < laneWidth; ++k, ++i)
        h.roulette[i] = toUnit(reverseBits(laineKarras(shuffledIndex(path[k], seeds.roulette.index), seeds.roulette.x)));
}
void drawBaseline(const Seeds& s, const uint32_t* path, bool roulette, PlainHits& h, std::size_t begin) noexcept {
    draw(s, path, roulette, h, begin);
}
CHIARO_TARGET_AVX2 void drawAvx2(const Seeds& s, const uint32_t* path, bool roulette, PlainHits& h, std::size_t begin) noexcept {
    draw(s, path, roulette, h, begin);
}
CHIARO_TARGET_AVX512 void drawAvx512(const Seeds& s, const uint32_t* path, bool roulette, PlainHits& h, std::size_t begin) noexcept {
    draw(s, path, roulette, h, begin);
}

// Seeds of three dimensions that are stratified together, as Sampler::get3D() has them.
struct TripleSeeds {
    uint32_t index = 0, x = 0, y = 0, third = 0;
    TripleSeeds(uint64_t key, uint32_t dimension) noexcept {
        const uint64_t h = hashCombine(key, dimension), g = hashMix(h ^ 0x6a09e667f3bcc909ull);
        index = uint32_t(h), x = uint32_t(h >> 32), y = uint32_t(g), third = uint32_t(g >> 32);
    }
};
// Third dimension of Sobol' by its direction numbers: primitive polynomial x^2 + x + 1, first ones 1 and 3 (Joe and Kuo 2008).
struct ThirdDirections {
    uint32_t of[32] = {0x80000000u, 0xc0000000u};
    constexpr ThirdDirections() {
        for (int i = 2; i < 32; ++i) of[i] = of[i - 1] ^ of[i - 2] ^ of[i - 2] >> 2;
    }
};
[[gnu::always_inline]] inline void drawTriple(const TripleSeeds& seeds, uint32_t first, StartLanes::Numbers& n) noexcept {
    constexpr ThirdDirections directions;
    alignas(64) uint32_t third[laneWidth] = {}, shuffled[laneWidth];
    for (uint32_t k = 0; k < laneWidth; ++k) shuffled[k] = shuffledIndex(first + k, seeds.index);
    for (uint32_t bit = 0; bit < 32; ++bit)
        for (uint32_t k = 0; k < laneWidth; ++k) third[k] ^= (0 - (shuffled[k] >> bit & 1)) & directions.of[bit];
    for (uint32_t k = 0; k < laneWidth; ++k) {
        const Point2 u = sobolPair(shuffled[k], seeds.x, seeds.y);
        n.pick[k] = reverseBits(laineKarras(reverseBits(third[k]), seeds.third));
        n.x[k] = u.x;
        n.y[k] = u.y;
    }
}
struct StartSeeds {
    TripleSeeds from, towards;
    Sampler::PairSeeds time;
};
[[gnu::always_inline]] inline void drawStart(const StartSeeds& seeds, uint32_t first, bool times, StartLanes& s) noexcept {
    drawTriple(seeds.from, first, s.from);
    drawTriple(seeds.towards, first, s.towards);
    if (!times) return;
    for (uint32_t k = 0; k < laneWidth; ++k)
        s.time[k] = toUnit(reverseBits(laineKarras(shuffledIndex(first + k, seeds.time.index), seeds.time.x)));
}
void startBaseline(const StartSeeds& seeds, uint32_t first, bool times, StartLanes& s) noexcept { drawStart(seeds, first, times, s); }
CHIARO_TARGET_AVX2 void startAvx2(const StartSeeds& seeds, uint32_t first, bool times, StartLanes& s) noexcept {
    drawStart(seeds, first, times, s);
}
CHIARO_TARGET_AVX512 void startAvx512(const StartSeeds& seeds, uint32_t first, bool times, StartLanes& s) noexcept {
    drawStart(seeds, first, times, s);
}

// Points of the disk by angle and radius, as concentricDisk() has them; sine and cosine lie between the loops, for they are the library's.
struct DiskLanes {
    alignas(64) float r[laneWidth], phi[laneWidth], sine[laneWidth], cosine[laneWidth];
    alignas(64) int32_t wide[laneWidth];
};
[[gnu::always_inline]] inline void toDisk(const PlainHits& h, std::size_t begin, DiskLanes& d) noexcept {
#pragma GCC ivdep
    for (std::size_t k = 0, i = begin; k < laneWidth; ++k, ++i) {
        const float x = h.ux[i] + h.ux[i] - 1, y = h.uy[i] + h.uy[i] - 1;
        const bool wide = std::fabs(x) > std::fabs(y);
        const float r = wide ? x : y, num = wide ? y : x, den = r == 0 ? 1.f : r;
        d.wide[k] = wide ? -1 : 0;
        d.r[k] = r;
        d.phi[k] = (pi / 4) * (num / den);
    }
}

// How the lanes leave the surface, between the loops.
struct LeavingLanes {
    alignas(64) float factor[laneWidth]; // f times this is the weight
    alignas(64) float facing[laneWidth]; // above 0 where there is a direction
};
[[gnu::always_inline]] inline void leave(const ParticleLanes& p, std::size_t first, const DiskLanes& d, PlainHits& h, std::size_t begin,
                                         LeavingLanes& l) noexcept {
#pragma GCC ivdep
    for (std::size_t k = 0; k < laneWidth; ++k) {
        const std::size_t i = begin + k, j = first + k;
        const Vec3 ng{h.nx[i], h.ny[i], h.nz[i]}, wo{-p.dx[j], -p.dy[j], -p.dz[j]};
        const float side = dot(ng, wo) >= 0 ? 1.f : -1.f;
        const Vec3 n = ng * side;
        const float s = d.r[k] * d.sine[k], c = d.r[k] * d.cosine[k];
        const bool wide = d.wide[k] != 0;
        const float x = wide ? c : s, y = wide ? s : c, z = safeSqrt(1 - x * x - y * y);
        const Vec3 wi = Frame::about(n).toWorld({x, y, z});
        l.facing[k] = z > 0 ? dot(wi, n) : 0.f;
        l.factor[k] = z / cosineHemispherePdfW(z);
        const float reach = h.reach[i], offset = dot(wi, ng) < 0 ? -reach : reach;
        h.ox[i] = h.px[i] + ng.x * offset, h.oy[i] = h.py[i] + ng.y * offset, h.oz[i] = h.pz[i] + ng.z * offset;
        h.dx[i] = wi.x, h.dy[i] = wi.y, h.dz[i] = wi.z;
        h.wi[i] = octahedralCode<fineSteps, 16>(wo);
        h.normal[i] = octahedralCode<coarseSteps, 8>(n);
    }
}

template <bool roulette>
[[gnu::always_inline]] inline void carry(const ParticleLanes& p, std::size_t first, const LeavingLanes& l, PlainHits& h, std::size_t begin,
                                         FluxLanes& ledger) noexcept {
#pragma GCC ivdep
    for (std::size_t k = 0; k < laneWidth; ++k) {
        const std::size_t i = begin + k, j = first + k;
        const float factor = l.factor[k];
        const Spectrum weight{h.r[i] * factor, h.g[i] * factor, h.b[i] * factor}, flux{p.fr[j], p.fg[j], p.fb[j]};
        const Spectrum after = flux * weight;
        Spectrum t = Spectrum(p.tr[j], p.tg[j], p.tb[j]) * weight, on = after;
        const bool lit = (weight.c[0] != 0) | (weight.c[1] != 0) | (weight.c[2] != 0);
        const auto step = int32_t(h.step[i]);
        bool goesOn = (step == int32_t(PlainStep::any)) & (h.goesOn[i] != 0) & (l.facing[k] > 0) & lit;
        if constexpr (roulette) {
            const float survive = min(maxComponent(t), 0.95f), boost = 1 / survive;
            goesOn = goesOn & (h.roulette[i] < survive);
            t = t * boost;
            on = flux * (weight * boost);
        }
        // What is still carried after each of the two: as zero where it has gone.
        const float had = step >= 0 ? luminance(flux) : 0.f, scattered = luminance(after), kept = luminance(on);
        const float left = step == 0 ? had : l.facing[k] > 0 ? scattered : 0.f, after2 = step >= 0 ? left : 0.f;
        ledger.absorbed[k] += double(had) - double(after2);
        ledger.ended[k] += double(after2) - double(goesOn ? kept : 0.f);
        h.goesOn[i] = goesOn;
        h.fr[i] = on.c[0], h.fg[i] = on.c[1], h.fb[i] = on.c[2];
        h.tr[i] = t.c[0], h.tg[i] = t.c[1], h.tb[i] = t.c[2];
    }
}
[[gnu::always_inline]] inline void scatterAny(const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin,
                                              FluxLanes& ledger) noexcept {
    DiskLanes d;
    toDisk(h, begin, d);
    for (std::size_t k = 0; k < laneWidth; ++k) d.sine[k] = std::sin(d.phi[k]), d.cosine[k] = std::cos(d.phi[k]);
    LeavingLanes l;
    leave(p, first, d, h, begin, l);
    roulette ? carry<true>(p, first, l, h, begin, ledger) : carry<false>(p, first, l, h, begin, ledger);
}
void scatterBaseline(const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin, FluxLanes& l) noexcept {
    scatterAny(p, first, roulette, h, begin, l);
}
CHIARO_TARGET_AVX2 void scatterAvx2(const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin,
                                    FluxLanes& l) noexcept {
    scatterAny(p, first, roulette, h, begin, l);
}
CHIARO_TARGET_AVX512 void scatterAvx512(const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin,
                                        FluxLanes& l) noexcept {
    scatterAny(p, first, roulette, h, begin, l);
}

} // namespace

void drawStarts(const Sampler& first, bool times, StartLanes& s) noexcept {
    static auto* const chosen = widest(startBaseline, startAvx2, startAvx512);
    if (first.kind() == SamplerKind::sobol) {
        Sampler time = first;
        time.skip(6);
        return chosen({{first.key(), 0}, {first.key(), 3}, time.pairSeeds()}, first.index(), times, s);
    }
    for (uint32_t k = 0; k < laneWidth; ++k) {
        Sampler own = first.at(first.index() + k);
        for (StartLanes::Numbers* n : {&s.from, &s.towards}) {
            const PickAndPoint u = own.get3D();
            n->pick[k] = uint32_t(u.pick * 0x1p32);
            n->x[k] = u.u.x;
            n->y[k] = u.u.y;
        }
        s.time[k] = own.get1D();
    }
}

void drawNumbers(const Sampler& at, const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin) noexcept {
    static auto* const chosen = widest(drawBaseline, drawAvx2, drawAvx512);
    constexpr uint32_t toRoulette = 4; // dimensions: three of the direction, one of the class
    if (at.kind() == SamplerKind::sobol) {
        Sampler later = at;
        later.skip(toRoulette);
        return chosen({at.pairSeeds(), later.pairSeeds()}, p.path + first, roulette, h, begin);
    }
    for (std::size_t k = 0; k < laneWidth; ++k) {
        Sampler own = at.at(p.path[first + k]);
        const Point2 u = own.get3D().u;
        own.skip(1);
        h.ux[begin + k] = u.x;
        h.uy[begin + k] = u.y;
        h.roulette[begin + k] = own.get1D();
    }
}

void scatterPlain(const ParticleLanes& p, std::size_t first, bool roulette, PlainHits& h, std::size_t begin, FluxLanes& ledger) noexcept {
    static auto* const chosen = widest(scatterBaseline, scatterAvx2, scatterAvx512);
    chosen(p, first, roulette, h, begin, ledger);
}

} // namespace chiaro
