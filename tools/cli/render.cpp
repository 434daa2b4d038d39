// chiaro render: one integrator, one picture.
#include "io/replace_file.h"
#include "tools/cli/checkpointing.h"
#include "tools/cli/ledger.h"
#include "tools/cli/photon_output.h"
#include "tools/cli/picture_output.h"
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
void checkMemory(const RenderSettings& s, const Scene& scene, const FilmLayout& layout) {
    const MemoryBudget& memory = s.scene.memory;
    const double limit = double(memory.beside(scene)), needed = double(layout.bytes());
    if (needed <= limit) return;
    const double scale = std::sqrt(limit / needed) * 0.9;
    throw Error(Exit::resources,
                fmt::format("a picture of {}x{} needs about {}{}, {}. Try --size {}x{}, or parts with --crop.", layout.crop.width(),
                            layout.crop.height(), memorySize(needed), besideText(scene, needed), memory.text(),
                            std::max(1, int(layout.width * scale)), std::max(1, int(layout.height * scale))));
}

bool anySample(const Film& film) {
    const Rect& r = film.layout().crop;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x)
            if (film.count({x, y}) > 0) return true;
    return false;
}

int exitCode(const RenderSettings& s, const RenderResult& result, const Diagnostics& notes) {
    if (result.ended == Ended::stopped) return int(Exit::stopped);
    return s.strict && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

void tellResumed(const RenderSettings& s, const Checkpoint& c, const Console& console) {
    console.phase("resume", fmt::format("{}  samples {}:{}{}, {} so far", s.checkpoint.resume.string(), c.begin, c.done,
                                        c.even ? "" : " and more in some pixels", duration(c.seconds)));
}

// What a resumed render has already; empty: it begins.
struct Earlier {
    std::optional<Checkpoint> checkpoint;
    double seconds() const noexcept { return checkpoint ? checkpoint->seconds : 0; }
    std::unique_ptr<Film> film(const RenderSettings& s, const FilmLayout& layout) {
        if (checkpoint) return std::move(checkpoint->film);
        return std::make_unique<Film>(layout, s.range ? s.range->begin : 0);
    }
};

// All of a run that has a scene and a view.
class Run {
public:
    Run(const RenderSettings& s, const LoadedScene& loaded, const View& view, const CameraDesc& camera, std::string cameraName,
        const DisplayTransform& display, const Executor& run, Diagnostics& notes, Console& console)
        : s_(s), loaded_(loaded), view_(view), display_(display), run_(run), notes_(notes), console_(console),
          key_(renderKey(s, loaded, view, camera)) {
        rendered_.camera = std::move(cameraName);
    }
    int render(Earlier earlier);

private:
    int finish(const Job&, const PreparedOnce&, const Film&, Keeper&, const Prepass*);
    void fill(const Film&);
    bool keep(Keeper&, const Film&, const Integrator&);
    void writeOrKeep(const PictureRequest&, const Film&, Keeper&, const Integrator&);

    const RenderSettings& s_;
    const LoadedScene& loaded_;
    const View& view_;
    const DisplayTransform& display_;
    const Executor& run_;
    Diagnostics& notes_;
    Console& console_;
    FileKey key_;
    Rendered rendered_;
    Exit keepFailed_ = Exit::file;
    bool developed_ = false; // a checkpoint that needed no more samples
};

int Run::render(Earlier earlier) {
    if (earlier.checkpoint) refuseOther(s_.checkpoint.resume, *earlier.checkpoint, key_);
    const FilmLayout layout = filmLayout(s_, view_);
    checkMemory(s_, *loaded_.scene, layout);
    const std::unique_ptr<Film> film = earlier.film(s_, layout);
    StopToken stop;
    const StopOnSignal signals(stop);
    ProgressBar progress(s_.progress, s_.quiet, s_.budget.seconds);
    const Work work{*loaded_.scene, s_.classes, view_.shutter, s_.seed, s_.sampler,
                    run_,           stop,       progress,      notes_,  s_.scene.memory.beside(*loaded_.scene) - layout.bytes()};
    const auto begin = std::chrono::steady_clock::now();
    const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    PrepassSolver solver(s_.prepass, s_.scene);
    const SolvedPrepass solved = solver.solve(work);
    if (solver.choice() && !solved.field) {
        console_.line("stopped during the pre-pass; nothing written");
        return int(Exit::killed);
    }
    tellPrepass(solver, solved, console_);
    const Job job{work, view_, solved.field.get()};
    PreparedOnce integrator(s_.integrator.entry->make(s_.integrator.options));
    integrator.prepare(job);
    if (earlier.checkpoint) {
        if (stop.cancelled()) {
            console_.line(fmt::format("stopped before it went on; {} is as it was", s_.checkpoint.resume.string()));
            return int(Exit::killed);
        }
        loadState(s_.checkpoint.resume, earlier.checkpoint->state, job, integrator);
    }
    console_.facts(notes_);
    const double prepared = spent();
    Budget budget = s_.budget;
    budget.seconds = std::max(0.0, budget.seconds - prepared);
    progress.budget(budget.seconds);
    rendered_.secondsBefore = earlier.seconds();
    rendered_.prepassSeconds = solved.seconds;
    rendered_.facts = solved.facts;
    for (const Diagnostics::Fact& f : notes_.facts()) rendered_.facts.push_back(f);

    Keeper keeper(s_, loaded_, view_, display_, job, key_);
    const Keeping keeping{s_.checkpoint.every, [&] {
                              rendered_.result.seconds = rendered_.secondsBefore + spent();
                              keep(keeper, *film, integrator);
                          }};
    const uint32_t before = earlier.checkpoint ? film->done() : 0;
    rendered_.result = chiaro::render(job, integrator, *film, budget, stop, keeping);
    progress.clear();
    developed_ = earlier.checkpoint && film->done() == before && s_.checkpoint.file == s_.checkpoint.resume;
    rendered_.result.seconds += prepared + rendered_.secondsBefore;
    if (rendered_.result.ended == Ended::stopped && !anySample(*film)) {
        console_.line("stopped before the first sample was done; nothing written");
        return int(Exit::killed);
    }
    return finish(job, integrator, *film, keeper, solved.field.get());
}

void Run::fill(const Film& film) {
    rendered_.result.spp = film.done() - film.begin();
    rendered_.noise = film.noise();
    rendered_.noiseBound = film.noiseBound();
    rendered_.mean = film.meanLuminance();
}

// False, and a warning: it could not be written. The one that was there is whole, and the render goes on.
bool Run::keep(Keeper& keeper, const Film& film, const Integrator& integrator) {
    try {
        keeper.write(film, integrator, rendered_);
        return true;
    } catch (const Error& e) {
        notes_.warn(e.what());
        keepFailed_ = e.code;
    }
    console_.warnings(notes_);
    return false;
}

// Pictures that cannot be written do not cost the render.
void Run::writeOrKeep(const PictureRequest& pictures, const Film& film, Keeper& keeper, const Integrator& integrator) {
    try {
        writePictures(pictures, film, rendered_.exposure, recipe(s_, loaded_, view_, display_, film, rendered_));
    } catch (const Error& e) {
        if (rendered_.checkpoint.empty() && !keep(keeper, film, integrator)) throw;
        throw Error(e.code, fmt::format("{}. The render is kept: chiaro render {} --resume {}", e.what(), shellQuoted(s_.scene.operand),
                                        shellQuoted(s_.checkpoint.file.string())));
    }
}

// The checkpoint first: all else can be made from it.
int Run::finish(const Job& job, const PreparedOnce& integrator, const Film& film, Keeper& keeper, const Prepass* field) {
    fill(film);
    warnDropped(s_, job, integrator.inner(), film);
    const bool stopped = rendered_.result.ended == Ended::stopped;
    const bool wanted = (s_.checkpoint.atEnd && !developed_) || stopped, kept = wanted && keep(keeper, film, integrator);
    if (kept) rendered_.checkpoint = s_.checkpoint.file;
    const PictureRequest pictures{
        outputFiles(s_, rendered_.result.spp), s_.aov, display_, s_.exposure, keeper.centres().depth, keeper.centres().lamp};
    rendered_.automaticExposure = !s_.exposure;
    rendered_.exposure = exposureOf(pictures, film);
    writeOrKeep(pictures, film, keeper, integrator);
    if (!s_.photonMap.empty()) writePhotonMap(s_, *loaded_.scene, integrator.inner(), field, notes_);
    console_.facts(notes_); // what was found while rendering
    console_.warnings(notes_);
    const int code = wanted && !kept ? int(keepFailed_) : exitCode(s_, rendered_.result, notes_);
    std::vector<std::filesystem::path> files = pictures.files;
    const std::vector<std::filesystem::path> costs = costFilesOf(s_.aov, files);
    for (const std::filesystem::path& file : costs) console_.phase("cost", fmt::format("{}  in false colour", file.string()));
    tellDone(s_, display_, film, rendered_, files, console_);
    files.insert(files.end(), costs.begin(), costs.end());
    if (s_.json) printSummary(s_, loaded_, view_, display_, film, rendered_, files, notes_, code);
    return code;
}

void checkOutputs(const RenderSettings& s) {
    const std::vector<std::filesystem::path> files = outputFiles(s, s.budget.spp);
    for (const std::filesystem::path& file : files) checkWritable(file);
    for (const std::filesystem::path& file : costFilesOf(s.aov, files)) checkWritable(file);
    checkWritable(s.checkpoint.file);
    PrepassSolver(s.prepass, s.scene).checkFile();
    checkPhotons(s);
    if (!s.photonMap.empty()) checkWritable(s.photonMap);
}

} // namespace

