#include "tools/cli/prepass_solver.h"
#include "io/replace_file.h"
#include "tools/cli/settings.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

// What decides a solution, and what it is called where another one is found. "scene" is what the user called it: told, not compared.
struct Part {
    std::string_view name, told;
};
constexpr Part parts[] = {
    {"version", "by chiaro"}, {"prepass", "as --prepass"},   {"time", "at --frame-time"}, {"shutter", "with the shutter"},
    {"seed", "with --seed"},  {"sampler", "with --sampler"}, {"isa", "with --isa"},
};

std::string difference(const SolutionKey& stored, const SolutionKey& wanted) {
    std::vector<std::string> all;
    for (const Part& p : parts)
        if (valueOf(stored, p.name) != valueOf(wanted, p.name))
            all.push_back(fmt::format("{} {}, not {}", p.told, valueOf(stored, p.name), valueOf(wanted, p.name)));
    return fmt::format("{}", fmt::join(all, "; "));
}

void refuseOthers(const std::filesystem::path& file, const SolutionKey& stored, const SolutionKey& wanted) {
    if (valueOf(stored, "hash") != valueOf(wanted, "hash"))
        throw Error(Exit::unsupported,
                    fmt::format("{}: solved for another scene ({} {}), this one is {} {}. Give another --prepass-file, or delete it",
                                file.string(), valueOf(stored, "scene"), valueOf(stored, "hash"), valueOf(wanted, "scene"),
                                valueOf(wanted, "hash")));
    if (const std::string what = difference(stored, wanted); !what.empty())
        throw Error(Exit::unsupported, fmt::format("{}: solved {}. Ask for the same, or give another --prepass-file", file.string(), what));
}

std::string oneLine(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
    return text;
}

} // namespace

PrepassSolver::PrepassSolver(PrepassSettings settings, const SceneRequest& scene)
    : settings_(std::move(settings)), scene_(oneLine(scene.operand)),
      time_(fmt::format("{}{}", scene.frameTime, scene.animation.empty() ? "" : " of " + oneLine(scene.animation))) {}

void PrepassSolver::checkFile() const {
    if (!kept() || !choice()) return;
    std::error_code ignored;
    if (std::filesystem::exists(file(), ignored))
        readSolutions(file());
    else
        checkWritable(file());
}

SolutionKey PrepassSolver::keyOf(const Work& work) const {
    return {{"scene", scene_},
            {"hash", fmt::format("{:016x}", work.scene.hash())},
            {"version", std::string(version)},
            {"prepass", prepassRecipe(*choice())},
            {"time", time_},
            {"shutter", fmt::format("{}:{}", work.shutter.open, work.shutter.close)},
            {"seed", fmt::format("{}", work.seed)},
            {"sampler", samplerName(work.sampler)},
            {"isa", work.scene.isa()},
            {"paths", fmt::format("{:016x}", work.classes.hash())}};
}

bool PrepassSolver::load(const Work& work, const SolutionKey& key, Prepass& prepass, SolvedPrepass& solved) const {
    std::error_code ignored;
    if (!kept() || !std::filesystem::exists(file(), ignored)) return false;
    for (const StoredSolution& s : readSolutions(file())) {
        refuseOthers(file(), s.key, key);
        if (valueOf(s.key, "paths") != valueOf(key, "paths")) continue;
        loadSolution(file(), s, [&](Reader& reader) { prepass.load(work, reader); });
        solved.seconds = s.seconds;
        return solved.loaded = true;
    }
    return false;
}

SolvedPrepass PrepassSolver::solve(const Work& work) {
    if (!choice()) return {};
    const SolutionKey key = keyOf(work);
    if (work.seed != seed_) kept_.clear();
    seed_ = work.seed;
    for (const Kept& k : kept_)
        if (k.key == key) return k.solved;
    SolvedPrepass solved;
    Diagnostics own; // its facts are this solution's
    const Work told{work.scene, work.classes, work.shutter,  work.seed, work.sampler,
                    work.run,   work.stop,    work.progress, own,       work.memoryLimit};
    const std::shared_ptr<Prepass> prepass = choice()->entry->make(choice()->options);
    if (!load(told, key, *prepass, solved)) {
        work.progress.phase(fmt::format("pre-pass {}", prepassRecipe(*choice())));
        const auto begin = std::chrono::steady_clock::now();
        prepass->solve(told);
        solved.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (work.stop.cancelled()) return {};
        if (kept()) addSolution(file(), key, solved.seconds, [&](Writer& writer) { prepass->save(writer); });
    }
    for (const std::string& warning : own.warnings()) work.notes.warn(warning);
    solved.facts = own.facts();
    solved.field = prepass;
    kept_.push_back({key, solved});
    return solved;
}

void tellPrepass(const PrepassSolver& solver, const SolvedPrepass& solved, const Console& console) {
    if (!solved.field) return;
    const std::string kept = !solver.kept()  ? std::string("      keep it with: --prepass-file FILE")
                             : solved.loaded ? fmt::format(" when it was solved; loaded from {}", solver.file().string())
                                             : fmt::format("; kept in {}", solver.file().string());
    console.phase("prepass", fmt::format("{}  {}{}", prepassRecipe(*solver.choice()), duration(solved.seconds), kept));
    for (const Diagnostics::Fact& f : solved.facts) console.phase(f.subject, f.message);
}

} // namespace chiaro::cli
