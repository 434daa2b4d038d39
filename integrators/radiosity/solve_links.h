// Hierarchical radiosity: light goes over links between the nodes of a tree, as few and as high up as an error bound allows, so that their
// number grows about with the number of patches, not with its square. A link is refined where what it carries could be wrong by more
// than its share of the scene's power (brightness-weighted refinement: Hanrahan, Salzman, Aupperle 1991, section 5):
//   A_p (range of F over p * B_q + range of F over q * deviation of B over q) > linkError / patches * sum A B
// B is that of the converged solution over coarser links. Form factors between nodes: four points of p against four of q, with sixteen
// shadow rays for both ways; between neighbouring patches Lambert's formula; all factors of a patch are then scaled to the sum that rays
// say. Bounces: gather over the links, push, pull.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/hierarchy.h"

namespace chiaro::radiosity {

// Throws Error(Exit::resources) where the links need more than the memory limit.
Solution solveHierarchical(const Work&, const FormFactors&, const System&, const Limits&, double linkError);

} // namespace chiaro::radiosity
