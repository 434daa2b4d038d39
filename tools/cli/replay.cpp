#include "tools/cli/replay.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {

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
    const StopToken stop;
    const Job job{{*loaded.scene, s.classes, view.shutter, s.seed, s.sampler, run, stop, silent, notes}, view};
    made->prepare(job);
    PathStart start = startPixel(job, pixel, s.sample);
    Outputs out{FilmLayout{.width = view.width, .height = view.height, .crop = view.crop, .layers = s.classes.layerNames()}};
    integrator->radiance(job, start, out);
    const Spectrum value = out.total();

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
