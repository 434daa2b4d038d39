// The loop of WidePaths for one instruction set: Path::radiance (integrators/path.cpp) in lanes, step by step.
#pragma once
#include "core/scene/wide_light_sampling.h"
#include "integrators/wide/path_packet.h"
#include "materials/wide_lobes.h"

namespace chiaro::CHIARO_ISA {

class PathFollower {
public:
    PathFollower(const WidePaths& paths, uint32_t maxDepth, SampleLanes& samples, PathStream& stream) noexcept
        : paths_(paths), scene_(paths.scene()), settings_(paths.settings()),
          tables_{paths.surfaces().firsts(), reinterpret_cast<const float*>(paths.surfaces().triangles()),
                  reinterpret_cast<const float*>(paths.surfaces().instances())},
          materials_(reinterpret_cast<const float*>(paths.materials().records())), maxDepth_(maxDepth),
          needs_{paths.lights().byTree(), paths.materials().volumes()},
          oneLight_(paths.lights().finite() == 1 && !paths.lights().environment()), samples_(samples), stream_(stream) {}
    void follow(StartSource& source) noexcept;

private:
    // A vertex of sixteen paths, as far as it is known.
    struct Vertex {
        Mask hit, lanes, alone; // lanes: of the hits those that are shaded here; alone: those that the scalar closure answers for
        WidePoint at;
        WideLobes lobes;
        Int flags, column;
        Rgbw emission;
        FrameT<Float> frame;
        Vec3w ng, wo; // ng: on the side of wo
        Mask outside;
        Rgbw albedo;
    };
    void begin(const StartPacket&) noexcept;
    void group(PathPacket&, Mask, const RayPacket&, const HitPacket&, bool first) noexcept;
    void meet(PathPacket&, const HitPacket&, Vertex&) noexcept;
    void find(PathPacket&, Mask, const HitPacket&, Vertex&) noexcept;
    void face(PathPacket&, Vertex&) noexcept;
    void direct(PathPacket&, const Vertex&, Mask, const WidePick&) noexcept;
    Mask scatter(PathPacket&, const Vertex&, Mask, const WidePick&) noexcept;
    Mask alone(PathPacket&, const Vertex&, const WidePick&, const WidePick&, Rgbw& albedo, Vec3w& normal) noexcept;
    void tell(const PathPacket&, const HitPacket&) noexcept;
    void add(PathPacket&, Mask, const Rgbw&) noexcept;
    static void trace(const PathPacket&, RayPacket&) noexcept;

