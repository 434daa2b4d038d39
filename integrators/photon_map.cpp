#include "integrators/photon_map.h"
#include "core/render/fault.h"
#include <algorithm>
#include <cmath>

namespace chiaro {

float kernelAt(PhotonKernel kernel, float squared) noexcept {
    switch (kernel) {
    case PhotonKernel::constant: return 1;
    case PhotonKernel::cone: return 1 - std::sqrt(squared);
    case PhotonKernel::epanechnikov: return 1 - squared;
    }
    return 1;
}

float kernelMean(PhotonKernel kernel) noexcept {
    return kernel == PhotonKernel::constant ? 1.f : kernel == PhotonKernel::cone ? 1.f / 3 : 0.5f;
}

namespace {

constexpr float mostSlant = 0.8f;  // cosine between normals, below which two surfaces are not one
constexpr float thickness = 0.25f; // of the disc, to either side, in radii

// The disc about a point: is a photon on its surface? The normal has 8 bits a coordinate; on a flat surface all have the same code.
class Disc {
public:
    Disc(const SurfacePoint& at, float radius) noexcept
        : p_(at.p), n_(at.ng), half_(thickness * radius + 4 * at.error), front_(packNormal(at.ng)), back_(packNormal(-at.ng)) {}
    // 1: on the front of the surface, -1: on its back; 0: elsewhere.
    float side(const Photon& photon) const noexcept {
        if (!(std::fabs(dot(photon.p - p_, n_)) <= half_)) return 0;
        if (photon.normal == front_) return 1;
        if (photon.normal == back_) return -1;
        const float cosine = dot(unpackNormal(photon.normal), n_);
        return cosine >= mostSlant ? 1.f : cosine <= -mostSlant ? -1.f : 0.f;
    }

private:
    Vec3 p_, n_;
    float half_;
    uint16_t front_, back_;
};

// How a photon's light leaves towards wo.
class Scatterer {
public:
    Scatterer(const PathClasses& classes, const GatherPoint& point) noexcept
        : classes_(classes), point_(point), flat_(point.bsdf.normal() == point.at.ng || point.bsdf.normal() == -point.at.ng),
          side_(dot(point.bsdf.normal(), point.at.ng) >= 0 ? 1.f : -1.f),
          apart_(point.lobes == GatheredLobes::diffuse || classes.sorts(point.eye) ? Terms::apart : Terms::together),
          even_(point.bsdf.albedo() == point.bsdf.diffuseAlbedo()), diffuse_(classes.eye(point.eye, Event::DR)) {
        if (even_) f_ = point.bsdf.evaluate(point.bsdf.normal()).f(); // an ideal diffuse surface
    }
    bool wanted() const noexcept {
        return even_ || point_.lobes == GatheredLobes::diffuse ? diffuse_ != 0 && !black(point_.bsdf.diffuseAlbedo())
                                                               : classes_.continues(point_.eye);
    }
    // scale: the kernel's, over the number of paths. side: of the surface on which the photon lies.
    void add(const Photon& photon, float side, float scale, Outputs& out, Spectrum& sum) noexcept {
        if (even_) {
            if (side != side_) return;
            give(photon.state, diffuse_, f_ * photon.flux * (flat_ ? scale : scale * tilt(unpackDirection(photon.wi))), out, sum);
            return;
        }
        const Vec3 wi = unpackDirection(photon.wi);
        const float s = scale * (flat_ ? 1.f : tilt(wi));
        for (const BsdfTerm& term : point_.bsdf.evaluate(wi, apart_)) {
            const bool glossy = term.event == Event::GR || term.event == Event::GT;
            if (glossy && point_.lobes == GatheredLobes::diffuse) continue;
            give(photon.state, classes_.eye(point_.eye, term.event), term.f * photon.flux * s, out, sum);
        }
    }

private:
    // Flux a unit of area is radiance times the cosine to the surface itself; the closure wants that to its shading normal.
    float tilt(const Vec3& wi) const noexcept {
        const float cosine = dot(wi, point_.bsdf.normal());
        if (even_ && cosine <= 0) return 0;
        return std::fabs(cosine) / std::max(absDot(wi, point_.at.ng), 1e-3f);
    }
    void give(PathState photon, PathState eye, const Spectrum& value, Outputs& out, Spectrum& sum) noexcept {
        if (photon != lastPhoton_ || eye != lastEye_) {
            lastPhoton_ = photon;
            lastEye_ = eye;
            layer_ = eye != 0 ? classes_.meet(photon, eye) : Layer(0);
        }
        if (layer_ == 0) return;
        const Spectrum v = point_.weight * value;
        out.add(layer_, v);
        sum += v;
    }