int runRender(const Arguments& typed) {
    Earlier earlier;
    Arguments arguments = typed;
    if (typed.given("resume")) arguments = continued(typed, readCheckpointHead(typed.text("resume")));
    RenderSettings s = readSettings(arguments);
    Console console(s.quiet);
    Diagnostics notes;
    const DisplayTransform display(s.ocio, s.view);
    if (!display.note().empty()) notes.warn(display.note());
    const Executor run(s.threads);
    const bool replay = !s.pixel.empty();
    if (!replay) checkOutputs(s);

    tellHeader(s, run, console);
    const LoadedScene loaded = loadScene(s.scene, notes, run);
    CameraDesc camera;
    bool automatic = false;
    const View view = makeView(s, loaded, camera, automatic);
    const std::string cameraName = automatic ? "auto" : camera.name;
    tellScene(s, loaded, cameraName, console);
    tellLens(s.lens, camera.lens, console);
    if (const auto unseen = unseenPaths(*loaded.scene, s.integrator, s.paths, s.prepass.get())) notes.warn(*unseen);
    console.warnings(notes);
    if (replay) return replaySample(s, loaded, view, cameraName, run, notes, console);
    if (typed.given("resume")) {
        earlier.checkpoint = readCheckpoint(s.checkpoint.resume, s.scene.memory.beside(*loaded.scene));
        chargeTime(s, typed, *earlier.checkpoint);
    }
    tellIntegrator(s, view, console);
    if (earlier.checkpoint) tellResumed(s, *earlier.checkpoint, console);
    return Run(s, loaded, view, camera, cameraName, display, run, notes, console).render(std::move(earlier));
}

} // namespace chiaro::cli
