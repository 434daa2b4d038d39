// The options of `chiaro ff` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

inline constexpr auto ffRows = std::to_array<OptionRow>({
    {.name = "method",
     .metavar = "analytic|hemisphere|hemicube",
     .help = "the double contour integral with rays for what hides it; rays by the cosine; the scene projected on half a cube",
     .standard = "hemisphere",
     .group = "Method"},
    {.name = "rays", .metavar = "N", .help = "of a row, hemisphere", .standard = "1024", .group = "Method"},
    {.name = "resolution", .metavar = "N", .help = "pixels along the top of a hemicube", .standard = "128", .group = "Method"},
    {.name = "points", .metavar = "N", .help = "of a patch, at which hemicubes stand", .standard = "4", .group = "Method"},
    {.name = "shadow-rays",
     .metavar = "N",
     .help = "between a pair of patches, analytic; 0: as if nothing stood between",
     .standard = "4",
     .group = "Method"},
    {.name = "patches", .metavar = "N", .help = "about so many patches", .standard = "2000", .group = "Patches"},
    {.name = "size", .metavar = "M", .help = "longest edge of a patch in metres, instead of --patches", .group = "Patches"},
    {.name = "check",
     .help = "all rows: their sums and how far they are from reciprocal; exit code 2 where a limit is broken",
     .group = "Output"},
});

} // namespace chiaro::cli
