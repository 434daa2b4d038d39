// The options of `chiaro agree` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

namespace agree_groups {
inline constexpr const char *method = "Method", *samples = "Samples", *rule = "Decision", *output = "Output";
}

inline constexpr auto agreeRows = std::to_array<OptionRow>({
    {.name = "integrator",
     .letter = 'i',
     .metavar = "LIST",
     .help = "NAME[:key=value,...],NAME,...: each is judged against the path tracer on the light paths that it covers; default: all",
     .group = agree_groups::method,
     .sample = true},
    {.name = "replicates",
     .metavar = "R",
     .help = "independent pictures a side, each with its own seed",
     .standard = "32",
     .group = agree_groups::samples,
     .sample = true},
    {.name = "spp",
     .metavar = "N",
     .help = "samples a pixel of one replicate; default: as many as --margin needs by a pilot, within 60 s or --time",
     .group = agree_groups::samples,
     .sample = true},
    {.name = "time",
     .metavar = "D",
     .help = "of all sides together, pilot included; a verdict that needs a second stage takes up to four times as long again",
     .group = agree_groups::samples,
     .sample = true},
    {.name = "size",
     .metavar = "WxH",
     .help = "pixels; default: 96 wide by the camera's aspect",
     .group = agree_groups::samples,
     .sample = true},
    {.name = "alpha",
     .metavar = "P",
     .help = "chance of a false alarm of the whole run, shared by the integrators",
     .standard = "0.001",
     .group = agree_groups::rule},
    {.name = "margin",
     .metavar = "PERCENT",
     .help = "bias of the mean that must be resolvable before anything agrees",
     .standard = "1",
     .group = agree_groups::rule},
    {.name = "no-confirm",
     .help = "a first alarm is final; without this, new seeds and four times the samples must repeat it",
     .group = agree_groups::rule,
     .sample = true},
    {.name = "output",
     .letter = 'o',
     .metavar = "FOLDER|FILE",
     .help = "where they differ: FILE.png in false colour, FILE.exr the numbers, a folder both of each integrator; {integrator} expands; "
             "repeatable",
     .group = agree_groups::output,
     .repeatable = true},
    {.name = "csv", .metavar = "FILE|-", .help = "a line an integrator", .group = agree_groups::output},
    {.name = "json", .metavar = "FILE|-", .help = "everything, as one object", .group = agree_groups::output},
});

} // namespace chiaro::cli
