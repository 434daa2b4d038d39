#include "integrators/radiosity/patch_sides.h"
#include "core/math/warp.h"
#include "integrators/radiosity/patch_surface.h"
#include <algorithm>

namespace chiaro::radiosity {
namespace {

constexpr uint64_t mostRays = 4'000'000;
constexpr uint32_t walks = 128, steps = 24;                          // of light, from a back
constexpr float touching = 5e-3f;                                    // of the extent of a surface
constexpr uint32_t leastRays = 16, usualRays = 512, raysOfFacet = 1; // of one side of a surface

struct Component {
    std::vector<uint32_t> facets;
    std::vector<double> area; // running sum
    bool reflects = false;
};

class Flood {
public:
    Flood(const Work& work, const PatchMesh& mesh) : work_(work), mesh_(mesh) { connect(); }
    std::vector<uint8_t> run() {
        const std::size_t sides = components_.size() * 2;
        look_.resize(sides);
        const uint64_t each = std::max<uint64_t>(mostRays / std::max<std::size_t>(sides, 1), leastRays);
        work_.run.chunks(
            sides,
            [&](uint64_t side) {
                const uint64_t wanted = usualRays + raysOfFacet * components_[side / 2].facets.size();
                look(uint32_t(side), uint32_t(std::min(each, wanted)));
            },
            &work_.stop);
        return spread();
    }

private:
    struct Look {
        std::vector<uint32_t> seen; // sides
        bool lit = false;
    };
    void connect();
    void look(uint32_t side, uint32_t rays);
    std::vector<uint8_t> spread() const;
    bool lightArrives(uint32_t side) const;
    bool walk(uint32_t side, Sampler, bool& near) const;
    bool shines(uint32_t side) const;
    SurfacePoint start(uint32_t side, Sampler&) const;
    uint32_t sideOf(const Hit& hit, const Vec3& direction) const;

