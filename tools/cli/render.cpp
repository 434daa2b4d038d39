// chiaro render: one integrator, one picture.
#include "core/render/depth.h"
#include "io/replace_file.h"
#include "tools/cli/cost_pictures.h"
#include "tools/cli/photon_output.h"
#include "tools/cli/prepared_once.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/recipe.h"
#include "tools/cli/replay.h"
#include "tools/cli/report.h"
#include "tools/cli/signals.h"
#include "tools/cli/unseen_paths.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

// A film that would not fit is refused before anything is allocated, with a size that would.
void checkMemory(const RenderSettings& s, const FilmLayout& layout) {
    const double limit = double(memoryLimit(s)), needed = double(layout.bytes());
    if (needed <= limit) return;
    const double scale = std::sqrt(limit / needed) * 0.9;
    throw Error(Exit::resources, fmt::format("a picture of {}x{} needs about {}, {}. Try --size {}x{}, or parts with --crop.",
                                             layout.crop.width(), layout.crop.height(), memorySize(needed), memoryLimitText(s),
                                             std::max(1, int(layout.width * scale)), std::max(1, int(layout.height * scale))));
}

std::vector<float> interleavedBeauty(const Picture& picture) {
    std::vector<float> rgb(picture.window.area() * 3);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < picture.planes[c].size(); ++i) rgb[i * 3 + c] = picture.planes[c][i];
    return rgb;
}

bool anySample(const Film& film) {
    const Rect& r = film.layout().crop;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x)
            if (film.count({x, y}) > 0) return true;
    return false;
}

// Film -> files. Returns what was written.
std::vector<std::filesystem::path> writeOutputs(const RenderSettings& s, const LoadedScene& loaded, const View& view,
                                                const DisplayTransform& display, const Film& film, const Centres& centres,
                                                Rendered& rendered) {
    Picture picture =
        pictureOf(film, s.aov.depth ? std::span<const float>(centres.depth) : std::span<const float>(), {s.aov.albedo, s.aov.normal});
    const std::vector<float> rgb = interleavedBeauty(picture);
    rendered.automaticExposure = !s.exposure;
    rendered.exposure = s.exposure ? *s.exposure : autoExposure(rgb, centres.lamp);
    picture.metadata = recipe(s, loaded, view, display, film, rendered);
    const std::vector<std::filesystem::path> files = outputFiles(s, rendered.result.spp);
    for (const std::filesystem::path& file : files) {
        if (!isExr(file) && s.aov.cost) writeCostPictures(file, picture);
        if (isExr(file))
            writeExr(file, picture);
        else
            writePng(file, picture.window.width(), picture.window.height(), display.bytes(rgb, rendered.exposure), picture.metadata,
                     display.srgb());
    }
    return files;
}

// Beside the PNGs among the files, where the cost was asked for.
std::vector<std::filesystem::path> costFilesOf(const RenderSettings& s, std::span<const std::filesystem::path> files) {
    std::vector<std::filesystem::path> all;
    for (const std::filesystem::path& file : files)
        if (s.aov.cost && !isExr(file))
            for (const std::filesystem::path& cost : costFiles(file)) all.push_back(cost);
    return all;
}

void warnDropped(const RenderSettings& s, const Job& job, const Integrator& integrator, const Film& film) {
    const std::vector<DroppedSample> dropped = film.droppedSamples();
    if (dropped.empty()) return;
    const DroppedSample& first = dropped.front();
    const auto* camera = dynamic_cast<const CameraIntegrator*>(&integrator);
    if (!camera) { // its paths begin elsewhere: no sample of a pixel brings them back
        job.notes.warn(
            fmt::format("{} non-finite samples dropped, the first at pixel {},{}", film.dropped(), first.pixel.x, first.pixel.y));
        return;
    }
    const PathStart start = startPixel(job, first.pixel, first.sample, camera->starts(job));
    std::string material;
    if (start.first) material = job.scene.material(job.scene.point(start.first, start.ray).material).name;
    job.notes.warn(fmt::format("{} non-finite samples dropped{}. Reproduce: {}", film.dropped(),
                               material.empty() ? "" : fmt::format(" (material \"{}\")", material), replayCommand(s, first)));
}

