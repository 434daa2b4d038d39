// chiaro agree SCENE, or A.exr B.exr: do they agree? A statistical verdict, and an exit code.
#include "tools/cli/agree_map.h"
#include "tools/cli/agree_options.h"
#include "tools/cli/agree_report.h"
#include "tools/cli/deliver.h"
#include "tools/cli/diff.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/report.h"
#include "tools/cli/signals.h"
#include "tools/cli/unseen_paths.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;
constexpr uint32_t standardWidth = 96;

void checkOutputs(const AgreeSettings& s, const std::vector<std::string>& fileNames) {
    prepareMaps(s.outputs, fileNames);
    checkTextOutputs(std::array{s.csv, s.json});
}

void tell(const AgreeSettings& s, const std::vector<AgreeRow>& rows, Json head, int code, const Console& console) {
    const bool forPrograms = s.csv == "-" || s.json == "-";
    if (!forPrograms) fmt::print("{}\n{}", agreeTable(rows), agreeVerdicts(rows));
    if (forPrograms && !s.base.quiet) fmt::print(stderr, "{}", agreeVerdicts(rows));
    Json all = std::move(head);
    all["integrators"] = Json::array();
    for (const AgreeRow& r : rows) all["integrators"].push_back(agreeJson(r));
    all["exitCode"] = code;
    deliver(s.csv, agreeCsv(rows), console);
    deliver(s.json, all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", console);
}

View smallView(const AgreeSettings& s, const LoadedScene& loaded, CameraDesc& camera, bool& automatic) {
    if (!s.base.size.empty()) return makeView(s.base, loaded, camera, automatic);
    RenderSettings sized = s.base;
    sized.crop.clear();
    const View full = makeView(sized, loaded, camera, automatic);
    if (sized.lens) sized.lens.focus = fmt::format("{}", camera.lens.focus); // a pixel is one of the full picture
    const double height = std::max(1.0, std::round(double(standardWidth) * full.height / full.width));
    sized.size = fmt::format("{}x{}", standardWidth, uint32_t(std::min(height, 65536.0)));
    sized.crop = s.base.crop;
    return makeView(sized, loaded, camera, automatic);
}

void checkMemory(const RenderSettings& settings, const Scene& scene, const View& view, const std::vector<Subject>& subjects) {
    double sides = double(referenceCount(subjects));
    for (const Subject& s : subjects) sides += double(s.levels.size()) + 1;
    constexpr double bytesAPixel = 40; // of a side: what it accumulates, and its picture of the round
    const FilmLayout layout{.width = view.width, .height = view.height, .crop = view.crop, .layers = {}, .splats = true};
    const double needed = double(layout.bytes()) + sides * bytesAPixel * double(view.crop.area());
    const MemoryBudget& memory = settings.scene.memory;
    if (needed > double(memory.beside(scene)))
        throw Error(Exit::resources, fmt::format("{}x{} pixels need about {}{}, {}. Try a smaller --size.", view.crop.width(),
                                                 view.crop.height(), memorySize(needed), besideText(scene, needed), memory.text()));
}

std::vector<std::string> notesOn(const Subject& s, const Outcome& o, const AgreeRow& row, const Scene& scene, const PathQuery& query) {
    std::vector<std::string> notes;
    if (const auto unseen = unseenPaths(scene, s.choice, query, s.prepass ? s.prepass->choice() : nullptr))
        notes.push_back("left out of both sides: " + *unseen);
    if (o.second && !o.second->red())
        notes.push_back(fmt::format("red in the first stage ({}), not in the second", o.first.text));
    else if (o.second)
        notes.push_back(fmt::format("confirmed with new seeds and four times the samples; first: {}", o.first.text));
    if (!s.traits.unbiased && !s.converging())
        notes.push_back("biased by nature, and without a convergence parameter: only its mean is judged");
    if (s.converging())
        for (std::size_t l = 0; l < s.parameter.size(); ++l)
            notes.push_back(fmt::format("{}={:.4g}: bias {:+.2g} %", s.traits.convergesOver, s.parameter[l],
                                        100 * (o.last().limit ? o.last().limit->bias[l] : 0)));
    if (row.dropped + row.referenceDropped > 0)
        notes.push_back(fmt::format("{} non-finite samples left out, {} of the reference", row.dropped, row.referenceDropped));
    return notes;
}

std::vector<AgreeRow> rowsOf(const AgreeSettings& s, const std::vector<Subject>& subjects, const AgreeRun& run, const Scene& scene) {
    std::vector<AgreeRow> rows;
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        const Outcome& o = run.outcomes[i];
        const Stage& stage = run.stageOf(i);
        const Side& reference = stage.references[subjects[i].reference];
        AgreeRow row;
        row.name = subjects[i].name;
        row.judgedOn = subjects[i].judgedOn;
        row.verdict = o.verdict();
        row.text = o.text();
        row.judgement = o.last();
        row.rule = run.rule;
        row.rule.samplesPerReplicate = stage.spp;
        row.rule.paired = subjects[i].paired;
        row.samples = double(stage.rounds) * stage.spp;
        row.seconds = stage.trials[i].seconds();
        row.referenceSeconds = reference.seconds;
        row.dropped = stage.trials[i].dropped();
        row.referenceDropped = reference.dropped;
        row.notes = notesOn(subjects[i], o, row, scene, s.base.paths);
        rows.push_back(std::move(row));
    }
    return rows;
}

