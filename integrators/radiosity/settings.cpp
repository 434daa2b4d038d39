#include "integrators/radiosity/solve_options.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::radiosity {
PatchSettings patchSettings(const Options& o) {
    PatchSettings p;
    p.size = float(o.real("size"));
    p.count = uint32_t(o.integer("patches"));
    return p;
}

SolveSettings solveSettings(const Options& o) {
    SolveSettings s;
    const std::string &solver = o.text("solver"), &factors = o.text("factors"), &direct = o.text("direct");
    s.solver = solver == "jacobi"         ? Solver::jacobi
               : solver == "direct"       ? Solver::direct
               : solver == "shoot"        ? Solver::shoot
               : solver == "hierarchical" ? Solver::hierarchical
               : solver == "stochastic"   ? Solver::stochastic
               : solver == "gauss-seidel" ? Solver::gaussSeidel
                                          : Solver::automatic;
    const bool shoot = s.solver == Solver::shoot;
    s.factors.method = factors == "analytic" || (factors == "auto" && shoot) ? FormFactorMethod::analytic
                       : factors == "hemicube"                               ? FormFactorMethod::hemicube
                                                                             : FormFactorMethod::hemisphere;
    s.factors.rays = uint32_t(o.integer("rays"));
    s.factors.resolution = uint32_t(o.integer("resolution"));
    s.factors.points = uint32_t(o.integer("points"));
    s.factors.shadowRays = uint32_t(o.integer("shadow-rays"));
    s.emissionByFactors = direct == "factors" || (direct == "auto" && shoot);
    s.lightRays = uint32_t(o.integer("light-rays"));
    s.limits.bounces = o.integer("bounces") < 0 ? Limits::converged : uint32_t(o.integer("bounces"));
    s.limits.tolerance = o.real("tolerance");
    s.steps = uint32_t(o.integer("steps"));
    s.overshoot = o.boolean("overshoot");
    s.ambient = o.boolean("ambient");
    s.linkError = o.real("link-error");
    s.raysPerPatch = double(o.integer("shots"));
    return s;
}

void tell(const Work& work, const Patches& patches, const PatchSettings& p, const SolveSettings& s, const Solution& out,
          std::string_view typed) {
    constexpr const char* names[] = {"gauss-seidel", "jacobi", "direct", "shoot", "hierarchical", "stochastic"};
    const std::string chosen = p.size > 0 ? "" : fmt::format("      keep it with: {}:size={:.4g}", typed, patches.longestEdge());
    work.notes.tell("radiosity", fmt::format("{} patches of up to {:.3g} m{}", patches.size(), patches.longestEdge(), chosen));
    const Solver solver = solverFor(s.solver, patches.size());
    std::string text = fmt::format("{}: {} {}", names[int(solver)], out.residuals.size(), solver == Solver::shoot ? "steps" : "iterations");
    if (!out.residuals.empty()) text += fmt::format(", residual {:.2g}", out.residuals.back());
    if (out.factors > 0) text += fmt::format(", {} form factors", out.factors);
    if (out.links > 0) text += fmt::format(", {} links", out.links);
    if (out.rays > 0) text += fmt::format(", {} rays", out.rays);
    work.notes.tell("radiosity", text + fmt::format(", {:.1f} MB", double(out.bytes) / 1e6));
    if (!out.rowSums.empty()) {
        float least = infinity, most = 0;
        std::size_t dark = 0; // below or inside of something
        for (std::size_t i = 0; i < patches.size(); ++i) {
            if (patches[i].open < 1 / 64.f) {
                ++dark;
                continue;
            }
            least = min(least, out.rowSums[i]);
            most = max(most, out.rowSums[i]);
        }
        work.notes.tell("radiosity", fmt::format("form factors of a patch add up to {:.4f} to {:.4f} (closed: 1){}", min(least, most), most,
                                                 dark ? fmt::format("; {} patches lie covered and dark", dark) : ""));
    }
    if (out.residuals.size() > 1 && solver != Solver::shoot) {
        std::string series;
        for (std::size_t i = 0; i < std::min<std::size_t>(out.residuals.size(), 12); ++i)
            series += fmt::format("{}{:.2g}", i == 0 ? "" : " ", out.residuals[i]);
        work.notes.tell("radiosity", fmt::format("power left after each iteration: {}{}", series, out.residuals.size() > 12 ? " ..." : ""));
    }
    if (!out.unshot.empty()) {
        std::vector<float> areas;
        for (const Patch& patch : patches.all()) areas.push_back(patch.area);
        work.notes.tell("radiosity", fmt::format("unshot {:.3g} lm, {:.2g} % of all", power(out.unshot, areas),
                                                 out.residuals.empty() ? 100.0 : 100 * out.residuals.back()));
    }
}

} // namespace chiaro::radiosity
