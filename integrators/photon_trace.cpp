#include "integrators/photon_trace.h"
#include "core/render/fault.h"
#include "integrators/emission_guide.h"
#include "integrators/light_walk.h"
#include "materials/possible_events.h"
#include <chrono>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr uint64_t chunkPaths = 4096;                        // paths of one task
constexpr uint64_t trialChunks = 16;                         // tell how many photons a path leaves
constexpr uint32_t pilotMap = ~0u;                           // its numbers are no other map's
constexpr std::size_t whileSorting = 2 * sizeof(Photon) + 8; // bytes a photon: the list, its copy in order, the cells

// Leaves the photons that are wanted.
struct Storing {
    const PhotonKinds& kinds;
    std::vector<Photon>& photons;
    Onward arrive(const Arrival& a, const Bsdf& bsdf, const Sampler&) const {
        const bool direct = a.depth == 0, caustic = !direct && a.deltas == a.depth;
        if ((direct ? kinds.direct : caustic ? kinds.caustic : kinds.indirect) && bsdf.smooth() && !black(a.flux)) {
            const Vec3 wi = -a.ray.d, normal = dot(wi, a.at.ng) < 0 ? -a.at.ng : a.at.ng;
            const Spectrum flux = fault(Fault::photonPowerBias) ? a.flux * 1.01f : a.flux;
            photons.push_back({a.at.p, flux, packDirection(wi), a.state, packNormal(normal)});
        }
        if (kinds.indirect) return Onward::any;
        return kinds.caustic && (direct || caustic) ? Onward::delta : Onward::stop;
    }
};

struct Begun {
    Sampler sampler;
    std::array<float, EmissionGuide::dimensions> numbers;
    std::optional<LightEmission> emission; // nothing: the numbers meet no light
};
Begun begin(const Work& work, const PhotonRequest& request, uint64_t number) noexcept {
    Begun b{Sampler(work.seed, work.sampler, Stream::light, uint64_t(request.map) << 32 | number >> 32, uint32_t(number)), {}, {}};
    Departure start = departure(work, b.sampler, request.time);
    b.numbers = EmissionGuide::numbers(start);
    const float factor = request.guide ? request.guide->aim(start) : 1.f;
    b.emission = work.scene.lights().emit(start.from, start.towards, start.time);
    if (b.emission) b.emission->flux *= factor;
    return b;
}

// What one task brought.
struct Harvest {
    std::vector<Photon> photons;
    Fate fate;
    double emitted = 0;
    uint64_t rays = 0;
};
Fate walkOne(const Work& work, const PhotonRequest& request, Begun& begun, std::vector<Photon>& photons, PathLog* log) {
    Storing visitor{request.kinds, photons};
    return walkParticle(work, *begun.emission, begun.emission->flux, begun.sampler, {request.rouletteDepth, log}, visitor);
}
void gatherIn(const Work& work, const PhotonRequest& request, uint64_t first, uint64_t last, std::size_t expected, Harvest& to) {
    to.photons.reserve(expected);
    for (uint64_t k = first; k < last; ++k) {
        Begun begun = begin(work, request, request.iteration * request.paths + k);
        if (!begun.emission) continue;
        to.emitted += double(luminance(begun.emission->flux));
        const Fate fate = walkOne(work, request, begun, to.photons, nullptr);
        to.fate.absorbed += fate.absorbed;
        to.fate.escaped += fate.escaped;
        to.fate.ended += fate.ended;
        to.rays += fate.rays;
    }
}

// The photons of all tasks one behind the other; each task's own are freed on the way.
std::vector<Photon> joined(const Work& work, std::vector<Harvest>& harvests) {
    std::vector<std::size_t> place;
    std::size_t sum = 0;
    for (const Harvest& h : harvests) {
        place.push_back(sum);
        sum += h.photons.size();
    }
    std::vector<Photon> all(sum);
    const auto copy = [&](uint64_t i) {
        std::copy(harvests[i].photons.begin(), harvests[i].photons.end(), all.begin() + std::ptrdiff_t(place[i]));
        std::vector<Photon>().swap(harvests[i].photons);
    };
    work.run.chunks(harvests.size(), copy, nullptr);
    return all;
}

double gigabytes(double bytes) { return bytes / 1e9; }

} // namespace

TracedPhotons tracePhotons(const Work& work, const PhotonRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    const uint64_t chunks = (request.paths + chunkPaths - 1) / chunkPaths, trial = std::min(chunks, trialChunks);
    std::vector<Harvest> harvests(chunks);
    const auto trace = [&](uint64_t first, uint64_t last, std::size_t expected) {
        const auto task = [&](uint64_t i) {
            const uint64_t c = first + i;
            gatherIn(work, request, c * chunkPaths, std::min(request.paths, (c + 1) * chunkPaths), expected, harvests[c]);
        };
        return work.run.chunks(last - first, task, &work.stop);
    };
    bool whole = trace(0, trial, 0);
    std::size_t few = 0;
    for (const Harvest& h : harvests) few += h.photons.size();
    const double share = trial > 0 ? double(std::min(request.paths, trial * chunkPaths)) / double(request.paths) : 1;
    const double needed = double(few) / share * double(whileSorting);
    if (whole && needed > double(work.memoryLimit))
        throw Error(Exit::resources,
                    fmt::format("the photons of {} light paths need about {:.2g} GB while they are sorted, limit {:.2g} GB; "
                                "ask for fewer, or allow more with --max-memory",
                                request.paths, gigabytes(needed), gigabytes(double(work.memoryLimit))));
    whole = whole && trace(trial, chunks, few / std::max<uint64_t>(1, trial) * 9 / 8);

    TracedPhotons traced;
    PhotonStatistics& s = traced.statistics;
    s.paths = request.paths;
    const double one = request.paths > 0 ? 1 / double(request.paths) : 0;
    for (const Harvest& h : harvests) {
        s.rays += h.rays;
        s.emitted += h.emitted * one;
        s.absorbed += h.fate.absorbed * one;
        s.escaped += h.fate.escaped * one;
        s.ended += h.fate.ended * one;
    }
    if (whole) traced.photons = joined(work, harvests);
    s.stored = traced.photons.size();
    s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return traced;
}

void tellPhotonPath(const Work& work, const PhotonRequest& request, uint64_t number, PathLog& log) {
    Begun begun = begin(work, request, number);
    std::vector<Photon> photons;
    if (begun.emission) walkOne(work, request, begun, photons, &log);
}

std::shared_ptr<const EmissionGuide> learnEmission(const Work& work, uint64_t pilotPaths) {
    constexpr LetterSet specular = letter(Event::SR) | letter(Event::ST);
    if ((possibleLetters(work.scene) & specular) == 0) return nullptr;
    PhotonRequest request;
    request.paths = pilotPaths;
    request.map = pilotMap;
    request.kinds = {.direct = false, .caustic = true, .indirect = false};
    std::vector<EmissionGuide::Sample> samples(pilotPaths);
    const auto task = [&](uint64_t i) {
        std::vector<Photon> photons;
        for (uint64_t k = i * chunkPaths; k < std::min(pilotPaths, (i + 1) * chunkPaths); ++k) {
            Begun begun = begin(work, request, k);
            photons.clear();
            if (begun.emission) walkOne(work, request, begun, photons, nullptr);
            samples[k].u = begun.numbers;
            for (const Photon& photon : photons) samples[k].worth += luminance(photon.flux);
        }
    };
    if (!work.run.chunks((pilotPaths + chunkPaths - 1) / chunkPaths, task, &work.stop)) return nullptr;
    return EmissionGuide::learn(std::move(samples));
}

} // namespace chiaro
