#include "tools/cli/agree_stage.h"
#include "tools/cli/agree_settings.h"
#include "tools/cli/film_picture.h"
#include "tools/cli/prepass_solver.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

// The progress of one picture as progress of the stage.
class Part : public Progress {
public:
    Part(Progress& whole, uint32_t total) : whole_(whole), total_(total) {}
    void next(uint32_t spp) noexcept { before_ += spp; }
    void phase(std::string_view) override {} // pre-passes of every replicate would flood the terminal
    void render(const RenderStatus& one) noexcept override {
        RenderStatus all;
        all.samples = before_ + one.samples;
        all.spp = before_ + one.spp;
        all.sppTarget = total_;
        all.seconds = secondsSince(start_);
        if (all.samples > 0) all.secondsLeft = all.seconds * std::max(0.0, total_ / all.samples - 1);
        all.noise = std::nan("");
        whole_.render(all);
    }

private:
    Progress& whole_;
    uint32_t total_, before_ = 0;
    Clock::time_point start_ = Clock::now();
};

// Renders the replicates of a stage, one after the other.
class Renderer {
public:
    Renderer(const Job& job, StopToken& stop, const StageRequest& request, Progress& progress, uint32_t sides)
        : job_(job), stop_(stop), request_(request), part_(progress, uint32_t(std::min(0x7fffffff, int(sides) * int(request.spp)))) {}

    uint64_t seed(uint32_t side) const noexcept {
        return job_.seed << 32 | uint64_t(side & 0xff) << 24 | uint64_t(request_.number & 0xf) << 20;
    }
    // Empty: stopped.
    std::optional<judge::Picture> render(const IntegratorChoice& choice, const PathClasses& classes, uint32_t replicate, Side& side,
                                         PrepassSolver* prepass = nullptr) {
        const uint64_t number = side.firstSeed + replicate;
        Diagnostics notes; // every replicate would tell the same choices again
        SolvedPrepass solved;
        if (prepass)
            solved = prepass->solve({job_.scene, classes, job_.shutter, prepass->kept() ? job_.seed : number, job_.sampler, job_.run, stop_,
                                     part_, notes, job_.memoryLimit});
        if (prepass && !solved.field) return {};
        const Job job{{job_.scene, classes, job_.shutter, number, job_.sampler, job_.run, stop_, part_, notes, job_.memoryLimit},
                      job_.view,
                      solved.field.get()};
        Film film({.width = job_.view.width,
                   .height = job_.view.height,
                   .crop = job_.view.crop,
                   .layers = {},
                   .splats = choice.entry->traits(choice.options).splats});
        const auto integrator = choice.entry->make(choice.options);
        const RenderResult result = chiaro::render(job, *integrator, film, {request_.spp, infinity}, stop_);
        if (result.ended == Ended::stopped) return {};
        for (const std::string& warning : notes.warnings()) job_.notes.warn(warning);
        if (request_.number == 1 && replicate == 0) tellFacts(nameWith(choice, prepass ? prepass->choice() : nullptr), solved, notes);
        side.seconds += result.seconds + (prepass && !prepass->kept() ? solved.seconds : 0);
        side.dropped += film.dropped();
        part_.next(request_.spp);
        return judgedPicture(film, std::string(choice.entry->name));
    }

private:
    // The automatic choices of the first replicate; those of the others are alike.
    void tellFacts(const std::string& name, const SolvedPrepass& solved, const Diagnostics& own) {
        for (const auto& facts : {solved.facts, own.facts()})
            for (const Diagnostics::Fact& f : facts) job_.notes.tell(f.subject, fmt::format("{}: {}", name, f.message));
    }

    const Job& job_;
    StopToken& stop_;
    const StageRequest& request_;
    Part part_;
};

judge::Picture weighted(const std::vector<judge::Picture>& levels, const std::vector<double>& weights) {
    judge::Picture sum = levels[0];
    for (std::size_t i = 0; i < sum.rgb.size(); ++i) {
        double v = 0;
        for (std::size_t l = 0; l < levels.size(); ++l) v += weights[l] * levels[l].rgb[i];
        sum.rgb[i] = float(v);
    }
    return sum;
}

