// chiaro ff SCENE [I] [J]: the patches of a scene and their form factors.
#include "tools/cli/ff.h"
#include "core/math/sampler.h"
#include "tools/cli/settings.h"
#include "tools/cli/signals.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace chiaro::cli {
namespace {

using namespace radiosity;

constexpr uint32_t replicas = 16;
constexpr double mostAsymmetry = 1e-3, mostOpenExcess = 1e-3, mostClosedError = 5e-3, mostExactError = 1e-6;

struct Setup {
    SceneRequest scene;
    PatchSettings patches;
    FormFactorSettings factors;
    std::string from, to; // as typed
    RenderSettings render;
    bool check = false, json = false, strict = false, quiet = false;
    bool exact() const { return factors.method == FormFactorMethod::analytic && factors.shadowRays == 0; }
};

Setup readSetup(const Arguments& a) {
    Setup s;
    s.scene = readSceneRequest(a);
    constexpr FormFactorMethod methods[] = {FormFactorMethod::analytic, FormFactorMethod::hemisphere, FormFactorMethod::hemicube};
    s.factors.method = methods[parseChoice("method", a.text("method"), {"analytic", "hemisphere", "hemicube"})];
    s.factors.rays = uint32_t(parseWhole("rays", a.text("rays"), 1, 1u << 30));
    s.factors.resolution = uint32_t(parseWhole("resolution", a.text("resolution"), 2, 8192));
    s.factors.points = uint32_t(parseWhole("points", a.text("points"), 1, 1u << 16));
    s.factors.shadowRays = uint32_t(parseWhole("shadow-rays", a.text("shadow-rays"), 0, 1u << 20));
    s.patches.count = uint32_t(parseWhole("patches", a.text("patches"), 1, s.patches.most));
    if (a.given("size")) s.patches.size = float(parseReal("size", a.text("size"), 1e-9, 1e9));
    if (a.given("size") && a.given("patches")) throw Error(Exit::usage, "--size and --patches: give one of them");
    if (a.operands.size() > 1) s.from = a.operands[1];
    if (a.operands.size() > 2) s.to = a.operands[2];
    s.check = a.on("check");
    if (s.check && !s.from.empty()) throw Error(Exit::usage, "--check looks at all patches: leave out the names of single ones");
    s.json = a.on("json");
    s.strict = a.on("strict");
    s.quiet = a.on("quiet");
    s.render.seed = parseWhole("seed", a.text("seed"), 0, ~uint64_t(0));
    s.render.threads = uint32_t(parseWhole("threads", a.given("threads") ? a.text("threads") : "0", 0, 4096));
    constexpr SamplerKind samplers[] = {SamplerKind::sobol, SamplerKind::independent};
    s.render.sampler = samplers[parseChoice("sampler", a.text("sampler"), {"sobol", "independent"})];
    return s;
}

std::string methodText(const FormFactorSettings& s) {
    switch (s.method) {
    case FormFactorMethod::analytic:
        return s.shadowRays ? fmt::format("analytic, {} shadow rays a pair", s.shadowRays) : "analytic, as if nothing stood between";
    case FormFactorMethod::hemisphere: return fmt::format("hemisphere, {} rays a row", (s.rays + 15) / 16 * 16);
    default: return fmt::format("hemicube, {} pixels along the top, {} points a patch", s.resolution, s.points);
    }
}

// Which patches are meant: a number, or the name of an object.
FfSelection select(const std::string& text, const Patches& patches, const FfObjects& objects) {
    FfSelection s;
    const bool number = std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
    if (number) {
        if (patches.size() == 0) throw Error(Exit::usage, "the scene has no patches");
        const uint64_t i = text.size() > 10 ? ~uint64_t(0) : std::stoull(text);
        if (i >= patches.size())
            throw Error(Exit::usage, fmt::format("no patch {}; the scene has patches 0 to {}", text, patches.size() - 1));
        s.patches = {uint32_t(i)};
        s.name = fmt::format("{} of \"{}\"", i, objects.nameOf(patches[i]));
        return s;
    }
    s.name = fmt::format("\"{}\"", text);
    for (uint32_t i = 0; i < patches.size(); ++i)
        if (objects.nameOf(patches[i]) == text) s.patches.push_back(i);
    if (!s.patches.empty()) return s;
    const std::string near = nearest(text, objects.names);
    throw Error(Exit::usage, fmt::format("no object \"{}\"{}; chiaro ff SCENE lists them, and a number from 0 to {} is a patch", text,
                                         near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), patches.size() - 1));
}

double areaOf(const Patches& p, const std::vector<uint32_t>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0, [&](double s, uint32_t i) { return s + double(p[i].area); });
}

// From all of one to every object or patch group: group[j] of each patch, ~0: none. One replica.
std::vector<double> fluxes(const Work& work, const FormFactors& f, const std::vector<uint32_t>& from, const std::vector<uint32_t>& group,
                           std::size_t groups) {
    const Patches& p = f.patches();
    const double area = areaOf(p, from);
    std::vector<std::vector<double>> each(from.size());
    work.run.chunks(
        from.size(),
        [&](uint64_t k) {
            const uint32_t i = from[k];
            each[k].assign(groups, 0);
            std::vector<Factor> row;
            f.row(i, row);
            for (const Factor& x : row)
                if (group[x.patch] != ~0u) each[k][group[x.patch]] += double(x.factor) * double(p[i].area) / area;
        },
        nullptr);
    std::vector<double> sum(groups, 0);
    for (const auto& e : each)
        for (std::size_t g = 0; g < groups; ++g) sum[g] += e[g];
    return sum;
}

