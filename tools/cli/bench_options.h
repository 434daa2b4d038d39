// The options of `chiaro bench` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

inline constexpr auto benchRows = std::to_array<OptionRow>({
    {.name = "scenes",
     .metavar = "LIST",
     .help = "built-in scenes and glTF files, parted by commas; default: those of the suite",
     .group = "What"},
    {.name = "integrator",
     .letter = 'i',
     .metavar = "LIST",
     .help = "of the suites that render: NAME[:key=value,...],NAME,...; default: those of the suite",
     .group = "What"},
    {.name = "size", .metavar = "WxH", .help = "pixels of the view", .standard = "256x256", .group = "What"},
    {.name = "time",
     .metavar = "D",
     .help = "of a suite, about, all its figures together; what does not fit is left out and named",
     .standard = "20s",
     .group = "How"},
    {.name = "replay-time",
     .metavar = "D",
     .help = "of the suite \"replay\": that every class of rays is replayed, at least; default: a share of --time",
     .group = "How"},
    {.name = "runs", .metavar = "N", .help = "of every figure; the median counts", .standard = "3", .group = "How"},
    {.name = "threads",
     .letter = 't',
     .metavar = "LIST",
     .help = "numbers of threads, such as 1,2,8; default: 1, 2, 4 ... and all, to show the growth",
     .group = "How"},
    {.name = "plot", .metavar = "FILE.svg", .help = "of the suites radiosity and triangles: growth as a picture", .group = "Output"},
    {.name = "seed", .metavar = "N", .help = "of the rays and paths that are traced", .standard = "0", .group = "How"},
});

} // namespace chiaro::cli
