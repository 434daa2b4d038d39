#include "integrators/whitted_tree.h"
#include "core/render/prepass.h"
#include "core/scene/ray_cone.h"
#include "integrators/transport.h"
#include <algorithm>
#include <new>

namespace chiaro {
namespace {

constexpr uint32_t sampled = ~0u; // in the place of a lamp: one of all lights, drawn by lot

// A surface that says only what a segment that leaves it runs through.
SurfacePoint leaving(const Vec3& ng, uint32_t material) noexcept {
    SurfacePoint s;
    s.ng = ng;
    s.material = material;
    return s;
}

} // namespace

struct WhittedTrees::Lane {
    uint32_t tree = 0, size = 0;
    alignas(Node) std::byte room[mostPending * sizeof(Node)];
    Node* nodes() noexcept { return reinterpret_cast<Node*>(room); }
    bool push(const Node& n) noexcept {
        if (size == mostPending) return false;
        ::new (nodes() + size++) Node(n);
        return true;
    }
    const Node& top() noexcept { return nodes()[size - 1]; }
    void pop() noexcept { --size; }
};

WhittedTrees::WhittedTrees(const WhittedScene& shared, const Job& job, std::span<PathStart> starts, std::span<Outputs> outputs) noexcept
    : shared_(shared), settings_(*shared.settings), job_(job), starts_(starts), outputs_(outputs),
      plain_(settings_, shared.lamps, shared.plain, job, outputs) {
    std::fill_n(nodes_, starts.size(), 1u);
}

uint32_t WhittedTrees::run() noexcept {
    // Camera hits, whose branches wait in one list, tree by tree.
    alignas(Node) std::byte room[mostTrees * TreeBranches::most * sizeof(Node)];
    Node* const waiting = reinterpret_cast<Node*>(room);
    uint32_t first[mostTrees + 1], count = 0;
    Visit visits[width];
    for (std::size_t begin = 0; begin < starts_.size(); begin += width) {
        const std::size_t n = std::min(width, starts_.size() - begin);
        std::size_t others = 0; // those that are no plain surface
        for (std::size_t k = begin; k < begin + n; ++k) {
            const PathStart& start = starts_[k];
            if (takePlain(start.first, start.ray, uint32_t(k), 0, job_.classes.eye(), Spectrum(1), false)) continue;
            Visit& v = visits[others++];
            v.node = {};
            v.node.ray = start.ray;
            v.node.footprint = cone(job_.scene, start.footprint);
            v.node.lambda = start.lambda;
            v.node.state = job_.classes.eye();
            v.hit = start.first;
            v.tree = uint32_t(k);
        }
        expand({visits, others});
        for (std::size_t k = begin, v = 0; k < begin + n; ++k) {
            first[k] = count;
            if (v == others || visits[v].tree != k) continue;
            for (int c = visits[v].children - 1; c >= 0; --c) ::new (waiting + count++) Node(visits[v].child[c]);
            ++v;
        }
        if (plain_.full()) plain_.answer();
    }
    plain_.answer();
    first[starts_.size()] = count;
    if (count == 0) return cut_;

    Lane lanes[width];
    uint32_t next = 0;
    for (;;) {
        Ray rays[width];
        Hit hits[width];
        Lane* of[width];
        std::size_t n = 0;
        for (Lane& lane : lanes) {
            for (; lane.size == 0 && next < starts_.size(); ++next) {
                lane.tree = next;
                for (uint32_t i = first[next]; i < first[next + 1]; ++i) lane.push(waiting[i]);
            }
            if (lane.size == 0) continue;
            rays[n] = lane.top().ray;
            of[n++] = &lane;
        }
        if (n == 0) return cut_;
        job_.scene.intersect({rays, n}, {hits, n}, false);
        std::size_t others = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const Node& node = of[k]->top();
            outputs_[of[k]->tree].traced(1, node.depth);
            if (!takePlain(hits[k], node.ray, of[k]->tree, node.depth, node.state, node.throughput, node.glossy)) {
                Visit& v = visits[others];
                v.node = node;
                v.hit = hits[k];
                v.tree = of[k]->tree;
                of[others++] = of[k];
            }
            of[k]->pop();
        }
        plain_.answer();
        expand({visits, others});
        for (std::size_t k = 0; k < others; ++k)
            for (int c = visits[k].children - 1; c >= 0; --c) cut_ += of[k]->push(visits[k].child[c]) ? 0 : 1;
    }
}

