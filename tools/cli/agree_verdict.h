// From the replicates of one stage to the verdict on one integrator.
//
// Unbiased methods: judge::decide, the rule at three scales. Biased methods are not expected to be equal, so that they are asked for less
// and told more: the mean must lie inside the margin (two one-sided tests at alpha). With a convergence parameter h it is the mean of the
// limit h -> 0 that must, together with the tiles of the limit (a quarter of alpha) and the fit in powers of h, whose residual must be
// chance (the quarter that is the pixels' otherwise: beside an edge no power of h holds for one pixel).
#pragma once
#include "tools/cli/agree_stage.h"
#include "tools/judge/agreement.h"
#include <optional>

namespace chiaro::cli {

struct Limit {                // of a converging method
    std::vector<double> bias; // relative, of the mean luminance at each level
    double fitP = 1;          // that the residual of the fit arises by chance
    bool fits = true;
};
struct Judgement {
    judge::Verdict verdict = judge::Verdict::cannotTell;
    std::string text;           // "agrees: ..."
    judge::Agreement agreement; // of the limit, for a converging method
    std::optional<Limit> limit;
    double moreSamples = 0; // a pixel and side; 0: none
    bool red() const noexcept { return verdict == judge::Verdict::biased || verdict == judge::Verdict::differs; }
};
Judgement judgeTrial(const Subject&, const Trial&, const judge::Replicates& reference, judge::AgreementSettings);
// One subject as it was chosen, without a limit, by what is known of both sides; tiles to be left out are out of both.
Judgement judgeEvidence(const Traits&, const judge::Evidence& test, const judge::Evidence& reference, const judge::AgreementSettings&);
// Pictures, or replicates of a biased method without a parameter: what `judge` says becomes a verdict.
Judgement judgement(judge::Agreement, const judge::AgreementSettings&);

} // namespace chiaro::cli
