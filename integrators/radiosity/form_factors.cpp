#include "integrators/radiosity/form_factors.h"
#include "core/math/warp.h"
#include "core/scene/ray_packet.h"
#include "integrators/radiosity/form_factors_pair.h"
#include "integrators/radiosity/form_factors_polygon.h"
#include "integrators/radiosity/form_factors_sum.h"
#include "integrators/radiosity/hemicube.h"
#include <array>

namespace chiaro::radiosity {
namespace {

constexpr uint32_t width = RayPacket::size;

// Rays between points of two patches, each with the kernel cos cos / r^2 there.
struct Between {
    Ray ray;
    double kernel = 0;
};
Between between(const Patches& patches, uint32_t i, uint32_t j, Sampler sampler) noexcept {
    const Point2 ui = sampler.get2D(), uj = sampler.get2D();
    const Patch &a = patches[i], &b = patches[j];
    const Vec3 x = patches.point(i, ui), y = patches.point(j, uj), way = y - x;
    const double r2 = double(lengthSquared(way)), ca = double(dot(way, a.normal)), cb = -double(dot(way, b.normal));
    if (!(ca > 0 && cb > 0 && r2 > 0)) return {};
    const Vec3 from = a.outside(x), d = b.outside(y) - from;
    const float far = length(d);
    if (!(far > 0)) return {};
    return {{from, 0, d * (1 / far), far * (1 - 0x1p-20f), patches.time()}, ca * cb / (r2 * r2)};
}

} // namespace

FormFactors::FormFactors(const Work& work, const Patches& patches, const FormFactorSettings& s)
    : work_(work), patches_(patches), settings_(s) {
    if (s.method == FormFactorMethod::hemicube) hemicube_ = std::make_unique<const Hemicube>(s.resolution);
}
FormFactors::~FormFactors() = default;

void FormFactors::row(uint32_t i, std::vector<Factor>& row) const {
    switch (settings_.method) {
    case FormFactorMethod::analytic: return analyticRow(i, row);
    case FormFactorMethod::hemisphere: return hemisphereRow(i, settings_.rays, 0, row);
    case FormFactorMethod::hemicube: return hemicubeRow(i, row);
    }
}

double FormFactors::unoccluded(const Vec3& p, const Vec3& normal, std::span<const Vec3> polygon) const noexcept {
    return pointToPolygon(cast<double>(p), cast<double>(normal), polygon);
}

double FormFactors::unoccluded(uint32_t i, uint32_t j) const noexcept {
    const Patch &a = patches_[i], &b = patches_[j];
    return i == j ? 0 : polygonExchange(a, b) / double(a.area) * double(a.coverage * a.open) * double(b.coverage * b.open);
}

double FormFactors::visibility(uint32_t i, uint32_t j, uint32_t rays, uint32_t salt) const noexcept {
    if (i > j) std::swap(i, j);
    const Sampler sampler(work_.seed, work_.sampler, Stream::prepass, hashCombine(uint64_t(i) << 32 | j, 0x715b1u + salt), 0);
    double arrived = 0, all = 0;
    std::array<Ray, width> batch;
    std::array<double, width> kernels;
    std::array<uint8_t, width> blocked;
    uint32_t n = 0, valid = 0;
    const auto trace = [&] {
        work_.scene.occluded(std::span<const Ray>(batch.data(), n), {blocked.data(), n});
        for (uint32_t k = 0; k < n; ++k) {
            all += kernels[k];
            if (!blocked[k]) arrived += kernels[k];
        }
        n = 0;
    };
    // Points that do not face each other (behind a horizon) tell nothing; as many more are tried.
    for (uint32_t k = 0; k < 8 * rays && valid < rays; ++k) {
        const Between b = between(patches_, i, j, sampler.at(k));
        if (!(b.kernel > 0)) continue;
        batch[n] = b.ray;
        kernels[n++] = b.kernel;
        ++valid;
        if (n == width) trace();
    }
    trace();
    return all > 0 ? arrived / all : 0;
}

void FormFactors::analyticRow(uint32_t i, std::vector<Factor>& row) const {
    row.clear();
    for (uint32_t j = 0; j < patches_.size(); ++j) {
        const double f = unoccluded(i, j);
        if (!(f > 1e-15)) continue;
        const double seen = settings_.shadowRays == 0
                                ? 1
                                : visibility(i, j, settings_.shadowRays, 0) / (double(patches_[i].open) * double(patches_[j].open));
        if (seen > 0) row.push_back({j, float(f * seen)});
    }
}

void FormFactors::hemicubeRow(uint32_t i, std::vector<Factor>& row) const {
    row.clear();
    const Patch& p = patches_[i];
    RowSum<double>& sums = RowSum<double>::ofThread(patches_.size());
    const Sampler sampler(work_.seed, work_.sampler, Stream::prepass, hashCombine(i, 0xc0be5), 0);
    RayPacket rays{};
    std::array<Hit, width> hits;
    const uint32_t points = std::max(1u, settings_.points), pixels = hemicube_->pixels();
    double closed = 0; // of the pixels, at points where the patch is not open
    for (uint32_t k = 0; k < points; ++k) {
        // Turned at random: where walls run along the cube's edges its pixels would err all in the same way.
        Sampler numbers = sampler.at(k);
        const Vec3 from = p.outside(patches_.point(i, numbers.get2D()));
        const float turn = 2 * pi * numbers.get1D(), c = std::cos(turn), s = std::sin(turn);
        const Frame frame = Frame::about(p.normal);
        const Vec3 x = frame.x * c + frame.y * s, y = frame.y * c - frame.x * s;
        for (uint32_t first = 0; first < pixels; first += width) {
            const uint32_t n = std::min(width, pixels - first);
            for (uint32_t l = 0; l < n; ++l) {
                const Vec3 d = (*hemicube_)[first + l].direction;
                rays.set(l, {from, 0, x * d.x + y * d.y + p.normal * d.z, infinity, patches_.time()});
            }
            work_.scene.intersect(rays, {hits.data(), n}, true);
            for (uint32_t l = 0; l < n; ++l) {
                if (!hits[l]) continue;
                const uint32_t j = patches_.seen(hits[l], {rays.dx[l], rays.dy[l], rays.dz[l]});
                if (j == ~0u)
                    closed += patches_.unlit(hits[l]) ? double((*hemicube_)[first + l].factor) : 0;
                else if (j != i)
                    sums.add(j, double((*hemicube_)[first + l].factor));
            }
        }
    }
    sums.drain(1 / std::max(points - closed, 1e-3), row);
}

} // namespace chiaro::radiosity
