#include "integrators/radiosity/direct.h"
#include "core/math/warp.h"
#include <algorithm>

namespace chiaro::radiosity {
namespace {

constexpr std::size_t width = 16;
constexpr uint64_t patchesPerChunk = 16;

class PatchLight {
public:
    PatchLight(const Work& work, const Patches& patches, FromLights from, uint32_t rays)
        : work_(work), patches_(patches), lights_(work.scene.lights()), rays_(rays), all_(from == FromLights::all) {
        uint32_t area = 0;
        for (const Lamp& l : lights_.lamps()) {
            if (l.kind == LightKind::area)
                area += l.count;
            else
                single_.push_back(l.first);
        }
        if (lights_.hasEnvironment()) single_.push_back(lights_.count() - 1);
        hits_ = lights_.hasEnvironment() || (all_ && area > 0);
    }
    Light at(uint32_t patch) const noexcept {
        const Sampler base(work_.seed, work_.sampler, Stream::prepass, patch, 0);
        Light sum(0);
        for (uint32_t begin = 0; begin < rays_; begin += width) {
            const uint32_t n = std::min<uint32_t>(width, rays_ - begin);
            if (all_) {
                shadows(patch, base, begin, n, ~0u, sum);
            } else {
                for (const uint32_t light : single_) shadows(patch, base, begin, n, light, sum);
            }
            if (hits_) hemisphere(patch, base, begin, n, sum);
        }
        return sum * (1 / (double(rays_) * double(patches_[patch].open))); // none arrives where it is not open
    }

private:
    SurfacePoint point(uint32_t patch, Point2 u) const noexcept {
        const Patch& p = patches_[patch];
        SurfacePoint s;
        s.p = patches_.point(patch, u);
        s.ng = s.ns = p.normal;
        s.error = p.error;
        s.time = patches_.time();
        return s;
    }
    // light: one of them, ~0: one of all by lot.
    void shadows(uint32_t patch, const Sampler& base, uint32_t begin, uint32_t n, uint32_t light, Light& sum) const noexcept {
        Ray rays[width];
        Spectrum value[width];
        uint8_t blocked[width];
        std::size_t count = 0;
        for (uint32_t k = 0; k < n; ++k) {
            Sampler u = base.at(begin + k);
            const SurfacePoint from = point(patch, u.get2D());
            u.skip(light == ~0u ? 0 : 3 + 3 * (light & 1023)); // of each light its own numbers
            const PickAndPoint to = u.get3D();
            const auto s = light == ~0u ? lights_.sampleTowards(from, to.pick, to.u) : lights_.sampleOne(light, from, to.pick, to.u);
            if (!s || !(s->pdfW > 0)) continue;
            const float cosine = dot(from.ng, s->wi);
            if (!(cosine > 0)) continue;
            // Of one light the density has no choice in it; a hit that finds the same light knows none of the choice either.
            const float weight = s->delta ? 1 : powerHeuristic(s->pdfW, cosineHemispherePdfW(cosine));
            value[count] = s->radiance * (cosine * weight / s->pdfW);
            rays[count++] = s->shadow;
        }
        if (count == 0) return;
        work_.scene.occluded({rays, count}, {blocked, count});
        for (std::size_t k = 0; k < count; ++k)
            if (!blocked[k]) sum += widened(value[k]);
    }
    void hemisphere(uint32_t patch, const Sampler& base, uint32_t begin, uint32_t n, Light& sum) const noexcept {
        SurfacePoint from[width];
        Ray rays[width];
        Hit hits[width];
        const Frame frame = Frame::about(patches_[patch].normal);
        for (uint32_t k = 0; k < n; ++k) {
            Sampler u = base.at(begin + k);
            from[k] = point(patch, u.get2D());
            u.skip(3 + 3 * 1024);
            rays[k] = from[k].towards(frame.toWorld(cosineHemisphere(u.get2D())));
        }
        work_.scene.intersect({rays, n}, {hits, n}, false);
        for (uint32_t k = 0; k < n; ++k) {
            LightHit light;
            if (!hits[k]) {
                light = lights_.miss(rays[k], &from[k]);
                if (!all_ && lights_.hasEnvironment()) light.pdfW /= lights_.pmf(lights_.count() - 1);
            } else if (all_) {
                light = lights_.hit(work_.scene.point(hits[k], rays[k]), -rays[k].d, &from[k]);
            }
            if (!light) continue;
            const float pdfW = cosineHemispherePdfW(dot(frame.z, rays[k].d));
            if (pdfW > 0) sum += widened(light.radiance * (pi * powerHeuristic(pdfW, light.pdfW)));
        }
    }

    const Work& work_;
    const Patches& patches_;
    const chiaro::Lights& lights_;
    uint32_t rays_;
    bool all_, hits_ = false;
    std::vector<uint32_t> single_; // the lights that are no surfaces
};

} // namespace

Lights3 directIrradiance(const Work& work, const Patches& patches, FromLights from, uint32_t rays) {
    Lights3 out(patches.size(), Light(0));
    if (work.scene.lights().count() == 0) return out;
    const PatchLight light(work, patches, from, rays);
    const uint64_t n = patches.size();
    const bool done = work.run.chunks((n + patchesPerChunk - 1) / patchesPerChunk,
                                      [&](uint64_t chunk) {
                                          for (uint64_t i = chunk * patchesPerChunk; i < std::min(n, (chunk + 1) * patchesPerChunk); ++i)
                                              out[i] = light.at(uint32_t(i));
                                      },
                                      &work.stop);
    return done ? out : Lights3{};
}

} // namespace chiaro::radiosity
