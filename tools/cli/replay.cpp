#include "tools/cli/replay.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/signals.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {

Replayed replay(const Job& job, const CameraIntegrator& integrator, Pixel pixel, uint32_t sample, PathLog* log) {
    Replayed r{.start = startPixel(job, pixel, sample, integrator.starts(job)), .value = {}};
    Outputs out{FilmLayout{.width = job.view.width, .height = job.view.height, .crop = job.view.crop, .layers = job.classes.layerNames()}};
    out.log = log;
    PathStart start = r.start; // an integrator may use it up
    integrator.radiance(job, start, out);
    r.value = out.total();
    r.rays = out.rays + 1;
    r.depth = out.depth;
    return r;
}

int replaySample(const RenderSettings& s, const LoadedScene& loaded, const View& view, const Executor& run, Diagnostics& notes,
                 Console& console) {
    const Pixel pixel = parsePixel("pixel", s.pixel, {view.width, view.height});
    const auto made = s.integrator.entry->make(s.integrator.options);
    const auto* integrator = dynamic_cast<CameraIntegrator*>(made.get());
    if (!integrator)
        throw Error(Exit::unsupported,
                    fmt::format("--pixel: {} does not make its picture sample by sample from the camera, so that one sample "
                                "cannot be replayed alone; try -i path",
                                s.integrator.entry->name));
    Progress silent;
    StopToken stop;
    const StopOnSignal signals(stop);
    const Work work{*loaded.scene, s.classes, view.shutter, s.seed, s.sampler, run, stop, silent, notes, memoryLimit(s)};
    PrepassSolver solver(s.prepass, s.scene);
    const SolvedPrepass solved = solver.solve(work);
    tellPrepass(solver, solved, console);
    const Job job{work, view, solved.field.get()};
    made->prepare(job);
    if (stop.cancelled()) return int(Exit::killed);
    const Spectrum value = replay(job, *integrator, pixel, s.sample).value;

    console.warnings(notes);
    console.phase("sample",
                  fmt::format("pixel {},{} sample {} seed {}{}", pixel.x, pixel.y, s.sample, s.seed, finite(value) ? "" : "   not finite"));
    if (s.json) {
        const auto number = [](float v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(fmt::format("{}", v)); };
        fmt::print("{}\n", nlohmann::json{{"pixel", {pixel.x, pixel.y}},
                                          {"sample", s.sample},
                                          {"rgb", {number(value[0]), number(value[1]), number(value[2])}}}
                               .dump());
    } else {
        fmt::print("{:.9g} {:.9g} {:.9g}\n", value[0], value[1], value[2]);
    }
    return s.strict && (!notes.warnings().empty() || !finite(value)) ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
