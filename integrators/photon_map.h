// A photon map: photons, and the estimate of their density. Light that leaves x towards wo is the sum over the photons about x of
//   f(x, wo, wi) flux / paths K(d / r) / (c pi r^2)      Jensen, Realistic Image Synthesis Using Photon Mapping, 2001, eq. 7.6
// with a kernel K whose mean over the unit disc is c: constant 1 (c = 1), cone 1 - d (1/3), Epanechnikov 1 - d^2 (1/2). r is given, or the
// distance of the k-th nearest photon: then the k - 1 nearer ones count, since the k-th lies on the rim by definition (k photons over
// pi r_k^2 err by k / (k - 1)); where fewer than k are within the greatest radius, all of them over that. Both are exact where the light is
// even; elsewhere they err by c' r^2 times the Laplacian of the illuminance, c' = 1/8, 0.075, 1/12, and at edges, where the disc leaves the
// surface, by a share of the light itself.
//
// A photon counts where it lies on the same surface: in its plane, its normal alike, and on a side from which light is scattered to wo.
#pragma once
#include "integrators/photon_store.h"
#include "materials/bsdf.h"

namespace chiaro {

enum class PhotonKernel : uint8_t { constant, cone, epanechnikov };
struct DensityPlan {
    PhotonKernel kernel = PhotonKernel::constant;
    uint32_t k = 0; // photons of a k-nearest estimate; 0: all within the radius
};
inline constexpr uint32_t mostNearest = 1024;

enum class GatheredLobes : uint8_t { all, diffuse };
// Where light is gathered: what arrives there leaves towards wo of the closure.
struct GatherPoint {
    const SurfacePoint& at;
    const Bsdf& bsdf;
    PathState eye = 0; // state on arrival
    Spectrum weight;   // of the radiance that leaves the point
    GatheredLobes lobes = GatheredLobes::all;
};
struct GatherResult {
    Spectrum added{0}; // in all layers together
    Gathered found;    // radius 0: nobody asked, since no such path is wanted
};

class PhotonMap {
public:
    PhotonMap() = default;
    // paths: whose photons these are. radius: metres, of the estimate or the greatest one.
    PhotonMap(PhotonStore store, uint64_t paths, float radius, const DensityPlan& plan)
        : store_(std::move(store)), paths_(paths), radius_(radius), plan_(plan) {}

    // Adds what leaves the point, photon by photon in the layer of its path. radius: other than the map's own.
    GatherResult add(const PathClasses&, const GatherPoint&, Outputs&) const noexcept;
    GatherResult add(const PathClasses&, const GatherPoint&, float radius, Outputs&) const noexcept;

    const PhotonStore& store() const noexcept { return store_; }
    uint64_t paths() const noexcept { return paths_; }
    float radius() const noexcept { return radius_; }

private:
    PhotonStore store_;
    uint64_t paths_ = 1;
    float radius_ = 1;
    DensityPlan plan_;
};

// The kernel at (d / r)^2, and its mean over the disc.
float kernelAt(PhotonKernel, float squared) noexcept;
float kernelMean(PhotonKernel) noexcept;

// The radius of the disc that holds k photons, typically: where a share `quantile` of the photons lies in a density below. Of a sample of
// them, by brute force; 0 without photons.
float typicalRadius(std::span<const Photon>, double k, double quantile);

} // namespace chiaro
