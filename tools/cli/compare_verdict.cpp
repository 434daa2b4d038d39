#include "tools/cli/compare_verdict.h"
#include "core/math/vec.h"
#include "core/render/path_expression_dfa.h"
#include "materials/possible_events.h"
#include "tools/cli/agree_settings.h"
#include "tools/cli/film_picture.h"
#include "tools/cli/unseen_paths.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using judge::Verdict;
using report::Standing;

std::vector<uint8_t> either(std::vector<uint8_t> a, const std::vector<uint8_t>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] |= b[i];
    return a;
}

Standing standingFor(Verdict v) noexcept {
    switch (v) {
    case Verdict::agrees: return Standing::agrees;
    case Verdict::biased: return Standing::biased;
    case Verdict::differs: return Standing::differs;
    case Verdict::cannotTell: return Standing::cannotTell;
    }
    return Standing::unjudged;
}

std::string percentOf(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

// "cannot tell yet" as a number of times what was spent.
std::string sentence(const Judgement& j, const judge::AgreementSettings& rule) {
    if (j.verdict != Verdict::cannotTell || !(j.moreSamples > 0) || !std::isfinite(j.moreSamples)) return j.text;
    const double spent = j.agreement.replicates * rule.samplesPerReplicate;
    return fmt::format("noisy: cannot tell yet, {:.1f} times the samples would show a bias of {} (now {})", 1 + j.moreSamples / spent,
                       percentOf(rule.margin), percentOf(j.agreement.resolution));
}

judge::AgreementSettings ruleOf(const Contestant& c, judge::AgreementSettings rule) {
    rule.samplesPerReplicate = c.spp() / std::max(1u, c.wholeSeeds());
    return rule;
}

// Unlike `agree`, a comparison gives its sides unequal samples, under which single pixels with a rare bright sample on one side alone pass
// for wrong: here pixels speak only when more of them stand out (p < 0.001) than chance allows.
Judgement withoutStrays(Judgement j) {
    const judge::Agreement& a = j.agreement;
    if (j.verdict != Verdict::differs || a.tiles.significant() || a.outliers > a.outlierBounds.high) return j;
    j.verdict = Verdict::cannotTell;
    j.moreSamples = 0;
    j.text = fmt::format("noisy: {} of {} pixels stand out, which rare bright samples may be; chiaro agree decides, with equal samples",
                         a.pixels.rejected, a.pixels.tests);
    return j;
}

Judgement judgeBy(const Contestant& c, const Truth& truth, const judge::AgreementSettings& rule) {
    const std::vector<uint8_t> bad = either(c.judged.badTiles(), truth.badTiles());
    return withoutStrays(judgeEvidence(c.traits, c.judged.evidence(bad), truth.evidence(bad), ruleOf(c, rule)));
}

double meanOf(const ReferenceSums& sums) {
    const std::vector<uint8_t> none(sums.luminance().badTiles().size(), 0);
    return sums.luminance().evidence(none).image[0].mean;
}

// Light that it shows on paths that it does not cover, or on none: the layers "rest" and "other" of howJudged's split. What the reference
// cannot see, "left-out", is none of its approximations.
double ownLight(const Contestant& c) {
    if (!c.film || c.judgedLayer < 0) return 0;
    double sum = 0;
    const std::vector<std::string>& names = c.classes.layerNames();
    for (std::size_t l = 0; l < names.size(); ++l)
        if (names[l] == "rest" || names[l] == "other") sum += meanLuminance(judgedLayer(*c.film, int(l), names[l]));
    return sum;
}

// "leaves out La D D E and the like (46 % of the mean) and adds approximated light of its own: 26 %; on what it covers: agrees: ..."
void tellMissing(Stands& s, const Contestant& c, const Truth* whole, const ReferenceSums* restricted) {
    constexpr double least = 1e-3; // of the mean, worth a word
    std::string share, own;
    if (whole && restricted) {
        const std::vector<uint8_t> none(restricted->luminance().badTiles().size(), 0);
        if (const double all = whole->evidence(none).image[0].mean; all > 0) {
            s.missingShare = 1 - meanOf(*restricted) / all;
            s.ownShare = ownLight(c) / all;
            share = fmt::format(" ({} of the mean)", percentOf(*s.missingShare));
            if (*s.ownShare > least) own = fmt::format(" and adds approximated light of its own: {}", percentOf(*s.ownShare));
        }
    }
    const std::string what = fmt::format("different by definition: leaves out {} and the like{}{}", s.missing, share, own);
    if (s.standing == Standing::agrees || s.standing == Standing::cannotTell || s.standing == Standing::unjudged)
        s.standing = Standing::missesPaths;
    s.text = s.text.empty() ? what : fmt::format("{}; on what it covers: {}", what, s.text);
}

} // namespace

std::vector<uint8_t> Truth::badTiles() const { return sums ? sums->luminance().badTiles() : judge::badTiles(picture, {}); }
judge::Evidence Truth::evidence(const std::vector<uint8_t>& leftOut) const {
    return sums ? sums->luminance().evidence(leftOut) : judge::evidenceOf(picture, {}, leftOut);
}

