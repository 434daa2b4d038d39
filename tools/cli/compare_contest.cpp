#include "tools/cli/compare_contest.h"
#include "core/math/vec.h"
#include "tools/cli/film_picture.h"
#include "tools/cli/photon_output.h"
#include "tools/cli/prepared_once.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace chiaro::cli {
namespace {

constexpr double pictureBytes = 1e9;                // of all seeds' pictures together
constexpr uint32_t leastSeeds = 4, fewestSeeds = 2; // by half of the time; by all of it
constexpr double leastPrepass = 1e-4;               // seconds; below, there is none

double samplesOf(const Film& film) {
    const Rect& r = film.layout().crop;
    double sum = 0;
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) sum += film.next({x, y});
    return sum / double(r.area());
}

// The next number of samples to look at: powers of two; on the way to a noise, no further than the square root law promises.
uint32_t nextLook(const Film& film, double noise) {
    const uint32_t done = film.done(), doubled = done == 0 ? 1 : done > 1u << 29 ? 1u << 30 : 2 * done;
    if (noise <= 0 || done < 2) return doubled;
    const double now = film.noise(), wanted = 1.02 * done * (now / noise) * (now / noise);
    return std::isfinite(wanted) ? std::clamp(uint32_t(std::min(wanted, 1e9)), done + 1, doubled) : doubled;
}

double sumOf(const std::vector<SeedRun>& runs, double SeedRun::*field) {
    return std::accumulate(runs.begin(), runs.end(), 0.0, [&](double sum, const SeedRun& r) { return sum + r.*field; });
}

} // namespace

Contestant::Contestant(IntegratorChoice c, PathClasses paths, const View& view, const PrepassChoice* before)
    : choice(std::move(c)), prepass(prepassFor(choice, before)), traits(traitsWith(choice, prepass)), name(nameWith(choice, prepass)),
      file(fileName(choice, prepass) + ".exr"), classes(std::move(paths)), photons(hasPhotons(choice, prepass)),
      judged(view.crop.width(), view.crop.height()) {}

double Contestant::seconds() const noexcept { return sumOf(runs, &SeedRun::seconds); }
double Contestant::prepassSeconds() const noexcept { return sumOf(runs, &SeedRun::prepassSeconds); }
double Contestant::prepareSeconds() const noexcept { return sumOf(runs, &SeedRun::prepareSeconds); }
double Contestant::spp() const noexcept { return sumOf(runs, &SeedRun::spp); }
FilmLayout Contestant::layout(const View& view) const {
    return {.width = view.width,
            .height = view.height,
            .crop = view.crop,
            .layers = classes.layerNames(),
            .splats = traits.splats,
            .photons = photons};
}

double bytesNeeded(const std::vector<Contestant>& all, const View& view) {
    double sum = 0, most = 0;
    for (const Contestant& c : all) {
        const double film = double(c.layout(view).bytes());
        sum += film + 80.0 * double(view.crop.area()); // and its measures, maps and the copy in the report
        most = std::max(most, film);
    }
    constexpr double ofReference = 300; // a pixel: sums, picture, FLIP's planes
    return sum + most + std::min(pictureBytes, 12.0 * standardSeeds * double(all.size()) * double(view.crop.area())) +
           ofReference * double(view.crop.area());
}

Contest::Contest(const CompareSettings& s, const Job& job, StopToken& stop, std::vector<Contestant>& all, PrepassSolver& prepasses)
    : s_(s), job_(job), stop_(stop), all_(all), prepasses_(prepasses), seeds_(s.seeds.value_or(standardSeeds)) {
    if (s.equal == Equal::spp) seeds_ = std::min(seeds_, s.spp);
}

SolvedPrepass Contest::solve(const Contestant& c, uint64_t seed, Progress& progress, Diagnostics& notes) {
    if (!c.prepass) return {};
    return prepasses_.solve({job_.scene, c.classes, job_.shutter, prepasses_.kept() ? s_.base.seed : seed, job_.sampler, job_.run, stop_,
                             progress, notes, job_.memoryLimit});
}

void Contest::pilot() {
    Progress silent;
    for (Contestant& c : all_)
        if (!stop_.cancelled()) pilot(c, silent);
}

