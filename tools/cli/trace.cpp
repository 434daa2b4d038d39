#include "tools/cli/trace.h"
#include "io/replace_file.h"
#include "tools/cli/integrator_list.h"
#include "tools/cli/prepass_solver.h"
#include "tools/cli/report.h"
#include "tools/cli/signals.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

constexpr uint32_t mostSamples = 4096;

// What `chiaro render` would have been given for one of the integrators: every option on which the value of a sample depends.
Arguments asRender(const Arguments& from, const std::string& integrator) {
    const std::span<const Command> all = commands();
    Arguments to;
    to.command = &*std::find_if(all.begin(), all.end(), [](const Command& c) { return c.name == "render"; });
    to.operands = from.operands;
    to.line = from.line;
    const bool prepass = takesPrepass(chooseIntegrator(integrator));
    for (const OptionRow& o : to.command->options)
        if (from.given(o.name) && (o.sample || o.name == "threads" || o.name == "max-memory" || o.name == "quiet") &&
            (prepass || !o.name.starts_with("prepass")))
            to.set(o.name, from.all(o.name));
    to.set("integrator", {integrator});
    return to;
}

std::string readOutput(const Arguments& a, const SceneRequest& scene) {
    std::string output = a.text("output");
    if (output.empty()) return {};
    if (output == "-") throw Error(Exit::usage, "-o -: a .glb does not go to stdout; give a file name ending in .glb");
    if (std::filesystem::path(output).extension() != ".glb")
        throw Error(Exit::usage, fmt::format("-o {}: the rays are written as .glb; give a file name with this ending", output));
    if (const std::size_t at = output.find("{scene}"); at != std::string::npos) output.replace(at, 7, scene.stem());
    return output;
}

// A path that does not belong to a pixel: by its number alone.
TracedSample tellPath(const Job& job, const PathSource& source, uint32_t number) {
    TracedSample s{.number = number, .camera = false, .ray = {}, .log = {}};
    source.tellPath(job, number, s.log);
    s.value = s.sum();
    return s;
}

TracedSide traceSide(const TraceSide& side, const Job& job, Pixel pixel, const TraceSettings& s) {
    TracedSide traced{.side = &side, .samples = {}};
    const IntegratorChoice& choice = side.settings.integrator;
    const auto integrator = choice.entry->make(choice.options);
    auto* camera = dynamic_cast<CameraIntegrator*>(integrator.get());
    const auto* source = dynamic_cast<const PathSource*>(integrator.get());
    if (!camera && !source)
        throw Error(Exit::unsupported,
                    fmt::format("-i {}: its picture is not made path by path, so that none can be shown; try -i path", choice.entry->name));
    integrator->prepare(job);
    for (uint32_t i = 0; i < s.spp; ++i) {
        if (!camera) {
            traced.samples.push_back(tellPath(job, *source, s.sample + i));
            continue;
        }
        TracedSample sample{.number = s.sample + i, .ray = {}, .log = {}};
        const Replayed r = replay(job, *camera, pixel, sample.number, &sample.log);
        sample.ray = r.start.ray;
        sample.value = r.value;
        sample.rays = r.rays;
        sample.depth = r.depth;
        traced.samples.push_back(std::move(sample));
    }
    return traced;
}

int deliverTrace(const TraceSettings& s, const Trace& trace, const Diagnostics& notes, const Console& console) {
    std::vector<std::string> files;
    if (!s.output.empty()) {
        writeTrace(s.output, trace);
        files.push_back(s.output);
    }
    fmt::print("{}", s.json ? traceJson(trace, files, notes.warnings()) : traceText(trace));
    if (!files.empty()) console.phase("wrote", fmt::format("{}  the rays as coloured lines; any glTF viewer shows them", s.output));
    return s.strict && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

} // namespace