    const PathClasses& classes_;
    const GatherPoint& point_;
    bool flat_;
    float side_; // of wo
    Terms apart_;
    bool even_;
    PathState diffuse_;
    Spectrum f_{0};
    PathState lastPhoton_ = 0, lastEye_ = 0;
    Layer layer_ = 0;
};

} // namespace

GatherResult PhotonMap::add(const PathClasses& classes, const GatherPoint& point, Outputs& out) const noexcept {
    return add(classes, point, radius_, out);
}

GatherResult PhotonMap::add(const PathClasses& classes, const GatherPoint& point, float radius, Outputs& out) const noexcept {
    GatherResult result;
    Scatterer scatterer(classes, point);
    if (!scatterer.wanted()) return result;
    const Disc disc(point.at, radius);
    const float over = 1 / (kernelMean(plan_.kernel) * pi * float(paths_));
    float r2 = radius * radius, count = 0;
    if (plan_.k == 0) {
        const float scale = over / r2, inverse = 1 / r2;
        store_.within(point.at.p, radius, [&](const Photon& photon, float d2) {
            const float side = disc.side(photon);
            if (side == 0) return;
            ++count;
            scatterer.add(photon, side, scale * kernelAt(plan_.kernel, d2 * inverse), out, result.added);
        });
    } else {
        PhotonStore::Near near[mostNearest];
        const uint32_t n =
            store_.nearest(point.at.p, plan_.k, radius, {near, plan_.k}, [&](const Photon& photon) { return disc.side(photon) != 0; });
        const bool full = n == plan_.k;
        if (full) r2 = near[0].distance2;
        const uint32_t first = full && !fault(Fault::photonDensityBias) ? 1 : 0;
        const float scale = over / r2;
        for (uint32_t i = first; i < n; ++i) {
            const Photon& photon = store_.photons()[near[i].photon];
            scatterer.add(photon, disc.side(photon), scale * kernelAt(plan_.kernel, std::min(near[i].distance2 / r2, 1.f)), out,
                          result.added);
        }
        count = float(n - first);
    }
    result.found = {count / (pi * r2), std::sqrt(r2), count};
    return result;
}

float typicalRadius(std::span<const Photon> photons, double k, double quantile) {
    constexpr std::size_t mostSample = 16384, queries = 128, enough = 8;
    if (photons.size() <= enough) return 0;
    const std::size_t stride = (photons.size() + mostSample - 1) / mostSample, n = photons.size() / stride;
    std::vector<float> distances(n), densities;
    for (std::size_t q = 0; q < std::min(queries, n); ++q) {
        const Vec3 p = photons[q * n / std::min(queries, n) * stride].p;
        for (std::size_t i = 0; i < n; ++i) distances[i] = lengthSquared(photons[i * stride].p - p);
        const std::size_t rank = std::min(enough, n - 1); // 0 is the photon itself
        std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(rank), distances.end());
        const float r2 = distances[rank];
        if (r2 > 0) densities.push_back(float(double(rank - 1) * double(stride) / (double(pi) * double(r2))));
    }
    if (densities.empty()) return 0;
    const auto at = densities.begin() + std::ptrdiff_t(double(densities.size() - 1) * quantile);
    std::nth_element(densities.begin(), at, densities.end());
    return float(std::sqrt(k / (double(pi) * double(*at))));
}

} // namespace chiaro
