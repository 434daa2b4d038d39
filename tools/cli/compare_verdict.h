// Where each picture of a comparison stands against the reference: by the rule of `agree` on the light paths that the integrator covers,
// so that "different by definition", "biased", "noisy" and "wrong" are told apart.
#pragma once
#include "tools/cli/agree_verdict.h"
#include "tools/cli/compare_contest.h"
#include "tools/cli/compare_reference.h"
#include "tools/report/report.h"
#include <map>
#include <memory>

namespace chiaro::cli {

// The reference, wherever it comes from. Without errors nothing can be judged by it.
struct Truth {
    judge::Picture picture;
    const ReferenceSums* sums = nullptr; // null: a file
    bool hasErrors() const { return sums || !picture.error.empty(); }
    std::vector<uint8_t> badTiles() const;
    judge::Evidence evidence(const std::vector<uint8_t>& leftOut) const;
};
struct Stands {
    report::Standing standing = report::Standing::unjudged;
    std::string text; // one sentence
    std::optional<judge::Agreement> agreement;
    std::vector<float> z;               // a pixel; on the paths covered where these are a layer; empty: not known
    std::string missing;                // the shortest path left out by definition, as "La D D E"; empty: none
    std::optional<double> missingShare; // of the reference's mean
    std::optional<double> ownShare;     // of the same: light that it shows on paths that it does not cover, an approximation of its own
};

// How one contestant is judged: known before anything is rendered.
struct Judged {
    std::string covers;                                             // one line
    std::string missing;                                            // as in Stands
    std::string beyond;                                             // a path that it may see and the reference cannot; empty: none
    std::optional<Subject> subject;                                 // none: a debug view, or it sees nothing of what is asked for
    bool restricted() const { return subject && !missing.empty(); } // judged by a reference of its own
    // Approximations may also put light into paths that they do not cover: what is judged is a layer, "covered".
    std::string split; // that makes it, as --split; empty: the whole picture is judged
};
// prepass: that it renders with, null for none.
Judged howJudged(const IntegratorChoice&, const Scene&, const PathQuery&, const PrepassChoice* prepass = nullptr);

judge::AgreementSettings judgeRule(std::size_t judged);
// restricted: the reference on the paths that it covers, where that is another one; null where it could not be had.
Stands standingOf(const Contestant&, const Judged&, const Truth* whole, const ReferenceSums* restricted, const judge::AgreementSettings&);
Stands standingOf(const judge::Picture& fromFile, const Truth* whole, const judge::AgreementSettings&);

const char* standingName(report::Standing) noexcept; // "agrees", "cannot tell yet", ...

} // namespace chiaro::cli
