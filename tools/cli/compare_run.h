// The course of `chiaro compare SCENE`: who takes part and how each is judged, a pilot that says what a sample costs, the references, the
// contest.
#pragma once
#include "tools/cli/compare_contest.h"
#include "tools/cli/compare_input.h"
#include "tools/cli/compare_measure.h"
#include "tools/cli/compare_verdict.h"
#include "tools/cli/console.h"

namespace chiaro::cli {

struct Comparison {
    FilePictures files;
    std::optional<Truth> truth; // the reference
    std::vector<Contestant> contestants;
    std::vector<Judged> judged; // of each contestant
    PathClasses classes;        // of the reference: those of the user, without layers
    std::unique_ptr<ReferenceRender> reference;
    std::vector<std::unique_ptr<ReferenceRender>> restricted; // of each contestant, null where the whole one serves; shared ones once
    std::vector<std::size_t> restrictedOf;                    // index into `restricted`
    ReferenceGoal goal;
    uint32_t seeds = 0;
    const ReferenceSums* restrictedSums(std::size_t contestant) const;
};

std::vector<Contestant> contestantsOf(const CompareSettings&, const Scene&, const View&, std::vector<Judged>&);
// Renders everything; what a stop leaves is in it.
void runComparison(const CompareSettings&, const Job&, StopToken&, Comparison&, Console&);

} // namespace chiaro::cli
