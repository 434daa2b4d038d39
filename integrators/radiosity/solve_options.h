// The options that every user of a radiosity solution shares: the integrator, the pre-pass. What they say: settings.cpp.
#pragma once
#include "core/render/options.h"
#include "integrators/radiosity/solve.h"

namespace chiaro::radiosity {

inline constexpr OptionSpec solveOptions[] = {
    {"patches", OptionType::integer, "2000", 1, 4e6, "", "about so many, where size says nothing"},
    {"size", OptionType::real, "0", 0, 1e18, "", "longest edge of a patch, metres; 0: by patches"},
    {"solver", OptionType::choice, "auto", 0, 0, "auto|gauss-seidel|jacobi|direct|shoot|hierarchical|stochastic",
     "auto: gauss-seidel up to 20,000 patches, stochastic beyond. Of the full matrix: gauss-seidel, jacobi, direct; shoot: progressive "
     "refinement, a row at a time; hierarchical: links between "
     "clusters; stochastic: rays alone"},
    {"factors", OptionType::choice, "auto", 0, 0, "auto|hemisphere|hemicube|analytic",
     "form factors; auto: analytic for shoot, hemisphere otherwise"},
    {"rays", OptionType::integer, "1024", 16, 1 << 24, "", "of each patch, factors=hemisphere"},
    {"resolution", OptionType::integer, "128", 8, 4096, "", "pixels along an edge of the hemicube"},
    {"points", OptionType::integer, "4", 1, 64, "", "of each patch, at which hemicubes stand"},
    {"shadow-rays", OptionType::integer, "4", 0, 1024, "", "between two patches, factors=analytic"},
    {"direct", OptionType::choice, "auto", 0, 0, "auto|rays|factors",
     "how light of emissive surfaces first arrives: by shadow rays or by form factors; auto: factors for shoot, rays otherwise"},
    {"light-rays", OptionType::integer, "64", 1, 1 << 20, "", "to the lights, of each patch"},
    {"bounces", OptionType::integer, "-1", -1, 1024, "", "scatterings of light: 0 emission, 1 direct, 2 one indirect; -1: until converged"},
    {"tolerance", OptionType::real, "1e-5", 1e-12, 0.5, "", "of the power under way, relative, at which it has converged"},
    {"steps", OptionType::integer, "0", 0, 1e9, "", "of shoot; 0: until converged"},
    {"overshoot", OptionType::boolean, "off", 0, 0, "", "shoot also what a patch will still receive"},
    {"ambient", OptionType::boolean, "off", 0, 0, "", "of shoot: show what is unshot as an even light"},
    {"link-error", OptionType::real, "5e-3", 1e-9, 1e3, "", "of hierarchical: what a link may get wrong, of the power of a mean patch"},
    {"shots", OptionType::integer, "64", 1, 1 << 20, "", "of stochastic: rays a patch, in the first bounce"},
};

PatchSettings patchSettings(const Options&);
SolveSettings solveSettings(const Options&);

} // namespace chiaro::radiosity
