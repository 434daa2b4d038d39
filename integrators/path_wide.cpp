#include "integrators/path_wide.h"
#include "core/math/warp.h"
#include "core/render/fault.h"
#include "core/scene/ray_cone.h"
#include "integrators/transport.h"
#include "materials/bsdf.h"
#include "materials/slot_reader.h"
#include "materials/surface_parameters.h"
#include <algorithm>

namespace chiaro {
namespace {

// That of the instruction set in which the scene's rays are traced: whoever fixes one fixes both, but that the first processors with
// AVX-512 lack what our loops want beside it. Null: it has none.
PathProgram* program(const Scene& scene) noexcept {
    if (scene.isa() == "avx512" && __builtin_cpu_supports("gfni")) return followPathsAvx512;
    return (scene.isa() == "avx512" || scene.isa() == "avx2") && __builtin_cpu_supports("fma") ? followPathsAvx2 : nullptr;
}

// Does a path pick a wavelength somewhere, and keep it?
bool parts(const Scene& scene) noexcept {
    return std::any_of(scene.materials().begin(), scene.materials().end(), [](const MaterialDesc& m) { return m.dispersion > 0; });
}

// From above: triangles with their texture coordinates and curvatures, lights with the table that chooses among them, materials.
std::size_t tableBytes(const Scene& scene) noexcept {
    constexpr std::size_t coordinates = 8 * sizeof(float), curvature = sizeof(float), choice = 4 * sizeof(float);
    const SceneCounts& n = scene.counts();
    const bool textured = !scene.textures().textures().empty();
    return n.triangles * (sizeof(WideTriangle) + (textured ? coordinates + curvature : 0)) +
           (n.emissiveTriangles + n.punctualLights) * (sizeof(WideLight) + choice) + scene.materials().size() * sizeof(WideMaterial);
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
    if (!hasInside(m)) return 0;
    return (id + 1) | (std::isfinite(m.attenuationDistance) ? VertexLanes::absorbs : 0u);
}
PickAndPoint numbers(const VertexLanes& l, int i, uint32_t k) noexcept {
    return {double(l.pick[i][k]) * 0x1p-32, {l.u[i][0][k], l.u[i][1][k]}};
}
template <class F> void each(uint32_t lanes, F&& f) noexcept {
    for (; lanes; lanes &= lanes - 1) f(uint32_t(__builtin_ctz(lanes)));
}

} // namespace

float PathSettings::hitWeight(bool delta, float pdfW, float lightPdfW) const noexcept {
    if ((delta && !fault(Fault::deltaWeighted)) || !nee || lightPdfW == 0 || fault(Fault::emissionTwice)) return 1;
    return mis ? powerHeuristic(pdfW, lightPdfW) : 0.f;
}

WidePaths::WidePaths(const Job& job, const PathSettings& settings, uint32_t length)
    : scene_(job.scene), settings_(settings), length_(std::clamp(length, PathStream::least, PathStream::most)), surfaces_(scene_, &job.run),
      materials_(scene_), lights_(scene_), textures_(scene_, surfaces_, &job.run), classes_(job.classes), dispersive_(parts(scene_)) {}

std::unique_ptr<const WidePaths> WidePaths::make(const Job& job, const PathSettings& settings, uint32_t length) {
    if (!program(job.scene) || job.sampler != SamplerKind::sobol) return nullptr;
    if (tableBytes(job.scene) > job.memoryLimit) {
        job.notes.warn("no memory for the tables that paths in lanes read; they are followed one by one. Give more with --max-memory.");
        return nullptr;
    }
    return std::make_unique<WidePaths>(job, settings, length);
}
bool WidePaths::able(const Job& job, const FilmLayout& layout) noexcept {
    return job.sampler == SamplerKind::sobol && !layout.costs && !layout.photons;
}

void WidePaths::run(const Job& job, StartSource& source, SampleLanes& samples) const noexcept {
    thread_local const std::unique_ptr<PathStream> room(new PathStream); // not filled with zeros
    const Footprint pixel = textures_.filtered() ? job.view.camera.footprint() : Footprint{};
    program(scene_)(*this, job.classes, pixel, source, samples, *room);
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

void WidePaths::direct(VertexLanes& l, uint32_t k, const SurfacePoint& at, const Bsdf& bsdf, const PathClasses* classes) const noexcept {
    const PickAndPoint uLight = numbers(l, 0, k);
    const auto light = scene_.lights().sampleTowards(at, uLight.pick, uLight.u);
    if (!light || !(light->pdfW > 0)) return;
    const PathState state = classes ? PathState(l.state[k]) : PathState(0);
    const BsdfValue value = bsdf.evaluate(light->wi, classes ? terms(*classes, state) : Terms::together);
    l.layer[0][k] = l.layer[1][k] = 0;
    for (int i = 0; i < value.n; ++i)
        l.layer[i][k] = classes ? classes->reached(classes->eye(state, value.terms[i].event), light->kind) : otherLayer;
    if ((l.layer[0][k] | l.layer[1][k]) == 0 || black(value.f())) return;
    const float weight = settings_.mis && !light->delta ? powerHeuristic(light->pdfW, value.pdfW) : 1.f;
    const float cosine = fault(Fault::receiverCosineMissing) ? 1.f : absDot(bsdf.normal(), light->wi);
    const Spectrum through = segmentTransmittance(scene_, &at, light->wi, nullptr, light->shadow.tfar);
    const float factor = cosine * weight / light->pdfW;
    for (int i = 0; i < value.n; ++i) put(l.arriving[i], k, value.terms[i].f * light->radiance * through * factor);
    l.shadow.set(k, light->shadow);
}

uint32_t WidePaths::vertex(VertexLanes& l, uint32_t lanes, const Wanted& wanted) const noexcept {
    const PathClasses* const classes = wanted.classes;
    uint32_t alive = 0;
    each(lanes, [&](uint32_t k) {
        const Ray ray = l.rays.ray(k);
        const SurfacePoint at = scene_.point(l.hits.hit(k), ray);
        const uint32_t depth = l.depth[k];
        const auto state = PathState(classes ? l.state[k] : 0);
        const bool more = classes ? classes->continues(state) : depth < wanted.maxDepth;
        l.shadow.tfar[k] = -1;
        if (!more && depth > 0) return;
        Wavelengths lambda{l.hero[k]};
        const Footprint here{l.width[k], l.spread[k]};
        const Bsdf bsdf = shade(scene_, at, -ray.d, here, lambda, Transport::radiance, Densities::forward);
        put(l.albedo, k, bsdf.albedo());
        put(l.normal, k, {bsdf.normal().x, bsdf.normal().y, bsdf.normal().z});
        if (!more) return;
        if (settings_.nee && bsdf.smooth() && !(fault(Fault::bounceDropped) && depth == 1)) direct(l, k, at, bsdf, classes);
        const PickAndPoint uBsdf = numbers(l, 1, k);
        const auto sample = bsdf.sample(min(float(uBsdf.pick), oneMinusEpsilon), uBsdf.u);
        if (!sample) return;
        const Turn next = classes ? turn(*classes, state, bsdf, *sample, l.uClass[k]) : Turn{1, sample->weight, sample->event};
        if (!next.state || black(next.weight)) return;
        alive |= 1u << k;
        l.state[k] = next.state;
        for (std::size_t c = 0; c < 3; ++c) l.throughput[c][k] *= next.weight[c];
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
