#include "tools/cli/agree_verdict.h"
#include "tools/judge/convergence.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using judge::Agreement, judge::AgreementSettings, judge::Verdict;

constexpr double fitShare = 0.25; // of alpha

// Samples for an interval that fits between the bias and the margin.
double samplesToMargin(const Agreement& a, const AgreementSettings& s) {
    const double room = s.margin - std::abs(a.bias[0].relative);
    if (!(a.resolution > 0) || !std::isfinite(a.resolution)) return a.moreSamples;
    const double ratio = room > 0 ? a.resolution / room : 2;
    return std::max({a.moreSamples, std::ceil(a.replicates * s.samplesPerReplicate * (ratio * ratio - 1)), s.samplesPerReplicate});
}

Limit limitOf(const Subject& subject, const Trial& trial, const judge::Replicates& reference, double alpha) {
    Limit limit;
    const std::vector<uint8_t> none(reference.badTiles().size(), 0);
    const judge::Estimate truth = reference.evidence(none).image[0];
    std::vector<judge::FitPoint> points;
    for (std::size_t l = 0; l < subject.levels.size(); ++l) {
        const judge::Estimate at = trial.levels[l].replicates.evidence(none).image[0];
        limit.bias.push_back((at.mean - truth.mean) / std::abs(truth.mean));
        // A method without dice has the rounding of its picture for an error.
        points.push_back({subject.parameter[l] / subject.parameter[0], at.mean, std::max(at.error, 1e-6 * std::abs(at.mean))});
    }
    if (const auto fit = judge::convergesTo(truth, points, subject.traits.convergencePowers, alpha)) limit.fitP = fit->fit.p;
    limit.fits = limit.fitP >= fitShare * alpha;
    return limit;
}

// over: the parameter in whose limit it was judged; empty: none.
Judgement judgeBiased(const std::string& over, Judgement j, const AgreementSettings& s) {
    const Agreement& a = j.agreement;
    const std::string of = over.empty() ? std::string() : fmt::format(" in the limit of {}", over);
    j.moreSamples = 0;
    if (j.limit && !j.limit->fits) {
        j.verdict = Verdict::differs;
        j.text = fmt::format("differs: does not converge over {} as its powers say (residual of the fit p = {:.2g})", over, j.limit->fitP);
    } else if (a.image.significant() && a.equivalenceP > s.alpha) {
        j.verdict = Verdict::biased;
        j.text = judge::describe(a, s) + of;
    } else if (j.limit && a.tiles.significant()) {
        j.verdict = Verdict::differs;
        j.text = fmt::format("differs{}: {} of {} tiles", of, a.tiles.rejected, a.tiles.tests);
    } else if (a.equivalenceP <= s.alpha) {
        j.verdict = Verdict::agrees;
        j.text = fmt::format("agrees{}: the bias lies within {:g} % (p = {:.2g})", of, 100 * s.margin, a.equivalenceP);
    } else {
        j.verdict = Verdict::cannotTell;
        j.moreSamples = samplesToMargin(a, s);
        j.text = fmt::format("cannot tell yet: needs {:.0f} more samples a pixel to place the bias{} within {:g} %", j.moreSamples, of,
                             100 * s.margin);
    }
    return j;
}

} // namespace

Judgement judgement(Agreement a, const AgreementSettings& s) {
    Judgement j;
    j.verdict = a.verdict;
    j.text = judge::describe(a, s);
    j.moreSamples = a.verdict == Verdict::cannotTell ? a.moreSamples : 0;
    j.agreement = std::move(a);
    return j;
}

Judgement judgeEvidence(const Traits& traits, const judge::Evidence& test, const judge::Evidence& reference, const AgreementSettings& s) {
    Judgement j = judgement(judge::decide(test, reference, s), s);
    return traits.unbiased ? j : judgeBiased({}, std::move(j), s);
}

Judgement judgeTrial(const Subject& subject, const Trial& trial, const judge::Replicates& reference, AgreementSettings s) {
    s.paired = subject.paired;
    Judgement j = judgement(judge::agree(trial.limit, reference, s), s);
    if (subject.traits.unbiased) return j;
    if (subject.converging()) j.limit = limitOf(subject, trial, reference, s.alpha);
    return judgeBiased(subject.converging() ? subject.traits.convergesOver : std::string(), std::move(j), s);
}

} // namespace chiaro::cli
