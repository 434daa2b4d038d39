// Solves pre-passes for a command, or loads them, and hands them to whoever renders with the same key: the scene with all that was changed
// about it, its time, the pre-pass and its options, seed, sampler, instruction set and light paths. Solutions of the seed that was asked
// for last stay in memory, so that integrators of one round share them.
//
// Without a file every seed has a solution of its own: what is random in it is then random between the seeds too, and their spread is an
// honest error. A solution in a file is one for all seeds: its own noise is the same in all of them.
#pragma once
#include "core/render/integrator.h"
#include "core/render/prepass.h"
#include "io/solution_file.h"
#include "tools/cli/prepass_settings.h"
#include "tools/cli/scene_source.h"

namespace chiaro::cli {

struct SolvedPrepass {
    std::shared_ptr<const Prepass> field; // null: stopped, or no pre-pass was asked for
    double seconds = 0;                   // that it took when it was solved, now or before
    bool loaded = false;                  // from the file
    std::vector<Diagnostics::Fact> facts; // told while it was solved or loaded
};

class PrepassSolver {
public:
    PrepassSolver(PrepassSettings, const SceneRequest&);
    const PrepassChoice* choice() const noexcept { return settings_.get(); }
    bool kept() const noexcept { return !settings_.file.empty(); } // one solution for all seeds
    const std::filesystem::path& file() const noexcept { return settings_.file; }
    // Before any work: a file that could not be written later, or one that holds nothing readable, is refused now.
    void checkFile() const;
    // work: its seed is that of the solution. Its progress is told of the phase; its notes of warnings, not of facts. Throws Error: the
    // file belongs to another scene or to other settings (Exit::unsupported), or is damaged (Exit::file).
    SolvedPrepass solve(const Work&);

private:
    struct Kept {
        SolutionKey key;
        SolvedPrepass solved;
    };
    SolutionKey keyOf(const Work&) const;
    bool load(const Work&, const SolutionKey&, Prepass&, SolvedPrepass&) const;

    PrepassSettings settings_;
    std::string scene_, time_;
    std::vector<Kept> kept_;
    uint64_t seed_ = 0;
};

// One line: "radiosity  1.2 s, kept in FILE".
void tellPrepass(const PrepassSolver&, const SolvedPrepass&, const Console&);

} // namespace chiaro::cli
