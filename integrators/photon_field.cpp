#include "integrators/photon_field.h"
#include "core/render/archive.h"
#include "core/render/fault.h"
#include "materials/possible_events.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace chiaro {
namespace {

constexpr uint32_t globalMap = 0, causticMap = 1;
constexpr uint64_t fewPilots = 65536, manyPilots = 262144;
// Photons in the disc of a radius that is chosen automatically, where half of them are denser.
constexpr double quantile = 0.5, globalPhotons = 50, causticPhotons = 30;
constexpr float mostOfScene = 0.1f; // a radius, of that of the scene

bool anySpecular(const Scene& scene) { return (possibleLetters(scene) & (letter(Event::SR) | letter(Event::ST))) != 0; }

std::string counted(double n) {
    return n >= 1e6 ? fmt::format("{:.3g} M", n * 1e-6) : n >= 1e4 ? fmt::format("{:.3g} k", n * 1e-3) : fmt::format("{:.0f}", n);
}

} // namespace

PhotonKernel photonKernel(const Options& o) {
    const std::string& name = o.text("kernel");
    return name == "constant" ? PhotonKernel::constant : name == "cone" ? PhotonKernel::cone : PhotonKernel::epanechnikov;
}

PhotonFieldPlan PhotonFieldOptions::plan(const Options& o) {
    PhotonFieldPlan p;
    p.paths = uint64_t(o.integer("count"));
    p.causticPaths = uint64_t(o.integer("caustic-count"));
    p.radius = float(o.real("radius"));
    p.causticRadius = float(o.real("caustic-radius"));
    const bool nearest = o.text("estimate") == "knn";
    p.density = {photonKernel(o), nearest ? uint32_t(o.integer("k")) : 0};
    p.shrink = float(o.real("shrink"));
    p.more = nearest ? 1 / (o.real("shrink") * o.real("shrink")) : 1;
    p.rouletteDepth = uint32_t(o.integer("rr-depth"));
    return p;
}

PhotonScale photonScale(const Job& job) {
    constexpr uint32_t side = 16;
    const View& v = job.view;
    std::vector<float> widths;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const Pixel pixel{uint32_t((uint64_t(x) * 2 + 1) * v.width / (2 * side)),
                              uint32_t((uint64_t(y) * 2 + 1) * v.height / (2 * side))};
            const PathStart start = startPixel(job, pixel, 0);
            if (start.first) widths.push_back(start.footprint.width + start.footprint.spread * start.first.t);
        }
    PhotonScale scale{double(v.width) * v.height, 0};
    if (widths.empty()) return scale;
    const auto middle = widths.begin() + std::ptrdiff_t(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    scale.pixel = *middle;
    return scale;
}

void PhotonField::prepare(const Work& work, const PhotonScale& scale) {
    scale_ = scale;
    sceneRadius_ = work.scene.radius();
    const double pixels = scale.pixels > 0 ? scale.pixels : 262144;
    const uint64_t paths = plan_.paths ? plan_.paths : uint64_t(std::clamp(pixels, 32768.0, 1048576.0));
    const uint64_t causticPaths = plan_.causticPaths ? plan_.causticPaths : 2 * paths;
    paths_ = uint64_t(double(paths) * plan_.more);
    causticPaths_ = uint64_t(double(causticPaths) * plan_.more);
    radius_ = plan_.radius * plan_.shrink;
    causticRadius_ = plan_.causticRadius * plan_.shrink;
    twoMaps_ = false;
    if (!anySpecular(work.scene)) return;
    guide_ = learnEmission(work, fewPilots);
    if (!guide_ && !work.stop.requested()) guide_ = learnEmission(work, manyPilots); // small things far from the light are easily missed
    twoMaps_ = true;
}

bool PhotonField::traceOne(const Work& work, const PhotonRequest& request, float& radius, const RadiusChoice& choice, PhotonMap& map,
                           PhotonStatistics& statistics) {
    TracedPhotons traced = tracePhotons(work, request);
    statistics = traced.statistics;
    if (work.stop.requested()) return false;
    if (radius == 0) {
        const float typical = typicalRadius(traced.photons, choice.photons, quantile);
        radius = plan_.shrink * std::clamp(typical > 0 ? typical : choice.most, std::min(choice.least, choice.most), choice.most);
    }
    map = PhotonMap(PhotonStore(work.run, std::move(traced.photons), radius), request.paths, radius, plan_.density);
    return true;
}

