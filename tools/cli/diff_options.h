// The options of `chiaro diff`; the thresholds are named and meant as those of OpenImageIO's idiff.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

namespace diff_groups {
inline constexpr const char *compared = "What is compared", *measured = "What is measured",
                            *limits = "Limits (as idiff; absolute difference of a channel)", *output = "Output";
}

inline constexpr auto diffTable = std::to_array<OptionRow>({
    {.name = "layer",
     .metavar = "NAME",
     .help = "a layer of both files instead of R G B: albedo, normal, Z, a path class ...",
     .group = diff_groups::compared},
    {.name = "mask",
     .metavar = "FILE",
     .help = "a picture of the same size: white pixels are compared, black ones are not (the limit is 0.5)",
     .group = diff_groups::compared},
    {.name = "crop", .metavar = "WxH+X+Y", .help = "compare this window alone", .group = diff_groups::compared},
    {.name = "fit", .help = "compare the rectangle that both pictures have, from the upper left corner", .group = diff_groups::compared},
    {.name = "metrics",
     .metavar = "LIST",
     .help = "names from the list below; `flip` is the kind that --flip picks; default: all",
     .group = diff_groups::measured},
    {.name = "channels", .help = "a column for luminance and each channel", .group = diff_groups::measured},
    {.name = "flip",
     .metavar = "auto|ldr|hdr|none",
     .help = "auto: hdr for two linear pictures, else ldr; none for layers that hold no colour",
     .standard = "auto",
     .group = diff_groups::measured},
    {.name = "exposure",
     .metavar = "EV|auto",
     .help = "FLIP LDR of linear pictures: both are shown x 2^EV; auto takes that of B as `render` would (0 beside a PNG)",
     .standard = "auto",
     .group = diff_groups::measured},
    {.name = "peak",
     .metavar = "X",
     .help = "of PSNR; default: 1 for display-referred pictures, else the largest |B|",
     .group = diff_groups::measured},
    {.name = "fail",
     .metavar = "X",
     .help = "a pixel fails when a channel differs by more, or is not finite",
     .standard = "1e-06",
     .group = diff_groups::limits},
    {.name = "failpercent", .metavar = "P", .help = "share of the pixels that may fail", .standard = "0", .group = diff_groups::limits},
    {.name = "hardfail", .metavar = "X", .help = "fail if any one pixel differs by more; default: no limit", .group = diff_groups::limits},
    {.name = "warn", .metavar = "X", .help = "as --fail, for a warning", .standard = "1e-06", .group = diff_groups::limits},
    {.name = "warnpercent", .metavar = "P", .help = "share of the pixels that may warn", .standard = "0", .group = diff_groups::limits},
    {.name = "hardwarn", .metavar = "X", .help = "warn if any one pixel differs by more; default: no limit", .group = diff_groups::limits},
    {.name = "fail-metric",
     .metavar = "NAME=X",
     .help = "fail when the metric is worse than X, such as flip=0.02 or psnr=40; repeatable; alone, it replaces the limits above",
     .group = diff_groups::limits,
     .repeatable = true},
    {.name = "warn-metric", .metavar = "NAME=X", .help = "the same for a warning", .group = diff_groups::limits, .repeatable = true},
    {.name = "output",
     .letter = 'o',
     .metavar = "FILE",
     .help = "the signed difference in false colour: red where A is brighter, blue where B is; .png with a legend, .exr with the numbers "
             "as well; repeatable",
     .group = diff_groups::output,
     .repeatable = true},
    {.name = "scale",
     .metavar = "X|auto",
     .help = "the difference that gets full colour; auto: the 99 % quantile, rounded up",
     .standard = "auto",
     .group = diff_groups::output},
    {.name = "csv", .metavar = "FILE|-", .help = "a line for every metric and channel", .group = diff_groups::output},
    {.name = "json", .metavar = "FILE|-", .help = "everything, as one object", .group = diff_groups::output},
    {.name = "quiet", .letter = 'q', .help = "the exit code alone, warnings and errors", .group = diff_groups::output},
});

} // namespace chiaro::cli
