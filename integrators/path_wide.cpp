#include "integrators/path_wide.h"
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/ray_cone.h"
#include "integrators/transport.h"
#include "materials/bsdf.h"
#include "materials/slot_reader.h"
#include <algorithm>

namespace chiaro {
namespace {

// That of the instruction set in which the scene's rays are traced: whoever fixes one fixes both, but that the first processors with
// AVX-512 lack what our loops want beside it. Null: it has none.
PathProgram* program(const Scene& scene) noexcept {
    if (scene.isa() == "avx512" && __builtin_cpu_supports("gfni")) return followPathsAvx512;
    return (scene.isa() == "avx512" || scene.isa() == "avx2") && __builtin_cpu_supports("fma") ? followPathsAvx2 : nullptr;
}

// Do classes ask for nothing but a depth? Then a path needs no state.
bool onlyDepth(const PathClasses& classes) noexcept {
    if (!classes.layerNames().empty()) return false;
    PathState state = classes.eye();
    for (uint32_t depth = 0; depth <= unlimitedDepth; ++depth) {
        if (classes.sorts(state)) return false;
        for (int kind = 0; kind < lightKindCount; ++kind)
            if (classes.reached(state, LightKind(kind)) != otherLayer) return false;
        if (!classes.continues(state)) return depth == classes.maxDepth();
        const PathState next = classes.eye(state, Event::DR);
        for (int event = 0; event < eventCount; ++event)
            if (classes.eye(state, Event(event)) != next) return false;
        if (next == 0) return false;
        if (next == state) return classes.maxDepth() >= unlimitedDepth;
        state = next;
    }
    return false;
}

// Does a path pick a wavelength somewhere, and keep it?
bool parts(const Scene& scene) noexcept {
    return std::any_of(scene.materials().begin(), scene.materials().end(), [](const MaterialDesc& m) { return m.dispersion > 0; });
}

SurfacePoint from(const VertexLanes& l, uint32_t k) noexcept {
    SurfacePoint s;
    s.p = {l.fromP[0][k], l.fromP[1][k], l.fromP[2][k]};
    s.ng = s.ns = {l.fromNg[0][k], l.fromNg[1][k], l.fromNg[2][k]};
    s.time = l.rays.time[k];
    return s;
}
void put(float (&to)[3][VertexLanes::size], uint32_t k, const Spectrum& s) noexcept {
    for (std::size_t c = 0; c < 3; ++c) to[c][k] = s[c];
}
uint32_t mediumOf(const MaterialDesc& m, uint32_t id) noexcept {
    if (!m.volume || !(m.transmission > 0 || m.diffuseTransmission > 0) || m.metallic >= 1) return 0;
    return (id + 1) | (std::isfinite(m.attenuationDistance) ? VertexLanes::absorbs : 0u);
}
template <class F> void each(uint32_t lanes, F&& f) noexcept {
    for (; lanes; lanes &= lanes - 1) f(uint32_t(__builtin_ctz(lanes)));
}

} // namespace

float PathSettings::hitWeight(bool delta, float pdfW, float lightPdfW) const noexcept {
    if ((delta && !fault(Fault::deltaWeighted)) || !nee || lightPdfW == 0 || fault(Fault::emissionTwice)) return 1;
    return mis ? powerHeuristic(pdfW, lightPdfW) : 0.f;
}

WidePaths::WidePaths(const Scene& scene, const PathSettings& settings, uint32_t length, const Executor* run)
    : scene_(scene), settings_(settings), length_(std::clamp(length, PathStream::least, PathStream::most)), surfaces_(scene, run),
      materials_(scene), lights_(scene), textures_(scene, surfaces_), dispersive_(parts(scene)) {}

std::unique_ptr<const WidePaths> WidePaths::make(const Job& job, const PathSettings& settings, uint32_t length) {
    if (!program(job.scene) || job.sampler != SamplerKind::sobol || !onlyDepth(job.classes)) return nullptr;
    if (job.scene.counts().triangles * sizeof(WideTriangle) > job.memoryLimit) {
        job.notes.warn("no memory for the table of triangles that paths in lanes read; they are followed one by one");
        return nullptr;
    }
    return std::make_unique<WidePaths>(job.scene, settings, length, &job.run);
}
bool WidePaths::able(const Job& job, const FilmLayout& layout) noexcept {
    return job.sampler == SamplerKind::sobol && layout.layers.empty() && !layout.costs && !layout.photons && onlyDepth(job.classes);
}

void WidePaths::run(const Job& job, StartSource& source, SampleLanes& samples) const noexcept {
    thread_local const std::unique_ptr<PathStream> room(new PathStream); // not filled with zeros
    const Footprint pixel = textures_.filtered() ? job.view.camera.footprint() : Footprint{};
    program(scene_)(*this, job.classes.maxDepth(), pixel, source, samples, *room);
}

void WidePaths::found(VertexLanes& l, uint32_t lanes) const noexcept {
    each(lanes, [&](uint32_t k) {
        const Ray ray = l.rays.ray(k);
        const Hit hit = l.hits.hit(k);
        const SurfacePoint before = from(l, k), *began = l.depth[k] > 0 ? &before : nullptr;
        const LightHit light = hit ? scene_.lights().hit(scene_.point(hit, ray), -ray.d, began) : scene_.lights().miss(ray, began);
        put(l.light, k, light.radiance);
        l.lightPdfW[k] = light.pdfW;
    });
}

void WidePaths::texture(VertexLanes& l, uint32_t lanes) const noexcept {
    each(lanes, [&](uint32_t k) {
        SurfacePoint at = scene_.attributes(l.hits.hit(k));
        at.time = l.rays.time[k];
        const MaterialDesc& m = scene_.material(at.material);
        const SlotReader read(scene_, at, {l.rays.dx[k], l.rays.dy[k], l.rays.dz[k]}, {l.width[k], l.spread[k]});
        const Vec4 t = read(m.baseColorTexture, fault(Fault::baseColorNotDecoded) ? Transfer::linear : Transfer::srgb);
        put(l.baseColor, k, {clamp01(m.baseColor[0] * t.x), clamp01(m.baseColor[1] * t.y), clamp01(m.baseColor[2] * t.z)});
    });
}

void WidePaths::attenuate(VertexLanes& l, uint32_t lanes) const noexcept {
    each(lanes, [&](uint32_t k) {
        const Ray ray = l.rays.ray(k);
        const SurfacePoint at = scene_.point(l.hits.hit(k), ray);
        SurfacePoint before;
        before.material = (l.medium[k] & ~VertexLanes::absorbs) - 1;
        before.ng = -ray.d; // it lies behind that back
        const Spectrum t = segmentTransmittance(scene_, l.medium[k] ? &before : nullptr, ray.d, &at, l.hits.t[k]);
        for (std::size_t c = 0; c < 3; ++c) l.throughput[c][k] *= t[c];
    });
}

uint32_t WidePaths::vertex(VertexLanes& l, uint32_t lanes, uint32_t maxDepth) const noexcept {
    uint32_t alive = 0;
    each(lanes, [&](uint32_t k) {
        const Ray ray = l.rays.ray(k);
        const SurfacePoint at = scene_.point(l.hits.hit(k), ray);
        const uint32_t depth = l.depth[k];
        l.shadow.tfar[k] = -1;
        if (depth >= maxDepth && depth > 0) return;
        Wavelengths lambda{l.hero[k]};
        const Footprint here{l.width[k], l.spread[k]};
        const Bsdf bsdf = shade(scene_, at, -ray.d, here, lambda, Transport::radiance, Densities::forward);
        put(l.albedo, k, bsdf.albedo());
        put(l.normal, k, {bsdf.normal().x, bsdf.normal().y, bsdf.normal().z});
        if (depth >= maxDepth) return;
        const auto numbers = [&](int i) { return PickAndPoint{double(l.pick[i][k]) * 0x1p-32, {l.u[i][0][k], l.u[i][1][k]}}; };
        const PickAndPoint uLight = numbers(0), uBsdf = numbers(1);
        if (settings_.nee && bsdf.smooth() && !(fault(Fault::bounceDropped) && depth == 1)) {
            const auto light = scene_.lights().sampleTowards(at, uLight.pick, uLight.u);
            const BsdfValue value = light && light->pdfW > 0 ? bsdf.evaluate(light->wi) : BsdfValue{};
            if (value.n > 0 && !black(value.f())) {
                const float weight = settings_.mis && !light->delta ? powerHeuristic(light->pdfW, value.pdfW) : 1.f;
                const float cosine = fault(Fault::receiverCosineMissing) ? 1.f : absDot(bsdf.normal(), light->wi);
                const Spectrum through = segmentTransmittance(scene_, &at, light->wi, nullptr, light->shadow.tfar);
                put(l.arriving, k, value.f() * light->radiance * through * (cosine * weight / light->pdfW));
                l.shadow.set(k, light->shadow);
            }
        }
        const auto sample = bsdf.sample(min(float(uBsdf.pick), oneMinusEpsilon), uBsdf.u);
        if (!sample || black(sample->weight)) return;
        alive |= 1u << k;
        for (std::size_t c = 0; c < 3; ++c) l.throughput[c][k] *= sample->weight[c];
        l.hero[k] = sample->after(lambda).hero;
        l.pdfW[k] = sample->delta ? -sample->pdfW : sample->pdfW;
        l.spread[k] = scattered(scene_, at, here, -ray.d, sample->wi, sample->delta, sample->pdfW).spread;
        l.fromP[0][k] = at.p.x, l.fromP[1][k] = at.p.y, l.fromP[2][k] = at.p.z;
        l.fromNg[0][k] = at.ng.x, l.fromNg[1][k] = at.ng.y, l.fromNg[2][k] = at.ng.z;
        const MaterialDesc& m = scene_.material(at.material);
        l.medium[k] = dot(at.ng, sample->wi) < 0 ? mediumOf(m, at.material) : 0;
        l.next.set(k, at.towards(sample->wi));
    });
    return alive;
}

} // namespace chiaro