Json stageJson(const Stage& stage, const std::vector<Subject>& subjects) {
    Json j{
        {"stage", stage.number}, {"replicates", stage.rounds}, {"planned", stage.planned}, {"spp", stage.spp}, {"seconds", stage.seconds}};
    j["firstSeeds"] = Json::object();
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        Json levels = Json::array();
        for (const Side& side : stage.trials[i].levels)
            if (side.replicates.count() > 0) levels.push_back(side.firstSeed);
        if (!levels.empty())
            j["firstSeeds"][subjects[i].name] = {{"levels", levels}, {"reference", stage.references[subjects[i].reference].firstSeed}};
    }
    return j;
}

Json headJson(const AgreeSettings& s, const View& view, const std::vector<Subject>& subjects, const AgreeRun& run) {
    Json head{{"command", s.base.arguments->line},
              {"version", version},
              {"scene", s.base.scene.operand},
              {"size", {view.width, view.height}},
              {"window", {view.crop.x0, view.crop.y0, view.crop.width(), view.crop.height()}},
              {"prepass", s.base.prepass.choice ? Json(prepassRecipe(*s.base.prepass.choice)) : Json(nullptr)},
              {"seed", s.base.seed},
              {"sampler", samplerName(s.base.sampler)},
              {"filter", filterName(s.base.filter)},
              {"alpha", s.rule.alpha},
              {"margin", s.rule.margin},
              {"reference", referenceName},
              {"stopped", run.stopped}};
    head["stages"] = Json::array();
    if (run.pilot) head["stages"].push_back(stageJson(*run.pilot, subjects));
    head["stages"].push_back(stageJson(run.first, subjects));
    if (run.second) head["stages"].push_back(stageJson(*run.second, subjects));
    return head;
}

int worst(const std::vector<AgreeRow>& rows) {
    int code = 0;
    for (const AgreeRow& r : rows) code = std::max(code, int(exitOf(r.verdict)));
    return code;
}

// The command that gives every verdict the samples that it lacks.
void tellNext(const AgreeSettings& s, const std::vector<AgreeRow>& rows, const Console& console) {
    double most = 0;
    for (const AgreeRow& r : rows)
        if (r.verdict == judge::Verdict::cannotTell && std::isfinite(r.judgement.moreSamples) && r.samples > 0)
            most = std::max(most, (r.samples + r.judgement.moreSamples) / s.replicates);
    if (most == 0 || most > 1e8) return;
    std::string line = "chiaro agree " + shellQuoted(s.base.scene.operand);
    for (const OptionRow& o : s.base.arguments->command->options) {
        if (!s.base.arguments->given(o.name) || o.name == "spp" || o.name == "time" || o.group == agree_groups::output) continue;
        line += o.letter ? fmt::format(" -{}", o.letter) : fmt::format(" --{}", o.name);
        if (!o.metavar.empty()) line += " " + shellQuoted(s.base.arguments->text(o.name));
    }
    console.phase("next", fmt::format("{} --spp {:.0f}", line, std::ceil(1.1 * most)));
}

std::vector<std::string> fileNamesOf(const AgreeSettings& s) {
    std::vector<std::string> names;
    for (const IntegratorChoice& c : s.integrators) names.push_back(fileName(c));
    return names;
}

void writeMaps(const AgreeSettings& s, const View& view, const std::vector<Subject>& subjects, const AgreeRun& run,
               const Console& console) {
    const std::vector<std::string> names = fileNamesOf(s);
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        const Stage& stage = run.stageOf(i);
        const AgreeMap map{subjects[i].name,
                           "reference",
                           view.width,
                           view.height,
                           view.crop,
                           &run.outcomes[i].last().agreement,
                           &stage.trials[i].limit,
                           &stage.references[subjects[i].reference].replicates};
        for (const std::filesystem::path& file : mapFiles(s.outputs, names[i])) {
            writeMap(file, map);
            console.phase("wrote",
                          fmt::format("{}  where {} differs, full colour at {:g} standard errors", file.string(), map.name, mapScale));
        }
    }
}

