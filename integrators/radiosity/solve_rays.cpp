#include "integrators/radiosity/solve_rays.h"
#include "core/math/sampler.h"
#include "core/math/warp.h"
#include <algorithm>
#include <cmath>

namespace chiaro::radiosity {
namespace {

constexpr uint64_t raysPerChunk = 4096;
constexpr std::size_t width = 16;
constexpr double unit = 0x1p24; // of the luminance that one ray carries

// What has arrived at a patch, in units of the light of a ray.
struct Arrivals {
    std::atomic<uint64_t> channel[3];
};

class RayBounce {
public:
    RayBounce(const Work& work, const Patches& patches, const System& system, double raysPerPatch)
        : work_(work), patches_(patches), system_(system), most_(raysPerPatch * double(patches.size())), sums_(patches.size() + 1),
          arrivals_(new Arrivals[patches.size()]) {}

    void operator()(std::span<const Light> radiosity, std::span<Light> irradiance) {
        const std::size_t n = patches_.size();
        sums_[0] = 0;
        for (std::size_t i = 0; i < n; ++i) sums_[i + 1] = sums_[i] + luminance(radiosity[i]) * double(system_.areas[i]);
        const double all = sums_[n];
        first_ = std::max(first_, all);
        for (std::size_t i = 0; i < n; ++i)
            for (std::atomic<uint64_t>& c : arrivals_[i].channel) c.store(0, std::memory_order_relaxed);
        const uint64_t rays = all > 0 ? uint64_t(std::clamp(most_ * all / first_, 1024.0, 4e9)) : 0;
        work_.run.chunks((rays + raysPerChunk - 1) / raysPerChunk,
                         [&](uint64_t chunk) { shoot(radiosity, rays, chunk * raysPerChunk, std::min(rays, (chunk + 1) * raysPerChunk)); },
                         &work_.stop);
        const double perUnit = rays > 0 ? all / double(rays) / unit : 0; // lumen
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                irradiance[i][c] = double(arrivals_[i].channel[c].load(std::memory_order_relaxed)) * perUnit / double(system_.areas[i]);
        total_ += rays;
        ++bounce_;
    }
    uint64_t total() const noexcept { return total_; }
    std::size_t bytes() const noexcept { return sums_.size() * sizeof(double) + patches_.size() * sizeof(Arrivals); }

private:
    void shoot(std::span<const Light> radiosity, uint64_t rays, uint64_t begin, uint64_t end) const {
        const Sampler base(hashCombine(work_.seed, bounce_), work_.sampler, Stream::prepass, 0x5ad1, 0);
        Sampler shift = base;
        const double offset = shift.getPick();
        const double step = sums_.back() / double(rays);
        std::size_t patch = std::size_t(std::upper_bound(sums_.begin(), sums_.end(), (double(begin) + offset) * step) - sums_.begin()) - 1;
        Ray ray[width];
        Hit hit[width];
        std::size_t from[width];
        for (uint64_t s = begin; s < end; s += width) {
            const std::size_t n = std::size_t(std::min<uint64_t>(width, end - s));
            for (std::size_t k = 0; k < n; ++k) {
                const double at = (double(s + k) + offset) * step;
                while (patch + 1 < patches_.size() && sums_[patch + 1] <= at) ++patch;
                Sampler u = base.at(uint32_t(s + k));
                u.skip(1);
                const Patch& p = patches_[patch];
                const Vec3 o = patches_.point(uint32_t(patch), u.get2D());
                const Vec3 d = Frame::about(p.normal).toWorld(cosineHemisphere(u.get2D()));
                ray[k] = {p.outside(o), 0, d, infinity, patches_.time()};
                from[k] = patch;
            }
            work_.scene.intersect({ray, n}, {hit, n}, false);
            for (std::size_t k = 0; k < n; ++k) arrive(ray[k], hit[k], radiosity[from[k]], patches_[from[k]].open);
        }
    }
    // open: of the patch that sent it; what left elsewhere does not arrive, the others stand for it.
    void arrive(const Ray& ray, const Hit& hit, const Light& colour, float open) const noexcept {
        if (!hit) return;
        const uint32_t at = patches_.seen(hit, ray.d);
        if (at == ~0u) return;
        const double scale = unit / (luminance(colour) * double(open));
        for (std::size_t c = 0; c < 3; ++c)
            if (colour[c] > 0) arrivals_[at].channel[c].fetch_add(uint64_t(colour[c] * scale + 0.5), std::memory_order_relaxed);
    }

    const Work& work_;
    const Patches& patches_;
    const System& system_;
    double most_, first_ = 0;
    std::vector<double> sums_; // of power, over the patches
    std::unique_ptr<Arrivals[]> arrivals_;
    uint64_t total_ = 0, bounce_ = 0;
};

} // namespace

Solution solveStochastic(const Work& work, const Patches& patches, const System& system, const Limits& limits, double raysPerPatch) {
    RayBounce bounce(work, patches, system, raysPerPatch);
    const auto one = [&](std::span<const Light> from, std::span<Light> to) { bounce(from, to); };
    Solution s = neumann(system, one, limits, {work.run, work.stop, work.seed, work.memoryLimit});
    if (work.stop.requested()) s.complete = false;
    s.rays = bounce.total();
    s.bytes = bounce.bytes() + system.size() * sizeof(Light) * (limits.levels() + 4);
    return s;
}

} // namespace chiaro::radiosity
