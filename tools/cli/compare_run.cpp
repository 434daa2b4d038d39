#include "tools/cli/compare_run.h"
#include "tools/cli/agree_settings.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

constexpr double referenceTimes = 4, referenceSamples = 8, referenceNoise = 0.5; // of what an integrator gets
constexpr double restrictedShare = 0.5;                                          // of the reference's budget
constexpr std::size_t none = ~std::size_t(0);

ReferenceGoal goalOf(const CompareSettings& s) {
    ReferenceGoal goal;
    if (s.referenceSeconds)
        goal.seconds = *s.referenceSeconds;
    else if (s.equal == Equal::time)
        goal.seconds = referenceTimes * s.seconds;
    else if (s.equal == Equal::spp)
        goal.samples = referenceSamples * s.spp;
    else
        goal.noise = referenceNoise * s.noise;
    return goal;
}

double pathCost(const CompareSettings& s, const Job& job, const Comparison& c, StopToken& stop, PrepassSolver& prepasses) {
    for (const Contestant& one : c.contestants)
        if (one.name == referenceName && one.pilotSeconds > 0) return one.pilotSeconds;
    CompareSettings alone = s;
    std::vector<Contestant> path;
    path.emplace_back(chooseIntegrator(referenceName), c.classes, job.view);
    Contest(alone, job, stop, path, prepasses).pilot();
    return path[0].pilotSeconds;
}

bool needsReference(const CompareSettings& s, const Comparison& c) {
    return s.reference == ReferenceKind::automatic &&
           (!c.files.pictures.empty() ||
            std::any_of(c.contestants.begin(), c.contestants.end(), [](const Contestant& x) { return x.traits.lightTransport; }));
}

void openReferences(const CompareSettings& s, const Job& job, Comparison& c) {
    c.restrictedOf.assign(c.contestants.size(), none);
    if (!needsReference(s, c)) return;
    c.reference = std::make_unique<ReferenceRender>(job, c.classes, c.goal, s.cache, job.notes);
    ReferenceGoal smaller = c.goal;
    smaller.seconds *= restrictedShare;
    smaller.samples *= restrictedShare;
    smaller.noise /= restrictedShare;
    for (std::size_t i = 0; i < c.contestants.size(); ++i) {
        if (!c.judged[i].restricted()) continue;
        auto own = std::make_unique<ReferenceRender>(job, c.judged[i].subject->classes, smaller, s.cache, job.notes);
        const auto same = std::find_if(c.restricted.begin(), c.restricted.end(), [&](const auto& r) { return r->key() == own->key(); });
        c.restrictedOf[i] = std::size_t(same - c.restricted.begin());
        if (same == c.restricted.end()) c.restricted.push_back(std::move(own));
    }
}

void tellReference(const ReferenceRender& r, const ReferenceGoal& goal, const std::string& what, const Console& console) {
    const ReferenceSums* sums = r.sums();
    if (!sums) return;
    console.phase("ref", fmt::format("{}{}: {} x {} spp in {}, noise {}{}", referenceName, what, sums->replicas(), sums->spp(),
                                     duration(sums->seconds()), percent(sums->noise()),
                                     r.fromCache()                 ? ", kept from before      render again with: --cache none"
                                     : std::isfinite(goal.seconds) ? fmt::format("      keep it with: --ref-time {:g}s", goal.seconds)
                                                                   : std::string()));
}

// Each automatic choice once, with the names of all who share it.
void tellFacts(const Comparison& c, Diagnostics& notes) {
    std::vector<Diagnostics::Fact> told;
    for (const Contestant& one : c.contestants)
        for (const Diagnostics::Fact& f : one.facts) {
            if (std::find(told.begin(), told.end(), f) != told.end()) continue;
            told.push_back(f);
            std::string names;
            for (const Contestant& other : c.contestants)
                if (std::find(other.facts.begin(), other.facts.end(), f) != other.facts.end())
                    names += (names.empty() ? "" : ", ") + other.name;
            notes.tell(f.subject, fmt::format("{}: {}", names, f.message));
        }
}

void renderReferences(StopToken& stop, Comparison& c, Course& course, double perSample, ProgressBar& bar, const Console& console) {
    const auto render = [&](ReferenceRender& r, const std::string& what) {
        r.render(stop, course, perSample);
        bar.clear();
        tellReference(r, c.goal, what, console);
    };
    if (c.reference) render(*c.reference, "");
    for (std::size_t i = 0; i < c.contestants.size(); ++i) {
        const std::size_t r = c.restrictedOf[i];
        if (r != none &&
            std::find(c.restrictedOf.begin(), c.restrictedOf.begin() + std::ptrdiff_t(i), r) == c.restrictedOf.begin() + std::ptrdiff_t(i))
            render(*c.restricted[r], " on " + c.judged[i].subject->judgedOn);
    }
}

} // namespace

