// The options of each subcommand: the one place where they are described.
#include "tools/cli/agree_options.h"
#include "tools/cli/bake_options.h"
#include "tools/cli/bench_options.h"
#include "tools/cli/command.h"
#include "tools/cli/compare_options.h"
#include "tools/cli/diff_options.h"
#include "tools/cli/ff_options.h"
#include "tools/cli/merge_options.h"
#include "tools/cli/trace_options.h"
#include <algorithm>
#include <array>

namespace chiaro::cli {
namespace {

constexpr const char *method = "Method", *budget = "Budget", *output = "Output", *frame = "Picture", *sampling = "Sampling",
                     *scene = "Scene", *display = "Display (PNG only; the EXR never changes)", *lens = "Lens", *general = "General";

constexpr OptionRow envRow{
    .name = "env",
    .metavar = "FILE|studio|white|none",
    .help = "environment light instead of the scene's: a lat-long EXR or HDR, a neutral studio, a white sky, or darkness",
    .group = scene,
    .sample = true};
constexpr OptionRow envRotateRow{.name = "env-rotate",
                                 .metavar = "DEG",
                                 .help = "turn the environment about +Y, counter-clockwise seen from above",
                                 .standard = "0",
                                 .group = scene,
                                 .sample = true};
constexpr OptionRow envScaleRow{
    .name = "env-scale", .metavar = "F", .help = "multiply the environment's radiance", .standard = "1", .group = scene, .sample = true};
constexpr OptionRow missingTextureRow{.name = "missing-texture",
                                      .metavar = "grey|error",
                                      .help = "what to do where a texture file is absent",
                                      .standard = "error",
                                      .group = scene,
                                      .sample = true};
constexpr OptionRow frameTimeRow{
    .name = "frame-time", .metavar = "T", .help = "the moment of the animation, seconds", .standard = "0", .group = scene, .sample = true};
constexpr OptionRow shutterRow{.name = "shutter",
                               .metavar = "D|OPEN:CLOSE",
                               .help = "how long the shutter is open from --frame-time on, seconds (0.02, 1/48), or from when to when "
                                       "relative to it (-0.01:0.01); what is animated blurs",
                               .standard = "0",
                               .group = scene,
                               .sample = true};
constexpr OptionRow animationRow{.name = "animation",
                                 .metavar = "NAME|N|all|none",
                                 .help = "which animation plays, by name or number (from 0), or all together; default: the first",
                                 .group = scene,
                                 .sample = true};
constexpr OptionRow sceneRow{.name = "scene",
                             .metavar = "NAME|N",
                             .help = "which scene of the file, by name or number (from 0); default: the one that the file says",
                             .group = scene,
                             .sample = true};
constexpr OptionRow isaRow{.name = "isa",
                           .metavar = "NAME",
                           .help = "Embree's instruction set: sse2, sse4.2, avx, avx2 or avx512; default: the machine's best",
                           .group = sampling,
                           .sample = true};
constexpr OptionRow strictRow{.name = "strict", .help = "warnings make the exit code 1", .group = general};
constexpr OptionRow jsonRow{.name = "json", .help = "results as JSON on stdout", .group = general};

constexpr auto renderTable = std::to_array<OptionRow>({
    {.name = "integrator",
     .letter = 'i',
     .metavar = "NAME[:key=value,...]",
     .help = "the algorithm; `chiaro integrators` lists them with their options",
     .standard = "path",
     .group = method,
     .sample = true},
    {.name = "prepass",
     .metavar = "NAME[:key=value,...]",
     .help = "solved before the picture: its diffuse field is the indirect light of whitted and distributed (photon, radiosity: chiaro "
             "integrators); default: none",
     .group = method,
     .sample = true},
    {.name = "prepass-file",
     .metavar = "FILE",
     .help = "the solution is taken from FILE where it fits, else solved and kept there; another camera needs no other",
     .group = method,
     .sample = true},
    {.name = "max-depth",
     .metavar = "N",
     .help = "most scatterings: 0 emission, 1 direct light, 2 one indirect bounce; default: no limit",
     .group = method,
     .sample = true},
    {.name = "paths",
     .metavar = "EXPR",
     .help = "only these light paths, such as \"L S+ D E\"; the grammar: chiaro help paths",
     .group = method,
     .sample = true},
    {.name = "split",
     .metavar = "paths|bounces|LIST",
     .help = "layers that sum to the picture: ten path classes, one a bounce, or direct,indirect, or NAME=EXPR,...,rest",
     .group = method,
     .sample = true},
    {.name = "rr-depth",
     .metavar = "N",
     .help = "scatterings before Russian roulette may end a path; default: the integrator's",
     .group = method,
     .sample = true},
    {.name = "aa",
     .metavar = "MODE[:N]",
     .help = "whitted's anti-aliasing: centre, grid, jitter, poisson or adaptive with N samples a pixel; default: samples from --filter",
     .group = method,
     .sample = true},
    {.name = "spp",
     .metavar = "N",
     .help = "samples a pixel, at most; 2k, 1M are understood; built-in scenes have their own default",
     .standard = "256",
     .group = budget},
    {.name = "time", .metavar = "D", .help = "stop after this time: 30s, 5m, 2h; the first limit reached ends the render", .group = budget},
    {.name = "noise",
     .metavar = "P",
     .help = "stop when the picture's relative error is below P percent with 95 % confidence: 2%; how it is found: chiaro help noise",
     .group = budget},
    {.name = "sample-range",
     .metavar = "A:B",
     .help = "only the samples A to B - 1 of every pixel, as a part (.chk) for chiaro merge: one picture by several machines",
     .group = budget},
    {.name = "checkpoint-every",
     .metavar = "D",
     .help = "so often, and at the end, what is there so far is kept in a .chk: 10m; Ctrl-C and SIGTERM always keep it",
     .group = budget},
    {.name = "resume",
     .metavar = "FILE.chk",
     .help =
         "go on from a checkpoint: the same bits as without the interruption; it knows the options, a new --spp, --time or --noise may be "
         "given",
     .group = budget},
    {.name = "output",
     .letter = 'o',
     .metavar = "FILE",
     .help = "FILE.exr (float32, linear Rec.709, layers), FILE.png, or FILE.chk (a checkpoint, kept at the end too); repeatable; {scene} "
             "{integrator} {spp} expand; default: {scene}.exr and {scene}.png here, or {scene}.A-B.chk of a --sample-range",
     .group = output,
     .repeatable = true},
    {.name = "aov",
     .metavar = "LIST",
     .help =
         "layers beside the beauty: albedo, normal, Z, cost, photons, all or none; cost is what a sample takes: cost.time (microseconds of "
         "one "
         "thread, another number in every run), cost.rays, cost.depth, and beside FILE.png also FILE.cost.rays.png ... in false colour; "
         "photons is what density estimates found, of integrators that have photons: photons.density (1/m2), photons.radius (m), "
         "photons.count",
     .standard = "albedo,normal,Z",
     .group = output},
    {.name = "photon-map",
     .metavar = "FILE.glb",
     .help = "the photons as points in the scene, each in the colour of its flux; of integrators that have photons",
     .group = output},
    {.name = "size",
     .metavar = "WxH",
     .help = "pixels; default: 1280 wide by the camera's aspect (16:9 without); built-in scenes have their own",
     .group = frame,
     .sample = true},
    {.name = "crop", .metavar = "WxH+X+Y", .help = "render only this window of the picture", .group = frame},
    {.name = "pixel", .metavar = "X,Y", .help = "replay one sample of this pixel, print its R G B and write no file", .group = frame},
    {.name = "sample", .metavar = "N", .help = "which sample --pixel replays", .standard = "0", .group = frame},
    {.name = "sampler",
     .metavar = "sobol|independent",
     .help = "Owen-scrambled Sobol' points, or independent random numbers",
     .standard = "sobol",
     .group = sampling,
     .sample = true},
    {.name = "filter",
     .metavar = "box|gauss|blackman-harris",
     .help = "pixel reconstruction filter",
     .standard = "blackman-harris",
     .group = sampling,
     .sample = true},
    {.name = "seed",
     .metavar = "N",
     .help = "another seed, another independent render",
     .standard = "0",
     .group = sampling,
     .sample = true},
    {.name = "threads", .letter = 't', .metavar = "N", .help = "default: all cores; the picture does not depend on it", .group = sampling},
    isaRow,
    {.name = "camera",
     .letter = 'c',
     .metavar = "NAME|N|auto",
     .help = "camera by name or number (from 0); auto frames the whole scene; default: the first",
     .group = scene,
     .sample = true},
    {.name = "aperture",
     .metavar = "D|f/N",
     .help = "diameter of the lens in metres, or an f-number on a 24 mm high sensor whose focal length follows from the camera's angle; "
             "default: a pinhole",
     .group = lens,
     .sample = true},
    {.name = "focus",
     .metavar = "D|X,Y|auto",
     .help = "what is sharp: metres along the viewing axis, what this pixel sees, or what the picture's centre sees",
     .standard = "auto",
     .group = lens,
     .sample = true},
    {.name = "blades",
     .metavar = "N[:DEG]",
     .help = "an opening of N straight edges, turned by so many degrees; default: round",
     .group = lens,
     .sample = true},
    envRow,
    envRotateRow,
    envScaleRow,
    missingTextureRow,
    frameTimeRow,
    shutterRow,
    animationRow,
    sceneRow,
    {.name = "exposure",
     .metavar = "EV|auto",
     .help = "x 2^EV; auto brings the log-average to 0.18 with the 99.5 % quantile kept below clipping",
     .standard = "auto",
     .group = display},
    {.name = "view",
     .metavar = "NAME",
     .help = "view of the OpenColorIO configuration; default: sRGB without tone mapping (\"Standard\")",
     .group = display},
    {.name = "ocio", .metavar = "CONFIG", .help = "another OpenColorIO configuration; $OCIO is taken too", .group = display},
    {.name = "max-memory",
     .metavar = "SIZE",
     .help = "what would need more is refused before it begins: 500M, 32G; default: 80 % of the machine's",
     .group = general},
    {.name = "config",
     .metavar = "FILE.json",
     .help = "options from a JSON object, e.g. {\"spp\": 64}; the command line wins",
     .group = general},
    strictRow,
    jsonRow,
    {.name = "progress",
     .metavar = "auto|bar|lines|json|none",
     .help = "how to show progress on stderr; auto: a bar on a terminal, a line every 10 s elsewhere",
     .standard = "auto",
     .group = general},
    {.name = "quiet", .letter = 'q', .help = "only warnings and errors", .group = general},
    {.name = "verbose", .letter = 'v', .help = "more about what is used", .group = general},
});

constexpr auto infoTable = std::to_array<OptionRow>(
    {envRow, envRotateRow, envScaleRow, missingTextureRow, frameTimeRow, shutterRow, animationRow, sceneRow, isaRow, strictRow, jsonRow});
constexpr auto jsonTable = std::to_array<OptionRow>({jsonRow});
constexpr std::span<const OptionRow> noOptions;

constexpr OptionRow renderRow(std::string_view name) {
    return *std::find_if(renderTable.begin(), renderTable.end(), [&](const OptionRow& o) { return o.name == name; });
}
template <std::size_t N, std::size_t M>
constexpr std::array<OptionRow, N + M> joined(const std::array<OptionRow, N>& a, const std::array<OptionRow, M>& b) {
    std::array<OptionRow, N + M> all{};
    std::copy(b.begin(), b.end(), std::copy(a.begin(), a.end(), all.begin()));
    return all;
}
// What `agree` and `compare` take over from `render`.
constexpr auto sharedRows = std::to_array<OptionRow>({renderRow("prepass"),
                                                      renderRow("prepass-file"),
                                                      renderRow("max-depth"),
                                                      renderRow("paths"),
                                                      renderRow("crop"),
                                                      renderRow("sampler"),
                                                      renderRow("filter"),
                                                      renderRow("seed"),
                                                      renderRow("threads"),
                                                      isaRow,
                                                      renderRow("camera"),
                                                      renderRow("aperture"),
                                                      renderRow("focus"),
                                                      renderRow("blades"),
                                                      envRow,
                                                      envRotateRow,
                                                      envScaleRow,
                                                      missingTextureRow,
                                                      frameTimeRow,
                                                      shutterRow,
                                                      animationRow,
                                                      sceneRow,
                                                      renderRow("max-memory"),
                                                      renderRow("config"),
                                                      strictRow,
                                                      renderRow("progress"),
                                                      renderRow("quiet"),
                                                      renderRow("verbose")});
constexpr auto agreeTable = joined(agreeRows, sharedRows);

// Every option of `render` on which the value of a sample depends, so that the same words ask for the same sample.
constexpr bool ofSample(const OptionRow& o) { return o.sample && o.name != "integrator"; }
constexpr auto sampleRows = [] {
    std::array<OptionRow, std::size_t(std::count_if(renderTable.begin(), renderTable.end(), ofSample))> rows{};
    std::copy_if(renderTable.begin(), renderTable.end(), rows.begin(), ofSample);
    return rows;
}();
constexpr auto traceTable =
    joined(traceRows, joined(sampleRows, std::to_array<OptionRow>({renderRow("threads"), renderRow("max-memory"), renderRow("config"),
                                                                   strictRow, renderRow("quiet")})));

constexpr auto compareTable =
    joined(compareRows,
           joined(std::to_array<OptionRow>({renderRow("size"), renderRow("exposure"), renderRow("view"), renderRow("ocio")}), sharedRows));

// What `bake` takes over from `render`.
constexpr auto bakeTable = joined(bakeRows, std::to_array<OptionRow>({renderRow("prepass"),
                                                                      renderRow("prepass-file"),
                                                                      renderRow("max-depth"),
                                                                      renderRow("rr-depth"),
                                                                      renderRow("sampler"),
                                                                      renderRow("seed"),
                                                                      renderRow("threads"),
                                                                      isaRow,
                                                                      envRow,
                                                                      envRotateRow,
                                                                      envScaleRow,
                                                                      missingTextureRow,
                                                                      frameTimeRow,
                                                                      animationRow,
                                                                      sceneRow,
                                                                      renderRow("max-memory"),
                                                                      renderRow("config"),
                                                                      strictRow,
                                                                      jsonRow,
                                                                      renderRow("progress"),
                                                                      renderRow("quiet"),
                                                                      renderRow("verbose")}));

constexpr auto infoCommandTable = joined(infoTable, std::to_array<OptionRow>({renderRow("max-memory")}));

constexpr auto benchTable =
    joined(benchRows, joined(infoTable, std::to_array<OptionRow>({renderRow("max-memory"), renderRow("config"), renderRow("quiet")})));

constexpr auto mergeTable =
    joined(mergeRows, std::to_array<OptionRow>({renderRow("aov"), renderRow("exposure"), renderRow("view"), renderRow("ocio"),
                                                renderRow("max-memory"), renderRow("config"), strictRow, jsonRow, renderRow("quiet")}));

constexpr auto ffTable =
    joined(ffRows, joined(infoTable, std::to_array<OptionRow>({renderRow("sampler"), renderRow("seed"), renderRow("threads"),
                                                               renderRow("max-memory"), renderRow("config"), renderRow("quiet")})));

constexpr auto table = std::to_array<Command>({
    {"render", "SCENE", "one integrator, EXR + PNG", renderTable, runRender, 1, 1},
    {"compare", "SCENE|IMAGE...", "several integrators or images side by side: report.html, sheet.png, results.csv, EXRs", compareTable,
     runCompare, 1, 256, compareNotes},
    {"diff", "A B", "two images: metrics and an exit code", diffTable, runDiff, 2, 2, diffNotes},
    {"agree", "SCENE|A.exr B.exr", "do the integrators agree? a statistical verdict, an exit code", agreeTable, runAgree, 1, 2, agreeNotes},
    {"trace", "SCENE --pixel X,Y", "the ray tree or path of one sample, as text and as GLB", traceTable, runTrace, 1, 1},
    {"bake", "SCENE", "light into the scene: vertex colours or a light map, as glTF", bakeTable, runBake, 1, 1},
    {"ff", "SCENE [I] [J]", "the patches of a scene and their form factors, checked", ffTable, runFormFactors, 1, 3},
    {"merge", "PART...", "ranges of samples that were rendered apart, as the one picture", mergeTable, runMerge, 1, 65536, mergeNotes},
    {"info", "SCENE|IMAGE", "what is in it, what Chiaro will use, approximate, ignore, add", infoCommandTable, runInfo, 1, 1},
    {"bench", "[SUITE]", "what this machine does in a second: rays, samples, photons, radiosity", benchTable, runBench, 0, 1, benchNotes},
    {"scenes", "", "the scenes inside the program", jsonTable, runScenes, 0, 0},
    {"integrators", "[NAME]", "the algorithms, their options and the light paths they cover", jsonTable, runIntegrators, 0, 1},
    {"doctor", "", "checks this installation: libraries, memory, disk, a self-test render", jsonTable, runDoctor, 0, 0},
    {"help", "[COMMAND|TOPIC]", "this overview, a command, or a topic: units, paths, prepass, noise, exit-codes, scenes", noOptions,
     runHelp, 0, 1},
});

} // namespace

std::span<const Command> commands() { return table; }

} // namespace chiaro::cli