    const Work& work_;
    const PatchMesh& mesh_;
    std::vector<Component> components_;
    std::vector<uint32_t> componentOf_; // facets
    std::vector<Look> look_;
};

void Flood::connect() {
    Sets sets(mesh_.facets.size());
    std::vector<uint32_t> last(mesh_.edges.size(), ~0u); // facet on each edge; edges join facets of one part
    for (uint32_t f = 0; f < mesh_.facets.size(); ++f)
        for (uint32_t k = 0; k < mesh_.facets[f].corners; ++k) {
            uint32_t& other = last[mesh_.facets[f].edge[k]];
            if (other != ~0u && mesh_.facets[other].part == mesh_.facets[f].part) sets.join(f, other);
            other = f;
        }
    componentOf_.assign(mesh_.facets.size(), 0);
    for (uint32_t f = 0; f < mesh_.facets.size(); ++f) {
        const uint32_t root = sets.find(f);
        if (root == f) {
            componentOf_[f] = uint32_t(components_.size());
            components_.emplace_back().reflects = mayReflect(work_.scene.material(work_.scene.parts()[mesh_.facets[f].part].material));
        }
        Component& c = components_[componentOf_[f] = componentOf_[root]];
        const Facet& facet = mesh_.facets[f];
        const Vec3 &a = mesh_.points[facet.point[0]], &b = mesh_.points[facet.point[1]], &d = mesh_.points[facet.point[2]];
        c.facets.push_back(f);
        c.area.push_back((c.area.empty() ? 0 : c.area.back()) + double(length(cross(b - a, d - a))));
    }
}

SurfacePoint Flood::start(uint32_t side, Sampler& sampler) const {
    const Component& c = components_[side / 2];
    const auto at = std::lower_bound(c.area.begin(), c.area.end(), sampler.getPick() * c.area.back());
    const Facet& f = mesh_.facets[c.facets[std::size_t(std::min(at, c.area.end() - 1) - c.area.begin())]];
    const Point2 u = uniformTriangle(sampler.get2D());
    const uint32_t half = f.triangle[1] != ~0u && sampler.get1D() < 0.5f ? 1 : 0;
    const DrawnPart& part = work_.scene.parts()[f.part];
    Ray ray;
    ray.time = work_.shutter.open;
    return work_.scene.point({part.geometry, f.triangle[half], part.instance, u.x, u.y, 0}, ray);
}

uint32_t Flood::sideOf(const Hit& hit, const Vec3& direction) const {
    // Parts in the order of Scene::parts(): all of one instance follow each other.
    const auto parts = work_.scene.parts();
    const auto before = [](const DrawnPart& p, const Hit& h) {
        return p.instance + 1 != h.instance + 1 ? p.instance + 1 < h.instance + 1 : p.geometry < h.geometry; // none + 1 = 0: first
    };
    const auto part = std::lower_bound(parts.begin(), parts.end(), hit, before);
    const uint32_t facet = mesh_.facetOf[mesh_.first[std::size_t(part - parts.begin())] + hit.triangle];
    if (facet == ~0u) return ~0u;
    return componentOf_[facet / 2] * 2 + (dot(direction, mesh_.facets[facet / 2].normal) < 0 ? 0 : 1);
}

void Flood::look(uint32_t side, uint32_t rays) {
    constexpr uint32_t width = 16;
    Look& l = look_[side];
    std::vector<Ray> batch(width);
    std::array<Hit, width> hits;
    for (uint32_t first = 0; first < rays; first += width) {
        const uint32_t n = std::min(width, rays - first);
        for (uint32_t k = 0; k < n; ++k) {
            // The same numbers under every seed: the patches of a scene are its own.
            Sampler sampler(0, SamplerKind::sobol, Stream::prepass, hashCombine(0x51de5, side), first + k);
            const SurfacePoint p = start(side, sampler);
            const Frame frame = Frame::about(side % 2 ? -p.ng : p.ng);
            batch[k] = p.towards(frame.toWorld(cosineHemisphere(sampler.get2D())));
            const double pick = sampler.getPick();
            if (l.lit) continue;
            const auto light = work_.scene.lights().sampleTowards(p, pick, sampler.get2D());
            l.lit = light && !black(light->radiance) && dot(light->wi, frame.z) > 0 && !work_.scene.occluded(light->shadow);
        }
        work_.scene.intersect(std::span<const Ray>(batch.data(), n), {hits.data(), n}, false);
        for (uint32_t k = 0; k < n; ++k) {
            if (!hits[k] && !l.lit) l.lit = bool(work_.scene.lights().miss(batch[k], nullptr));
            const uint32_t seen = hits[k] ? sideOf(hits[k], batch[k].d) : ~0u;
            if (seen != ~0u) l.seen.push_back(seen);
        }
        std::sort(l.seen.begin(), l.seen.end());
        l.seen.erase(std::unique(l.seen.begin(), l.seen.end()), l.seen.end());
    }
}

bool Flood::shines(uint32_t side) const {
    const Facet& f = mesh_.facets[components_[side / 2].facets[0]];
    const DrawnPart& part = work_.scene.parts()[f.part];
    const MaterialDesc& m = work_.scene.material(part.material);
    return m.unlit || (!black(m.emission) && (side % 2 == 0 || m.doubleSided));
}

// Does a walk of diffuse light that goes on for ever come to a light? near: it began against another surface.
bool Flood::walk(uint32_t side, Sampler sampler, bool& near) const {
    const Scene& scene = work_.scene;
    SurfacePoint p = start(side, sampler);
    Vec3 n = side % 2 ? -p.ng : p.ng;
    for (uint32_t step = 0; step < steps; ++step) {
        const double pick = sampler.getPick();
        const auto light = scene.lights().sampleTowards(p, pick, sampler.get2D());
        const bool lit = light && !black(light->radiance) && dot(light->wi, n) > 0 && !scene.occluded(light->shadow);
        const Ray ray = p.towards(Frame::about(n).toWorld(cosineHemisphere(sampler.get2D())));
        const Hit hit = scene.intersect(ray);
        if (step == 0) near = hit && hit.t < touching * std::sqrt(float(components_[side / 2].area.back()));
        if (lit) return true;
        if (!hit) return bool(scene.lights().miss(ray, nullptr));
        p = scene.point(hit, ray);
        if (scene.lights().hit(p, -ray.d, nullptr)) return true;
        const uint32_t met = sideOf(hit, ray.d);
        if (met == ~0u || !components_[met / 2].reflects) return false;
        n = met % 2 ? -p.ng : p.ng;
    }
    return false;
}

bool Flood::lightArrives(uint32_t side) const {
    uint32_t arrived = 0, near = 0;
    for (uint32_t w = 0; w < walks; ++w) {
        bool close = false;
        arrived += walk(side, Sampler(0, SamplerKind::sobol, Stream::prepass, hashCombine(0x3a1c5, side), w), close);
        near += close;
        if (arrived > 0 && near * 10 < (w + 1) * 8 && w >= 15) return true;
    }
    return arrived > 0 && near * 10 < walks * 9;
}

std::vector<uint8_t> Flood::spread() const {
    const std::size_t sides = look_.size();
    std::vector<std::vector<uint32_t>> seenBy(sides);
    for (uint32_t s = 0; s < sides; ++s)
        for (const uint32_t other : look_[s].seen) {
            seenBy[other].push_back(s);
            seenBy[s].push_back(other);
        }
    std::vector<uint8_t> reached(sides, 0), passed(sides, 0);
    std::vector<uint32_t> open;
    for (uint32_t s = 0; s < sides; ++s) {
        reached[s] = look_[s].lit;
        passed[s] = shines(s) || (reached[s] && components_[s / 2].reflects);
        if (passed[s]) open.push_back(s);
    }
    while (!open.empty()) {
        const uint32_t from = open.back();
        open.pop_back();
        for (const uint32_t to : seenBy[from]) {
            reached[to] = 1;
            if (passed[to] || !components_[to / 2].reflects) continue;
            passed[to] = 1;
            open.push_back(to);
        }
    }
    const bool dark = work_.scene.lights().count() == 0;
    if (!dark)
        work_.run.chunks(
            components_.size(),
            [&](uint64_t c) {
                const uint32_t back = uint32_t(c) * 2 + 1;
                if (reached[back] && !shines(back)) reached[back] = lightArrives(back);
            },
            &work_.stop);
    std::vector<uint8_t> backs(mesh_.facets.size());
    for (uint32_t f = 0; f < mesh_.facets.size(); ++f) {
        const uint32_t side = componentOf_[f] * 2 + 1;
        const DrawnPart& part = work_.scene.parts()[mesh_.facets[f].part];
        backs[f] = dark ? work_.scene.material(part.material).doubleSided && !seenBy[side].empty() : reached[side] || shines(side);
    }
    return backs;
}

} // namespace

std::vector<uint8_t> reachedBacks(const Work& work, const PatchMesh& mesh) { return Flood(work, mesh).run(); }

} // namespace chiaro::radiosity