bool PhotonField::trace(const Work& work, uint64_t iteration, std::optional<float> time) {
    const auto begin = std::chrono::steady_clock::now();
    PhotonRequest request;
    request.iteration = iteration;
    request.time = time;
    request.rouletteDepth = plan_.rouletteDepth;
    request.paths = paths_;
    request.map = globalMap;
    request.kinds = {.direct = plan_.direct || fault(Fault::photonDirectTwice),
                     .caustic = plan_.all || !twoMaps_ || fault(Fault::photonCausticTwice),
                     .indirect = true};
    // The greatest radius of a k-nearest estimate is three times the typical one.
    const double k = 9.0 * plan_.density.k;
    const float most = mostOfScene * sceneRadius_;
    if (!traceOne(work, request, radius_, {k > 0 ? k : globalPhotons, 0, most}, global_, statistics_)) return false;
    if (twoMaps_) {
        request.paths = causticPaths_;
        request.map = causticMap;
        request.kinds = {.direct = false, .caustic = true, .indirect = false};
        request.guide = guide_.get();
        const RadiusChoice choice{k > 0 ? k : causticPhotons, scale_.pixel, std::max(scale_.pixel, radius_ / plan_.shrink)};
        if (!traceOne(work, request, causticRadius_, choice, caustic_, causticStatistics_)) return false;
    }
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return true;
}

std::string PhotonField::summary() const {
    const auto one = [](const PhotonMap& map, float radius) {
        return fmt::format("{} of {} light paths, radius {:.3g} m", counted(double(map.store().size())), counted(double(map.paths())),
                           double(radius));
    };
    std::string text = one(global_, radius_);
    if (twoMaps_) text += "; caustic " + one(caustic_, causticRadius_);
    return text + fmt::format("; {:.3g} MB in {:.2f} s", double(bytes()) / 1e6, seconds_);
}

std::string PhotonField::balance() const {
    const PhotonStatistics& s = statistics_;
    if (!(s.emitted > 0)) return "no light is emitted";
    const auto share = [&](double flux) { return fmt::format("{:.3g} %", 100 * flux / s.emitted); };
    std::string text = fmt::format("emitted {:.4g} lm: {} absorbed, {} escaped, {} ended; stored {:.4g} lm", s.emitted, share(s.absorbed),
                                   share(s.escaped), share(s.ended), s.storedFlux);
    if (twoMaps_) text += fmt::format("; caustic stored {:.4g} lm", causticStatistics_.storedFlux);
    return text;
}

std::string PhotonField::recipe() const {
    const auto count = [&](uint64_t paths) { return std::llround(double(paths) / plan_.more); };
    std::string text = fmt::format("count={},radius={:.3g}", count(paths_), double(radius_ / plan_.shrink));
    if (twoMaps_)
        text += fmt::format(",caustic-count={},caustic-radius={:.3g}", count(causticPaths_), double(causticRadius_ / plan_.shrink));
    return text;
}

std::vector<PhotonMapView> PhotonField::views() const {
    std::vector<PhotonMapView> all;
    if (global_.store().size() > 0) all.push_back({"global", global_.store().photons(), double(global_.paths())});
    if (twoMaps_ && caustic_.store().size() > 0) all.push_back({"caustic", caustic_.store().photons(), double(caustic_.paths())});
    return all;
}

void PhotonField::save(Writer& to) const {
    to.value(paths_);
    to.value(causticPaths_);
    to.value(radius_);
    to.value(causticRadius_);
    to.value(uint8_t(twoMaps_));
    global_.store().save(to);
    if (twoMaps_) caustic_.store().save(to);
}

void PhotonField::load(const Work& work, Reader& from) {
    paths_ = from.value<uint64_t>();
    causticPaths_ = from.value<uint64_t>();
    radius_ = from.value<float>();
    causticRadius_ = from.value<float>();
    twoMaps_ = from.value<uint8_t>() != 0;
    if (paths_ == 0 || !(radius_ > 0) || !std::isfinite(radius_) ||
        (twoMaps_ && (causticPaths_ == 0 || !(causticRadius_ > 0) || !std::isfinite(causticRadius_))))
        from.refuse("its photon maps have no paths or no radius; make them again");
    PhotonStore store;
    store.load(work.run, from, work.classes);
    global_ = PhotonMap(std::move(store), paths_, radius_, plan_.density);
    if (!twoMaps_) return;
    PhotonStore caustic;
    caustic.load(work.run, from, work.classes);
    caustic_ = PhotonMap(std::move(caustic), causticPaths_, causticRadius_, plan_.density);
}

} // namespace chiaro
