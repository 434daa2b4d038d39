// Samples a second of every integrator, beside what Embree does alone with the camera rays of the same view in the same run. The numbers of
// threads take turns, so that their ratio does not depend on the minute.
#include "tools/bench/memory.h"
#include "tools/bench/rays.h"
#include "tools/bench/rendering.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::bench {
namespace {

constexpr uint32_t coherentPixels = 1 << 14;
constexpr double longPreparation = 0.2; // of the time that is measured: then it is done once for each number of threads

// Of one integrator with one number of threads.
struct Measured {
    std::vector<double> rates; // samples a second, one a run
    double prepareSeconds = 0, raysPerSample = 0, peak = NAN;
};

struct Turn {
    const Request& request;
    const BenchScene& scene;
    const IntegratorChoice& choice;
    double seconds; // of all runs with one number of threads

    Job job(const Executor& run, const PathClasses& classes) const {
        return {{*scene.scene, classes, scene.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                 request.notes, request.memoryLimit},
                scene.view};
    }
    // False: stopped.
    bool take(unsigned threads, Measured& m) const {
        const Executor run(threads); // one at a time: the least of all that are alive counts
        const PathClasses classes;
        const Job j = job(run, classes);
        const bool first = m.rates.empty(), knowsPeak = first && resetPeak();
        Rendering rendering(j, choice);
        const double each = seconds / request.runs;
        rendering.pass(each);
        if (first) {
            m.prepareSeconds = rendering.prepareSeconds();
            m.raysPerSample = rendering.raysPerSample();
            if (knowsPeak) m.peak = double(peakBytes());
        }
        const bool once = m.prepareSeconds > longPreparation * seconds;
        for (std::size_t r = 0; r < (once ? request.runs : 1u) && m.rates.size() < request.runs; ++r) {
            const auto begin = Clock::now();
            double samples = 0;
            do {
                samples += rendering.pass(each);
                if (request.stop.requested()) return false;
            } while (secondsSince(begin) < each);
            m.rates.push_back(samples / secondsSince(begin));
        }
        return !request.stop.requested();
    }
};

// Of the rates of each run over those of the first number of threads in the same run.
double growth(const Measured& m, const Measured& first) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < std::min(m.rates.size(), first.rates.size()); ++r) ratios.push_back(m.rates[r] / first.rates[r]);
    return median(ratios);
}

double spread(std::vector<double> v) {
    const auto [least, most] = std::minmax_element(v.begin(), v.end());
    const double range = *most - *least, middle = median(v);
    return middle > 0 ? range / middle : 0;
}

// Camera rays a second, 16 wide and coherent, of each number of threads; empty: stopped.
std::vector<double> coherentRates(const Request& request, const BenchScene& s, Stopwatch& watch) {
    std::vector<double> all;
    for (const unsigned threads : request.threads) {
        const Executor run(threads);
        const PathClasses classes;
        const Job job{{*s.scene, classes, s.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                       request.notes, request.memoryLimit},
                      s.view};
        const RecordedRays rays = recordRays(job, coherentPixels);
        const auto rate = watch.rate([&] { return double(traceAll(*s.scene, run, rays, RayKind::cameraWide, request.stop).rays); });
        if (!rate) return {};
        all.push_back(rate->perSecond);
    }
    return all;
}

} // namespace

Table integratorsSuite(const Request& request) {
    Table table{.suite = "integrators",
                .title = "whole renders: passes of up to sixteen samples a pixel, again and again",
                .columns = {{"samples", "M/s"},
                            {"rays", "M/s"},
                            {"rays", "a sample"},
                            {"of coherent", "% of Embree's rate"},
                            {"growth", "of 1 thread"},
                            {"prepare", "s"},
                            {"peak", "MB"}},
                .rows = {},
                .notes = {"of coherent: rays/s of the integrator, all kinds together, over the rate of camera rays alone, 16 wide and "
                          "coherent, of the same view in the same run; replay_ratio (suite replay) divides by the same rays instead",
                          "peak: of the whole process while it prepared and rendered, scene and film included"}};
    const std::size_t figures = request.scenes.size() * request.threads.size() * (request.integrators.size() + 1);
    Stopwatch watch(request.seconds, figures, request.runs, request.stop);
    for (const BenchScene& s : request.scenes) {
        const std::vector<double> coherent = coherentRates(request, s, watch);
        table.stopped = coherent.empty();
        for (std::size_t i = 0; i < request.integrators.size() && !table.stopped; ++i) {
            const IntegratorChoice& choice = request.integrators[i];
            request.progress.phase(fmt::format("{} {}", nameOf(choice), s.name));
            const Turn turn{request, s, choice, request.seconds / double(std::max<std::size_t>(1, figures))};
            std::vector<Measured> all(request.threads.size());
            for (uint32_t r = 0; r < request.runs && !table.stopped; ++r)
                for (std::size_t t = 0; t < all.size() && !table.stopped; ++t)
                    if (all[t].rates.size() <= r) table.stopped = !turn.take(request.threads[t], all[t]);
            if (table.stopped) break;
            for (std::size_t t = 0; t < all.size(); ++t) {
                const Measured& m = all[t];
                const double samples = median(m.rates), rays = samples * m.raysPerSample;
                table.rows.push_back({s.name,
                                      nameOf(choice),
                                      request.threads[t],
                                      spread(m.rates),
                                      {samples * 1e-6, rays * 1e-6, m.raysPerSample, coherent[t] > 0 ? 100 * rays / coherent[t] : NAN,
                                       growth(m, all[0]), m.prepareSeconds, m.peak * 1e-6}});
            }
        }
        if (table.stopped) return table;
    }
    return table;
}

} // namespace chiaro::bench
