#include "tools/cli/replay.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/signals.h"
#include "tools/cli/trace.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {

namespace {

// In lanes a sample may round otherwise than alone: its value is what a film of this pixel gets. The path that is told is the one alone.
void takeStreamed(const Job& job, CameraIntegrator& integrator, Pixel pixel, uint32_t sample, Spectrum& value) {
    View view = job.view;
    view.crop = {pixel.x, pixel.y, pixel.x + 1, pixel.y + 1};
    const FilmLayout layout{.width = view.width, .height = view.height, .crop = view.crop, .layers = job.classes.layerNames()};
    const Job here{static_cast<const Work&>(job), view, job.prepass};
    if (!integrator.streams(here, layout)) return;
    Film film(layout, sample);
    integrator.render(here, {sample, sample + 1}, film);
    if (film.count(pixel) > 0) value = film.mean(pixel);
}

} // namespace

Replayed replay(const Job& job, CameraIntegrator& integrator, Pixel pixel, uint32_t sample, PathLog* log) {
    Replayed r{.start = startPixel(job, pixel, sample, integrator.starts(job)), .value = {}};
    Outputs out{FilmLayout{.width = job.view.width, .height = job.view.height, .crop = job.view.crop, .layers = job.classes.layerNames()}};
    out.log = log;
    PathStart start = r.start; // an integrator may use it up
    integrator.radiance(job, start, out);
    r.value = out.total();
    takeStreamed(job, integrator, pixel, sample, r.value);
    r.rays = out.rays + 1;
    r.depth = out.depth;
    return r;
}

int replaySample(const RenderSettings& s, const LoadedScene& loaded, const View& view, const std::string& camera, const Executor& run,
                 Diagnostics& notes, Console& console) {
    const Pixel pixel = parsePixel("pixel", s.pixel, {view.width, view.height});
    const auto made = s.integrator.entry->make(s.integrator.options);
    auto* integrator = dynamic_cast<CameraIntegrator*>(made.get());
    if (!integrator)
        throw Error(Exit::unsupported,
                    fmt::format("--pixel: {} does not make its picture sample by sample from the camera, so that one sample "
                                "cannot be replayed alone; {}",
                                s.integrator.entry->name,
                                dynamic_cast<const PathSource*>(made.get()) ? "chiaro trace --sample N follows one of its paths"
                                                                            : "try --crop 1x1+X+Y, or -i path"));
    Progress silent;
    StopToken stop;
    const StopOnSignal signals(stop);
    const Work work{*loaded.scene, s.classes, view.shutter, s.seed, s.sampler,
                    run,           stop,      silent,       notes,  s.scene.memory.beside(*loaded.scene)};
    PrepassSolver solver(s.prepass, s.scene);
    const SolvedPrepass solved = solver.solve(work);
    tellPrepass(solver, solved, console);
    const Job job{work, view, solved.field.get()};
    made->prepare(job);
    if (stop.cancelled()) return int(Exit::killed);
    TracedSample sample{.number = s.sample, .ray = {}, .log = {}};
    const Replayed r = replay(job, *integrator, pixel, s.sample, &sample.log);
    const Spectrum value = sample.value = r.value;
    sample.ray = r.start.ray;
    sample.rays = r.rays;
    sample.depth = r.depth;

    console.warnings(notes);
    const bool dropped = !finite(value) || maxComponent(value) >= fixedLimit;
    console.phase("sample", fmt::format("pixel {},{} sample {} seed {}{}", pixel.x, pixel.y, s.sample, s.seed,
                                        !finite(value) ? "   not finite: left out of pictures"
                                        : dropped      ? "   beyond 2^36: left out of pictures"
                                                       : ""));
    const LightNames lights(*loaded.scene);
    const TraceSide side{*s.arguments, s, nameWith(s.integrator, s.prepass.get())};
    Trace trace{*loaded.scene, lights, s.scene.operand, camera, s.seed, pixel, {}};
    trace.sides.push_back({&side, {std::move(sample)}});
    if (s.json) {
        const auto number = [](float v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(fmt::format("{}", v)); };
        fmt::print("{}\n", nlohmann::json{{"pixel", {pixel.x, pixel.y}},
                                          {"sample", s.sample},
                                          {"rgb", {number(value[0]), number(value[1]), number(value[2])}},
                                          {"trace", nlohmann::json::parse(traceJson(trace, {}, notes.warnings()))}}
                               .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        fmt::print("{:.9g} {:.9g} {:.9g}\n\n{}", value[0], value[1], value[2], traceText(trace));
    }
    return s.strict && (!notes.warnings().empty() || dropped) ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
