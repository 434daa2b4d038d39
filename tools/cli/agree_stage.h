// One stage of `chiaro agree`: rounds of replicates. In a round every side, that is every integrator on trial and each path-traced
// reference, renders one whole low-sample picture with a seed of its own; both sides of a comparison have the same samples, which keeps
// the tests safe for skewed noise. A round that is stopped half way does not count. Integrators that are judged on the same light paths
// share one reference.
//
// Seeds: bits 32 to 62 the user's, 24 to 31 the side, 20 to 23 the stage, 0 to 19 the replicate: runs of different seeds share none, nor do
// the replicates of one side. `chiaro render --seed` makes any of them again. A pair shares its seed, the reference's: both sides look
// through the same points of every pixel, and that noise is gone from their difference (common random numbers; Law and Kelton, Simulation
// Modeling and Analysis, ch. 11). Not paired are the reference's own integrator, which would be compared with itself, and the levels of a
// method that converges, whose fit wants independent answers.
#pragma once
#include "core/render/render.h"
#include "integrators/registry.h"
#include "tools/judge/replicates.h"
#include <string>
#include <vector>

namespace chiaro::cli {

class PrepassSolver;

// An integrator on trial.
struct Subject {
    IntegratorChoice choice{nullptr, Options({})};
    Traits traits;
    std::string name;     // with its options: "path:nee=off"
    std::string judgedOn; // the light paths, in words
    PathClasses classes;  // the same as an automaton
    std::size_t reference = 0;
    // The options with which it is rendered: as chosen; for a biased method with a convergence parameter h, also at h s, h s^2, ...
    std::vector<IntegratorChoice> levels;
    std::vector<double> parameter; // h of each level; empty without a convergence parameter
    std::vector<double> weights;   // of the levels in the limit; {1} without
    bool converging() const noexcept { return !parameter.empty(); }
    PrepassSolver* prepass = nullptr; // of the field that it renders with; null: none
    // Where it is the field that converges: that of each level, and who solves it.
    std::vector<PrepassChoice> fields;
    std::vector<PrepassSolver*> solvers;
    PrepassSolver* solver(std::size_t level) const noexcept { return solvers.empty() ? prepass : solvers[level]; }
    bool paired = false; // its replicates share their seeds with the reference's
};
// query: what the user wants (--paths, --max-depth). Error(Exit::usage) where an integrator sees none of it. limits: whether methods with a
// convergence parameter are judged in its limit, at several levels, or as they were chosen. prepass: of those that take one; null: none;
// kept: it is one for all, from a file, and has no limit.
std::vector<Subject> makeSubjects(const std::vector<IntegratorChoice>&, const PathQuery& query, bool limits = true,
                                  const PrepassChoice* prepass = nullptr, bool kept = false);
std::size_t referenceCount(const std::vector<Subject>&);

// Weights a of least squares without errors: sum a_l y_l is the constant of the fit y = c_0 + sum c_k h^(powers_k).
std::vector<double> limitWeights(const std::vector<double>& h, const std::vector<double>& powers);

struct Side {
    explicit Side(uint32_t width, uint32_t height) : replicates(width, height) {}
    judge::Replicates replicates;
    double seconds = 0;
    uint64_t dropped = 0; // non-finite samples left out
    uint64_t firstSeed = 0;
};
struct Trial { // of one subject
    std::vector<Side> levels;
    judge::Replicates limit; // of the extrapolated pictures; of level 0 without a convergence parameter
    double seconds() const noexcept;
    uint64_t dropped() const noexcept;
};
struct Stage {
    uint32_t number = 0, spp = 0, rounds = 0, planned = 0;
    bool stopped = false, timeUp = false;
    double seconds = 0;
    std::vector<Trial> trials;    // of all subjects; without replicates where not asked for
    std::vector<Side> references; // by Subject::reference
};

struct StageRequest {
    uint32_t number = 1, replicates = 32, spp = 16;
    double seconds = infinity;   // no round begins later, but two are always made
    std::vector<bool> takesPart; // a subject
};
// job: its seed and classes are not used. progress: told of all samples of the stage.
Stage renderStage(const Job& job, StopToken&, const std::vector<Subject>&, const StageRequest&, Progress& progress);

} // namespace chiaro::cli
