#include "core/render/render.h"
#include <bit>
#include <cmath>

namespace chiaro {
namespace {

using Clock = StopToken::Clock;
constexpr double longestPass = 1; // seconds: how often the driver looks up

constexpr uint32_t firstLook = 16; // samples before noise may end it

double secondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

// The next sample index at which so many after `begin` are a power of two: the film looks at itself there.
uint32_t nextLook(const Film& film, uint32_t end) noexcept {
    const uint64_t taken = film.done() - film.begin();
    return uint32_t(std::min<uint64_t>(end, film.begin() + (taken == 0 ? 1 : 2 * std::bit_floor(taken))));
}

// The sample index that ends a render with so much noise; `end` where that is beyond it or not known yet.
uint32_t quietEnd(const Film& film, double noise, uint32_t end) {
    const uint32_t taken = film.done() - film.begin();
    if (!(noise > 0) || taken < firstLook) return end;
    const double needed = std::max(double(firstLook), std::ceil(taken * sqr(film.noiseBound() / noise) * (1 - 1e-9)));
    return needed < double(end - film.begin()) ? std::max(film.begin() + uint32_t(needed), film.done()) : end;
}

// Samples that every pixel has after a pass that was stopped. Adaptive sampling leaves some pixels behind for good.
uint32_t reached(const Film& film) {
    const Rect& r = film.layout().crop;
    uint32_t least = ~0u;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) least = std::min(least, film.next({x, y}));
    return std::max(least, film.done());
}

} // namespace

RenderResult render(const Job& job, Integrator& integrator, Film& film, const Budget& budget, StopToken& stop, const Keeping& keeping) {
    const auto start = Clock::now();
    const auto deadline = std::isfinite(budget.seconds)
                              ? start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(budget.seconds))
                              : Clock::time_point::max();
    integrator.prepare(job);
    Progress::Plan plan{start, budget.seconds, film.done(), budget.spp, 0, 0, std::nan("")};
    RenderResult result;
    auto kept = Clock::now();
    double perSample = 0;
    uint32_t size = 1, end = quietEnd(film, budget.noise, budget.spp);
    const auto begun = [&] { return film.done() > film.begin(); };
    while (film.done() < end && !stop.cancelled() && (!begun() || Clock::now() < deadline)) {
        if (perSample > 0) size = uint32_t(std::clamp(std::min(longestPass, keeping.every) / perSample, 1.0, 2.0 * size));
        const Pass pass{film.done(), nextLook(film, film.done() + std::min(size, end - film.done()))};
        plan.passBegin = pass.begin;
        plan.passEnd = pass.end;
        plan.sppTarget = end;
        job.progress.beginPass(plan);
        stop.setDeadline(begun() ? deadline : Clock::time_point::max()); // the first sample is always completed
        const auto passBegun = Clock::now();
        integrator.render(job, pass, film);
        perSample = secondsSince(passBegun) / (pass.end - pass.begin);
        if (stop.requested() && !film.complete(pass.end)) { // within the pass: what is there is in the film's counts
            film.setDone(reached(film));
            break;
        }
        film.setDone(pass.end);
        if (std::has_single_bit(film.done() - film.begin())) {
            plan.noise = film.noise();
            end = quietEnd(film, budget.noise, budget.spp);
        }
        if (keeping.keep && film.done() < end && secondsSince(kept) >= keeping.every) {
            keeping.keep();
            kept = Clock::now();
        }
    }
    result.ended = stop.cancelled()           ? Ended::stopped
                   : film.done() < end        ? Ended::time
                   : film.done() < budget.spp ? Ended::noise
                                              : Ended::spp;
    stop.setDeadline(Clock::time_point::max());
    result.spp = film.done();
    result.seconds = secondsSince(start);
    return result;
}

} // namespace chiaro
