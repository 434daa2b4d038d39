// chiaro bench [SUITE]: what this machine does in a second, as tables and as JSON.
#include "tools/bench/bench.h"
#include "io/replace_file.h"
#include "tools/bench/memory.h"
#include "tools/cli/compare_output.h"
#include "tools/cli/integrator_list.h"
#include "tools/cli/report.h"
#include "tools/cli/signals.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchSettings {
    std::vector<const bench::Suite*> suites;
    std::vector<std::string> scenes;           // empty: the suite's own
    std::vector<IntegratorChoice> integrators; // empty: the suite's own
    std::vector<unsigned> threads;
    Size size;
    double seconds = 20, replaySeconds = 0;
    uint32_t runs = 3;
    uint64_t seed = 0;
    std::size_t memory = 0;
    bool json = false, quiet = false;
    std::string isa;
    std::filesystem::path plot; // empty: none
};

std::vector<std::string> pieces(std::string_view list, std::string_view option) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        all.emplace_back(list.substr(begin, end - begin));
        if (all.back().empty()) throw Error(Exit::usage, fmt::format("--{} \"{}\": a name is missing between the commas", option, list));
        begin = end + 1;
    }
    return all;
}

std::vector<const bench::Suite*> readSuites(const Arguments& a) {
    std::vector<const bench::Suite*> all;
    std::vector<std::string> names;
    for (const bench::Suite& s : bench::suites()) {
        names.emplace_back(s.name);
        if (a.operands.empty() || a.operands[0] == s.name) all.push_back(&s);
    }
    if (!all.empty()) return all;
    const std::string near = nearest(a.operands[0], names);
    throw Error(Exit::usage, fmt::format("no suite \"{}\"; have {}{}", a.operands[0], fmt::join(names, ", "),
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

std::vector<unsigned> readThreads(const Arguments& a) {
    std::vector<unsigned> all;
    const unsigned machine = Executor().threads();
    if (a.given("threads"))
        for (const std::string& piece : pieces(a.text("threads"), "threads"))
            all.push_back(unsigned(parseWhole("threads", piece, 1, 4096)));
    else
        for (all = {machine}; all.size() < 16 && 1u << (all.size() - 1) < machine;) all.push_back(1u << (all.size() - 1));
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

void readPlot(const Arguments& a, BenchSettings& s) {
    if (!a.given("plot")) return;
    s.plot = a.text("plot");
    std::vector<std::string> growing;
    for (const bench::Suite& suite : bench::suites())
        if (suite.plot) growing.emplace_back(suite.name);
    if (s.suites.size() != 1 || !s.suites[0]->plot)
        throw Error(Exit::usage, fmt::format("--plot: one suite that shows growth has a plot; name {}", fmt::join(growing, " or ")));
    if (s.plot.extension() != ".svg")
        throw Error(Exit::usage, fmt::format("--plot {}: it is an SVG picture; end it in .svg", s.plot.string()));
}

BenchSettings readBench(const Arguments& a) {
    BenchSettings s;
    s.suites = readSuites(a);
    if (a.given("scenes")) s.scenes = pieces(a.text("scenes"), "scenes");
    if (a.given("integrator")) s.integrators = chooseIntegrators(a.text("integrator"));
    s.threads = readThreads(a);
    s.size = parseSize("size", a.text("size"));
    if (s.size.width < 8 || s.size.height < 8) throw Error(Exit::usage, "--size: the views of bench are 8x8 at least, a tile of rays");
    s.seconds = parseDuration("time", a.text("time"));
    if (a.given("replay-time")) s.replaySeconds = parseDuration("replay-time", a.text("replay-time"));
    s.runs = uint32_t(parseWhole("runs", a.text("runs"), 1, 1000));
    s.seed = parseWhole("seed", a.text("seed"), 0, ~uint64_t(0));
    s.json = a.on("json");
    s.quiet = a.on("quiet");
    s.isa = a.text("isa");
    readPlot(a, s);
    s.memory = readMemoryBudget(a).bytes;
    return s;
}

std::vector<IntegratorChoice> integratorsOf(const BenchSettings& s, const bench::Suite& suite) {
    if (!s.integrators.empty()) return s.integrators;
    return suite.integrators.empty() ? allLightTransport() : chooseIntegrators(std::string(suite.integrators));
}
// Of a suite that makes its own scenes: none.
std::vector<std::string> scenesOf(const BenchSettings& s, const bench::Suite& suite) {
    if (suite.scenes.empty()) return {};
    return s.scenes.empty() ? pieces(suite.scenes, "scenes") : s.scenes;
}

// Scenes stay loaded from suite to suite.
class Scenes {
public:
    Scenes(const BenchSettings& s, const Arguments& a, Diagnostics& notes, const Console& console)
        : s_(s), a_(a), notes_(notes), console_(console) {}
    bench::BenchScene scene(const std::string& name) {
        for (const Loaded& l : all_)
            if (l.name == name) return {l.name, l.loaded.scene.get(), l.view};
        SceneRequest request = readSceneRequest(a_);
        request.operand = name;
        RenderSettings frame;
        frame.scene = request;
        frame.size = fmt::format("{}x{}", s_.size.width, s_.size.height);
        Loaded one{name, loadScene(request, notes_, Executor()), View()};
        CameraDesc camera;
        bool automatic = false;
        one.view = makeView(frame, one.loaded, camera, automatic);
        const SceneCounts& c = one.loaded.scene->counts();
        console_.phase("scene", fmt::format("{}   {} triangles, {}x{}, {}", name, c.trianglesDrawn, s_.size.width, s_.size.height,
                                            duration(one.loaded.seconds)));
        all_.push_back(std::move(one));
        return {name, all_.back().loaded.scene.get(), all_.back().view};
    }

private:
    struct Loaded {
        std::string name;
        LoadedScene loaded;
        View view;
    };
    const BenchSettings& s_;
    const Arguments& a_;
    Diagnostics& notes_;
    const Console& console_;
    std::deque<Loaded> all_;
};

// What is being measured; nothing else, since a line now and then would be measured too.
class Phases : public Progress {
public:
    explicit Phases(const Console& console) : console_(console) {}
    void phase(std::string_view text) override { console_.phase("measure", std::string(text)); }

private:
    const Console& console_;
};

std::string cell(double v) {
    if (!std::isfinite(v)) return "-";
    const double size = std::abs(v);
    return size >= 1000 ? fmt::format("{:.0f}", v) : fmt::format("{:.3g}", v);
}

std::string tableText(const bench::Table& t) {
    std::vector<std::vector<std::string>> lines;
    std::vector<std::string> names{"scene", "what", "threads", "spread"}, units{"", "", "", "%"};
    for (const bench::Column& c : t.columns) {
        names.push_back(c.name);
        units.push_back(c.unit);
    }
    lines.push_back(names);
    lines.push_back(units);
    for (const bench::Row& r : t.rows) {
        lines.push_back({r.scene, r.subject, fmt::format("{}", r.threads), r.spread > 0 ? fmt::format("{:.1f}", 100 * r.spread) : "-"});
        for (const double v : r.cells) lines.back().push_back(cell(v));
    }
    std::vector<std::size_t> widths(names.size());
    for (const auto& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
    std::string text = fmt::format("{}: {}\n", t.suite, t.title);
    for (const auto& line : lines) {
        std::string row;
        for (std::size_t i = 0; i < line.size(); ++i)
            row += i < 2 ? fmt::format("{:<{}}  ", line[i], widths[i]) : fmt::format("{:>{}}  ", line[i], widths[i]);
        row.resize(row.find_last_not_of(' ') + 1);
        text += row + "\n";
    }
    for (const std::string& note : t.notes) text += note + "\n";
    return text + "\n";
}

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json tableJson(const bench::Table& t) {
    Json j{{"suite", t.suite}, {"title", t.title}, {"stopped", t.stopped}, {"failed", t.failed}};
    j["columns"] = Json::array();
    for (const bench::Column& c : t.columns) j["columns"].push_back({{"name", c.name}, {"unit", c.unit}});
    j["rows"] = Json::array();
    for (const bench::Row& r : t.rows) {
        Json row{
            {"scene", r.scene}, {"subject", r.subject}, {"threads", r.threads}, {"spread", number(r.spread)}, {"values", Json::array()}};
        for (const double v : r.cells) row["values"].push_back(number(v));
        j["rows"].push_back(std::move(row));
    }
    j["notes"] = t.notes;
    return j;
}

bool slowBuild() { return buildType != "release" && buildType != "relwithdebinfo"; }

} // namespace

std::string benchNotes() {
    std::string text = "\nSuites (default: all)\n";
    for (const bench::Suite& s : bench::suites())
        text += fmt::format("  {:<12} {}; on {}\n", s.name, s.summary, s.scenes.empty() ? "scenes of its own" : s.scenes);
    return text + R"(
Every figure is the median of several runs; spread: (largest - smallest) / median of the first figure. Compare figures of one run of bench:
another minute, another machine. Nothing else should be running. Exit code 0 done, 2 a replay that found other hits than its render, 4 a file, 5 stopped by Ctrl-C with
the rows so far.
)";
}

int runBench(const Arguments& arguments) {
    const BenchSettings s = readBench(arguments);
    Console console(s.quiet);
    Diagnostics notes;
    if (!s.plot.empty()) checkWritable(s.plot);
    if (slowBuild())
        notes.warn(fmt::format("THIS IS A {} BUILD: its figures say nothing about chiaro. Build with: cmake --preset release", buildType));
    console.warnings(notes);
    console.phase("machine", machineName(s.threads.back(), s.isa.empty() ? bestIsa() : s.isa));
    StopToken stop;
    const StopOnSignal signals(stop);
    Phases progress(console);
    Scenes scenes(s, arguments, notes, console);
    Json all{{"version", version},
             {"commit", commit},
             {"build", buildType},
             {"machine", machineName(s.threads.back(), s.isa.empty() ? bestIsa() : s.isa)},
             {"suites", Json::array()}};
    bool failed = false;
    for (const bench::Suite* suite : s.suites) {
        bench::Request request{.scenes = {},
                               .integrators = integratorsOf(s, *suite),
                               .threads = s.threads,
                               .seconds = s.seconds,
                               .runs = s.runs,
                               .replaySeconds = s.replaySeconds,
                               .seed = s.seed,
                               .memoryLimit = s.memory,
                               .width = s.size.width,
                               .height = s.size.height,
                               .isa = s.isa,
                               .stop = stop,
                               .progress = progress,
                               .notes = notes};
        for (const std::string& name : scenesOf(s, *suite)) request.scenes.push_back(scenes.scene(name));
        console.warnings(notes);
        const bench::Table table = suite->run(request);
        console.warnings(notes);
        failed = failed || table.failed;
        if (!s.plot.empty()) {
            const std::string svg = bench::svgPlot(suite->plot(table));
            replaceFile(s.plot, std::as_bytes(std::span(svg)));
            console.phase("wrote", fmt::format("{}  growth, over logarithmic axes", s.plot.string()));
        }
        if (s.json)
            all["suites"].push_back(tableJson(table));
        else
            fmt::print("{}", tableText(table));
        if (stop.cancelled()) break;
    }
    const double peak = double(bench::peakOfAll());
    all["peakMemory"] = peak;
    console.phase("memory", fmt::format("{} at the peak of all", memorySize(peak)));
    all["stopped"] = stop.cancelled();
    if (s.json) fmt::print("{}\n", all.dump(2, ' ', false, Json::error_handler_t::replace));
    if (stop.cancelled()) console.line("stopped; the rows that were done are above");
    const bool warned = arguments.on("strict") && !notes.warnings().empty();
    return failed ? int(Exit::failed) : stop.cancelled() ? int(Exit::stopped) : warned ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