int agreeScene(const AgreeSettings& s) {
    Console console(s.base.quiet);
    Diagnostics notes;
    PrepassSolver prepass(s.base.prepass, s.base.scene);
    prepass.checkFile();
    std::vector<Subject> subjects = makeSubjects(s.integrators, s.base.paths, true, prepass.choice(), prepass.kept());
    std::vector<std::unique_ptr<PrepassSolver>> solvers;
    for (Subject& subject : subjects) {
        if (prepassFor(subject.choice, prepass.choice())) subject.prepass = &prepass;
        for (const PrepassChoice& field : subject.fields)
            subject.solvers.push_back(
                solvers.emplace_back(std::make_unique<PrepassSolver>(PrepassSettings{field, {}}, s.base.scene)).get());
    }
    checkOutputs(s, fileNamesOf(s));
    const Executor executor(s.base.threads);
    tellHeader(s.base, executor, console);
    const LoadedScene loaded = loadScene(s.base.scene, notes, executor);
    CameraDesc camera;
    bool automatic = false;
    const View view = smallView(s, loaded, camera, automatic);
    checkMemory(s.base, *loaded.scene, view, subjects);
    tellScene(s.base, loaded, automatic ? "auto" : camera.name, console);
    console.warnings(notes);
    console.phase("agree",
                  fmt::format("{}x{}, {} on trial against {}, alpha {:g}{}, margin {:g} %, seed {}", view.crop.width(), view.crop.height(),
                              subjects.size(), referenceName, s.rule.alpha,
                              subjects.size() > 1 ? fmt::format(" ({:g} each)", s.rule.alpha / double(subjects.size())) : std::string(),
                              100 * s.rule.margin, s.base.seed));

    if (prepass.choice())
        console.phase("prepass", fmt::format("{} for {}{}", prepassRecipe(*prepass.choice()), takersText(s.integrators),
                                             prepass.kept() ? "; one solution for all replicates: what is random in it counts as bias"
                                                            : "; a solution for each replicate"));

    StopToken stop;
    const StopOnSignal signals(stop);
    ProgressBar progress(s.base.progress, s.base.quiet, infinity);
    const Job job{{*loaded.scene, s.base.classes, view.shutter, s.base.seed, s.base.sampler, executor, stop, progress, notes,
                   s.base.scene.memory.beside(*loaded.scene)},
                  view};
    const AgreeRun run = runStages(s, subjects, job, stop, progress, console);
    progress.clear();
    console.facts(notes);
    console.warnings(notes);
    if (run.outcomes.empty()) {
        console.line("stopped before the second replicate was done; nothing to tell");
        return int(Exit::killed);
    }
    const std::vector<AgreeRow> rows = rowsOf(s, subjects, run, *loaded.scene);
    const int code = run.stopped                                                      ? int(Exit::stopped)
                     : s.base.strict && worst(rows) == 0 && !notes.warnings().empty() ? int(Exit::warning)
                                                                                      : worst(rows);
    if (run.stopped) console.line(fmt::format("stopped at {}/{} replicates of {} spp", run.first.rounds, run.first.planned, run.first.spp));
    Json head = headJson(s, view, subjects, run);
    head["facts"] = factsJson(notes.facts());
    tell(s, rows, std::move(head), code, console);
    writeMaps(s, view, subjects, run, console);
    if (!run.stopped) tellNext(s, rows, console);
    return code;
}

int agreeImages(const AgreeSettings& s) {
    const Arguments& a = *s.base.arguments;
    checkOutputs(s, {"agree"});
    Console console(s.base.quiet);
    Diagnostics notes;
    DiffSettings files;
    files.fileA = a.operands[0];
    files.fileB = a.operands[1];
    files.crop = s.base.crop;
    const DiffInputs in = loadDiffInputs(files, notes);
    AgreeRow row;
    row.name = files.fileA;
    row.judgedOn = "against " + files.fileB;
    row.rule = s.rule;
    row.judgement = judgement(judge::agree(in.a.picture, in.b.picture, in.region, s.rule), s.rule);
    // One picture is one replicate of however many samples: what it lacks is a factor.
    const judge::Agreement& agreement = row.judgement.agreement;
    row.verdict = row.judgement.verdict;
    row.text = row.judgement.text;
    if (row.verdict == judge::Verdict::cannotTell && std::isfinite(row.judgement.moreSamples) && agreement.compared > 0)
        row.text = fmt::format("cannot tell yet: needs {:.0f} more samples for each that both have to see a bias of {:g} % (now {:.2g} %)",
                               row.judgement.moreSamples, 100 * s.rule.margin, 100 * agreement.resolution);
    if (agreement.tilesLeftOut > 0)
        row.notes.push_back(fmt::format("{} tiles with values or errors that are not finite were left out", agreement.tilesLeftOut));
    console.warnings(notes);
    const int code = worst({row});
    tell(s, {row},
         {{"command", a.line},
          {"version", version},
          {"images", {files.fileA, files.fileB}},
          {"alpha", s.rule.alpha},
          {"margin", s.rule.margin}},
         code, console);
    const AgreeMap map{files.fileA, files.fileB, in.a.width, in.a.height, in.area, &agreement, nullptr, nullptr};
    for (const std::filesystem::path& file : mapFiles(s.outputs, "agree")) {
        writeMap(file, map);
        console.phase("wrote", fmt::format("{}  full colour at {:g} standard errors", file.string(), mapScale));
    }
    return code;
}

} // namespace

int runAgree(const Arguments& arguments) {
    const AgreeSettings settings = readAgreeSettings(arguments);
    return comparesImages(arguments) ? agreeImages(settings) : agreeScene(settings);
}

} // namespace chiaro::cli
