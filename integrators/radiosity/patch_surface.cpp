#include "integrators/radiosity/patch_surface.h"
#include "core/render/error.h"
#include "materials/bsdf.h"
#include "materials/surface_parameters.h"
#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <set>

namespace chiaro::radiosity {
namespace {

// Gauss-Legendre, 8 points on [0, 1] (Abramowitz and Stegun 1964, table 25.4).
constexpr double node8[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr double weight8[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

const TextureSlot* const* texturesOf(const MaterialDesc& m, const TextureSlot* (&slots)[6]) noexcept {
    slots[0] = &m.baseColorTexture, slots[1] = &m.metallicRoughnessTexture, slots[2] = &m.emissionTexture;
    slots[3] = &m.specularTexture, slots[4] = &m.specularColorTexture, slots[5] = &m.transmissionTexture;
    return slots;
}

} // namespace

bool SurfaceMeans::plain(std::span<const uint32_t> triangles) const noexcept {
    const TextureSlot* slots[6];
    texturesOf(scene_.material(part_.material), slots);
    for (const TextureSlot* s : slots)
        if (s->texture >= 0) return false;
    const Vec4 first = scene_.attributes({part_.geometry, triangles[0], part_.instance, 0, 0, 0}).color;
    for (const uint32_t t : triangles)
        for (const Point2 at : {Point2{0, 0}, Point2{1, 0}, Point2{0, 1}})
            if (scene_.attributes({part_.geometry, t, part_.instance, at.x, at.y, 0}).color != first) return false;
    return true;
}

uint32_t SurfaceMeans::pointsFor(uint32_t triangle, float share) const noexcept {
    const TextureSlot* slots[6];
    texturesOf(scene_.material(part_.material), slots);
    Point2 uv[3][uvSets];
    for (int k = 0; k < 3; ++k) {
        const SurfacePoint s = scene_.attributes({part_.geometry, triangle, part_.instance, k == 1 ? 1.f : 0.f, k == 2 ? 1.f : 0.f, 0});
        std::copy(std::begin(s.uv), std::end(s.uv), uv[k]);
    }
    float texels = 0;
    for (const TextureSlot* s : slots) {
        if (s->texture < 0) continue;
        Point2 p[3];
        for (int k = 0; k < 3; ++k) p[k] = apply(s->transform, uv[k][s->uvSet]);
        const float area = std::fabs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) / 2;
        texels = max(texels, area * float(scene_.textures().width(s->texture)) * float(scene_.textures().height(s->texture)));
    }
    return std::bit_ceil(uint32_t(std::clamp(texels * share, 16.f, 256.f)));
}

Spectrum SurfaceMeans::diffuse(const SurfacePoint& at) noexcept {
    BsdfParameters p = surfaceParameters(scene_, at);
    const Spectrum base = p.baseColor;
    if (const Coat c{p.metallic, p.roughness, p.specular, p.transmission, p.specularColor};
        !(c == coat_) || hasFurtherLobes(scene_.material(at.material))) {
        coat_ = c;
        share_ = Spectrum(0);
        p.baseColor = Spectrum(1);
        const Frame frame = Frame::about(at.ng);
        for (int k = 0; k < 8; ++k) {
            const double half = k < 4 ? node8[k] : -node8[k - 4], mu = (1 + half) / 2, weight = weight8[k % 4] / 2;
            const Vec3 wo = frame.toWorld({float(std::sqrt(1 - mu * mu)), 0, float(mu)});
            share_ += Bsdf(p, at.ng, at.ng, wo).diffuseAlbedo() * float(2 * mu * weight);
        }
    }
    return base * share_;
}

Surface SurfaceMeans::mean(std::span<const Where> points) noexcept {
    Rgb<double> reflectance(0), front(0), back(0);
    double matter = 0;
    const auto add = [](Rgb<double>& to, const Spectrum& s, double w) { to += Rgb<double>(s[0], s[1], s[2]) * w; };
    Ray ray;
    ray.time = time_;
    for (const Where& w : points) {
        const SurfacePoint at = scene_.point({part_.geometry, w.triangle, part_.instance, w.u, w.v, 0}, ray);
        const double opacity = double(scene_.opacity(at));
        if (!(opacity > 0)) continue;
        matter += opacity;
        add(reflectance, diffuse(at), opacity);
        add(front, scene_.lights().hit(at, at.ng, nullptr).radiance, opacity);
        add(back, scene_.lights().hit(at, -at.ng, nullptr).radiance, opacity);
    }
    Surface s;
    const double n = double(points.size());
    s.coverage = float(std::max(matter, 0.5) / n); // what no point met is not known to be nothing
    if (!(matter > 0)) return s;
    const auto single = [&](const Rgb<double>& x) { return Spectrum(float(x[0] / matter), float(x[1] / matter), float(x[2] / matter)); };
    s.front = {single(reflectance), single(front)};
    s.back = {single(reflectance), single(back)};
    return s;
}

bool mayReflect(const MaterialDesc& m) noexcept {
    if (m.unlit || black(m.baseColor)) return false;
    if (!m.specularGlossiness && m.metallic >= 1 && m.metallicRoughnessTexture.texture < 0) return false;
    return !(m.transmission >= 1 && m.transmissionTexture.texture < 0);
}

void tellMaterials(const Scene& scene, Diagnostics& notes) {
    std::set<uint32_t> used;
    for (const DrawnPart& part : scene.parts()) used.insert(part.material);
    struct Group {
        std::string names;
        std::size_t count = 0;
        void add(const MaterialDesc& m) {
            if (++count <= 4) names += fmt::format("{}\"{}\"", count > 1 ? ", " : "", m.name);
        }
        std::string text() const { return fmt::format("{} ({}{})", count, names, count > 4 ? ", ..." : ""); }
    } blockers, mixed, coated, cut, leaves;
    for (const uint32_t id : used) {
        const MaterialDesc& m = scene.material(id);
        if (m.alphaMode != AlphaMode::opaque) cut.add(m);
        if (m.unlit) continue;
        if (m.diffuseTransmission > 0) leaves.add(m);
        const bool beside = m.metallic > 0 || m.transmission > 0;
        if (!mayReflect(m) && (beside || m.specular > 0))
            blockers.add(m);
        else if (beside)
            mixed.add(m);
        else if (m.specular > 0 && m.ior != 1)
            coated.add(m);
    }
    if (blockers.count)
        notes.warn(fmt::format("radiosity carries diffuse light only: of the materials, {} block light, pass none on and are black to look "
                               "at; -i whitted --prepass radiosity shows them",
                               blockers.text()));
    if (mixed.count)
        notes.warn(
            fmt::format("radiosity carries diffuse light only: of the materials, {} take part by their diffuse share", mixed.text()));
    if (leaves.count)
        notes.warn(fmt::format("radiosity carries reflected light only: what passes through {} is missing behind them", leaves.text()));
    if (coated.count)
        notes.tell("diffuse", fmt::format("materials with a glossy coat take part by the diffuse base under it: {}", coated.text()));
    if (cut.count) notes.tell("cut-out", fmt::format("patches count by the share of them that alpha leaves: {}", cut.text()));
}

} // namespace chiaro::radiosity