// What is too simple for a visit: nothing was hit, or a plain surface. Somebody who wants to see the path gets the general way.
bool WhittedTrees::takePlain(const Hit& hit, const Ray& ray, uint32_t tree, uint32_t depth, PathState state, const Spectrum& throughput,
                             bool glossy) noexcept {
    Outputs& out = outputs_[tree];
    if (out.log) return false;
    if (hit) return plain_.take(hit, ray, tree, depth, state, throughput);
    sky(ray, state, throughput, depth, glossy, out);
    return true;
}

void WhittedTrees::expand(std::span<Visit> visits) noexcept {
    if (visits.empty()) return;
    for (Visit& v : visits) arrive(v);
    lamps(visits);
}

void WhittedTrees::arrive(Visit& v) noexcept {
    Outputs& out = outputs_[v.tree];
    v.lit = false;
    v.children = 0;
    if (out.log) [[unlikely]] {
        out.log->here = v.node.parent;
        if (v.node.depth > 0) out.log->scatter(v.node.event, v.node.weight, 1, !v.node.glossy);
    }
    const bool first = v.node.depth == 0, goesOn = job_.classes.continues(v.node.state);
    if (!found(v, out)) return;
    if (!goesOn && out.log) out.log->end(v.node.depth >= job_.classes.maxDepth() ? "depth limit" : "no longer path is wanted");
    if (!goesOn && !first) return;
    v.node.footprint = v.node.footprint.at(v.hit.t);
    const WhittedSurface& surface =
        *::new (v.surface) WhittedSurface(settings_, job_.scene, v.at, -v.node.ray.d, v.node.footprint, v.node.lambda);
    const Bsdf& bsdf = surface.bsdf();
    if (first) {
        out.aov(Aov::albedo, bsdf.albedo());
        out.aov(Aov::normal, Spectrum(bsdf.normal().x, bsdf.normal().y, bsdf.normal().z));
    }
    if (!goesOn) return;
    if (out.log) (*out.log)[out.log->here].normal = bsdf.normal();
    if (job_.prepass)
        job_.prepass->addIndirect(job_.classes, v.hit, v.at, bsdf, v.node.state, v.node.throughput, out);
    else if (!black(settings_.ambient))
        addFound(out, otherLayer, v.node.throughput * settings_.ambient * surface.diffuseAlbedo());
    v.lit = bsdf.smooth();
    branch(v, out);
}

void WhittedTrees::sky(const Ray& ray, PathState state, const Spectrum& throughput, uint32_t depth, bool glossy,
                       Outputs& out) const noexcept {
    const LightHit sky = job_.scene.lights().miss(ray, nullptr);
    // The lobe that a glossy ray stands for has had its lights: the sky is one of them where all lights are sampled.
    if (sky && !(glossy && settings_.area == WhittedSettings::Area::sample))
        addFound(out, job_.classes.reached(state, sky.kind), throughput * sky.radiance);
    if (depth == 0) out.aov(Aov::albedo, {clamp01(sky.radiance[0]), clamp01(sky.radiance[1]), clamp01(sky.radiance[2])});
}

// What the ray has come to: the sky, or a surface that may shine. False: nothing follows.
bool WhittedTrees::found(Visit& v, Outputs& out) noexcept {
    Node& node = v.node;
    const Scene& scene = job_.scene;
    if (!v.hit) {
        if (out.log) logSky(*out.log, scene, node.ray, node.throughput);
        sky(node.ray, node.state, node.throughput, node.depth, node.glossy, out);
        return false;
    }
    ::new (&v.at) SurfacePoint(scene.point(v.hit, node.ray));
    if (shared_.absorbs) {
        const SurfacePoint from = leaving(node.ng, node.material);
        node.throughput *= segmentTransmittance(scene, node.material == PathLog::none ? nullptr : &from, node.ray.d, &v.at, v.hit.t);
    }
    if (settings_.rayFalloff) node.throughput *= min(1.f, 1 / v.hit.t);
    if (out.log) logSurface(*out.log, v.at, v.at.ns, v.hit.t, node.throughput);
    if (v.at.light != Lights::none && !node.glossy)
        if (const LightHit light = scene.lights().hit(v.at, -node.ray.d, nullptr))
            addFound(out, job_.classes.reached(node.state, light.kind), node.throughput * light.radiance);
    return true;
}

