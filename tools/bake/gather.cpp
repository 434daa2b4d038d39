#include "tools/bake/gather.h"
#include "core/math/warp.h"
#include "materials/bsdf.h"
#include <cmath>
#include <numbers>

namespace chiaro::bake {
namespace {

constexpr std::size_t width = 64;
constexpr float pi = std::numbers::pi_v<float>;
constexpr float leastAlbedo = 1e-3f; // below it nothing of the light is seen

} // namespace

// One sample of one site, as far as it is known before its rays are traced.
struct Gather::Point {
    uint32_t sample = 0;
    Spectrum albedo, emission, direct; // direct: irradiance, if the shadow ray arrives
    float opacity = 1;
    bool asks = false, traced = false; // a shadow ray; a ray into the scene
};
struct Gather::Room {
    explicit Room(const FilmLayout& layout) : plain(layout) {
        points.reserve(width);
        starts.reserve(width);
        outputs.reserve(width);
    }
    FilmLayout plain;
    std::vector<Point> points;
    std::vector<PathStart> starts; // of the points that trace
    std::vector<Outputs> outputs;
    std::vector<Ray> shadows; // of the points that ask
    std::array<Ray, width> rays;
    std::array<Hit, width> hits;
    std::array<uint8_t, width> blocked;
};

Gather::Gather(const Job& job, const CameraIntegrator& integrator, const GatherSettings& settings)
    : job_(job), integrator_(integrator), settings_(settings), height_(1e-3f * job.scene.radius()) {}

void Gather::take(const Sites& sites, std::size_t site, uint32_t sample, Room& room) const {
    const Scene& scene = job_.scene;
    const float time = job_.shutter.open;
    Sampler sampler(job_.seed, job_.sampler, Stream::pixel, site, sample);
    Hit hit = sites.hit(site, sample, sampler.get2D());
    const SurfacePoint at = scene.point(hit, Ray{{}, 0, {0, 0, 1}, infinity, time});
    Wavelengths lambda;
    const Bsdf bsdf = shade(scene, at, at.ng, {}, lambda);
    const Vec3 n = bsdf.normal();
    Point& p = room.points.emplace_back();
    p.sample = sample;
    p.albedo = bsdf.albedo();
    p.opacity = scene.opacity(at);
    if (const LightHit light = scene.lights().hit(at, at.ng, nullptr)) p.emission = light.radiance;
    const PickAndPoint u = sampler.get3D();
    const Point2 v = sampler.get2D();
    if (settings_.estimate == Estimate::gather && settings_.direct)
        if (const auto light = scene.lights().sampleTowards(at, u.pick, u.u); light && light->pdfW > 0) {
            const float cosine = dot(n, light->wi);
            if (cosine > 0 && dot(at.ng, light->wi) > 0) {
                p.direct = light->radiance * (cosine / light->pdfW);
                p.asks = true;
                room.shadows.push_back(light->shadow);
            }
        }
    PathStart start{{uint32_t(site % 65536), uint32_t(site / 65536)}, sample, {}, {}, {}, sampler, {}};
    if (settings_.estimate != Estimate::gather) {
        start.ray = {at.p + at.ng * height_, 0, -at.ng, infinity, time};
        hit.t = height_;
        start.first = hit;
        p.traced = true;
    } else if (settings_.indirect) {
        const Vec3 wi = Frame::about(n).toWorld(cosineHemisphere(v));
        p.traced = dot(wi, at.ng) > 0;
        start.ray = at.towards(wi);
    }
    if (p.traced) {
        room.rays[room.starts.size()] = start.ray;
        room.starts.push_back(start);
    }
}

void Gather::trace(Room& room) const {
    const std::size_t n = room.starts.size(), asked = room.shadows.size();
    job_.scene.occluded(room.shadows, {room.blocked.data(), asked});
    if (settings_.estimate == Estimate::gather) {
        job_.scene.intersect(std::span<const Ray>(room.rays.data(), n), {room.hits.data(), n}, false);
        for (std::size_t i = 0; i < n; ++i) room.starts[i].first = room.hits[i];
    }
    for (std::size_t i = 0; i < n; ++i) room.outputs.emplace_back(room.plain);
    if (n > 0) integrator_.radianceWide(job_, room.starts, room.outputs);
}

bool Gather::seesBack(const Ray& ray, const Hit& hit) const noexcept {
    if (!hit) return false;
    const SurfacePoint s = job_.scene.point(hit, ray);
    const MaterialDesc& m = job_.scene.material(s.material);
    return !m.doubleSided && m.transmission == 0 && m.alphaMode == AlphaMode::opaque && dot(s.ng, ray.d) > 0;
}

void Gather::settle(const Point& p, const Outputs& out, SiteSum& sum) const {
    ++sum.next;
    const Spectrum arrives = p.traced ? out.total() : Spectrum(0);
    Spectrum irradiance = p.asks ? p.direct : Spectrum(0);
    for (std::size_t c = 0; c < 3; ++c) {
        if (settings_.estimate == Estimate::look)
            irradiance[c] = p.albedo[c] > leastAlbedo ? pi * arrives[c] / p.albedo[c] : 0;
        else
            irradiance[c] += pi * arrives[c];
    }
    Spectrum outgoing = p.albedo * irradiance * (1 / pi) + p.emission;
    if (settings_.estimate == Estimate::look) outgoing = arrives + p.emission;
    if (!finite(irradiance) || !finite(outgoing)) {
        ++sum.dropped;
        return;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        sum.irradiance[c] += double(irradiance[c]);
        sum.outgoing[c] += double(outgoing[c]);
    }
    sum.opacity += double(p.opacity);
    sum.half[p.sample % 2] += double(luminance(irradiance));
    ++sum.counted[p.sample % 2];
    sum.shines = sum.shines || !black(p.emission);
}

void Gather::samples(const Sites& sites, std::size_t firstSite, std::span<SiteSum> sums, uint32_t end) const {
    Room room(FilmLayout{});
    for (std::size_t i = 0; i < sums.size(); ++i) {
        SiteSum& sum = sums[i];
        while (sum.next < end) {
            room.points.clear();
            room.starts.clear();
            room.outputs.clear();
            room.shadows.clear();
            const uint32_t most = std::min<uint32_t>(end - sum.next, width);
            for (uint32_t k = 0; k < most; ++k) take(sites, firstSite + i, sum.next + k, room);
            trace(room);
            std::size_t ray = 0, shadow = 0;
            static const Outputs nothing{FilmLayout{}};
            for (Point& p : room.points) {
                if (p.asks && room.blocked[shadow++]) p.asks = false;
                if (!p.traced) {
                    settle(p, nothing, sum);
                    continue;
                }
                if (settings_.estimate == Estimate::gather) {
                    ++sum.rays;
                    sum.backs += seesBack(room.rays[ray], room.hits[ray]);
                }
                settle(p, room.outputs[ray++], sum);
            }
        }
    }
}

std::optional<PathQuery> raysOf(Estimate estimate, uint32_t maxDepth) {
    PathQuery q;
    q.maxDepth = maxDepth;
    if (estimate == Estimate::view) return q;
    q.within = "L .+ E";
    if (maxDepth == unlimitedDepth || estimate == Estimate::look) return maxDepth > 0 ? std::optional(q) : std::nullopt;
    if (maxDepth < 2) return {};
    q.maxDepth = maxDepth - 1;
    return q;
}

} // namespace chiaro::bake
