#include "integrators/photon_stream.h"
#include "integrators/emission_guide.h"
#include <cstring>

namespace chiaro {
namespace {

constexpr uint32_t directionAt = 2; // of a scattering's dimensions, the two before are the visitor's

// emitters: Lights, or whoever answers as they do.
template <class Emitters> std::optional<LightEmission> emit(const Emitters& emitters, const PhotonRequest& request, Departure d) noexcept {
    const float factor = request.guide ? request.guide->aim(d) : 1.f;
    std::optional<LightEmission> e = emitters.emit(d.from, d.towards, d.time);
    if (e) e->flux *= factor;
    return e;
}

} // namespace

Sampler photonSampler(const Work& work, const PhotonRequest& request, uint64_t number) noexcept {
    return {work.seed, work.sampler, Stream::light, uint64_t(request.map) << 32 | number >> 32, uint32_t(number)};
}

PhotonStart startPhoton(const Work& work, const PhotonRequest& request, uint64_t number) noexcept {
    PhotonStart s{photonSampler(work, request, number), {}, {}};
    s.departure = departure(work, s.sampler, request.time);
    s.emission = emit(work.scene.lights(), request, s.departure);
    return s;
}

PhotonStream::PhotonStream(const Work& work, const PhotonRequest& request, const PlainScene& plain)
    : work_(work), request_(request), plain_(plain), rules_{request.kinds}, lanes_{}, hits_{} {}

void PhotonStream::walk(uint64_t first, uint64_t count, PhotonHarvest& to, std::span<uint32_t> counts) {
    first_ = first;
    stored_ = 0;
    ledger_ = {};
    places_.assign(count + 1, 0);
    depart(first, count, to);
    for (uint32_t depth = 0; lanes_.count > 0; ++depth) bounce(depth, to);
    for (std::size_t k = 0; k < laneWidth; ++k) {
        to.fate.absorbed += ledger_.absorbed[k];
        to.fate.ended += ledger_.ended[k];
    }
    sortInto(to, counts);
}

Departure PhotonStream::departureOf(std::size_t k) const noexcept {
    const auto numbers = [k](const StartLanes::Numbers& n) { return PickAndPoint{double(n.pick[k]) * 0x1p-32, {n.x[k], n.y[k]}}; };
    const Interval& s = work_.shutter;
    return {numbers(starts_.from), numbers(starts_.towards),
            request_.time ? *request_.time : s.open + starts_.time[k] * (s.close - s.open)};
}

void PhotonStream::depart(uint64_t first, uint64_t count, PhotonHarvest& to) {
    ParticleLanes& l = lanes_;
    l.count = 0;
    for (uint64_t k = 0; k < count; ++k) {
        if (k % laneWidth == 0) drawStarts(photonSampler(work_, request_, first + k), !request_.time, starts_);
        const std::optional<LightEmission> emission = emit(plain_.lamps, request_, departureOf(k % laneWidth));
        if (!emission) continue;
        const LightEmission& e = *emission;
        const auto flux = double(luminance(e.flux));
        to.emitted += flux;
        const PathState state = work_.classes.light(e.kind);
        if (state == 0) {
            to.fate.ended += flux;
            continue;
        }
        const std::size_t i = l.count++;
        l.ox[i] = e.ray.o.x, l.oy[i] = e.ray.o.y, l.oz[i] = e.ray.o.z;
        l.dx[i] = e.ray.d.x, l.dy[i] = e.ray.d.y, l.dz[i] = e.ray.d.z;
        l.tfar[i] = e.ray.tfar, l.time[i] = e.ray.time;
        l.fr[i] = e.flux.c[0], l.fg[i] = e.flux.c[1], l.fb[i] = e.flux.c[2];
        l.tr[i] = l.tg[i] = l.tb[i] = 1;
        l.path[i] = uint32_t(first + k);
        l.slot[i] = uint16_t(k);
        l.deltas[i] = 0;
        l.state[i] = state;
        l.kind[i] = e.kind;
        l.hero[i] = 0;
        l.left[i] = {};
    }
}

// All lanes meet what they meet; those that go on move up.
void PhotonStream::bounce(uint32_t depth, PhotonHarvest& to) {
    Sampler numbers = photonSampler(work_, request_, first_); // but for the sample index, that of all
    numbers.skip(Particle::dimensions * (depth + 1));
    kept_ = 0;
    for (std::size_t first = 0; first < lanes_.count; first += PlainHits::most)
        block(depth, numbers, first, std::min(PlainHits::most, lanes_.count - first), to);
    to.fate.rays += uint32_t(lanes_.count);
    lanes_.count = kept_;
}

void PhotonStream::block(uint32_t depth, const Sampler& numbers, std::size_t first, std::size_t count, PhotonHarvest& to) {
    trace(first, count);
    if (photons_.size() < stored_ + count) {
        photons_.resize(2 * (stored_ + count));
        slots_.resize(2 * (stored_ + count));
    }
    bool plain[PlainHits::most / laneWidth] = {};
    for (std::size_t i = 0; i < count; ++i) plain[i / laneWidth] |= takePlain(depth, first + i, i, to);
    std::fill(hits_.step + count, hits_.step + (count + laneWidth - 1) / laneWidth * laneWidth, PlainStep::none);
    const bool roulette = depth >= request_.rouletteDepth;
    Sampler direction = numbers;
    direction.skip(directionAt);
    for (std::size_t begin = 0; begin < count; begin += laneWidth)
        if (plain[begin / laneWidth]) {
            drawNumbers(direction, lanes_, first + begin, roulette, hits_, begin);
            scatterPlain(lanes_, first + begin, roulette, hits_, begin, ledger_);
        }
    for (std::size_t i = 0; i < count; ++i)
        hits_.step[i] != PlainStep::none ? goOnPlain(depth, first + i, i) : goOnAny(depth, numbers, first + i, i, to);
}

void PhotonStream::trace(std::size_t first, std::size_t count) noexcept {
    const ParticleLanes& l = lanes_;
    for (std::size_t i = 0; i < count; i += laneWidth) {
        alignas(64) RayPacket packet;
        const auto copy = [&](float* to, const float* from) { std::memcpy(to, from + first + i, sizeof packet.ox); };
        copy(packet.ox, l.ox), copy(packet.oy, l.oy), copy(packet.oz, l.oz);
        copy(packet.dx, l.dx), copy(packet.dy, l.dy), copy(packet.dz, l.dz);
        copy(packet.tfar, l.tfar), copy(packet.time, l.time);
        std::memset(packet.tnear, 0, sizeof packet.tnear);
        work_.scene.intersect(packet, met_[i / laneWidth], uint32_t(std::min(laneWidth, count - i)), false);
    }
}

const PhotonStream::Known& PhotonStream::known(const Hit& hit) noexcept {
    Known& k = known_[(hit.geometry * 2 + hit.triangle) % remembered];
    if (k.hit.geometry == hit.geometry && k.hit.triangle == hit.triangle && k.hit.instance == hit.instance) return k;
    k.hit = hit;
    k.material = nullptr;
    if (work_.scene.flat(hit, k.triangle))
        if (const PlainMaterial& m = plain_.materials[k.triangle.material]; m.plain && m.smooth) k.material = &m;
    return k;
}

// Prepares the lane for the step in lanes where its hit is plain: segments end there, photons stay there.
bool PhotonStream::takePlain(uint32_t depth, std::size_t lane, std::size_t i, PhotonHarvest& to) noexcept {
    ParticleLanes& l = lanes_;
    const Hit hit = met_[i / laneWidth].hit(i % laneWidth);
    const PathState state = l.state[lane];
    hits_.step[i] = PlainStep::none;
    hits_.goesOn[i] = 0;
    if (!hit || !work_.classes.continues(state) || work_.classes.sorts(state)) return false;
    const Known& k = known(hit);
    if (!k.material) return false;
    if (l.left[lane].material != ParticleLanes::Left::none) { // it may have come through a solid
        SurfacePoint from;
        from.ng = l.left[lane].ng;
        from.material = l.left[lane].material;
        const Spectrum flux{l.fr[lane], l.fg[lane], l.fb[lane]};
        const Spectrum arrives = flux * segmentTransmittance(work_.scene, &from, {l.dx[lane], l.dy[lane], l.dz[lane]}, nullptr, hit.t);
        to.fate.absorbed += double(luminance(flux)) - double(luminance(arrives));
        l.fr[lane] = arrives.c[0], l.fg[lane] = arrives.c[1], l.fb[lane] = arrives.c[2];
    }
    const FlatTriangle& t = k.triangle;
    const Vec3 p = t.at(hit.u, hit.v);
    hits_.px[i] = p.x, hits_.py[i] = p.y, hits_.pz[i] = p.z;
    hits_.nx[i] = t.ng.x, hits_.ny[i] = t.ng.y, hits_.nz[i] = t.ng.z;
    hits_.reach[i] = reachOf(t.ng, t.error);
    hits_.r[i] = k.material->f.c[0], hits_.g[i] = k.material->f.c[1], hits_.b[i] = k.material->f.c[2];
    const Onward onward = rules_.onward(depth, l.deltas[lane]);
    hits_.step[i] = onward == Onward::any ? PlainStep::any : onward == Onward::delta ? PlainStep::delta : PlainStep::stop;
    next_[i] = work_.classes.eye(state, Event::DR);
    hits_.goesOn[i] = next_[i] != 0;
    return true;
}

void PhotonStream::goOnPlain(uint32_t depth, std::size_t lane, std::size_t i) {
    ParticleLanes& l = lanes_;
    const PlainHits& h = hits_;
    const Spectrum flux{l.fr[lane], l.fg[lane], l.fb[lane]};
    if (rules_.stores(depth, l.deltas[lane]) && !black(flux))
        keep(l.slot[lane], {{h.px[i], h.py[i], h.pz[i]}, powerOf(flux), h.wi[i], l.state[lane], uint16_t(h.normal[i])});
    if (!h.goesOn[i]) return;
    const std::size_t to = kept_++;
    l.ox[to] = h.ox[i], l.oy[to] = h.oy[i], l.oz[to] = h.oz[i];
    l.dx[to] = h.dx[i], l.dy[to] = h.dy[i], l.dz[to] = h.dz[i];
    l.tfar[to] = infinity, l.time[to] = l.time[lane];
    l.fr[to] = h.fr[i], l.fg[to] = h.fg[i], l.fb[to] = h.fb[i];
    l.tr[to] = h.tr[i], l.tg[to] = h.tg[i], l.tb[to] = h.tb[i];
    l.path[to] = l.path[lane];
    l.slot[to] = l.slot[lane];
    l.deltas[to] = 0;
    l.state[to] = next_[i];
    l.kind[to] = l.kind[lane];
    l.hero[to] = l.hero[lane];
    l.left[to] = {};
}

// The step of the single walk.
void PhotonStream::goOnAny(uint32_t depth, const Sampler& numbers, std::size_t lane, std::size_t i, PhotonHarvest& to) {
    ParticleLanes& l = lanes_;
    const Hit hit = met_[i / laneWidth].hit(i % laneWidth);
    if (!hit) {
        to.fate.escaped += double(luminance(Spectrum(l.fr[lane], l.fg[lane], l.fb[lane])));
        return;
    }
    Particle p{.ray = {{l.ox[lane], l.oy[lane], l.oz[lane]}, 0, {l.dx[lane], l.dy[lane], l.dz[lane]}, l.tfar[lane], l.time[lane]},
               .flux = {l.fr[lane], l.fg[lane], l.fb[lane]},
               .sampler = numbers.at(l.path[lane]),
               .state = l.state[lane],
               .kind = l.kind[lane],
               .depth = depth,
               .deltas = l.deltas[lane],
               .throughput = {l.tr[lane], l.tg[lane], l.tb[lane]},
               .lambda = {l.hero[lane]}};
    SurfacePoint from, at;
    from.ng = l.left[lane].ng;
    from.material = l.left[lane].material == ParticleLanes::Left::none ? 0 : l.left[lane].material;
    const uint16_t slot = l.slot[lane];
    PhotonVisitor visitor{rules_, [&](const Photon& photon) { keep(slot, photon); }};
    if (!scatterParticle(work_, p, hit, depth > 0 ? &from : nullptr, at, {request_.rouletteDepth, nullptr}, visitor, to.fate)) return;
    const uint32_t path = l.path[lane];
    const std::size_t k = kept_++;
    l.ox[k] = p.ray.o.x, l.oy[k] = p.ray.o.y, l.oz[k] = p.ray.o.z;
    l.dx[k] = p.ray.d.x, l.dy[k] = p.ray.d.y, l.dz[k] = p.ray.d.z;
    l.tfar[k] = p.ray.tfar, l.time[k] = p.ray.time;
    l.fr[k] = p.flux.c[0], l.fg[k] = p.flux.c[1], l.fb[k] = p.flux.c[2];
    l.tr[k] = p.throughput.c[0], l.tg[k] = p.throughput.c[1], l.tb[k] = p.throughput.c[2];
    l.path[k] = path;
    l.slot[k] = slot;
    l.deltas[k] = uint16_t(p.deltas);
    l.state[k] = p.state;
    l.kind[k] = p.kind;
    l.hero[k] = p.lambda.hero;
    l.left[k] = {at.ng, at.material};
}

void PhotonStream::keep(uint16_t slot, const Photon& photon) noexcept {
    photons_[stored_] = photon;
    slots_[stored_++] = slot;
    ++places_[slot];
}

// By path: each path's photons lie in the order of its vertices already.
void PhotonStream::sortInto(PhotonHarvest& to, std::span<uint32_t> counts) {
    if (!counts.empty()) std::copy_n(places_.begin(), counts.size(), counts.begin());
    PhotonList& all = to.photons;
    const std::size_t base = all.size();
    uint32_t sum = 0;
    for (uint32_t& place : places_) sum += std::exchange(place, sum);
    all.resize(base + stored_);
    double flux = 0;
    for (std::size_t i = 0; i < stored_; ++i) {
        all[base + places_[slots_[i]]++] = photons_[i];
        flux += double(luminance(photons_[i].flux));
    }
    to.stored += flux;
}

} // namespace chiaro
