// chiaro compare SCENE|IMAGE...: why do these differ? Side-by-side pictures with numbers, in one page.
#include "core/render/depth.h"
#include "tools/cli/compare_output.h"
#include "tools/cli/compare_results.h"
#include "tools/cli/deliver.h"
#include "tools/cli/report.h"
#include "tools/cli/sheet.h"
#include "tools/cli/signals.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

void checkMemory(const RenderSettings& s, const Scene& scene, const std::vector<Contestant>& contestants, const View& view) {
    const double limit = double(s.scene.memory.beside(scene)), needed = bytesNeeded(contestants, view);
    if (needed <= limit) return;
    const double scale = std::sqrt(limit / needed) * 0.9;
    throw Error(Exit::resources,
                fmt::format("{} pictures of {}x{} need about {}{}, {}. Try --size {}x{}, fewer integrators, or "
                            "--crop.",
                            contestants.size(), view.crop.width(), view.crop.height(), memorySize(needed), besideText(scene, needed),
                            s.scene.memory.text(), std::max(1, int(view.width * scale)), std::max(1, int(view.height * scale))));
}

Json headOf(const CompareSettings& s, const Comparison& c, bool stopped, int code) {
    Json head{{"commit", commit}};
    if (s.hasScene) {
        head["equal"] = std::array{"time", "spp", "noise"}[std::size_t(s.equal)];
        head["seeds"] = c.seeds;
        head["firstSeed"] = s.base.seed;
    }
    head["reference"] = nullptr;
    if (c.truth && c.truth->sums)
        head["reference"] = {{"integrator", "path"},
                             {"replicas", c.truth->sums->replicas()},
                             {"spp", c.truth->sums->spp()},
                             {"seconds", c.truth->sums->seconds()},
                             {"noise", std::isfinite(c.truth->sums->noise()) ? Json(c.truth->sums->noise()) : Json(nullptr)},
                             {"fromCache", c.reference->fromCache()},
                             {"cache", c.reference->file().string()}};
    else if (c.files.reference)
        head["reference"] = {{"file", c.files.reference->file}, {"errors", !c.files.reference->picture.error.empty()}};
    head["prepass"] = s.base.prepass.choice ? Json(prepassRecipe(*s.base.prepass.choice)) : Json(nullptr);
    head["facts"] = Json::array();
    for (const Contestant& x : c.contestants)
        for (const Diagnostics::Fact& f : x.facts)
            head["facts"].push_back({{"integrator", x.name}, {"subject", f.subject}, {"message", f.message}});
    head["stopped"] = stopped;
    head["exitCode"] = code;
    return head;
}

// Everything after rendering: measures, judges, writes, tells.
int finish(const CompareSettings& s, const Comparison& c, const SceneContext* context, const DisplayTransform& display, bool stopped,
           Diagnostics& notes, Console& console) {
    const Told told = makeReport(s, c, context, notes);
    const report::Report& r = told.report;
    const int code = stopped ? int(Exit::stopped) : s.base.strict && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
    std::vector<std::filesystem::path> files;
    if (context) files = writePictures(s, c, *context, display, r.exposure, !s.base.exposure);
    const std::string csv = compareCsv(r), json = compareJson(r, told.stands, told.rule, headOf(s, c, stopped, code));
    Console quiet(true);
    deliver((s.folder / "results.csv").string(), csv, quiet);
    deliver((s.folder / "results.json").string(), json, quiet);
    const report::WrittenReport page = report::writeReport(r, s.folder / "report.html");
    writeSheet(r, s.folder / "sheet.png", display);
    console.warnings(notes);
    console.phase("exposure", fmt::format("{:g}{}, one for all      keep it with: --exposure {:g}", r.exposure,
                                          s.base.exposure ? "" : " (auto)", r.exposure));
    for (const std::string& reduced : page.reductions) console.phase("reduced", reduced);
    if (!files.empty())
        console.phase("wrote", fmt::format("{} EXRs in {}  linear Rec.709 float32, 1.0 = 1 cd/m2", files.size(), s.folder.string()));
    console.phase("wrote", fmt::format("{}, results.json, sheet.png", (s.folder / "results.csv").string()));
    console.phase("wrote",
                  fmt::format("{}  {}, open it in a browser", (s.folder / "report.html").string(), memorySize(double(page.bytes))));
    const bool forPrograms = s.csv == "-" || s.json == "-";
    if (!forPrograms) fmt::print("{}", compareTable(r));
    deliver(s.csv, csv, console);
    deliver(s.json, json, console);
    return code;
}

int compareFiles(const CompareSettings& s, const DisplayTransform& display, Diagnostics& notes, Console& console) {
    Comparison c;
    c.files = loadPictures(s, nullptr, notes);
    if (c.files.reference) c.truth = Truth{c.files.reference->picture, nullptr};
    prepareFolder(s, {});
    return finish(s, c, nullptr, display, false, notes, console);
}

int compareScene(const CompareSettings& s, const DisplayTransform& display, Diagnostics& notes, Console& console) {
    const Executor run(s.base.threads);
    tellHeader(s.base, run, console);
    const LoadedScene loaded = loadScene(s.base.scene, notes, run);
    CameraDesc camera;
    bool automatic = false;
    View view = makeView(s.base, loaded, camera, automatic);
    Comparison c;
    c.files = loadPictures(s, &view, notes);
    view.crop = c.files.area;
    if (c.files.reference) c.truth = Truth{c.files.reference->picture, nullptr};
    PathQuery unsplit = s.base.paths;
    unsplit.split.clear();
    c.classes = PathClasses::make(unsplit);
    c.contestants = contestantsOf(s, *loaded.scene, view, c.judged);
    checkMemory(s.base, *loaded.scene, c.contestants, view);
    prepareFolder(s, c.contestants);
    const std::string cameraName = automatic ? "auto" : camera.name;
    tellScene(s.base, loaded, cameraName, console);
    console.warnings(notes);

    StopToken stop;
    const StopOnSignal signals(stop);
    Progress silent;
    const Job job{{*loaded.scene, c.classes, view.shutter, s.base.seed, s.base.sampler, run, stop, silent, notes,
                   s.base.scene.memory.beside(*loaded.scene)},
                  view,
                  nullptr};
    runComparison(s, job, stop, c, console);
    const bool any = std::any_of(c.contestants.begin(), c.contestants.end(), [](const Contestant& x) { return x.film != nullptr; });
    if (stop.cancelled() && !any && c.files.pictures.empty()) {
        console.line("stopped before the first sample was done; nothing written");
        return int(Exit::killed);
    }
    if (stop.cancelled()) console.line("stopped; what there is is measured and written (Ctrl-C again: nothing is)");
    Centres centres = seenAtCentres(job);
    const SceneContext context{loaded, view, cameraName, run, std::move(centres.depth), std::move(centres.lamp)};
    return finish(s, c, &context, display, stop.cancelled(), notes, console);
}

} // namespace

int runCompare(const Arguments& arguments) {
    const CompareSettings s = readCompareSettings(arguments);
    checkTextOutputs(std::array{s.csv, s.json});
    Console console(s.base.quiet);
    Diagnostics notes;
    const DisplayTransform display(s.base.ocio, s.base.view);
    if (!display.note().empty()) notes.warn(display.note());
    return s.hasScene ? compareScene(s, display, notes, console) : compareFiles(s, display, notes, console);
}

} // namespace chiaro::cli
