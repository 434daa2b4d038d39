// Radiosity: what every solver takes for so many patches, and how far its answer lies from that of the finest full matrix.
#include "integrators/radiosity/patches.h"
#include "integrators/radiosity/solve.h"
#include "tools/bench/bench.h"
#include "tools/bench/measure.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace chiaro::bench {
namespace {

using radiosity::Solver;

struct Trial {
    std::string_view name;
    Solver solver;
    uint32_t patches;
    double growth; // of the time that solving takes, as a power of the patches
};
constexpr std::array trials = {
    Trial{"matrix, Gauss-Seidel", Solver::gaussSeidel, 500, 2},
    Trial{"matrix, Jacobi", Solver::jacobi, 500, 2},
    Trial{"matrix, Cholesky", Solver::direct, 500, 3},
    Trial{"shooting", Solver::shoot, 500, 2},
    Trial{"hierarchical", Solver::hierarchical, 500, 1.2},
    Trial{"stochastic", Solver::stochastic, 500, 1},
    Trial{"matrix, Gauss-Seidel", Solver::gaussSeidel, 2'000, 2},
    Trial{"matrix, Jacobi", Solver::jacobi, 2'000, 2},
    Trial{"matrix, Cholesky", Solver::direct, 2'000, 3},
    Trial{"shooting", Solver::shoot, 2'000, 2},
    Trial{"hierarchical", Solver::hierarchical, 2'000, 1.2},
    Trial{"stochastic", Solver::stochastic, 2'000, 1},
    Trial{"stochastic", Solver::stochastic, 10'000, 1},
    Trial{"hierarchical", Solver::hierarchical, 10'000, 1.2},
    Trial{"matrix, Gauss-Seidel", Solver::gaussSeidel, 10'000, 2},
    Trial{"matrix, Jacobi", Solver::jacobi, 10'000, 2},
    Trial{"stochastic", Solver::stochastic, 100'000, 1},
    Trial{"hierarchical", Solver::hierarchical, 100'000, 1.2},
    Trial{"matrix, Cholesky", Solver::direct, 10'000, 3},
    Trial{"stochastic", Solver::stochastic, 1'000'000, 1},
};

// Light that arrives at each surface of the scene, lumen: comparable between numbers of patches.
using Arrived = std::map<uint32_t, double>;
Arrived arrivedAt(const radiosity::Patches& patches, const radiosity::Solution& s) {
    Arrived all;
    for (std::size_t i = 0; i < patches.size(); ++i) all[patches[i].part] += double(patches[i].area) * luminance(s.irradiance(i));
    return all;
}
// Root mean square over the surfaces, relative to the mean of them.
double distance(const Arrived& a, const Arrived& b) {
    double squares = 0, sum = 0;
    for (const auto& [part, flux] : b) {
        const auto at = a.find(part);
        const double d = (at == a.end() ? 0 : at->second) - flux;
        squares += d * d;
        sum += flux;
    }
    const double n = double(b.size());
    return n > 0 && sum > 0 ? std::sqrt(squares / n) / (sum / n) : NAN;
}

struct Done {
    std::size_t row = 0; // of the table
    Arrived arrived;
};

// What the last trial of a solver took.
struct Took {
    double patches = 0, before = 0, solving = 0; // seconds
};
using Last = std::map<Solver, Took>;
// The time that a trial will take by that; 0: nobody knows. What comes before solving takes about as many rays a patch, whatever their
// number.
double expected(const Trial& t, const Last& last) {
    const auto at = last.find(t.solver);
    if (at == last.end()) return 0;
    const double more = t.patches / at->second.patches;
    return at->second.before * std::pow(more, 1.1) + at->second.solving * std::pow(more, t.growth);
}

struct Bench {
    const Request& request;
    Table& table;
    double secondsAScene;

    // False: stopped.
    bool one(const BenchScene& s, const Work& work, const Trial& t, std::vector<Done>& done, Last& last) {
        request.progress.phase(fmt::format("radiosity {} {} {} patches", s.name, t.name, t.patches));
        const auto begin = Clock::now();
        const radiosity::Patches patches = radiosity::Patches::of(work, {.size = 0, .count = t.patches});
        const double cut = secondsSince(begin);
        radiosity::SolveSettings settings;
        settings.solver = t.solver;
        const radiosity::Solution solution = radiosity::solve(work, patches, settings);
        if (request.stop.requested() || !solution.complete) return false;
        const double seconds = secondsSince(begin);
        last[t.solver] = {double(t.patches), seconds - solution.solveSeconds, solution.solveSeconds};
        done.push_back({table.rows.size(), arrivedAt(patches, solution)});
        table.rows.push_back({s.name,
                              std::string(t.name),
                              work.run.threads(),
                              0,
                              {double(patches.size()), seconds, cut, solution.factorSeconds, solution.solveSeconds,
                               double(solution.bytes) * 1e-6, double(solution.rays) * 1e-6, NAN}});
        return true;
    }
    // The finest full matrix is what the others are measured by.
    void errors(const std::vector<Done>& done) {
        const Done* finest = nullptr;
        for (const Done& d : done) {
            const Row& row = table.rows[d.row];
            if (row.subject == trials[0].name && (!finest || row.cells[0] > table.rows[finest->row].cells[0])) finest = &d;
        }
        for (const Done& d : done)
            if (finest && finest != &d) table.rows[d.row].cells.back() = 100 * distance(d.arrived, finest->arrived);
    }
    bool scene(const BenchScene& s, const Executor& run) {
        const PathClasses classes;
        const Work work{*s.scene, classes,      s.view.shutter,   request.seed,  SamplerKind::sobol,
                        run,      request.stop, request.progress, request.notes, request.memoryLimit};
        const auto begin = Clock::now();
        std::vector<Done> done;
        Last last;
        bool goesOn = true;
        for (const Trial& t : trials) {
            const double left = secondsAScene - secondsSince(begin), wanted = expected(t, last);
            if (left <= 0 || wanted > left) {
                table.notes.push_back(fmt::format("{}: {} with {} patches left out{}; give more --time", s.name, t.name, t.patches,
                                                  wanted > 0 ? fmt::format(", about {:.0f} s", wanted) : std::string()));
                continue;
            }
            try {
                if (goesOn = one(s, work, t, done, last); !goesOn) break;
            } catch (const Error& e) {
                if (e.code != Exit::resources) throw;
                table.notes.push_back(fmt::format("{}: {} with {} patches left out: {}", s.name, t.name, t.patches, e.what()));
            }
        }
        errors(done);
        return goesOn;
    }
};

} // namespace

Table radiositySuite(const Request& request) {
    Table table{
        .suite = "radiosity",
        .title = "the whole of it: patches, direct light, form factors, solution",
        .columns = {{"patches", ""},
                    {"all", "s"},
                    {"patches", "s"},
                    {"factors", "s"},
                    {"solving", "s"},
                    {"memory", "MB"},
                    {"rays", "M"},
                    {"error", "%"}},
        .rows = {},
        .notes = {"error: of the light that arrives at each surface, root mean square over the surfaces relative to their mean, against "
                  "the finest matrix by Gauss-Seidel of this table; patches of another size count in it too"}};
    const Executor run(request.threads.back());
    Bench bench{request, table, request.seconds / double(std::max<std::size_t>(1, request.scenes.size()))};
    for (const BenchScene& s : request.scenes)
        if (!bench.scene(s, run)) {
            table.stopped = true;
            break;
        }
    return table;
}

std::vector<Panel> radiosityPlot(const Table& table) {
    return {panelOf(table, "time, all of it", 0, 1), panelOf(table, "time to solve", 0, 4), panelOf(table, "memory", 0, 5)};
}

} // namespace chiaro::bench