struct Round {
    std::vector<std::vector<judge::Picture>> subjects; // [subject][level]
    std::vector<std::optional<judge::Picture>> references;
};
bool renderRound(Renderer& renderer, const std::vector<Subject>& subjects, const StageRequest& request, uint32_t r, Stage& stage,
                 Round& round) {
    const IntegratorChoice reference = chooseIntegrator(referenceName);
    round.references.resize(stage.references.size());
    round.subjects.resize(subjects.size());
    for (std::size_t s = 0; s < subjects.size(); ++s) {
        if (!request.takesPart[s]) continue;
        const Subject& subject = subjects[s];
        auto& shared = round.references[subject.reference];
        if (!shared) shared = renderer.render(reference, subject.classes, r, stage.references[subject.reference]);
        if (!shared) return false;
        for (std::size_t l = 0; l < subject.levels.size(); ++l) {
            auto picture = renderer.render(subject.levels[l], subject.classes, r, stage.trials[s].levels[l], subject.solver(l));
            if (!picture) return false;
            round.subjects[s].push_back(std::move(*picture));
        }
    }
    return true;
}

void keep(const Round& round, const std::vector<Subject>& subjects, Stage& stage) {
    for (std::size_t s = 0; s < subjects.size(); ++s) {
        if (round.subjects[s].empty()) continue;
        for (std::size_t l = 0; l < round.subjects[s].size(); ++l) stage.trials[s].levels[l].replicates.add(round.subjects[s][l]);
        stage.trials[s].limit.add(weighted(round.subjects[s], subjects[s].weights));
    }
    for (std::size_t g = 0; g < stage.references.size(); ++g)
        if (round.references[g]) stage.references[g].replicates.add(*round.references[g]);
}

} // namespace

double Trial::seconds() const noexcept {
    double sum = 0;
    for (const Side& s : levels) sum += s.seconds;
    return sum;
}
uint64_t Trial::dropped() const noexcept {
    uint64_t sum = 0;
    for (const Side& s : levels) sum += s.dropped;
    return sum;
}

Stage renderStage(const Job& job, StopToken& stop, const std::vector<Subject>& subjects, const StageRequest& request, Progress& progress) {
    const uint32_t width = job.view.crop.width(), height = job.view.crop.height();
    Stage stage;
    stage.number = request.number;
    stage.spp = request.spp;
    stage.planned = request.replicates;
    uint32_t sides = 0;
    std::vector<bool> used(referenceCount(subjects), false);
    for (std::size_t s = 0; s < subjects.size(); ++s)
        if (request.takesPart[s])
            sides += uint32_t(subjects[s].levels.size()) + (used[subjects[s].reference] ? 0 : 1), used[subjects[s].reference] = true;
    Renderer renderer(job, stop, request, progress, sides * request.replicates);
    uint32_t side = 0;
    for (std::size_t g = 0; g < used.size(); ++g) stage.references.emplace_back(width, height).firstSeed = renderer.seed(side++);
    for (const Subject& s : subjects) {
        stage.trials.push_back({{}, judge::Replicates(width, height)});
        for (std::size_t l = 0; l < s.levels.size(); ++l)
            stage.trials.back().levels.emplace_back(width, height).firstSeed =
                s.paired ? stage.references[s.reference].firstSeed : renderer.seed(side++);
    }
    if (side > 256) throw Error(Exit::usage, "-i: more than 255 pictures a round; name fewer integrators");

    const auto begin = Clock::now();
    while (stage.rounds < request.replicates && !stage.stopped && !stage.timeUp) {
        Round round;
        if (!renderRound(renderer, subjects, request, stage.rounds, stage, round)) {
            stage.stopped = true;
            break;
        }
        keep(round, subjects, stage);
        ++stage.rounds;
        stage.timeUp = stage.rounds >= 2 && stage.rounds < request.replicates && secondsSince(begin) >= request.seconds;
    }
    stage.seconds = secondsSince(begin);
    return stage;
}

} // namespace chiaro::cli