// Mean and standard error of each group, from independent replicas (other seeds).
std::vector<FfEstimate> estimate(const Setup& s, const Work& work, const Patches& patches, const std::vector<uint32_t>& from,
                                 const std::vector<uint32_t>& group, std::size_t groups) {
    const uint32_t n = s.exact() ? 1 : replicas;
    std::vector<FfEstimate> all(groups);
    std::vector<double> squares(groups, 0);
    for (uint32_t r = 0; r < n; ++r) {
        const Work other{work.scene, work.classes,  work.shutter, hashCombine(work.seed, r), work.sampler, work.run,
                         work.stop,  work.progress, work.notes,   work.memoryLimit};
        const std::vector<double> found = fluxes(other, FormFactors(other, patches, s.factors), from, group, groups);
        for (std::size_t g = 0; g < groups; ++g) all[g].value += found[g] / n, squares[g] += found[g] * found[g] / n;
        if (work.stop.requested()) throw Error(Exit::killed, "stopped; nothing was found");
    }
    for (std::size_t g = 0; g < groups; ++g)
        all[g].error =
            n == 1 ? mostExactError * all[g].value : std::sqrt(std::max(squares[g] - all[g].value * all[g].value, 0.0) / (n - 1));
    return all;
}

FfPair findPair(const Setup& s, const Work& work, const Patches& patches, const FfObjects& objects) {
    FfPair pair;
    pair.from = select(s.from, patches, objects);
    pair.to = select(s.to, patches, objects);
    const auto one = [&](const FfSelection& a, const FfSelection& b) {
        std::vector<uint32_t> group(patches.size(), ~0u);
        for (const uint32_t j : b.patches) group[j] = 0;
        return estimate(s, work, patches, a.patches, group, 1)[0];
    };
    pair.there = one(pair.from, pair.to);
    pair.back = one(pair.to, pair.from);
    pair.areaFrom = areaOf(patches, pair.from.patches);
    pair.areaTo = areaOf(patches, pair.to.patches);
    return pair;
}

FfRow findRow(const Setup& s, const Work& work, const Patches& patches, const FfObjects& objects) {
    FfRow row;
    row.from = select(s.from, patches, objects);
    std::vector<uint32_t> group(patches.size());
    for (uint32_t j = 0; j < patches.size(); ++j) group[j] = objects.numberOf(patches[j]);
    const auto found = estimate(s, work, patches, row.from.patches, group, objects.names.size());
    for (uint32_t g = 0; g < found.size(); ++g) {
        row.sum += found[g].value;
        if (found[g].value > 0) row.to.push_back({objects.names[g], found[g]});
    }
    std::stable_sort(row.to.begin(), row.to.end(), [](const auto& a, const auto& b) { return a.second.value > b.second.value; });
    return row;
}

FfCheck checkAll(const Setup& s, const Work& work, const Patches& patches) {
    FfCheck c;
    const auto start = std::chrono::steady_clock::now();
    const FormFactors factors(work, patches, s.factors);
    const FormFactorMatrix m = formFactorMatrix(work, factors, &c.found);
    if (work.stop.requested()) throw Error(Exit::killed, "stopped; nothing was checked");
    c.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    c.entries = m.exchanges.size();
    c.bytes = m.bytes();
    c.rowLimit = !c.found.closed ? mostOpenExcess : s.exact() ? mostExactError : mostClosedError;
    c.asymmetryLimit = mostAsymmetry;
    // What rays and cubes make of a single row is theirs to make; what a solver gets is the matrix.
    c.passed = c.found.worstRowSumAfter <= c.rowLimit && c.found.worstAsymmetryAfter == 0 &&
               (s.factors.method != FormFactorMethod::analytic || c.found.worstAsymmetry <= c.asymmetryLimit);
    return c;
}

} // namespace

int runFormFactors(const Arguments& arguments) {
    Setup s = readSetup(arguments);
    Console console(s.quiet);
    Diagnostics notes;
    FfObjects objects;
    const Executor run(s.render.threads);
    const LoadedScene loaded = loadScene(s.scene, notes, run, [&](const SceneDesc& desc) {
        for (std::size_t i = 0; i < desc.instances.size(); ++i) objects.add(desc.instances[i].name, i);
    });
    const Scene& scene = *loaded.scene;
    for (const DrawnPart& p : scene.parts()) objects.nodeOfPart.push_back(p.node);
    StopToken stop;
    const StopOnSignal signals(stop);
    Progress silent;
    const PathClasses classes(unlimitedDepth);
    const Work work{scene, classes, scene.shutter(), s.render.seed, s.render.sampler,
                    run,   stop,    silent,          notes,         s.scene.memory.beside(scene)};
    const Patches patches = Patches::of(work, s.patches);
    for (const std::string& line : loaded.added) console.phase("added", line);
    for (const Diagnostics::Fact& f : notes.facts()) console.phase(f.subject, f.message);
    console.warnings(notes);
    FfAnswer answer{
        .scene = s.scene.operand, .method = methodText(s.factors), .patches = patches, .objects = objects, .warnings = notes.warnings()};
    answer.exact = s.exact();
    if (s.check)
        answer.check = checkAll(s, work, patches);
    else if (!s.to.empty())
        answer.pair = findPair(s, work, patches, objects);
    else if (!s.from.empty())
        answer.row = findRow(s, work, patches, objects);
    fmt::print("{}", s.json ? ffJson(answer) : ffText(answer));
    if (answer.check && !answer.check->passed) return int(Exit::failed);
    return s.strict && !notes.warnings().empty() ? int(Exit::warning) : int(Exit::done);
}

} // namespace chiaro::cli