void WhittedTrees::branch(Visit& v, Outputs& out) noexcept {
    const Node& node = v.node;
    for (const TreeBranch& b : v.closure().branches(settings_, job_.scene, v.at, -node.ray.d, node.footprint)) {
        const PathState state = job_.classes.eye(node.state, b.event);
        if (!state) continue;
        const Spectrum throughput = node.throughput * b.weight;
        if (maxComponent(throughput) < settings_.minWeight) {
            if (out.log) out.log->end("contribution too small");
            continue;
        }
        if (nodes_[v.tree] >= settings_.maxNodes) {
            ++cut_;
            if (out.log) out.log->end("tree too large");
            continue;
        }
        ++nodes_[v.tree];
        v.child[v.children++] = {.ray = v.at.towards(b.wi),
                                 .footprint = scattered(job_.scene, v.at, node.footprint, -node.ray.d, b.wi, true, 1),
                                 .throughput = throughput,
                                 .weight = b.weight,
                                 .ng = v.at.ng,
                                 .material = v.at.material,
                                 .parent = out.log ? out.log->here : PathLog::none,
                                 .depth = node.depth + 1,
                                 .lambda = node.lambda,
                                 .state = state,
                                 .event = b.event,
                                 .glossy = b.glossy};
    }
}

void WhittedTrees::lamps(std::span<Visit> visits) noexcept {
    std::size_t n = 0;
    if (settings_.area == WhittedSettings::Area::sample) {
        for (Visit& v : visits) {
            if (!v.lit) continue;
            const PickAndPoint u = starts_[v.tree].sampler.get3D();
            const auto light = job_.scene.lights().sampleTowards(v.at, u.pick, u.u);
            if (light && light->pdfW > 0 && ask(v, *light, pending_[n])) ++n;
        }
        return settle({pending_, n}, sampled);
    }
    for (uint32_t lamp = 0; lamp < shared_.lamps.count(); ++lamp) {
        n = 0;
        for (Visit& v : visits) {
            if (!v.lit) continue;
            const auto light = shared_.lamps.towards(lamp, v.at);
            if (light && ask(v, *light, pending_[n])) ++n;
        }
        settle({pending_, n}, lamp);
    }
}

// What the surface would answer, if anybody wants it: the shadow ray is worth casting.
bool WhittedTrees::ask(Visit& v, const LightSample& light, Pending& p) const noexcept {
    const PathClasses& classes = job_.classes;
    const WhittedSurface& surface = v.closure();
    p.value = surface.evaluate(light.wi, terms(classes, v.node.state));
    if (p.value.n == 0 || black(p.value.f())) return false;
    bool wanted = false;
    for (int i = 0; i < p.value.n; ++i) {
        p.state[i] = classes.eye(v.node.state, p.value.terms[i].event);
        wanted = wanted || classes.reached(p.state[i], light.kind) != 0 || (shared_.filters && p.state[i]);
    }
    if (!wanted) return false;
    p.visit = &v;
    p.light = light;
    p.arriving = v.node.throughput * light.radiance * (absDot(surface.bsdf().normal(), light.wi) / light.pdfW);
    return true;
}