void Contest::pilot(Contestant& c, Progress& progress) {
    constexpr uint64_t seed = uint64_t(1) << 61;
    Diagnostics untold; // the seeds that count will say it again
    const SolvedPrepass solved = solve(c, seed, progress, untold);
    if (c.prepass && !solved.field) return;
    c.sharedPrepass = prepasses_.kept() ? solved.seconds : 0;
    const Job job{{job_.scene, c.classes, job_.shutter, seed, job_.sampler, job_.run, job_.stop, progress, untold, job_.memoryLimit},
                  job_.view,
                  solved.field.get()};
    const uint32_t spp = s_.equal == Equal::noise ? 2 : 1;
    // A disturbance of the machine must not cost seeds: what seems too slow for the fewest wanted is measured once more.
    for (int tries = 0; tries < 2; ++tries) {
        PreparedOnce integrator(c.choice.entry->make(c.choice.options));
        Film film(c.layout(job_.view));
        const double all = chiaro::render(job, integrator, film, {spp, infinity}, stop_).seconds;
        const double before = integrator.seconds() + solved.seconds - c.sharedPrepass;
        const double seconds = before + (all - integrator.seconds()) / spp;
        if (tries == 0 || seconds < c.pilotSeconds) c.pilotSeconds = seconds, c.pilotPrepass = before;
        if (s_.equal == Equal::noise && std::isfinite(film.noise())) pilotNoise_ = std::max(pilotNoise_, film.noise());
        if (s_.equal != Equal::time || c.pilotSeconds * leastSeeds <= s_.seconds || stop_.cancelled()) break;
    }
}

uint32_t Contest::chooseSeeds(Diagnostics& notes) {
    if (s_.equal != Equal::time) return seeds_;
    // Of its time, what one seed takes at least.
    const auto share = [&](const Contestant& c) { return c.pilotSeconds / std::max(s_.seconds - c.sharedPrepass, 1e-9); };
    const Contestant* slowest = nullptr;
    for (const Contestant& c : all_)
        if (!slowest || share(c) > share(*slowest)) slowest = &c;
    if (!slowest) return seeds_;
    const double least = share(*slowest);
    // Each seed takes at least one sample; half of the time at most may go into these.
    if (!s_.seeds) seeds_ = uint32_t(std::clamp(0.5 / std::max(least, 1e-9), double(leastSeeds), double(standardSeeds)));
    if (!s_.seeds && least * seeds_ > 1) seeds_ = fewestSeeds;
    if (least * seeds_ > 1)
        notes.warn(fmt::format(
            "{} needs about {:.1f} s for one sample a pixel with each of {} seeds{}, more than --time {:g}s: the times will not "
            "be equal. Give more --time, fewer --seeds or a smaller --size",
            slowest->name, slowest->sharedPrepass + slowest->pilotSeconds * seeds_, seeds_,
            slowest->sharedPrepass + slowest->pilotPrepass > leastPrepass ? ", its pre-pass included" : "", s_.seconds));
    return seeds_;
}

double Contest::samplesFor(double noise) const {
    const double ratio = noise > 0 ? pilotNoise_ / noise : 0;
    return std::max(256.0, 2 * ratio * ratio);
}

Course::Part Contest::planned() const {
    Course::Part part;
    for (const Contestant& c : all_) {
        part.samples += s_.spp;
        const double squared = pilotNoise_ / s_.noise * (pilotNoise_ / s_.noise);
        const double perSample = c.pilotSeconds - c.pilotPrepass, before = c.sharedPrepass + seeds_ * c.pilotPrepass;
        part.seconds += s_.equal == Equal::time  ? s_.seconds
                        : s_.equal == Equal::spp ? before + s_.spp * perSample
                                                 : std::min(s_.seconds, before + 2 * perSample * std::max(1.0, squared));
    }
    return part;
}

