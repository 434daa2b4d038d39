#include "integrators/plain_lamps.h"
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/wide_lights.h"
#include <bit>
#include <cstring>

namespace chiaro {
namespace {

Vec3 three(const float (&v)[3]) noexcept { return {v[0], v[1], v[2]}; }

} // namespace

PlainLamps::PlainLamps(const Scene& scene) : scene_(scene) {
    const WideLights wide(scene);
    edge_ = wide.edge();
    for (uint32_t i = 0; i < wide.finite(); ++i) {
        WideLight w;
        static_assert(std::is_trivially_copyable_v<WideLight>);
        std::memcpy(&w, wide.records() + i * (sizeof(WideLight) / sizeof(float)), sizeof w);
        float cell[2];
        std::memcpy(cell, wide.cells() + 4 * std::size_t(i), sizeof cell);
        cells_.push_back({cell[0], std::bit_cast<uint32_t>(cell[1])});
        Lamp l;
        l.plain = (w.flags & (WideLight::ask | WideLight::punctual)) == 0;
        if (l.plain) {
            l.p = three(w.p), l.e1 = three(w.e1), l.e2 = three(w.e2);
            l.error = w.error;
            l.pmf = w.pmf;
            l.doubleSided = (w.flags & WideLight::doubleSided) != 0;
            const Vec3 n = cross(l.e1, l.e2);
            const float twice = length(n), area = twice / 2;
            l.ng = n * ((w.inverse < 0 ? -1.f : 1.f) / twice);
            l.flux = Spectrum(w.emission[0], w.emission[1], w.emission[2]) * (pi * area * (l.doubleSided ? 2.f : 1.f));
            l.flux *= (fault(Fault::emittedFluxBias) ? 1.01f : 1.f) / l.pmf;
            l.plain = l.pmf > 0 && !black(l.flux);
        }
        lamps_.push_back(l);
    }
}

std::optional<LightEmission> PlainLamps::emit(const PickAndPoint& from, const PickAndPoint& towards, float time) const noexcept {
    if (from.pick < edge_ || cells_.empty()) return scene_.lights().emit(from, towards, time);
    const double cell = (from.pick - edge_) / (1 - edge_);
    const auto i = std::min(uint32_t(cell * double(cells_.size())), uint32_t(cells_.size() - 1));
    const Cell& c = cells_[i];
    const bool stays = from.u.x < c.keep;
    const Lamp& l = lamps_[stays ? i : c.alias];
    if (!l.plain) return scene_.lights().emit(from, towards, time);
    const float u = std::min(stays ? from.u.x / c.keep : (from.u.x - c.keep) / (1 - c.keep), oneMinusEpsilon);
    const Vec3 w = cosineHemisphere(towards.u);
    if (!(w.z > 0)) return {};
    const Point2 b = uniformTriangle(Point2{u, from.u.y});
    SurfacePoint at;
    at.p = l.p + l.e1 * b.x + l.e2 * b.y;
    at.ng = l.ng;
    at.error = l.error;
    at.time = time;
    const bool back = l.doubleSided && towards.pick >= 0.5;
    LightEmission e;
    e.ray = at.towards(Frame::about(back ? -l.ng : l.ng).toWorld(w));
    e.flux = l.flux;
    e.pmf = l.pmf;
    e.light = stays ? i : c.alias;
    return e;
}

} // namespace chiaro