TraceSettings readTraceSettings(const Arguments& a) {
    TraceSettings s;
    const std::string list = a.text("integrator");
    requireTaker(readPrepass(a), chooseIntegrators(list)); // unknown and repeated names too
    for (const std::string& name : splitIntegrators(list)) {
        TraceSide& side = s.sides.emplace_back();
        side.arguments = asRender(a, name);
        side.settings = readSettings(side.arguments);
        side.recipe = nameWith(side.settings.integrator, side.settings.prepass.get());
    }
    s.pixel = a.text("pixel");
    if (s.pixel.empty()) throw Error(Exit::usage, "trace needs --pixel X,Y: the pixel whose path is to be shown (chiaro help trace)");
    s.spp = uint32_t(parseWhole("spp", a.text("spp"), 1, mostSamples));
    s.sample = uint32_t(parseWhole("sample", a.text("sample"), 0, 0xffffffffu - mostSamples));
    s.output = readOutput(a, s.common().scene);
    s.json = a.on("json");
    s.strict = a.on("strict");
    return s;
}

Spectrum TracedSample::sum() const {
    Spectrum all(0);
    for (const PathLog::Vertex& v : log.vertices()) all += v.contribution;
    return all;
}

bool TracedSide::told() const {
    return std::any_of(samples.begin(), samples.end(), [](const TracedSample& s) { return !s.log.vertices().empty(); });
}

std::string_view eventName(Event e) {
    static constexpr std::array<std::string_view, eventCount> names = {"DR", "DT", "GR", "GT", "SR", "ST"};
    return names[std::size_t(e)];
}

std::string Trace::lightName(const PathLog& log, uint32_t vertex) const {
    const PathLog::Vertex& v = log.vertices()[vertex];
    return lights.name(v, v.parent == PathLog::none ? nullptr : &log.vertices()[v.parent]);
}

std::string Trace::pathClass(const PathLog& log, uint32_t vertex) const {
    static constexpr const char* kinds[] = {"La", "Ld", "Le"};
    const std::vector<PathLog::Vertex>& all = log.vertices();
    if (black(all[vertex].contribution)) return {};
    uint32_t root = vertex;
    for (uint32_t i = vertex; i != PathLog::none; i = all[i].parent) root = i;
    const bool fromLight = all[root].kind == PathLog::Kind::emission;
    const uint32_t light = all[fromLight ? root : vertex].light;
    if (light == PathLog::none || (fromLight && !all[vertex].event && all[vertex].parent != root)) return {};
    std::vector<std::string> events;
    for (uint32_t i = vertex; i != PathLog::none; i = all[i].parent)
        if (all[i].event) events.emplace_back(eventName(*all[i].event));
    if (fromLight) std::reverse(events.begin(), events.end());
    return fmt::format("{} {}{}E", kinds[int(lights.kind(light))], fmt::join(events, " "), events.empty() ? "" : " ");
}

int runTrace(const Arguments& arguments) {
    const TraceSettings s = readTraceSettings(arguments);
    const RenderSettings& common = s.common();
    Console console(arguments.on("quiet"));
    Diagnostics notes;
    if (!s.output.empty()) checkWritable(s.output);
    const Executor run(common.threads);
    const LoadedScene loaded = loadScene(common.scene, notes, run);
    CameraDesc camera;
    bool automatic = false;
    const View view = makeView(common, loaded, camera, automatic);
    const LightNames lights(*loaded.scene);
    Trace trace{.scene = *loaded.scene,
                .lights = lights,
                .operand = common.scene.operand,
                .camera = automatic ? "auto" : camera.name,
                .seed = common.seed,
                .pixel = parsePixel("pixel", s.pixel, {view.width, view.height}),
                .sides = {}};
    tellScene(common, loaded, trace.camera, console);
    Progress silent;
    StopToken stop;
    const StopOnSignal signals(stop);
    PrepassSolver solver(readPrepass(arguments), common.scene);
    for (const TraceSide& side : s.sides) {
        const RenderSettings& o = side.settings;
        const Work work{*loaded.scene, o.classes, view.shutter, o.seed, o.sampler,
                        run,           stop,      silent,       notes,  common.scene.memory.beside(*loaded.scene)};
        const SolvedPrepass solved = o.prepass.choice ? solver.solve(work) : SolvedPrepass();
        tellPrepass(solver, solved, console);
        const Job job{work, view, solved.field.get()};
        if (!stop.cancelled()) trace.sides.push_back(traceSide(side, job, trace.pixel, s));
        if (stop.cancelled()) return int(Exit::killed);
    }
    console.facts(notes);
    console.warnings(notes);
    return deliverTrace(s, trace, notes, console);
}

} // namespace chiaro::cli
