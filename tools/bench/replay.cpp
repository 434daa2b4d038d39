// The recorded-ray replay: what Embree alone takes for the very rays of a render, in their order, by the same calls on the same scene, over
// what the render takes. Both are measured in turns, on the same threads and the same part of the picture; the render that is timed does
// not record. The classes of rays are those of the calls: camera rays sixteen wide and coherent, closest hits and shadow rays sixteen wide
// and one by one. Every replay must find the hits and the distances that the render found, bit by bit.
#include "core/scene/accel.h"
#include "tools/bench/rendering.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <mutex>

namespace chiaro::bench {
namespace {

constexpr uint64_t mostRays = 6'000'000; // 260 MB of them
constexpr uint32_t passSamples = 16;     // as many samples of a pixel as make one packet of camera rays

// The part of the picture that is rendered and recorded: blocks of whole tiles, spread over it.
struct Plan {
    std::vector<Rect> blocks;
    uint32_t samples = 1;
    double pixels() const {
        double sum = 0;
        for (const Rect& b : blocks) sum += double(b.area());
        return sum;
    }
};

// About so many samples.
Plan planFor(const Rect& crop, double samples, bool whole) {
    Plan plan;
    const double each = samples / double(crop.area());
    if (whole || each >= passSamples) {
        plan.blocks = {crop};
        plan.samples = uint32_t(std::clamp(each, 1.0, 64.0));
        if (plan.samples > passSamples) plan.samples -= plan.samples % passSamples;
        return plan;
    }
    const double pixels = samples / passSamples;
    uint32_t side = 16;
    while (side < 128 && pixels >= 8.0 * 4 * side * side) side *= 2;
    std::vector<Rect> all;
    for (uint32_t y = crop.y0; y < crop.y1; y += side)
        for (uint32_t x = crop.x0; x < crop.x1; x += side) all.push_back({x, y, std::min(x + side, crop.x1), std::min(y + side, crop.y1)});
    const std::size_t wanted = std::clamp<std::size_t>(std::size_t(pixels / (double(side) * side)), 1, all.size());
    for (std::size_t i = 0; i < wanted; ++i) plan.blocks.push_back(all[(2 * i + 1) * all.size() / (2 * wanted)]);
    plan.samples = passSamples;
    return plan;
}

class Subject {
public:
    Subject(const Job& job, const IntegratorChoice& choice)
        : job_(job), choice_(choice), splats_(choice.entry->traits(choice.options).splats) {
        make();
        tiled_ = dynamic_cast<const CameraIntegrator*>(integrator_.get()) != nullptr;
    }
    bool tiled() const { return tiled_; } // any part of the picture can be rendered alone
    // Seconds of rendering. What is rendered by iterations with a memory begins anew each time, so that its rays are the same.
    double render(const Plan& plan) {
        if (!tiled_ && used_) make();
        used_ = true;
        std::vector<std::unique_ptr<Film>> films;
        for (const Rect& block : plan.blocks)
            films.push_back(std::make_unique<Film>(
                FilmLayout{.width = job_.view.width, .height = job_.view.height, .crop = block, .layers = {}, .splats = splats_}));
        const auto begin = Clock::now();
        for (std::size_t i = 0; i < plan.blocks.size(); ++i) {
            View view = job_.view;
            view.crop = plan.blocks[i];
            const Job part{static_cast<const Work&>(job_), view, job_.prepass};
            integrator_->render(part, {0, plan.samples}, *films[i]);
        }
        return secondsSince(begin);
    }

private:
    void make() {
        integrator_ = choice_.entry->make(choice_.options);
        integrator_->prepare(job_);
    }
    const Job& job_;
    const IntegratorChoice& choice_;
    bool splats_, tiled_ = false, used_ = false;
    std::unique_ptr<Integrator> integrator_;
};

// The blocks of a class, in their order, over all threads.
RayAnswers replay(const Executor& run, std::span<const RayBlock* const> blocks, bool trace) {
    std::mutex mutex;
    RayAnswers all;
    run.chunks(
        blocks.size(),
        [&](uint64_t i) {
            const RayAnswers a = trace ? Accel::replay(*blocks[i]) : Accel::readThrough(*blocks[i]);
            const std::lock_guard lock(mutex);
            all += a;
        },
        nullptr);
    return all;
}

// Seconds of one round of work, repeated until the time is over.
double repeated(double seconds, FunctionRef<double()> work) {
    double sum = 0;
    uint32_t rounds = 0;
    do {
        sum += work();
        ++rounds;
    } while (sum < seconds);
    return sum / rounds;
}

struct Figures {
    double samples = 0, render = 0, spread = 0, ratio = 0; // render: seconds
    uint64_t rays = 0;
    struct Class {
        RayAnswers asked;
        double seconds = 0, reading = 0;
    };
    std::array<Class, rayCalls> classes;
    std::vector<std::string> wrong; // replays that found something else
    bool whole = true;
};

double spreadOf(const std::vector<double>& v) {
    const auto [least, most] = std::minmax_element(v.begin(), v.end());
    const double middle = median(v);
    return middle > 0 ? (*most - *least) / middle : 0;
}

uint64_t countRays(Subject& subject, const Plan& plan) {
    RayRecord counting(0);
    counting.start();
    subject.render(plan);
    counting.stop();
    return counting.rays();
}

// Render and replays in turns. False: stopped.
bool time(const Job& job, Subject& subject, const Plan& plan, const RayRecord& record, std::span<const RayCall> present, double seconds,
          const Request& request, Figures& f) {
    const double each = seconds / (2 * request.runs), fixed = request.replaySeconds / request.runs;
    std::vector<double> renders, ratios;
    std::array<std::vector<double>, rayCalls> replays;
    for (uint32_t r = 0; r < request.runs; ++r) {
        renders.push_back(repeated(fixed > 0 ? fixed : each, [&] { return subject.render(plan); }));
        double sum = 0;
        for (const RayCall call : present) {
            const double taken = repeated(fixed > 0 ? fixed : each / double(present.size()), [&] {
                const auto begin = Clock::now();
                replay(job.run, record.blocks(call), true);
                return secondsSince(begin);
            });
            replays[std::size_t(call)].push_back(taken);
            sum += taken;
            if (job.stop.requested()) return false;
        }
        ratios.push_back(sum / renders.back());
    }
    for (const RayCall call : present) {
        Figures::Class& one = f.classes[std::size_t(call)];
        one.seconds = median(replays[std::size_t(call)]);
        const auto begin = Clock::now();
        replay(job.run, record.blocks(call), false);
        one.reading = secondsSince(begin) / one.seconds;
    }
    f.render = median(renders);
    f.ratio = median(ratios);
    f.spread = spreadOf(ratios);
    return true;
}

// Empty: stopped.
std::optional<Figures> measure(const Job& job, const IntegratorChoice& choice, double seconds, const Request& request) {
    Subject subject(job, choice);
    const Rect& crop = job.view.crop;
    const Plan first = planFor(crop, subject.tiled() ? std::min(65536.0, double(crop.area())) : 1, !subject.tiled());
    const uint64_t counted = countRays(subject, first);
    if (job.stop.requested()) return {};
    const double raysASample = double(counted) / (first.pixels() * first.samples);
    const double wanted = double(mostRays) * std::clamp(seconds / 4, 0.02, 0.95); // little time, few rays
    const Plan plan = planFor(crop, wanted / std::max(raysASample, 1e-3), !subject.tiled());

    Figures f;
    RayRecord record(mostRays);
    record.start();
    subject.render(plan);
    record.stop();
    f.whole = record.whole();
    f.samples = plan.pixels() * plan.samples;
    f.rays = record.rays();
    if (job.stop.requested()) return {};
    if (!f.whole || f.rays == 0) return f;

    std::vector<RayCall> present;
    for (int c = 0; c < rayCalls; ++c) {
        const RayCall call{uint8_t(c)};
        f.classes[std::size_t(c)].asked = record.answers(call);
        if (record.blocks(call).empty()) continue;
        present.push_back(call);
        const RayAnswers told = replay(job.run, record.blocks(call), true); // and the caches are warm
        if (const RayAnswers& asked = record.answers(call); told != asked)
            f.wrong.push_back(fmt::format("{}: {} hits of {} rays in the render, {} of {} in the replay{}", rayCallName(call), asked.hits,
                                          asked.rays, told.hits, told.rays, told.hits == asked.hits ? ", other distances" : ""));
    }
    return time(job, subject, plan, record, present, seconds, request, f) ? std::optional(f) : std::nullopt;
}

void addRows(Table& table, const std::string& scene, const std::string& name, unsigned threads, const Figures& f) {
    double reading = 0, replayed = 0;
    for (const Figures::Class& c : f.classes) reading += c.reading * c.seconds, replayed += c.seconds;
    table.rows.push_back({scene,
                          name,
                          threads,
                          f.spread,
                          {f.ratio, 1e9 * f.render / f.samples, double(f.rays) / f.samples, 1e-6 * double(f.rays) / f.render,
                           1e-6 * double(f.rays), NAN, reading / replayed}});
    for (int c = 0; c < rayCalls; ++c) {
        const Figures::Class& one = f.classes[std::size_t(c)];
        if (one.seconds == 0) continue;
        const double rays = double(one.asked.rays);
        table.rows.push_back({scene,
                              fmt::format("{}, {}", name, rayCallName(RayCall(c))),
                              threads,
                              0,
                              {one.seconds / f.render, 1e9 * one.seconds / f.samples, rays / f.samples, 1e-6 * rays / one.seconds,
                               1e-6 * rays, rays / double(one.asked.calls), one.reading}});
    }
}

bool cutOut(const Scene& scene) {
    return std::any_of(scene.materials().begin(), scene.materials().end(),
                       [](const MaterialDesc& m) { return m.alphaMode != AlphaMode::opaque; });
}

} // namespace

Table replaySuite(const Request& request) {
    Table table{
        .suite = "replay",
        .title = "Embree alone on the recorded rays of a render, over that render",
        .columns = {{"replay_ratio", "of the render"},
                    {"time", "ns a sample"},
                    {"rays", "a sample"},
                    {"rate", "M rays/s"},
                    {"recorded", "M rays"},
                    {"filled", "rays a call"},
                    {"reading", "of the replay"}},
        .rows = {},
        .notes = {"first row: the render and the sum of its classes; then every class of rays replayed, its share of the render's time",
                  "reading: the share of a replay that reads records and lays them out, at most (without the calls)"}};
    const double seconds =
        request.seconds / double(std::max<std::size_t>(1, request.scenes.size() * request.threads.size() * request.integrators.size()));
    const PathClasses classes;
    for (const BenchScene& s : request.scenes) {
        if (cutOut(*s.scene))
            table.notes.push_back(fmt::format("{}: cut-out surfaces; our filter for them runs in the replay too", s.name));
        for (const IntegratorChoice& choice : request.integrators)
            for (const unsigned threads : request.threads) {
                const std::string name = nameOf(choice);
                request.progress.phase(fmt::format("replay {} {} {} thread{}", name, s.name, threads, threads == 1 ? "" : "s"));
                const Executor run(threads);
                const Job job{{*s.scene, classes, s.view.shutter, request.seed, SamplerKind::sobol, run, request.stop, request.progress,
                               request.notes, request.memoryLimit},
                              s.view};
                const auto f = request.stop.requested() ? std::nullopt : measure(job, choice, seconds, request);
                if (!f) {
                    table.stopped = true;
                    return table;
                }
                if (f->whole && f->rays > 0)
                    addRows(table, s.name, name, threads, *f);
                else
                    table.notes.push_back(
                        fmt::format("{}: {} left out: {}", s.name, name,
                                    f->rays == 0 ? std::string("it traces no ray") : fmt::format("{} rays in its smallest part", f->rays)));
                for (const std::string& what : f->wrong) table.notes.push_back(fmt::format("{}: {}: WRONG: {}", s.name, name, what));
                table.failed = table.failed || !f->wrong.empty();
            }
    }
    return table;
}

} // namespace chiaro::bench
