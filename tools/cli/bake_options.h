// The options of `chiaro bake` that no other command has, or that mean something else here.
#pragma once
#include "tools/cli/command.h"
#include <array>

namespace chiaro::cli {

inline constexpr auto bakeRows = std::to_array<OptionRow>({
    {.name = "integrator",
     .letter = 'i',
     .metavar = "NAME[:key=value,...]",
     .help = "whose light is baked; `chiaro integrators` lists them with their options",
     .standard = "path",
     .group = "Method",
     .sample = true},
    {.name = "estimate",
     .metavar = "gather|look",
     .help =
         "gather: direct light, and what the integrator answers along rays over the hemisphere; look: what it shows of the surface seen "
         "straight on (photons, patches, ambient terms and views like ao as they are); default: gather, for views look",
     .group = "Method",
     .sample = true},
    {.name = "light",
     .metavar = "all|direct|indirect",
     .help = "which light is baked; indirect alone for pages that keep their lamps",
     .standard = "all",
     .group = "Method",
     .sample = true},
    {.name = "spp", .metavar = "N", .help = "samples a texel or vertex, at most", .standard = "256", .group = "Budget"},
    {.name = "time", .metavar = "D", .help = "stop after this time: 30s, 5m, 2h; the first limit reached ends the bake", .group = "Budget"},
    {.name = "output",
     .letter = 'o',
     .metavar = "FILE",
     .help = "FILE.glb, or FILE.gltf with FILE.bin beside it; {scene} and {integrator} expand; default: {scene}-baked.glb here",
     .group = "Output"},
    {.name = "to",
     .metavar = "lightmap|vertex",
     .help = "a picture of the light on a second set of texture coordinates, or colours of the vertices",
     .standard = "lightmap",
     .group = "Output"},
    {.name = "mode",
     .metavar = "lit|keep",
     .help = "lit: surfaces shine with what leaves them, so that any viewer shows the lit scene without a lamp; keep: materials stay, the "
             "light lies beside them for a page of your own (lightMap, _IRRADIANCE)",
     .standard = "lit",
     .group = "Output"},
    {.name = "size", .metavar = "N", .help = "texels along the light map; default: 512, or as --density asks", .group = "Light map"},
    {.name = "density",
     .metavar = "N",
     .help = "texels a metre, the map as large as that takes; with --to vertex vertices a metre: longer edges are divided",
     .group = "Light map"},
    {.name = "padding", .metavar = "N", .help = "texels between charts, filled from their rims", .standard = "2", .group = "Light map"},
    {.name = "uv",
     .metavar = "auto|keep|new",
     .help = "texture coordinates of the file that do not overlap lead to the light map (auto), must (keep), or never do (new)",
     .standard = "auto",
     .group = "Light map"},
    {.name = "exposure",
     .metavar = "EV|auto",
     .help = "x 2^EV in what the file shows; the irradiance beside it is not scaled",
     .standard = "auto",
     .group = "Output"},
});

} // namespace chiaro::cli
