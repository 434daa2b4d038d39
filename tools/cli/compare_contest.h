// The renders of `chiaro compare`: each integrator renders its picture several times, each time with another seed, so that its error is
// known from the spread; the picture that is shown is all of them merged. Seed by seed the integrators take turns, in rotated order, so
// that a disturbance of the machine hits all of them; with equal time each seed gets what is left of its integrator's time divided by the
// seeds left, so that what one takes too much the next give back. Pre-passes count; what is measured between passes does not. What the
// integrators of a round share (the field of --prepass) is solved once and billed to each of them; one that is kept in a file serves all
// seeds, and its time is billed to each integrator once.
//
// Seeds are --seed, --seed + 1, ...: those of `chiaro render --seed`, the same for every integrator.
#pragma once
#include "core/render/render.h"
#include "tools/cli/compare_course.h"
#include "tools/cli/compare_settings.h"
#include "tools/cli/prepass_solver.h"
#include "tools/judge/replicates.h"
#include <functional>
#include <memory>

namespace chiaro::cli {

struct Snapshot { // of one seed as it renders on
    double seconds = 0, spp = 0;
    double error = 0; // relative, root mean square, to the reference
};
struct SeedRun {
    uint64_t seed = 0;
    double spp = 0;            // mean over the pixels: the last pass may be a part of one
    double seconds = 0;        // all of it
    double prepassSeconds = 0; // of these, for the field of --prepass
    double prepareSeconds = 0; // and for what the integrator itself makes before its first sample: photon maps, tables
    double mean = 0;           // luminance
    bool whole = false;        // at least one complete sample, and not stopped
    std::vector<Snapshot> snapshots;
    judge::Picture picture; // empty where all of them would take too much memory
};
struct Contestant {
    // prepass: that it renders with; null: none. It must outlive this.
    Contestant(IntegratorChoice c, PathClasses paths, const View& view, const PrepassChoice* prepass = nullptr);
    IntegratorChoice choice;
    const PrepassChoice* prepass = nullptr;
    Traits traits;
    std::string name, file;     // "photon:count=2M", "photon-count-2M.exr"; "whitted + radiosity"
    PathClasses classes;        // rendered with
    bool photons = false;       // has some, and its film keeps what lookups found
    int judgedLayer = -1;       // of the film, where the verdict is about one layer alone; -1: about all
    std::unique_ptr<Film> film; // all seeds merged; null: nothing yet
    std::vector<SeedRun> runs;
    judge::Replicates judged;             // of the whole seeds
    double pilotSeconds = 0;              // of one sample a pixel, with what comes before it in every seed
    double pilotPrepass = 0;              // of these, what comes before
    double sharedPrepass = 0;             // what comes before all seeds together: a pre-pass that is kept
    bool reached = true;                  // the noise asked for
    std::vector<Diagnostics::Fact> facts; // automatic choices of its first seed
    double seconds() const noexcept;
    double prepassSeconds() const noexcept;
    double prepareSeconds() const noexcept;
    double spp() const noexcept;
    uint32_t wholeSeeds() const noexcept { return uint32_t(judged.count()); }
    FilmLayout layout(const View&) const;
};

using MeasureError = std::function<double(const judge::Picture&)>; // empty: no reference

class Contest {
public:
    // job: its seed and classes are not used.
    Contest(const CompareSettings&, const Job& job, StopToken&, std::vector<Contestant>&, PrepassSolver&);
    // One sample a pixel of each (two for --equal noise), thrown away: what it costs, and everything touched once.
    void pilot();
    uint32_t chooseSeeds(Diagnostics&);    // as asked for, or as many as the budget bears
    Course::Part planned() const;          // of all, about
    double samplesFor(double noise) const; // a pixel, by the pilot and the square root law
    void run(Course&, const MeasureError&);

private:
    struct Limit {
        uint32_t spp = 0;
        double seconds = infinity, noise = 0;
    };
    SolvedPrepass solve(const Contestant&, uint64_t seed, Progress&, Diagnostics&);
    void pilot(Contestant&, Progress&);
    Limit limitOf(const Contestant&, uint32_t round) const;
    void renderSeed(Contestant&, uint64_t seed, const Limit&, Course&, const MeasureError&);
    void keep(Contestant&, SeedRun, std::unique_ptr<Film>);
    bool keepsPictures() const;

    const CompareSettings& s_;
    const Job& job_;
    StopToken& stop_;
    std::vector<Contestant>& all_;
    PrepassSolver& prepasses_;
    uint32_t seeds_ = standardSeeds;
    double pilotNoise_ = 0;
};

// Memory that the films and pictures of a comparison need.
double bytesNeeded(const std::vector<Contestant>&, const View&);

} // namespace chiaro::cli