const ReferenceSums* Comparison::restrictedSums(std::size_t contestant) const {
    const std::size_t r = restrictedOf.empty() ? none : restrictedOf[contestant];
    return r == none ? nullptr : restricted[r]->sums();
}

std::vector<Contestant> contestantsOf(const CompareSettings& s, const Scene& scene, const View& view, std::vector<Judged>& judged) {
    std::vector<Contestant> all;
    for (const IntegratorChoice& choice : s.integrators) {
        const PrepassChoice* prepass = prepassFor(choice, s.base.prepass.get());
        judged.push_back(howJudged(choice, scene, s.base.paths, prepass));
        const bool own = !judged.back().split.empty() && s.base.paths.split.empty();
        PathQuery query = s.base.paths;
        if (own) query.split = judged.back().split;
        all.emplace_back(choice, own ? PathClasses::make(query) : s.base.classes, view, prepass);
        if (own) {
            const auto& names = all.back().classes.layerNames();
            all.back().judgedLayer = int(std::find(names.begin(), names.end(), "covered") - names.begin());
        }
        for (uint32_t n = 2; std::any_of(all.begin(), all.end() - 1, [&](const Contestant& c) { return c.file == all.back().file; }); ++n)
            all.back().file = fmt::format("{}-{}.exr", fileName(choice, prepass), n);
    }
    return all;
}

void runComparison(const CompareSettings& s, const Job& job, StopToken& stop, Comparison& c, Console& console) {
    PrepassSolver prepasses(s.base.prepass, s.base.scene);
    prepasses.checkFile();
    if (prepasses.choice())
        console.phase("prepass",
                      fmt::format("{} for {}{}", prepassRecipe(*prepasses.choice()), takersText(s.integrators),
                                  prepasses.kept() ? "; one solution for all seeds: what is random in it is no part of the error bars"
                                                   : "; a solution for each seed"));
    Contest contest(s, job, stop, c.contestants, prepasses);
    c.goal = goalOf(s);
    double perSample = 0;
    const bool timed = s.equal != Equal::spp || s.referenceSeconds;
    if (timed) {
        contest.pilot();
        if (s.reference == ReferenceKind::automatic) perSample = pathCost(s, job, c, stop, prepasses);
    }
    c.seeds = contest.chooseSeeds(job.notes);
    c.goal.expected = contest.samplesFor(c.goal.noise);
    openReferences(s, job, c);

    const std::string limit = s.equal == Equal::time  ? fmt::format("equal time, {:g} s", s.seconds)
                              : s.equal == Equal::spp ? fmt::format("equal samples, {} spp", s.spp)
                                                      : fmt::format("equal noise, {:g} %", 100 * s.noise);
    console.phase("compare", fmt::format("{}x{}, {} {}, {} each, {} seed{} from {}{}", job.view.crop.width(), job.view.crop.height(),
                                         c.contestants.size(), c.contestants.size() == 1 ? "integrator" : "integrators", limit, c.seeds,
                                         c.seeds == 1 ? "" : "s", s.base.seed,
                                         s.seeds ? std::string() : fmt::format("      keep it with: --seeds {}", c.seeds)));
    console.warnings(job.notes);

    Course::Part planned = contest.planned();
    const auto plan = [&](const ReferenceRender& r) {
        planned.seconds += r.missingSeconds(perSample);
        planned.samples += r.missingSamples();
    };
    if (c.reference) plan(*c.reference);
    for (const auto& r : c.restricted) plan(*r);
    const bool bySamples = !timed;
    ProgressBar bar(s.base.progress, s.base.quiet, bySamples ? double(infinity) : planned.seconds);
    Course course(bar, bySamples ? planned.samples : planned.seconds, bySamples);
    renderReferences(stop, c, course, perSample, bar, console);
    if (c.reference && c.reference->sums()) c.truth = Truth{c.reference->sums()->picture(), c.reference->sums()};

    std::optional<ErrorMeter> meter;
    if (c.truth) meter.emplace(c.truth->picture);
    contest.run(course, meter ? MeasureError([&](const judge::Picture& p) { return meter->relative(p); }) : MeasureError());
    bar.clear();
    tellFacts(c, job.notes);
    console.facts(job.notes);
}

} // namespace chiaro::cli
