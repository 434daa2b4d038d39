#include "core/scene/wide_lights.h"
#include "core/render/fault.h"
#include "core/scene/scene.h"
#include <bit>

namespace chiaro {
namespace {

static_assert(sizeof(WideLight) == WideLights::members * sizeof(float));
void put(float (&to)[3], const Vec3& v) noexcept { to[0] = v.x, to[1] = v.y, to[2] = v.z; }
void put(float (&to)[3], const Spectrum& v) noexcept { to[0] = v[0], to[1] = v[1], to[2] = v[2]; }

SurfacePoint receiver(const LightLanes& l, uint32_t k) noexcept {
    SurfacePoint s;
    s.p = {l.px[k], l.py[k], l.pz[k]};
    s.ng = s.ns = {l.nx[k], l.ny[k], l.nz[k]};
    s.error = l.error[k];
    s.time = l.time[k];
    return s;
}

} // namespace

WideLights::WideLights(const Scene& scene) : scene_(scene) {
    const Lights& lights = scene.lights();
    sky_ = lights.sky();
    edge_ = double(lights.pickEnvironment_);
    tree_ = viewOf(lights.tree_);
    treeShare_ = double(lights.pickTree_);
    for (std::size_t i = 0; i < lights.triangles_.size(); ++i) {
        const Lights::Triangle& t = lights.triangles_[i];
        const MaterialDesc& m = scene.material(t.material);
        WideLight w{};
        put(w.p, t.p), put(w.e1, t.e1), put(w.e2, t.e2);
        w.inverse = t.area > 0 ? 0.5f / t.area * (dot(cross(t.e1, t.e2), t.ng) < 0 ? -1.f : 1.f) : 0;
        w.error = t.error;
        put(w.emission, m.emission * (fault(Fault::lightPowerBias) ? 1.01f : 1.f));
        w.flags = t.doubleSided ? WideLight::doubleSided : 0u;
        if (m.unlit || m.emissionTexture.texture >= 0 || m.alphaMode != AlphaMode::opaque || t.motion != Lights::none || !(t.area > 0))
            w.flags |= WideLight::ask;
        records_.push_back(w);
    }
    for (const Lights::Punctual& l : lights.punctual_) {
        WideLight w{};
        put(w.p, l.p), put(w.e1, l.axis), put(w.e2, l.intensity);
        w.inverse = l.range;
        w.emission[0] = l.scale;
        w.emission[1] = l.offset;
        w.flags = WideLight::punctual | (l.kind == PunctualKind::directional ? WideLight::directional : 0u) |
                  (l.kind == PunctualKind::spot ? WideLight::spot : 0u) | (l.motion != Lights::none ? WideLight::ask : 0u);
        records_.push_back(w);
    }
    const AliasTable& table = lights.finite_;
    for (uint32_t i = 0; i < records_.size(); ++i) {
        records_[i].pmf = lights.pmf(i);
        if (table.empty()) continue;
        const uint32_t other = table.alias(i);
        for (const float f : {table.keep(i), std::bit_cast<float>(other), lights.pmf(i), lights.pmf(other)}) cells_.push_back(f);
    }
    for (std::size_t i = 0; i < records_.size() && records_.size() <= few; ++i)
        for (std::size_t m = 0; m < members + 4; ++m)
            fields_[m][i] = m < members ? records()[i * members + m] : cells_.empty() ? 0 : cells_[4 * i + m - members];
}

void WideLights::choose(LightLanes& l, uint32_t lanes) const noexcept {
    const Lights& lights = scene_.lights();
    for (uint32_t b = lanes; b; b &= b - 1) {
        const auto k = uint32_t(__builtin_ctz(b));
        const double u = double(l.pick[k]) * 0x1p-32;
        if (u < edge_) continue; // by lanes
        const Choice c = lights.choose(receiver(l, k), (u - edge_) / (1 - edge_), l.ux[k]);
        l.light[k] = c.pmf == 0 ? LightLanes::unchosen : c.index;
        l.pmf[k] = float(1 - edge_) * c.pmf;
        l.ux[k] = c.u;
    }
}

void WideLights::sample(LightLanes& l, uint32_t lanes) const noexcept {
    const Lights& lights = scene_.lights();
    for (uint32_t b = lanes; b; b &= b - 1) {
        const auto k = uint32_t(__builtin_ctz(b));
        const auto s = lights.sampleOne(l.light[k], receiver(l, k), 0, {l.ux[k], l.uy[k]});
        l.pdfW[k] = 0;
        if (!s) continue;
        l.wx[k] = s->wi.x, l.wy[k] = s->wi.y, l.wz[k] = s->wi.z;
        l.r[k] = s->radiance[0], l.g[k] = s->radiance[1], l.b[k] = s->radiance[2];
        l.pdfW[k] = s->pdfW * (fault(Fault::lightChoiceForgotten) ? 1.f : l.pmf[k]);
        l.ox[k] = s->shadow.o.x, l.oy[k] = s->shadow.o.y, l.oz[k] = s->shadow.o.z;
        l.dx[k] = s->shadow.d.x, l.dy[k] = s->shadow.d.y, l.dz[k] = s->shadow.d.z;
        l.tfar[k] = s->shadow.tfar;
        l.delta[k] = s->delta;
    }
}

} // namespace chiaro
