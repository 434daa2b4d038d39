#include "integrators/radiosity/solve.h"
#include "integrators/radiosity/direct.h"
#include "integrators/radiosity/solve_links.h"
#include "integrators/radiosity/solve_matrix.h"
#include "integrators/radiosity/solve_rays.h"
#include "integrators/radiosity/solve_shoot.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace chiaro::radiosity {
namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }
bool matrixSolver(Solver s) noexcept { return s == Solver::gaussSeidel || s == Solver::jacobi || s == Solver::direct; }

std::vector<float> sumsOf(const FormFactorMatrix& m) {
    std::vector<float> sums(m.size());
    for (std::size_t i = 0; i < m.size(); ++i) {
        double sum = 0;
        for (const Factor& e : m.exchange(uint32_t(i))) sum += double(e.factor);
        sums[i] = float(sum / double(m.areas[i]));
    }
    return sums;
}
std::vector<float> sumsOf(const Work& work, const FormFactors& factors) {
    std::vector<float> sums(factors.patches().size());
    work.run.chunks(
        sums.size(),
        [&](uint64_t i) {
            std::vector<Factor> row;
            factors.row(uint32_t(i), row);
            double sum = 0;
            for (const Factor& f : row) sum += double(f.factor);
            sums[i] = float(sum);
        },
        &work.stop);
    return sums;
}

Solution byMatrix(const Work& work, const FormFactors& factors, const System& system, const SolveSettings& s, const Run& run) {
    const auto begin = Clock::now();
    const FormFactorMatrix matrix = formFactorMatrix(work, factors);
    const double seconds = since(begin);
    Solution out;
    if (matrix.size() != system.size()) return out;
    out = s.solver == Solver::jacobi   ? solveJacobi(system, matrix, s.limits, run)
          : s.solver == Solver::direct ? solveDirect(system, matrix, s.limits, run)
                                       : solveGaussSeidel(system, matrix, s.limits, run);
    out.factors = matrix.exchanges.size();
    out.rowSums = sumsOf(matrix);
    out.factorSeconds = seconds;
    return out;
}

Solution byShooting(const FormFactors& factors, const System& system, const SolveSettings& s, const Run& run) {
    ShootSettings how;
    how.steps = s.steps;
    how.overshoot = s.overshoot;
    how.ambient = s.ambient;
    how.roomForRows = std::min(how.roomForRows, run.memoryLimit / 4);
    return solveShooting(
        system, [&](uint32_t i, std::vector<Factor>& row) { factors.row(i, row); }, s.limits, how, run);
}

} // namespace

System systemOf(const Patches& patches, Lights3 received, bool emissionByFactors) {
    System s;
    s.received = std::move(received);
    s.areas.reserve(patches.size());
    s.reflectance.reserve(patches.size());
    s.emission.reserve(patches.size());
    for (const Patch& p : patches.all()) {
        s.areas.push_back(p.area);
        s.reflectance.push_back(p.reflectance);
        s.emission.push_back(emissionByFactors ? widened(p.emission) : Light(0));
    }
    return s;
}

Solver solverFor(Solver s, std::size_t patches) noexcept {
    constexpr std::size_t mostOfMatrix = 20'000;
    return s != Solver::automatic ? s : patches <= mostOfMatrix ? Solver::gaussSeidel : Solver::stochastic;
}

Solution solve(const Work& work, const Patches& patches, const SolveSettings& asked) {
    SolveSettings s = asked;
    s.solver = solverFor(asked.solver, patches.size());
    const std::size_t least = patches.size() * (sizeof(Light) * (s.limits.levels() + 6) + 32);
    if (least > work.memoryLimit)
        throw Error(Exit::resources, fmt::format("radiosity: {} patches need {:.1f} GB, limit {:.1f} GB. Use fewer patches.",
                                                 patches.size(), double(least) / 1e9, double(work.memoryLimit) / 1e9));
    const FormFactors factors(work, patches, s.factors);
    const bool noExchange = s.limits.bounces <= (s.emissionByFactors ? 0u : 1u);
    if (!noExchange && matrixSolver(s.solver)) requireRoomForMatrix(work, factors);
    Solution out;
    auto begin = Clock::now();
    Lights3 received(patches.size(), Light(0));
    if (s.limits.bounces > 0)
        received = directIrradiance(work, patches, s.emissionByFactors ? FromLights::notPatches : FromLights::all, s.lightRays);
    if (received.size() != patches.size()) return out;
    const double directSeconds = since(begin);
    const System system = systemOf(patches, std::move(received), s.emissionByFactors);
    const Run run{work.run, work.stop, work.seed, work.memoryLimit};
    begin = Clock::now();
    const auto nothing = [](std::span<const Light>, std::span<Light> to) { std::fill(to.begin(), to.end(), Light(0)); };
    if (noExchange)
        out = neumann(system, nothing, s.limits, run);
    else if (matrixSolver(s.solver))
        out = byMatrix(work, factors, system, s, run);
    else if (s.solver == Solver::shoot)
        out = byShooting(factors, system, s, run);
    else if (s.solver == Solver::hierarchical)
        out = solveHierarchical(work, factors, system, s.limits, s.linkError);
    else
        out = solveStochastic(work, patches, system, s.limits, s.raysPerPatch);
    out.solveSeconds = since(begin) - out.factorSeconds;
    out.directSeconds = directSeconds;
    if (s.rowSums && out.complete && out.rowSums.empty()) out.rowSums = sumsOf(work, factors);
    if (work.stop.requested()) out.complete = false;
    return out;
}

} // namespace chiaro::radiosity
