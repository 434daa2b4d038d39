#include "core/render/render.h"
#include <cmath>

namespace chiaro {
namespace {

using Clock = StopToken::Clock;
constexpr double longestPass = 1; // seconds: how often the driver looks up

double secondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

} // namespace

RenderResult render(const Job& job, Integrator& integrator, Film& film, const Budget& budget, StopToken& stop) {
    const auto start = Clock::now();
    const auto deadline = std::isfinite(budget.seconds)
                              ? start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(budget.seconds))
                              : Clock::time_point::max();
    integrator.prepare(job);
    Progress::Plan plan{start, budget.seconds, film.done(), budget.spp, 0, 0, std::nan("")};
    RenderResult result;
    double perSample = 0;
    uint32_t size = 1, noiseAt = 2;
    while (film.done() < budget.spp && !stop.cancelled() && (film.done() == 0 || Clock::now() < deadline)) {
        if (perSample > 0) size = uint32_t(std::clamp(longestPass / perSample, 1.0, 2.0 * size));
        const Pass pass{film.done(), std::min(budget.spp, film.done() + std::min(size, budget.spp - film.done()))};
        plan.passBegin = pass.begin;
        plan.passEnd = pass.end;
        job.progress.beginPass(plan);
        stop.setDeadline(film.done() == 0 ? Clock::time_point::max() : deadline); // the first sample is always completed
        const auto begun = Clock::now();
        integrator.render(job, pass, film);
        perSample = secondsSince(begun) / (pass.end - pass.begin);
        if (stop.requested() && !film.complete(pass.end)) break; // within the pass: what is there is in the film's counts
        film.setDone(pass.end);
        if (film.done() >= noiseAt && film.done() < budget.spp) {
            plan.noise = film.noise();
            noiseAt = 2 * film.done();
        }
    }
    result.ended = stop.cancelled() ? Ended::stopped : film.done() >= budget.spp ? Ended::spp : Ended::time;
    stop.setDeadline(Clock::time_point::max());
    result.spp = film.done();
    result.seconds = secondsSince(start);
    return result;
}

} // namespace chiaro
