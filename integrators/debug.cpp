// Debug views: what the first hit is like, as a picture. No light is transported.
#include "integrators/entries.h"
#include "integrators/transport.h"

namespace chiaro {
namespace {

enum class Show : uint8_t { normals, depth, albedo, uv };

template <Show show> class DebugView final : public CameraIntegrator {
    void radiance(const Job& job, PathStart& start, Outputs& out) const noexcept override {
        if (!start.first) {
            if (out.log) logSky(*out.log, job.scene, start.ray, Spectrum(1));
            return;
        }
        const SurfacePoint at = job.scene.point(start.first, start.ray);
        const Bsdf bsdf = shade(job.scene, at, -start.ray.d, start.footprint.at(start.first.t), start.lambda);
        const Vec3 n = bsdf.normal();
        if (out.log) logSurface(*out.log, at, n, start.first.t, Spectrum(1));
        out.aov(Aov::albedo, bsdf.albedo());
        out.aov(Aov::normal, {n.x, n.y, n.z});
        if constexpr (show == Show::normals) addFound(out, 1, {n.x, n.y, n.z});
        if constexpr (show == Show::depth) addFound(out, 1, Spectrum(job.view.camera.depth(at.p)));
        if constexpr (show == Show::albedo) addFound(out, 1, bsdf.albedo());
        if constexpr (show == Show::uv) addFound(out, 1, {at.uv[0].x, at.uv[0].y, 0});
    }
};

Traits traits(const Options&) {
    Traits t;
    t.lightTransport = false;
    t.covers = "";
    return t;
}
template <Show show> std::unique_ptr<Integrator> make(const Options&) { return std::make_unique<DebugView<show>>(); }

} // namespace

extern const IntegratorEntry normalsEntry = {
    "normals", "shading normals in world space, on the viewer's side", {}, traits, make<Show::normals>};
extern const IntegratorEntry depthEntry = {"depth", "planar depth of the first hit, metres", {}, traits, make<Show::depth>};
extern const IntegratorEntry albedoEntry = {"albedo", "directional albedo of the first hit", {}, traits, make<Show::albedo>};
extern const IntegratorEntry uvEntry = {"uv", "texture coordinates of the first hit, set 0", {}, traits, make<Show::uv>};

} // namespace chiaro
