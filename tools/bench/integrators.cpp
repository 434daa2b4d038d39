// Samples a second of every integrator, beside what Embree does alone with the camera rays of the same view in the same run.
#include "tools/bench/rays.h"
#include <cmath>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr uint32_t coherentPixels = 1 << 14;

struct Measured {
    Rate samples;
    double prepareSeconds = 0, raysPerSample = 0;
};

// Mean over the picture of the rays of a sample, from a pass whose film keeps costs.
double raysPerSample(const Job& job, Integrator& integrator, bool splats) {
    Film film({.width = job.view.width, .height = job.view.height, .crop = job.view.crop, .layers = {}, .splats = splats, .costs = true});
    integrator.render(job, {0, 1}, film);
    const Rect& r = job.view.crop;
    double rays = 0;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) rays += film.cost({x, y}).rays;
    return rays / double(r.area());
}

std::optional<Measured> measure(const Job& job, const IntegratorChoice& choice, Stopwatch& watch) {
    const bool splats = choice.entry->traits(choice.options).splats;
    const auto integrator = choice.entry->make(choice.options);
    Measured m;
    const auto begin = Clock::now();
    integrator->prepare(job);
    m.prepareSeconds = secondsSince(begin);
    if (job.stop.requested()) return {};
    Film film({.width = job.view.width, .height = job.view.height, .crop = job.view.crop, .layers = {}, .splats = splats});
    uint32_t next = 0;
    const auto rate = watch.rate([&] {
        integrator->render(job, {next, next + 1}, film);
        film.setDone(++next);
        return double(job.view.crop.area());
    });
    if (!rate) return {};
    m.samples = *rate;
    m.raysPerSample = raysPerSample(job, *integrator, splats);
    return job.stop.requested() ? std::nullopt : std::optional(m);
}

} // namespace

Table integratorsSuite(const Request& request) {
    Table table{.suite = "integrators",
                .title = "whole renders: one sample a pixel, again and again",
                .columns = {{"samples", "M/s"},
                            {"rays", "M/s"},
                            {"rays", "a sample"},
                            {"of coherent", "% of Embree's rate"},
                            {"growth", "of 1 thread"},
                            {"prepare", "s"}},
                .rows = {},
                .notes = {"of coherent: rays/s of the integrator over the rate of camera rays, 16 wide and coherent, in the same run"}};
    Stopwatch watch(request.seconds, request.scenes.size() * request.threads.size() * (request.integrators.size() + 1), request.runs,
                    request.stop);
    const PathClasses classes;
    for (const BenchScene& s : request.scenes) {
        std::vector<double> first(request.integrators.size(), NAN);
        for (const unsigned threads : request.threads) {
            const Executor run(threads);
            const Job job{{*s.scene, classes, s.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                           request.notes, request.memoryLimit},
                          s.view};
            const RecordedRays rays = recordRays(job, coherentPixels);
            const auto coherent = watch.rate([&] { return double(traceAll(*s.scene, run, rays, RayKind::cameraWide, request.stop).rays); });
            table.stopped = !coherent;
            for (std::size_t i = 0; i < request.integrators.size() && !table.stopped; ++i) {
                const IntegratorChoice& choice = request.integrators[i];
                const std::string options = choice.options.recipe(),
                                  name = fmt::format("{}{}{}", choice.entry->name, options.empty() ? "" : ":", options);
                request.progress.phase(fmt::format("{} {} {} thread{}", name, s.name, threads, threads == 1 ? "" : "s"));
                const auto m = measure(job, choice, watch);
                table.stopped = !m;
                if (!m) break;
                if (threads == request.threads.front()) first[i] = m->samples.perSecond;
                const double raysPerSecond = m->samples.perSecond * m->raysPerSample;
                table.rows.push_back({s.name,
                                      name,
                                      threads,
                                      m->samples.spread,
                                      {m->samples.perSecond * 1e-6, raysPerSecond * 1e-6, m->raysPerSample,
                                       coherent->perSecond > 0 ? 100 * raysPerSecond / coherent->perSecond : NAN,
                                       m->samples.perSecond / first[i], m->prepareSeconds}});
            }
            if (table.stopped) return table;
        }
    }
    return table;
}

} // namespace chiaro::bench
