#include "integrators/whitted_plain.h"
#include "core/math/wide_isa.h"
#include "core/render/fault.h"
#include "integrators/transport.h"

namespace chiaro {
namespace {

constexpr std::size_t width = PlainLanes::width;

// What the lamp brings to each lane and the shadow ray that asks for it. Every operation is that of the general way.
template <bool physical, bool flat>
[[gnu::always_inline]] inline void light(const MeshLamp& lamp, const Spectrum& intensity, const PlainLanes& at, std::size_t first,
                                         LampLanes& to) noexcept {
    for (std::size_t k = 0, i = first; k < width; ++k, ++i) {
        const Vec3 p{at.px[i], at.py[i], at.pz[i]}, ng{at.nx[i], at.ny[i], at.nz[i]};
        const LampWay way = lamp.way<physical, flat>(p, ng, at.reach[i]);
        const float cosine = dot(ng, way.wi) * at.side[i];
        const bool asks = (at.wanted[i] != 0) & way.arrives & (cosine > 0);
        to.shadow.ox[k] = way.start.x;
        to.shadow.oy[k] = way.start.y;
        to.shadow.oz[k] = way.start.z;
        to.shadow.tnear[k] = 0;
        to.shadow.dx[k] = way.d.x;
        to.shadow.dy[k] = way.d.y;
        to.shadow.dz[k] = way.d.z;
        to.shadow.time[k] = at.time[i];
        to.shadow.tfar[k] = asks ? way.left : -1.f;
        to.r[k] = at.fr[i] * (at.tr[i] * (intensity.c[0] * way.factor) * cosine);
        to.g[k] = at.fg[i] * (at.tg[i] * (intensity.c[1] * way.factor) * cosine);
        to.b[k] = at.fb[i] * (at.tb[i] * (intensity.c[2] * way.factor) * cosine);
    }
}
[[gnu::always_inline]] inline void anyLight(const MeshLamp& lamp, const Spectrum& intensity, const PlainLanes& at, std::size_t first,
                                            LampLanes& to) noexcept {
    if (lamp.attenuation.physical)
        lamp.flat ? light<true, true>(lamp, intensity, at, first, to) : light<true, false>(lamp, intensity, at, first, to);
    else
        lamp.flat ? light<false, true>(lamp, intensity, at, first, to) : light<false, false>(lamp, intensity, at, first, to);
}

void baseline(const MeshLamp& lamp, const Spectrum& intensity, const PlainLanes& at, std::size_t first, LampLanes& to) noexcept {
    anyLight(lamp, intensity, at, first, to);
}
CHIARO_TARGET_AVX2 void avx2(const MeshLamp& lamp, const Spectrum& intensity, const PlainLanes& at, std::size_t first,
                             LampLanes& to) noexcept {
    anyLight(lamp, intensity, at, first, to);
}
CHIARO_TARGET_AVX512 void avx512(const MeshLamp& lamp, const Spectrum& intensity, const PlainLanes& at, std::size_t first,
                                 LampLanes& to) noexcept {
    anyLight(lamp, intensity, at, first, to);
}

} // namespace

std::vector<PlainMaterial> plainMaterials(const Scene& scene, const WhittedSettings& settings) {
    if (settings.area == WhittedSettings::Area::sample || settings.rayFalloff) return {};
    return plainMaterials(scene);
}

const WhittedPlain::Known& WhittedPlain::known(const Hit& hit) noexcept {
    Known& k = known_[(hit.geometry * 2 + hit.triangle) % remembered];
    if (k.hit.geometry == hit.geometry && k.hit.triangle == hit.triangle && k.hit.instance == hit.instance) return k;
    k.hit = hit;
    const bool flat = job_.scene.flat(hit, k.triangle) && k.triangle.light == Lights::none;
    k.material = flat && materials_[k.triangle.material].plain ? &materials_[k.triangle.material] : nullptr;
    return k;
}

bool WhittedPlain::take(const Hit& hit, const Ray& ray, uint32_t tree, uint32_t depth, PathState state,
                        const Spectrum& throughput) noexcept {
    if (materials_.empty()) return false;
    const Known& k = known(hit);
    if (!k.material) return false;
    const FlatTriangle& t = k.triangle;
    const PlainMaterial& m = *k.material;
    Outputs& out = outputs_[tree];
    const bool outside = dot(t.ng, -ray.d) >= 0 || fault(Fault::backNormalKept);
    if (depth == 0) {
        out.aov(Aov::albedo, m.albedo);
        out.aov(Aov::normal, outside ? Spectrum(t.ng.x, t.ng.y, t.ng.z) : Spectrum(-t.ng.x, -t.ng.y, -t.ng.z));
    }
    if (!job_.classes.continues(state)) return true;
    if (!black(settings_.ambient)) addFound(out, otherLayer, throughput * settings_.ambient * m.diffuseAlbedo);
    if (!m.smooth) return true;
    PlainLanes& l = lanes_;
    const std::size_t i = l.count++;
    const Vec3 p = t.at(hit.u, hit.v);
    l.px[i] = p.x, l.py[i] = p.y, l.pz[i] = p.z;
    l.nx[i] = t.ng.x, l.ny[i] = t.ng.y, l.nz[i] = t.ng.z;
    l.side[i] = outside ? 1.f : -1.f;
    l.reach[i] = reachOf(t.ng, t.error);
    l.error[i] = t.error;
    l.time[i] = ray.time;
    l.fr[i] = m.f.c[0], l.fg[i] = m.f.c[1], l.fb[i] = m.f.c[2];
    l.tr[i] = throughput.c[0], l.tg[i] = throughput.c[1], l.tb[i] = throughput.c[2];
    l.tree[i] = tree;
    l.depth[i] = depth;
    l.state[i] = job_.classes.eye(state, Event::DR);
    return true;
}

// Of a punctual lamp, one lane after the other.
void WhittedPlain::towards(uint32_t lamp, std::size_t first, std::size_t count) noexcept {
    const PlainLanes& l = lanes_;
    for (std::size_t k = 0, i = first; k < count; ++k, ++i) {
        SurfacePoint at;
        at.p = {l.px[i], l.py[i], l.pz[i]};
        at.ng = at.ns = {l.nx[i], l.ny[i], l.nz[i]};
        at.error = l.error[i];
        at.time = l.time[i];
        lit_.shadow.tfar[k] = -1;
        const auto s = l.wanted[i] ? lamps_.towards(lamp, at) : std::nullopt;
        const float cosine = s ? dot(at.ng, s->wi) * l.side[i] : 0.f;
        if (!(cosine > 0)) continue;
        const Spectrum arriving = Spectrum(l.tr[i], l.tg[i], l.tb[i]) * s->radiance * (cosine / s->pdfW);
        lit_.shadow.set(k, s->shadow);
        lit_.r[k] = l.fr[i] * arriving.c[0];
        lit_.g[k] = l.fg[i] * arriving.c[1];
        lit_.b[k] = l.fb[i] * arriving.c[2];
    }
}

void WhittedPlain::answer() noexcept {
    for (std::size_t first = 0; first < lanes_.count; first += width) answer(first, std::min(width, lanes_.count - first));
    lanes_.count = 0;
}

void WhittedPlain::answer(std::size_t first, std::size_t count) noexcept {
    static auto* const chosen = widest(baseline, avx2, avx512);
    PlainLanes& l = lanes_;
    const bool shadows = settings_.shadows != WhittedSettings::Shadows::none;
    std::fill(l.wanted + first + count, l.wanted + first + width, 0);
    for (uint32_t lamp = 0; lamp < lamps_.count(); ++lamp) {
        const LightKind kind = lamps_.lamp(lamp).kind;
        for (std::size_t i = first; i < first + count; ++i) {
            l.layer[i] = job_.classes.reached(l.state[i], kind);
            l.wanted[i] = l.layer[i] != 0 ? -1 : 0;
        }
        if (kind == LightKind::area)
            chosen(lamps_.mesh(lamp), lamps_.lamp(lamp).intensity, l, first, lit_);
        else
            towards(lamp, first, count);
        uint8_t blocked[width] = {};
        if (shadows) lamps_.occluded(lamp, lit_.shadow, {blocked, count});
        for (std::size_t k = 0, i = first; k < count; ++k, ++i) {
            if (lit_.shadow.tfar[k] < 0) continue;
            Outputs& out = outputs_[l.tree[i]];
            out.traced(shadows ? 1 : 0, l.depth[i] + 1);
            if (!blocked[k]) out.add(l.layer[i], {lit_.r[k], lit_.g[k], lit_.b[k]});
        }
    }
}

} // namespace chiaro
