// Progressive refinement: step by step the patch with the most unshot power sends it to all others, so that the first steps already make a
// picture (Cohen, Chen, Wallace, Greenberg 1988). Needs one row of form factors a step, never the matrix.
//   overshoot  a patch also sends what it is expected to receive later, from the ambient term; it is owed that afterwards (Feda and
//              Purgathofer, Accelerating Radiosity by Overshooting, 1992)
//   ambient    the light still unshot is added as if it were spread evenly over all surfaces (Cohen et al. 1988, section 4)
// Among equals the lowest number shoots. Rows of the next candidates are made side by side and kept while there is room.
#pragma once
#include "integrators/radiosity/form_factors.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

struct ShootSettings {
    uint32_t steps = 0; // 0: until the limits are met
    bool overshoot = false, ambient = false;
    std::size_t roomForRows = std::size_t(512) << 20; // bytes
    std::vector<uint32_t>* order = nullptr;           // who wants to know which patch shot when
};
// F_ij of patch i; called from several threads.
using RowOf = FunctionRef<void(uint32_t i, std::vector<Factor>& row)>;

Solution solveShooting(const System&, RowOf, const Limits&, const ShootSettings&, const Run&);

} // namespace chiaro::radiosity