int exitCode(const RenderSettings& s, const RenderResult& result, const Diagnostics& notes) {
    if (result.ended == Ended::stopped) return int(Exit::stopped);
    return s.strict && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

// Scene, view and options are known: renders, writes, tells.
int renderFilm(const RenderSettings& s, const LoadedScene& loaded, const View& view, const std::string& camera,
               const DisplayTransform& display, const Executor& run, Diagnostics& notes, Console& console) {
    const FilmLayout layout{.width = view.width,
                            .height = view.height,
                            .crop = view.crop,
                            .layers = s.classes.layerNames(),
                            .splats = s.integrator.entry->traits(s.integrator.options).splats,
                            .costs = s.aov.cost,
                            .photons = s.aov.photons || (s.aov.all && hasPhotons(s))};
    checkMemory(s, layout);
    Film film(layout);
    StopToken stop;
    const StopOnSignal signals(stop);
    ProgressBar progress(s.progress, s.quiet, s.budget.seconds);
    const Work work{*loaded.scene, s.classes, view.shutter, s.seed, s.sampler, run, stop, progress, notes, memoryLimit(s)};
    const auto begin = std::chrono::steady_clock::now();
    PrepassSolver solver(s.prepass, s.scene);
    const SolvedPrepass solved = solver.solve(work);
    if (solver.choice() && !solved.field) {
        console.line("stopped during the pre-pass; nothing written");
        return int(Exit::killed);
    }
    tellPrepass(solver, solved, console);
    const Job job{work, view, solved.field.get()};
    PreparedOnce integrator(s.integrator.entry->make(s.integrator.options));
    integrator.prepare(job);
    console.facts(notes);
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const Budget budget{s.budget.spp, std::max(0.0, s.budget.seconds - spent)};
    progress.budget(budget.seconds);

    Rendered rendered{.result = render(job, integrator, film, budget, stop), .mean = {}, .camera = camera};
    progress.clear();
    rendered.result.seconds += spent;
    rendered.prepassSeconds = solved.seconds;
    rendered.facts = solved.facts;
    for (const Diagnostics::Fact& f : notes.facts()) rendered.facts.push_back(f);
    if (rendered.result.ended == Ended::stopped && !anySample(film)) {
        console.line("stopped before the first sample was done; nothing written");
        return int(Exit::killed);
    }
    rendered.noise = film.noise();
    rendered.mean = film.meanLuminance();
    warnDropped(s, job, integrator.inner(), film);
    std::vector<std::filesystem::path> files = writeOutputs(s, loaded, view, display, film, seenAtCentres(job), rendered);
    if (!s.photonMap.empty()) writePhotonMap(s, *loaded.scene, integrator.inner(), solved.field.get(), notes);
    console.facts(notes); // what was found while rendering
    console.warnings(notes);
    const int code = exitCode(s, rendered.result, notes);
    const std::vector<std::filesystem::path> costs = costFilesOf(s, files);
    for (const std::filesystem::path& file : costs) console.phase("cost", fmt::format("{}  in false colour", file.string()));
    tellDone(s, display, film, rendered, files, console);
    files.insert(files.end(), costs.begin(), costs.end());
    if (s.json) printSummary(s, loaded, view, display, film, rendered, files, notes, code);
    return code;
}

} // namespace

int runRender(const Arguments& arguments) {
    const RenderSettings s = readSettings(arguments);
    Console console(s.quiet);
    Diagnostics notes;
    const DisplayTransform display(s.ocio, s.view);
    if (!display.note().empty()) notes.warn(display.note());
    const Executor run(s.threads);
    const bool replay = !s.pixel.empty();
    if (!replay) {
        const std::vector<std::filesystem::path> files = outputFiles(s, s.budget.spp);
        for (const std::filesystem::path& file : files) checkWritable(file);
        for (const std::filesystem::path& file : costFilesOf(s, files)) checkWritable(file);
        PrepassSolver(s.prepass, s.scene).checkFile();
        checkPhotons(s);
        if (!s.photonMap.empty()) checkWritable(s.photonMap);
    }

    tellHeader(s, run, console);
    const LoadedScene loaded = loadScene(s.scene, notes);
    CameraDesc camera;
    bool automatic = false;
    const View view = makeView(s, loaded, camera, automatic);
    const std::string cameraName = automatic ? "auto" : camera.name;
    tellScene(s, loaded, cameraName, console);
    tellLens(s.lens, camera.lens, console);
    if (const auto unseen = unseenPaths(*loaded.scene, s.integrator, s.paths, s.prepass.get())) notes.warn(*unseen);
    console.warnings(notes);
    if (replay) return replaySample(s, loaded, view, run, notes, console);
    tellIntegrator(s, view, console);
    return renderFilm(s, loaded, view, cameraName, display, run, notes, console);
}

} // namespace chiaro::cli
