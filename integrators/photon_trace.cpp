#include "integrators/photon_trace.h"
#include "integrators/emission_guide.h"
#include "integrators/photon_stream.h"
#include "materials/possible_events.h"
#include <chrono>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr uint64_t chunkPaths = 4096;                        // paths of one task
constexpr uint64_t trialChunks = 16;                         // tell how many photons a path leaves
constexpr uint32_t pilotMap = ~0u;                           // its numbers are no other map's
constexpr std::size_t whileSorting = 2 * sizeof(Photon) + 8; // bytes a photon: the list, its copy in order, the cells

// Paths that share their high bits go in one stream.
uint64_t streamLength(uint64_t first, uint64_t last) noexcept {
    return std::min({last - first, PhotonStream::most, (uint64_t(1) << 32) - (first & 0xffffffffu)});
}

void gatherIn(const Work& work, const PhotonRequest& request, const PlainScene& plain, uint64_t first, uint64_t last, std::size_t expected,
              PhotonHarvest& to) {
    to.photons.reserve(expected);
    const auto stream = std::make_unique<PhotonStream>(work, request, plain);
    for (uint64_t n = 0; first < last; first += n) stream->walk(first, n = streamLength(first, last), to);
}

// The photons of all tasks one behind the other; each task's own are freed on the way.
PhotonList joined(const Work& work, std::vector<PhotonHarvest>& harvests) {
    std::vector<std::size_t> place;
    std::size_t sum = 0;
    for (const PhotonHarvest& h : harvests) {
        place.push_back(sum);
        sum += h.photons.size();
    }
    PhotonList all(sum);
    const auto copy = [&](uint64_t i) {
        std::copy(harvests[i].photons.begin(), harvests[i].photons.end(), all.begin() + std::ptrdiff_t(place[i]));
        PhotonList().swap(harvests[i].photons);
    };
    work.run.chunks(harvests.size(), copy, nullptr);
    return all;
}

double gigabytes(double bytes) { return bytes / 1e9; }

} // namespace

TracedPhotons tracePhotons(const Work& work, const PhotonRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    const uint64_t chunks = (request.paths + chunkPaths - 1) / chunkPaths, trial = std::min(chunks, trialChunks);
    std::vector<PhotonHarvest> harvests(chunks);
    const PlainScene plain(work.scene);
    const auto trace = [&](uint64_t first, uint64_t last, std::size_t expected) {
        const auto task = [&](uint64_t i) {
            const uint64_t c = first + i, begin = request.iteration * request.paths;
            gatherIn(work, request, plain, begin + c * chunkPaths, begin + std::min(request.paths, (c + 1) * chunkPaths), expected,
                     harvests[c]);
        };
        return work.run.chunks(last - first, task, &work.stop);
    };
    bool whole = trace(0, trial, 0);
    std::size_t few = 0;
    for (const PhotonHarvest& h : harvests) few += h.photons.size();
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
    for (const PhotonHarvest& h : harvests) {
        s.rays += h.fate.rays;
        s.emitted += h.emitted * one;
        s.storedFlux += h.stored * one;
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
    const PhotonStart start = startPhoton(work, request, number);
    if (!start.emission) return;
    const PhotonRules rules{request.kinds};
    PhotonVisitor visitor{rules, [](const Photon&) {}};
    walkParticle(work, *start.emission, start.emission->flux, start.sampler, {request.rouletteDepth, &log}, visitor);
}

std::shared_ptr<const EmissionGuide> learnEmission(const Work& work, uint64_t pilotPaths) {
    constexpr LetterSet specular = letter(Event::SR) | letter(Event::ST);
    if ((possibleLetters(work.scene) & specular) == 0) return nullptr;
    PhotonRequest request;
    request.paths = pilotPaths;
    request.map = pilotMap;
    request.kinds = {.direct = false, .caustic = true, .indirect = false};
    std::vector<EmissionGuide::Sample> samples(pilotPaths);
    const PlainScene plain(work.scene);
    const auto task = [&](uint64_t i) {
        const auto stream = std::make_unique<PhotonStream>(work, request, plain);
        std::vector<uint32_t> counts(PhotonStream::most);
        PhotonHarvest harvest;
        for (uint64_t k = i * chunkPaths, n = 0; k < std::min(pilotPaths, (i + 1) * chunkPaths); k += n) {
            n = streamLength(k, std::min(pilotPaths, (i + 1) * chunkPaths));
            harvest.photons.clear();
            stream->walk(k, n, harvest, {counts.data(), n});
            auto photon = harvest.photons.begin();
            for (uint64_t j = 0; j < n; ++j) {
                Sampler sampler = photonSampler(work, request, k + j);
                samples[k + j].u = EmissionGuide::numbers(departure(work, sampler, request.time));
                for (uint32_t c = 0; c < counts[j]; ++c) samples[k + j].worth += luminance((photon++)->flux);
            }
        }
    };
    if (!work.run.chunks((pilotPaths + chunkPaths - 1) / chunkPaths, task, &work.stop)) return nullptr;
    return EmissionGuide::learn(std::move(samples));
}

} // namespace chiaro
