// The options of `chiaro trace` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

inline constexpr auto traceRows = std::to_array<OptionRow>({
    {.name = "integrator",
     .letter = 'i',
     .metavar = "LIST",
     .help = "NAME[:key=value,...],NAME,...: the same sample by each of them",
     .standard = "path",
     .group = "Method",
     .sample = true},
    {.name = "pixel", .metavar = "X,Y", .help = "whose path: x from the left, y from the top", .group = "Sample"},
    {.name = "sample", .metavar = "N", .help = "which sample of the pixel", .standard = "0", .group = "Sample"},
    {.name = "spp", .metavar = "N", .help = "so many samples, from --sample on; at most 4096", .standard = "1", .group = "Sample"},
    {.name = "output",
     .letter = 'o',
     .metavar = "FILE.glb",
     .help = "the rays as coloured lines that any glTF viewer shows; {scene} expands",
     .group = "Output"},
    {.name = "json", .help = "everything as one JSON object on stdout, in place of the text", .group = "Output"},
});

} // namespace chiaro::cli
