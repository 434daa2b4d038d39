#include "tools/cli/agree_run.h"
#include "tools/cli/console.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

constexpr uint32_t pilotReplicates = 16, pilotSpp = 4, leastSpp = 4, mostSpp = 1u << 20;
constexpr double reserve = 1.5; // the pilot's standard deviations have an error of their own
constexpr uint32_t confirmFactor = 4;

// 4, 6, 8, 12, 16, 24, ...: the next that is no smaller.
uint32_t roundSpp(double spp) {
    double step = leastSpp;
    for (int i = 0; step < spp; ++i) step *= i % 2 == 0 ? 1.5 : 4.0 / 3;
    return uint32_t(std::min<double>(step, mostSpp));
}

// Samples of one replicate that resolve the margin for everybody, by the errors alone.
double wantedSpp(const std::vector<Subject>& subjects, const Stage& pilot, uint32_t replicates, judge::AgreementSettings rule) {
    rule.samplesPerReplicate = pilot.spp;
    double most = leastSpp;
    for (std::size_t s = 0; s < subjects.size(); ++s) {
        rule.paired = subjects[s].paired;
        const judge::Agreement a = judge::agree(pilot.trials[s].limit, pilot.references[subjects[s].reference].replicates, rule);
        if (!std::isfinite(a.resolution)) continue; // black: no number of samples helps
        most = std::max(most, reserve * a.neededReplicates * pilot.spp / replicates);
    }
    return most;
}

std::vector<Judgement> judgeStage(const std::vector<Subject>& subjects, const Stage& stage, const std::vector<bool>& takesPart,
                                  judge::AgreementSettings rule) {
    rule.samplesPerReplicate = stage.spp;
    std::vector<Judgement> all(subjects.size());
    for (std::size_t s = 0; s < subjects.size(); ++s)
        if (takesPart[s]) all[s] = judgeTrial(subjects[s], stage.trials[s], stage.references[subjects[s].reference].replicates, rule);
    return all;
}

// The pilot, and the samples that follow from it. 0: stopped.
uint32_t plan(const AgreeSettings& s, const std::vector<Subject>& subjects, const Job& job, StopToken& stop, Progress& progress,
              const Console& console, AgreeRun& run) {
    const double budget = s.seconds.value_or(planSeconds);
    run.pilot = renderStage(job, stop, subjects,
                            {.number = 0,
                             .replicates = pilotReplicates,
                             .spp = pilotSpp,
                             .seconds = budget / 4,
                             .takesPart = std::vector<bool>(subjects.size(), true)},
                            progress);
    const Stage& pilot = *run.pilot;
    if (pilot.stopped) return 0;
    const double wanted = wantedSpp(subjects, pilot, s.replicates, run.rule);
    const double left = std::max(budget - pilot.seconds, 0.0);
    const double affordable = left / (pilot.seconds / (double(pilot.rounds) * pilot.spp)) / s.replicates;
    run.shortOfTime = wanted > affordable;
    const uint32_t spp = run.shortOfTime ? std::max(uint32_t(std::min<double>(affordable, mostSpp)), 1u) : roundSpp(wanted);
    console.phase("plan",
                  fmt::format("{} replicates of {} spp a side{}      keep it with: --spp {}", s.replicates, spp,
                              run.shortOfTime ? fmt::format(", {:.0f} would be needed but {} does not suffice", wanted, duration(budget))
                                              : std::string(),
                              spp));
    return spp;
}

void confirm(const AgreeSettings& s, const std::vector<Subject>& subjects, const Job& job, StopToken& stop, Progress& progress,
             const Console& console, AgreeRun& run) {
    std::vector<bool> red;
    std::string names;
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        red.push_back(run.outcomes[i].first.red());
        if (red[i]) names += (names.empty() ? "" : ", ") + subjects[i].name;
    }
    if (names.empty() || !s.confirm) return;
    for (std::size_t i = 0; i < red.size(); ++i) run.outcomes[i].unconfirmed = red[i];
    const uint32_t spp = std::min(run.first.spp, mostSpp) * confirmFactor;
    console.phase("confirm", fmt::format("{}: {} replicates of {} spp, new seeds", names, run.first.rounds, spp));
    run.second = renderStage(job, stop, subjects,
                             {.number = 2,
                              .replicates = run.first.rounds,
                              .spp = spp,
                              .seconds = s.seconds ? confirmFactor * *s.seconds : infinity,
                              .takesPart = red},
                             progress);
    run.stopped = run.second->stopped;
    if (run.stopped) return;
    std::vector<Judgement> again = judgeStage(subjects, *run.second, red, run.rule);
    for (std::size_t i = 0; i < red.size(); ++i) {
        if (!red[i]) continue;
        run.outcomes[i].second = std::move(again[i]);
        run.outcomes[i].unconfirmed = false;
    }
}

} // namespace

judge::Verdict Outcome::verdict() const noexcept { return unconfirmed ? judge::Verdict::cannotTell : last().verdict; }

std::string Outcome::text() const {
    if (unconfirmed) return fmt::format("cannot tell yet: red once ({}), stopped before it was confirmed", first.text);
    return last().text;
}

Exit exitOf(judge::Verdict v) noexcept {
    return v == judge::Verdict::agrees ? Exit::done : v == judge::Verdict::cannotTell ? Exit::warning : Exit::failed;
}

AgreeRun runStages(const AgreeSettings& s, const std::vector<Subject>& subjects, const Job& job, StopToken& stop, Progress& progress,
                   const Console& console) {
    AgreeRun run;
    run.rule = s.rule;
    run.rule.alpha = s.rule.alpha / double(subjects.size());
    const uint32_t spp = s.spp ? *s.spp : plan(s, subjects, job, stop, progress, console, run);
    if (spp == 0) {
        run.stopped = true;
        return run;
    }
    const std::vector<bool> everybody(subjects.size(), true);
    const double seconds = s.seconds ? *s.seconds - (run.pilot ? run.pilot->seconds : 0) : infinity;
    run.first = renderStage(job, stop, subjects,
                            {.number = 1, .replicates = s.replicates, .spp = spp, .seconds = seconds, .takesPart = everybody}, progress);
    run.stopped = run.first.stopped;
    if (run.first.rounds < 2) return run;
    for (Judgement& j : judgeStage(subjects, run.first, everybody, run.rule)) run.outcomes.push_back({std::move(j), {}, false});
    if (run.stopped)
        for (Outcome& o : run.outcomes) o.unconfirmed = o.first.red();
    else
        confirm(s, subjects, job, stop, progress, console, run);
    return run;
}

} // namespace chiaro::cli
