// The options of `chiaro merge` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

inline constexpr auto mergeRows = std::to_array<OptionRow>({
    {.name = "output",
     .letter = 'o',
     .metavar = "FILE",
     .help = "FILE.exr, FILE.png, or FILE.chk (the parts as one); repeatable; {scene} {integrator} {spp} expand; default: {scene}.exr and "
             "{scene}.png here",
     .group = "Output",
     .repeatable = true},
});

} // namespace chiaro::cli