Contest::Limit Contest::limitOf(const Contestant& c, uint32_t round) const {
    double rest = s_.seconds - c.seconds();
    // Iterations of light paths are whole: the last one begins only where half of it or more fits.
    if (c.traits.splats && round + 1 == seeds_ && c.spp() > 0) rest -= 0.5 * c.seconds() / c.spp();
    const double left = std::max(0.0, rest) / (seeds_ - round);
    switch (s_.equal) {
    case Equal::time: return {1u << 30, left, 0};
    case Equal::spp: return {s_.spp / seeds_ + (round < s_.spp % seeds_ ? 1 : 0), infinity, 0};
    case Equal::noise: return {std::max(1u, s_.spp / seeds_), left, s_.noise * std::sqrt(double(seeds_))};
    }
    return {};
}

void Contest::run(Course& course, const MeasureError& measure) {
    const Course::Part all = planned();
    const double pictures = double(all_.size()) * seeds_;
    for (uint32_t round = 0; round < seeds_; ++round)
        for (std::size_t i = 0; i < all_.size() && !stop_.cancelled(); ++i) {
            Contestant& c = all_[(i + round) % all_.size()];
            const Limit limit = limitOf(c, round);
            const bool open = s_.equal == Equal::noise;
            course.begin({double(limit.spp), all.seconds / pictures, limit.spp < 1u << 30 ? double(limit.spp) : infinity,
                          open ? all.seconds / pictures : limit.seconds});
            renderSeed(c, s_.base.seed + round, limit, course, measure);
            course.end();
        }
}

void Contest::renderSeed(Contestant& c, uint64_t seed, const Limit& limit, Course& course, const MeasureError& measure) {
    auto film = std::make_unique<Film>(c.layout(job_.view));
    Diagnostics notes; // its facts are this seed's
    const SolvedPrepass solved = solve(c, seed, course, notes);
    if (c.prepass && !solved.field) return;
    const Job job{{job_.scene, c.classes, job_.shutter, seed, job_.sampler, job_.run, job_.stop, course, notes, job_.memoryLimit},
                  job_.view,
                  solved.field.get()};
    PreparedOnce integrator(c.choice.entry->make(c.choice.options));
    SeedRun run;
    run.seed = seed;
    run.seconds = run.prepassSeconds = prepasses_.kept() ? solved.seconds / seeds_ : solved.seconds;
    for (bool more = true; more;) {
        const uint32_t target = std::min(limit.spp, nextLook(*film, limit.noise));
        const RenderResult result = chiaro::render(job, integrator, *film, {target, limit.seconds - run.seconds}, stop_);
        run.seconds += result.seconds;
        more = result.ended == Ended::spp && film->done() < limit.spp && run.seconds < limit.seconds;
        if (more && limit.noise > 0 && film->done() >= 2) {
            const double noise = film->noise();
            more = noise > limit.noise; // black: no number
            if (!more) break;
        }
        if (measure && more && c.traits.lightTransport)
            run.snapshots.push_back({run.seconds, double(film->done()), measure(judgedPicture(*film, c.name))});
    }
    run.whole = !stop_.cancelled() && film->done() > 0;
    if (integrator.seconds() > leastPrepass) run.prepareSeconds = integrator.seconds();
    for (const std::string& warning : notes.warnings()) job_.notes.warn(warning);
    if (c.runs.empty()) {
        c.facts = solved.facts;
        for (const Diagnostics::Fact& f : notes.facts()) c.facts.push_back(f);
    }
    if (limit.noise > 0 && film->noise() > 1.1 * limit.noise) c.reached = false;
    run.picture = judgedPicture(*film, c.name);
    run.mean = meanLuminance(run.picture);
    run.spp = samplesOf(*film);
    if (measure && run.whole && c.traits.lightTransport) run.snapshots.push_back({run.seconds, run.spp, measure(run.picture)});
    if (run.whole) c.judged.add(c.judgedLayer < 0 ? run.picture : judgedLayer(*film, c.judgedLayer, c.name));
    keep(c, std::move(run), std::move(film));
}

bool Contest::keepsPictures() const { return 12.0 * double(job_.view.crop.area()) * seeds_ * double(all_.size()) <= pictureBytes; }

void Contest::keep(Contestant& c, SeedRun run, std::unique_ptr<Film> film) {
    if (run.spp == 0) return;
    if (!keepsPictures() || !run.whole) run.picture = {};
    c.runs.push_back(std::move(run));
    if (c.film)
        c.film->merge(*film);
    else
        c.film = std::move(film);
}

} // namespace chiaro::cli