void WhittedTrees::settle(std::span<Pending> pending, uint32_t lamp) noexcept {
    Ray rays[width];
    uint8_t blocked[width] = {};
    if (pending.empty()) return;
    for (std::size_t k = 0; k < pending.size(); ++k) rays[k] = pending[k].light.shadow;
    if (settings_.shadows != WhittedSettings::Shadows::none) {
        if (lamp == sampled)
            job_.scene.occluded({rays, pending.size()}, {blocked, pending.size()});
        else
            shared_.lamps.occluded(lamp, {rays, pending.size()}, {blocked, pending.size()});
        if (shared_.blends) std::fill_n(blocked, pending.size(), uint8_t(1)); // those that pass do so by lot: to be walked
    }
    for (std::size_t k = 0; k < pending.size(); ++k) {
        Pending& p = pending[k];
        Outputs& out = outputs_[p.visit->tree];
        out.traced(settings_.shadows == WhittedSettings::Shadows::none ? 0 : 1, p.visit->node.depth + 1);
        Spectrum shadow(0), added(0);
        if (blocked[k])
            shadow = shared_.filters ? passed(p, lamp, out) : shadow;
        else
            shadow = shared_.absorbs ? segmentTransmittance(job_.scene, &p.visit->at, rays[k].d, nullptr, rays[k].tfar) : Spectrum(1);
        if (black(shadow) && !out.log) continue;
        for (int i = 0; i < p.value.n; ++i) {
            const Layer layer = black(shadow) ? Layer(0) : job_.classes.reached(p.state[i], p.light.kind);
            const Spectrum contribution = p.value.terms[i].f * p.arriving * shadow;
            out.add(layer, contribution);
            if (layer != 0) added += contribution;
        }
        if (out.log) [[unlikely]]
            log(p, shadow, added, *out.log);
    }
}

// What the surfaces on the straight way to the lamp leave of its light. Each transparent one is one more event of the path: T. One that
// only covers a share of itself (alpha blend) takes that share and is no event.
Spectrum WhittedTrees::passed(Pending& p, uint32_t lamp, Outputs& out) const noexcept {
    constexpr int mostSurfaces = 64;
    const Scene& scene = job_.scene;
    Ray ray = p.light.shadow;
    SurfacePoint from = p.visit->at; // the last event
    float way = 0;                   // since
    Spectrum factor(1);
    for (int i = 0; i < mostSurfaces; ++i) {
        const Hit hit = scene.firstSurface(ray);
        out.traced(1, 0);
        if (!hit) return factor * segmentTransmittance(scene, &from, ray.d, nullptr, way + ray.tfar);
        const SurfacePoint at = scene.point(hit, ray);
        const float left = ray.tfar - hit.t;
        way += hit.t;
        if (lamp == sampled || !shared_.lamps.own(lamp, hit)) {
            const Passage passage = shadowPassage(scene, at);
            const float opacity = scene.opacity(at);
            factor *= passage.factor * opacity + Spectrum(1 - opacity);
            if (black(factor)) return factor;
            if (!black(passage.factor)) {
                factor *= segmentTransmittance(scene, &from, ray.d, &at, way);
                from = at;
                way = 0;
                bool wanted = false;
                for (int k = 0; k < p.value.n; ++k) {
                    p.state[k] = job_.classes.eye(p.state[k], passage.event);
                    wanted = wanted || p.state[k];
                }
                if (!wanted) return Spectrum(0);
            }
        }
        ray = at.towards(ray.d);
        ray.tfar = max(left, 0.f);
    }
    return Spectrum(0);
}

void WhittedTrees::log(const Pending& p, const Spectrum& shadow, const Spectrum& added, PathLog& log) const {
    const bool far = !std::isfinite(p.light.shadow.tfar), blocked = black(shadow);
    const BsdfTerm& term =
        p.value.n > 1 && luminance(p.value.terms[1].f) > luminance(p.value.terms[0].f) ? p.value.terms[1] : p.value.terms[0];
    const float t = far ? job_.scene.radius() : p.light.shadow.tfar;
    const Spectrum weight = p.value.f() * shadow * (absDot(p.visit->closure().bsdf().normal(), p.light.wi) / p.light.pdfW);
    PathLog::Vertex v{.parent = log.here,
                      .kind = PathLog::Kind::light,
                      .p = p.light.shadow.o + p.light.shadow.d * t,
                      .normal = {},
                      .t = far ? infinity : t,
                      .event = term.event,
                      .weight = weight,
                      .pdfW = p.light.pdfW,
                      .delta = p.light.delta,
                      .blocked = blocked,
                      .light = p.light.light,
                      .throughput = p.visit->node.throughput * weight,
                      .contribution = added};
    if (!blocked && !(shadow == Spectrum(1))) v.note = "filtered by transparent surfaces";
    if (blocked)
        if (const Hit hit = job_.scene.intersect(p.light.shadow)) v.material = job_.scene.attributes(hit).material;
    log.add(v);
}

} // namespace chiaro