    const WidePaths& paths_;
    const Scene& scene_;
    const PathSettings& settings_;
    const WideTables tables_;
    const float* const materials_;
    const uint32_t maxDepth_;
    const PathPacket::Needs needs_;
    const bool oneLight_; // nothing to choose
    SampleLanes& samples_;
    PathStream& stream_;
    ShadowQueue shadows_;
    VertexLanes told_;
    uint32_t kept_ = 0;      // of the stream, packed
    uint32_t firstSlot_ = 0; // of the starts at hand
};

// The ray's packet as Embree takes it.
CHIARO_LANE void PathFollower::trace(const PathPacket& p, RayPacket& rays) noexcept {
    p.o.x.store(rays.ox), p.o.y.store(rays.oy), p.o.z.store(rays.oz);
    p.d.x.store(rays.dx), p.d.y.store(rays.dy), p.d.z.store(rays.dz);
    Float(0.f).store(rays.tnear), Float(infinity).store(rays.tfar), p.time.store(rays.time);
}
CHIARO_LANE void PathFollower::add(PathPacket& p, Mask m, const Rgbw& light) noexcept {
    alignas(64) uint32_t slot[laneCount];
    p.slot.store(slot);
    addTo(samples_.found, slot, m, light.c[0], light.c[1], light.c[2]);
}
void PathFollower::tell(const PathPacket& p, const HitPacket& hits) noexcept {
    trace(p, told_.rays);
    told_.hits = hits;
    int k = 0;
    for (const Float& v : {p.from.x, p.from.y, p.from.z}) v.store(told_.fromP[k++]);
    k = 0;
    for (const Float& v : {p.fromNg.x, p.fromNg.y, p.fromNg.z}) v.store(told_.fromNg[k++]);
    for (std::size_t c = 0; c < 3; ++c) p.throughput.c[c].store(told_.throughput[c]);
    p.pdfW.store(told_.pdfW), p.depth.store(told_.depth), p.medium.store(told_.medium);
}

// Points and materials; what the inside of a solid lets through.
void PathFollower::meet(PathPacket& p, const HitPacket& hits, Vertex& v) noexcept {
    const Mask known = widePoint(tables_, hits, v.hit, v.at);
    alignas(64) uint32_t record[laneCount];
    select(known, v.at.material << 5, Int(0u)).store(record);
    v.flags = v.lobes.load(materials_, paths_.materials().columns(), record, known);
    const auto has = [&](uint32_t flag) { return known & ((v.flags & Int(flag)) != Int(0u)); };
    v.alone = andNot(v.hit, known) | has(WideMaterial::scalar);
    v.lanes = andNot(known, v.alone);
    v.lobes.lanes = v.lanes;
    Float column(0.f);
    v.emission = Rgbw(Float(0.f));
    if (any(has(WideMaterial::emits | WideMaterial::lobes)))
        loadFour(materials_ + 16, record, v.emission.c[0], v.emission.c[1], v.emission.c[2], column);
    v.column = floatAsBits(column);
    const Mask absorbed = v.hit & (((p.medium & Int(VertexLanes::absorbs)) != Int(0u)) | v.alone |
                                   ((p.medium == Int(0u)) & has(WideMaterial::absorbs) & (dot(v.at.ng, p.d) > Float(0.f))));
    const Mask textured = v.lanes & has(WideMaterial::textured);
    if (none(absorbed | textured)) return;
    tell(p, hits);
    if (any(absorbed)) {
        paths_.attenuate(told_, absorbed.bits());
        for (std::size_t c = 0; c < 3; ++c) p.throughput.c[c] = Float(told_.throughput[c]);
    }
    if (none(textured)) return;
    paths_.texture(told_, textured.bits());
    for (std::size_t c = 0; c < 3; ++c) v.lobes.baseColor.c[c] = select(textured, Float(told_.baseColor[c]), v.lobes.baseColor.c[c]);
}

// Light that the rays have found: emitters where they hit, the sky where they did not.
void PathFollower::find(PathPacket& p, Mask m, const HitPacket& hits, Vertex& v) noexcept {
    const WideLights& lights = paths_.lights();
    const Mask sky = lights.environment() ? andNot(m, v.hit) : Mask();
    const Mask shines = v.lanes & ((v.flags & Int(WideMaterial::emits)) != Int(0u)) & (v.at.light != Int(WideSurfaces::none));
    const Mask asked = sky | v.alone |
                       (shines & (((v.flags & Int(WideMaterial::askEmission)) != Int(0u)) | (v.at.light == Int(WideSurfaces::askLight)) |
                                  (lights.byTree() ? Mask(0xffffu) : Mask())));
    if (none(shines | asked)) return;
    Rgbw light = v.emission;
    Float lightPdf(0.f);
    Mask found = andNot(shines, asked);
    if (any(found)) {
        const Float cosine = -dot(p.d, v.at.ng);
        const Mask bothSides = (v.flags & Int(WideMaterial::doubleSided)) != Int(0u);
        found = found & ((cosine > Float(0.f)) | (bothSides & (cosine < Float(0.f))));
        const Int record = v.at.light * Int(20u);
        const Float density = gather(lights.records() + 10, record, found), pmf = gather(lights.records() + 11, record, found);
        const Float pdf = pmf * areaToSolidAngle(density, lengthSquared(v.at.p - p.from), cosine);
        lightPdf = select(found, fault(Fault::misOtherMeasure) ? pmf * density : pdf, Float(0.f));
    }
    if (any(asked)) {
        tell(p, hits);
        paths_.found(told_, asked.bits());
        for (std::size_t c = 0; c < 3; ++c) light.c[c] = select(asked, Float(told_.light[c]), light.c[c]);
        lightPdf = select(asked, Float(told_.lightPdfW), lightPdf);
        found = found | asked;
        for (std::size_t c = 0; c < 3; ++c) v.albedo.c[c] = select(sky, clamp01(light.c[c]), v.albedo.c[c]);
    }
    found = found & notBlack(light);
    const Mask delta = p.pdfW < Float(0.f);
    const Mask alone = (p.depth == Int(0u)) | (fault(Fault::deltaWeighted) ? Mask() : delta) | (lightPdf == Float(0.f));
    Float weight = settings_.mis ? powerHeuristic(abs(p.pdfW), lightPdf) : Float(0.f);
    weight = settings_.nee && !fault(Fault::emissionTwice) ? select(alone, Float(1.f), weight) : Float(1.f);
    add(p, found, p.throughput * light * weight);
}

// The closures, seen from where the paths come.
void PathFollower::face(PathPacket& p, Vertex& v) noexcept {
    const Vec3w wo = -p.d;
    v.outside = fault(Fault::backNormalKept) ? Mask(0xffffu) : dot(v.at.ng, wo) >= Float(0.f);
    v.ng = select(v.outside, v.at.ng, -v.at.ng);
    Vec3w n = select(v.outside, v.at.ns, -v.at.ns);
    // A shading normal that wo does not see is turned towards it, as little as needed (Bsdf).
    const Float have = dot(n, wo), need = min(Float(0.01f), dot(v.ng, wo));
    const Mask same = (n.x == v.ng.x) & (n.y == v.ng.y) & (n.z == v.ng.z), hidden = v.lanes & andNot(have < need, same);
    if (any(hidden)) {
        const Vec3w across = n - wo * have;
        const Float l = length(across);
        const Vec3w turned = normalize(across * (sqrt(Float(1.f) - need * need) / l) + wo * need);
        n = select(hidden, select(l > Float(1e-6f), turned, v.ng), n);
    }
    v.frame = FrameT<Float>::about(n);
    v.wo = wo;
    v.lobes.look(v.frame.toLocal(wo), v.outside, v.column);
}

// Next-event estimation: shadow rays to one light each.
void PathFollower::direct(PathPacket& p, const Vertex& v, Mask m, const WidePick& pick) noexcept {
    const WideLightSample s = sampleTowards(paths_.lights(), v.at, p.time, m, pick);
    const Vec3w wi = v.frame.toLocal(s.wi);
    const WideLobeValue value = v.lobes.evaluate(wi);
    const Mask lit = m & s.arrives & (value.pdfW > Float(0.f)) & (dot(s.wi, v.ng) > Float(0.f)) & notBlack(value.f);
    if (none(lit)) return;
    const Float weight = settings_.mis ? select(s.delta, Float(1.f), powerHeuristic(s.pdfW, value.pdfW)) : Float(1.f);
    const Float cosine = fault(Fault::receiverCosineMissing) ? Float(1.f) : abs(wi.z);
    const Rgbw brings = p.throughput * value.f * s.radiance * (cosine * weight / s.pdfW);
    shadows_.append(lit, s.o, s.d, s.tfar, p.time, brings, p.slot);
}

// The next rays; the lanes that have one.
Mask PathFollower::scatter(PathPacket& p, const Vertex& v, Mask m, const WidePick& pick) noexcept {
    // As float(double(bits) 2^-32) rounds, but never to 1.
    const Float uLobe = min(wholeToFloat(pick.pick) * Float(0x1p-32f), Float(oneMinusEpsilon));
    const WideLobeSample s = v.lobes.sample(uLobe, pick.u);
    const Vec3w wi = v.frame.toWorld(s.wi);
    const Float side = dot(wi, v.ng);
    Mask alive = m & s.drawn & select(s.wi.z > Float(0.f), side > Float(0.f), side < Float(0.f));
    // Of a diffuse base alone: the cosine and its density cancel out.
    Rgbw weight = v.lobes.diffuseColor * Float(fault(Fault::diffuseBias) ? 1.01f : 1.f);
    Float pdfW = cosineHemispherePdfW(s.wi.z);
    if (const Mask others = m & v.lobes.others(); any(others)) {
        const WideLobeValue value = v.lobes.evaluate(s.wi);
        weight = select(others, value.f * (abs(s.wi.z) / value.pdfW), weight);
        pdfW = select(others, value.pdfW, pdfW);
    }
    alive = alive & (s.delta | (pdfW > Float(0.f)));
    if (any(s.delta)) weight = select(s.delta, s.weight * (Float(1.f) / s.pmf), weight);
    alive = alive & notBlack(weight);
    p.throughput = select(alive, p.throughput * weight, p.throughput);
    p.pdfW = select(alive, select(s.delta, -s.pmf, pdfW), p.pdfW);
    p.o = select(alive, offset(v.at.p, v.at.ng, v.at.error, wi), p.o);
    p.d = select(alive, wi, p.d);
    p.from = select(alive, v.at.p, p.from);
    p.fromNg = select(alive, v.at.ng, p.fromNg);
    const auto is = [&](uint32_t flag) { return (v.flags & Int(flag)) != Int(0u); };
    const Mask within = is(WideMaterial::volume) & (dot(v.at.ng, wi) < Float(0.f));
    const Int medium = (v.at.material + Int(1u)) | select(is(WideMaterial::absorbs), Int(VertexLanes::absorbs), Int(0u));
    p.medium = select(alive, select(within, medium, Int(0u)), p.medium);
    return alive;
}

// Lanes that the scalar closure answers for.
Mask PathFollower::alone(PathPacket& p, const Vertex& v, const WidePick& uLight, const WidePick& uBsdf, Rgbw& albedo,
                         Vec3w& normal) noexcept {
    const Mask m = v.alone;
    const WidePick* const picks[] = {&uLight, &uBsdf};
    for (int i = 0; i < 2; ++i) {
        picks[i]->pick.store(told_.pick[i]);
        picks[i]->u.x.store(told_.u[i][0]), picks[i]->u.y.store(told_.u[i][1]);
    }
    const Mask alive(paths_.vertex(told_, m.bits(), maxDepth_));
    const auto rgb = [](const float(&values)[3][laneCount]) { return Rgbw(Float(values[0]), Float(values[1]), Float(values[2])); };
    const auto vec = [](const float* x, const float* y, const float* z) { return Vec3w{Float(x), Float(y), Float(z)}; };
    albedo = select(m, rgb(told_.albedo), albedo);
    normal = select(m, vec(told_.normal[0], told_.normal[1], told_.normal[2]), normal);
    const RayPacket &s = told_.shadow, &n = told_.next;
    if (const Mask lit = m & (Float(s.tfar) >= Float(0.f)); any(lit))
        shadows_.append(lit, vec(s.ox, s.oy, s.oz), vec(s.dx, s.dy, s.dz), Float(s.tfar), p.time, p.throughput * rgb(told_.arriving),
                        p.slot);
    p.throughput = select(alive, rgb(told_.throughput), p.throughput);
    p.pdfW = select(alive, Float(told_.pdfW), p.pdfW);
    p.o = select(alive, vec(n.ox, n.oy, n.oz), p.o);
    p.d = select(alive, vec(n.dx, n.dy, n.dz), p.d);
    p.from = select(alive, vec(told_.fromP[0], told_.fromP[1], told_.fromP[2]), p.from);
    p.fromNg = select(alive, vec(told_.fromNg[0], told_.fromNg[1], told_.fromNg[2]), p.fromNg);
    p.medium = select(alive, Int(told_.medium), p.medium);
    return alive;
}

// One vertex of sixteen paths, whose rays have been traced. What goes on is packed into the stream.
[[gnu::flatten]] void PathFollower::group(PathPacket& p, Mask m, const RayPacket&, const HitPacket& hits, bool first) noexcept {
    Vertex v;
    v.albedo = Rgbw(Float(0.f));
    v.hit = m & (Int(hits.geometry) != Int(Hit::none));
    meet(p, hits, v);
    find(p, m, hits, v);
    face(p, v);
    const Mask more = v.hit & (p.depth < Int(maxDepth_));
    Vec3w normal{Float(0.f), Float(0.f), Float(0.f)};
    if (first) {
        v.albedo = select(v.lanes, v.lobes.albedo(), v.albedo);
        normal = select(v.lanes, v.frame.z, normal);
    }
    const WideSampler sampler(p.keyLow, p.keyHigh, p.sample);
    const Int dimension = Int(startDimensions) + p.depth * Int(8u);
    const Mask choices = v.alone | v.lobes.others();
    const WidePick uLight = sampler.get3D(dimension, !oneLight_ || any(v.alone)), uBsdf = sampler.get3D(dimension + Int(3u), any(choices));
    Mask asks = more & v.lanes & v.lobes.smooth();
    if (fault(Fault::bounceDropped)) asks = asks & (p.depth != Int(1u));
    if (settings_.nee && any(asks)) direct(p, v, asks, uLight);
    Mask alive;
    if (const Mask here = more & v.lanes; any(here)) alive = scatter(p, v, here, uBsdf);
    if (any(v.alone)) alive = alive | alone(p, v, uLight, uBsdf, v.albedo, normal);
    if (first) {
        for (std::size_t c = 0; c < 3; ++c) v.albedo.c[c].store(samples_.albedo[c] + firstSlot_);
        normal.x.store(samples_.normal[0] + firstSlot_);
        normal.y.store(samples_.normal[1] + firstSlot_);
        normal.z.store(samples_.normal[2] + firstSlot_);
    }
    if (const Mask risk = alive & (p.depth >= Int(settings_.rouletteDepth)); any(risk)) {
        const Float survive = min(maxComponent(p.throughput), Float(0.95f));
        alive = andNot(alive, andNot(risk, sampler.get1D(dimension + Int(7u)) < survive));
        if (!fault(Fault::rouletteUnweighted)) p.throughput = select(risk, p.throughput * (Float(1.f) / survive), p.throughput);
    }
    p.depth = p.depth + Int(1u);
    p.append(stream_, kept_, alive, needs_);
    kept_ += count(alive);
    while (shadows_.count >= laneCount) shadows_.flush(scene_, samples_);
}

void PathFollower::begin(const StartPacket& start) noexcept {
    PathPacket p;
    p.o = {Float(start.rays.ox), Float(start.rays.oy), Float(start.rays.oz)};
    p.d = {Float(start.rays.dx), Float(start.rays.dy), Float(start.rays.dz)};
    p.from = p.o;
    p.fromNg = p.d;
    p.throughput = Rgbw(Float(1.f));
    p.pdfW = Float(-1.f);
    p.time = Float(start.rays.time);
    alignas(64) uint32_t slots[laneCount];
    for (uint32_t k = 0; k < laneCount; ++k) slots[k] = start.first + k;
    p.slot = Int(slots);
    p.depth = p.medium = Int(0u);
    p.keyLow = Int(start.keyLow), p.keyHigh = Int(start.keyHigh), p.sample = Int(start.sample);
    firstSlot_ = start.first;
    group(p, firstLanes(start.count), start.rays, start.hits, true);
}

void PathFollower::follow(StartSource& source) noexcept {
    const uint32_t length = paths_.length();
    bool open = true;
    PathPacket p;
    RayPacket rays;
    HitPacket hits;
    StartPacket start;
    for (uint32_t under = 0; open || under > 0; under = kept_) {
        kept_ = 0;
        // While starts are left, a packet that is not full waits for them.
        const uint32_t end = open ? under & ~(laneCount - 1) : under;
        for (uint32_t at = 0; at < end; at += laneCount) {
            const uint32_t n = end - at < laneCount ? end - at : laneCount;
            p.load(stream_, at, needs_);
            trace(p, rays);
            scene_.intersect(rays, hits, n, false);
            group(p, firstLanes(n), rays, hits, false);
        }
        if (end < under) {
            p.load(stream_, end, needs_);
            p.append(stream_, kept_, firstLanes(under - end), needs_);
            kept_ += under - end;
        }
        while (open && kept_ + laneCount <= length) {
            open = source.next(start);
            if (open) begin(start);
        }
    }
    while (shadows_.count > 0) shadows_.flush(scene_, samples_);
}

} // namespace chiaro::CHIARO_ISA