Judged howJudged(const IntegratorChoice& choice, const Scene& scene, const PathQuery& query, const PrepassChoice* prepass) {
    const Traits traits = traitsWith(choice, prepass);
    Judged j;
    if (!traits.lightTransport) {
        j.covers = "no light: a debug view";
        return j;
    }
    j.covers = traits.covers + (traits.misses.empty() ? "" : " without " + traits.misses);
    j.missing = unseenPath(scene, traits, query).value_or("");
    const IntegratorChoice path = chooseIntegrator(referenceName);
    const PathsPresent present{LetterSet(possibleLetters(scene) | eyeLetter), query.maxDepth};
    const std::string hidden = path.entry->traits(path.options).misses;
    if (firstCommon(query.paths, hidden, present) && firstCommon(traits.covers, hidden, present))
        j.beyond = firstMissing(hidden, traits.misses, present).value_or("");
    if (!j.missing.empty() || !j.beyond.empty()) {
        for (const std::string& leftOut : {traits.misses, hidden})
            if (!leftOut.empty()) j.split += (j.split.empty() ? "left-out=" : "|") + leftOut;
        j.split += fmt::format("{}covered={},rest", j.split.empty() ? "" : ",", traits.covers);
    }
    PathQuery unsplit = query;
    unsplit.split.clear();
    try {
        j.subject = makeSubjects({choice}, unsplit, false, prepass).front();
    } catch (const Error&) { j.missing = j.missing.empty() ? "all that is asked for" : j.missing; }
    return j;
}

judge::AgreementSettings judgeRule(std::size_t judged) {
    judge::AgreementSettings rule; // those of `agree`
    rule.alpha /= double(std::max<std::size_t>(1, judged));
    return rule;
}

Stands standingOf(const Contestant& c, const Judged& how, const Truth* whole, const ReferenceSums* restricted,
                  const judge::AgreementSettings& rule) {
    Stands s;
    s.missing = how.missing;
    if (!c.traits.lightTransport) {
        s.standing = Standing::debug;
        s.text = "a debug view: its picture is not light, nothing to judge";
        return s;
    }
    const bool twoSeeds = c.wholeSeeds() >= 2;
    if (whole && whole->hasErrors() && twoSeeds && c.judgedLayer < 0) s.z = judgeBy(c, *whole, rule).agreement.pixelZ;
    Truth own;
    own.sums = restricted;
    const Truth* by = how.restricted() ? (restricted ? &own : nullptr) : whole;
    if (!whole)
        s.text = "no reference: not judged";
    else if (!twoSeeds)
        s.text = "one seed shows no spread: not judged; give --seeds 2 or more";
    else if (!how.subject)
        s.text.clear();
    else if (!by)
        s.text = "not judged: the reference is a picture of all paths";
    else if (!by->hasErrors())
        s.text = "not judged: the reference does not know its own error";
    else if (how.split.empty() || c.judgedLayer >= 0) {
        const Judgement j = judgeBy(c, *by, rule);
        s.standing = standingFor(j.verdict);
        s.text = sentence(j, ruleOf(c, rule));
        s.agreement = j.agreement;
        s.z = j.agreement.pixelZ;
        if (!c.traits.unbiased)
            s.text += c.traits.convergesOver.empty()
                          ? " (biased by nature)"
                          : fmt::format(" (biased by nature; its limit over {} is for chiaro agree)", c.traits.convergesOver);
        if (!how.beyond.empty()) s.text += fmt::format("; without {}, which the reference cannot see", how.beyond);
    } else
        s.text = "not judged there: the layer of these paths has no room beside --split; leave that out";
    if (!how.missing.empty()) tellMissing(s, c, whole, restricted);
    return s;
}

Stands standingOf(const judge::Picture& p, const Truth* whole, const judge::AgreementSettings& rule) {
    Stands s;
    if (!whole) {
        s.text = "no reference: not judged";
        return s;
    }
    if (p.error.empty() || !whole->hasErrors()) {
        s.text = fmt::format("not judged: {} no error layer (error.R, error.G, error.B), so that noise and bias cannot be told apart",
                             p.error.empty() ? "it has" : "the reference has");
        return s;
    }
    const std::vector<uint8_t> bad = either(judge::badTiles(p, {}), whole->badTiles());
    const Judgement j = judgement(judge::decide(judge::evidenceOf(p, {}, bad), whole->evidence(bad), rule), rule);
    s.standing = standingFor(j.verdict);
    s.text = j.text;
    if (j.verdict == Verdict::cannotTell && std::isfinite(j.moreSamples))
        s.text = fmt::format("noisy: cannot tell yet, {:.1f} times the samples would show a bias of {} (now {})", 1 + j.moreSamples,
                             percentOf(rule.margin), percentOf(j.agreement.resolution));
    s.z = j.agreement.pixelZ;
    s.agreement = j.agreement;
    return s;
}

const char* standingName(Standing s) noexcept {
    switch (s) {
    case Standing::reference: return "reference";
    case Standing::agrees: return "agrees";
    case Standing::cannotTell: return "cannot tell yet";
    case Standing::missesPaths: return "misses paths";
    case Standing::biased: return "biased";
    case Standing::differs: return "differs";
    case Standing::debug: return "debug view";
    case Standing::unjudged: return "not judged";
    }
    return "";
}

} // namespace chiaro::cli
