// The course of `chiaro agree`: a pilot that plans the samples (where they are not given), one stage of a fixed design that decides, and,
// for whoever is red in it, a second stage of new seeds and four times the samples at the same alpha. Nothing is looked at twice: the
// pilot's pictures are thrown away and its differences never read, so that alpha is spent once, evenly among the integrators.
#pragma once
#include "tools/cli/agree_settings.h"
#include "tools/cli/agree_verdict.h"

namespace chiaro::cli {

struct Outcome { // of one subject
    Judgement first;
    std::optional<Judgement> second; // of the second stage, where it was needed and done
    bool unconfirmed = false;        // red once, and the second stage was not done
    judge::Verdict verdict() const noexcept;
    std::string text() const;
    const Judgement& last() const noexcept { return second ? *second : first; }
};
struct AgreeRun {
    judge::AgreementSettings rule; // alpha: that of one integrator
    std::optional<Stage> pilot;
    Stage first;
    std::optional<Stage> second;
    std::vector<Outcome> outcomes; // of each subject; empty: stopped before there was anything to tell
    bool stopped = false;
    bool shortOfTime = false; // the plan needed more samples than the time allows
    const Stage& stageOf(std::size_t subject) const { return outcomes[subject].second ? *second : first; }
};

class Console;
AgreeRun runStages(const AgreeSettings&, const std::vector<Subject>&, const Job&, StopToken&, Progress&, const Console&);

// 0 agrees, 1 cannot tell yet, 2 biased or differs: the worst of them.
Exit exitOf(judge::Verdict) noexcept;

} // namespace chiaro::cli
