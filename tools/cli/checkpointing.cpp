#include "tools/cli/checkpointing.h"
#include "tools/cli/report.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <array>
#include <bit>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace chiaro::cli {
namespace {

// Of one run, not of the picture; and those that would name the checkpoint itself.
constexpr std::array<std::string_view, 11> ofOneRun = {"resume",  "config", "quiet",  "verbose", "progress",  "json",
                                                       "threads", "pixel",  "sample", "strict",  "max-memory"};
constexpr std::array<std::string_view, 3> budgets = {"spp", "time", "noise"};

template <std::size_t N> bool among(const std::array<std::string_view, N>& all, std::string_view name) {
    return std::find(all.begin(), all.end(), name) != all.end();
}
bool anyBudget(const Arguments& a) {
    return std::any_of(budgets.begin(), budgets.end(), [&](std::string_view name) { return a.given(name); });
}

std::map<std::string, std::vector<std::string>> keptOptions(const Arguments& a) {
    std::map<std::string, std::vector<std::string>> kept;
    for (const OptionRow& o : a.command->options)
        if (a.given(o.name) && !among(ofOneRun, o.name))
            kept[std::string(o.name)] = o.metavar.empty() ? std::vector<std::string>{a.on(o.name) ? "true" : "false"} : a.all(o.name);
    return kept;
}

// How a part of the key is told where another one is found.
struct Told {
    std::string_view name, words;
};
constexpr Told told[] = {
    {"version", "by chiaro"},           {"integrator", "with -i"},   {"prepass", "with --prepass"}, {"seed", "with --seed"},
    {"sampler", "with --sampler"},      {"filter", "with --filter"}, {"isa", "with --isa"},         {"paths", "with --paths"},
    {"max-depth", "with --max-depth"},  {"split", "with --split"},   {"size", "with --size"},       {"crop", "with --crop"},
    {"camera", "with --camera"},        {"lens", "with the lens"},   {"time", "at --frame-time"},   {"shutter", "with the shutter"},
    {"samples", "with --sample-range"}, {"layers", "with --aov"},
};

std::string oneLine(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
    return text;
}

// Its name, and a number that tells cameras of one name apart.
std::string cameraText(const CameraDesc& c) {
    uint64_t h = uint64_t(c.projection);
    const auto add = [&h](double v) { h = hashCombine(h, std::bit_cast<uint64_t>(v)); };
    for (const double v : {c.yfov, c.aspect, c.xmag, c.ymag}) add(v);
    const auto addPlace = [&](const Affine& m) {
        for (const auto& row : m.m)
            for (const double v : row) add(v);
    };
    addPlace(c.toWorld);
    for (const Affine& m : c.motion) addPlace(m);
    return fmt::format("\"{}\" ({:08x})", oneLine(c.name), uint32_t(h));
}

std::string layersText(const FilmLayout& l) {
    std::vector<std::string_view> names;
    if (l.costs) names.push_back("cost");
    if (l.photons) names.push_back("photons");
    return names.empty() ? "neither cost nor photons" : fmt::format("{}", fmt::join(names, ","));
}

} // namespace

Arguments continued(const Arguments& typed, const CheckpointHead& head) {
    Arguments all = typed;
    const bool newBudget = anyBudget(typed);
    for (const auto& [name, values] : head.options)
        if (!typed.given(name) && findOption(*typed.command, name) && !(newBudget && among(budgets, name)) && !values.empty())
            all.set(name, values);
    if (const std::string isa = valueOf(head.key, "isa"); !isa.empty() && !all.given("isa") && isa != bestIsa()) all.set("isa", {isa});
    all.line = commandOf(typed, head);
    return all;
}

std::string commandOf(const Arguments& typed, const CheckpointHead& head) {
    const bool more = std::any_of(typed.command->options.begin(), typed.command->options.end(),
                                  [&](const OptionRow& o) { return typed.given(o.name) && !among(ofOneRun, o.name); });
    return more ? head.command + "; " + typed.line : head.command;
}

void chargeTime(RenderSettings& s, const Arguments& typed, const CheckpointHead& head) {
    if (!anyBudget(typed)) s.budget.seconds = std::max(0.0, s.budget.seconds - head.seconds);
}

FileKey renderKey(const RenderSettings& s, const LoadedScene& loaded, const View& view, const CameraDesc& camera) {
    const LensDesc lens = view.camera.lens();
    const Rect& crop = view.crop;
    return {
        {"scene", oneLine(s.scene.operand)},
        {"hash", fmt::format("{:016x}", loaded.scene->hash())},
        {"version", std::string(version)},
        {"integrator", integratorRecipe(s.integrator)},
        {"prepass", s.prepass.choice ? prepassRecipe(*s.prepass.choice) : "none"},
        {"seed", fmt::format("{}", s.seed)},
        {"sampler", samplerName(s.sampler)},
        {"filter", filterName(s.filter)},
        {"isa", loaded.scene->isa()},
        {"paths", s.paths.paths.empty() ? "all" : oneLine(s.paths.paths)},
        {"max-depth", s.paths.maxDepth == unlimitedDepth ? "unlimited" : fmt::format("{}", s.paths.maxDepth)},
        {"split", s.paths.split.empty() ? "none" : oneLine(s.paths.split)},
        {"size", fmt::format("{}x{}", view.width, view.height)},
        {"crop", fmt::format("{}x{}+{}+{}", crop.width(), crop.height(), crop.x0, crop.y0)},
        {"camera", cameraText(camera)},
        {"lens", fmt::format("{} m wide at {} m, {} blades turned by {}", 2 * lens.radius, lens.radius > 0 ? lens.focus : 0, lens.blades,
                             lens.rotation)},
        {"time", fmt::format("{}{}", s.scene.frameTime, s.scene.animation.empty() ? "" : " of " + oneLine(s.scene.animation))},
        {"shutter", fmt::format("{}:{}", view.shutter.open, view.shutter.close)},
        {"samples", s.range ? fmt::format("{}:{}", s.range->begin, s.range->end) : "all"},
        {"layers", layersText(filmLayout(s, view))},
    };
}

std::string keyDifference(const FileKey& a, const FileKey& b, std::string_view except) {
    std::vector<std::string> all;
    for (const Told& t : told)
        if (t.name != except && valueOf(a, t.name) != valueOf(b, t.name))
            all.push_back(fmt::format("{} {}, not {}", t.words, valueOf(a, t.name), valueOf(b, t.name)));
    return fmt::format("{}", fmt::join(all, "; "));
}

void refuseOther(const std::filesystem::path& file, const CheckpointHead& head, const FileKey& wanted) {
    if (valueOf(head.key, "hash") != valueOf(wanted, "hash"))
        throw Error(Exit::unsupported,
                    fmt::format("{}: rendered from another scene ({}, content {}) than this one ({}, content {}). Give that scene, or "
                                "leave --resume out",
                                file.string(), valueOf(head.key, "scene"), valueOf(head.key, "hash"), valueOf(wanted, "scene"),
                                valueOf(wanted, "hash")));
    if (const std::string what = keyDifference(head.key, wanted); !what.empty())
        throw Error(Exit::unsupported, fmt::format("{}: rendered {}. Leave these options out, since the file knows its own, or leave "
                                                   "--resume out",
                                                   file.string(), what));
}

Keeper::Keeper(const RenderSettings& s, const LoadedScene& loaded, const View& view, const DisplayTransform& display, const Job& job,
               FileKey key)
    : s_(s), loaded_(loaded), view_(view), display_(display), job_(job), key_(std::move(key)) {}

const Centres& Keeper::centres() {
    if (!centres_) centres_ = seenAtCentres(job_);
    return *centres_;
}

void Keeper::write(const Film& film, const Integrator& integrator, Rendered now) {
    Checkpoint c;
    c.key = key_;
    c.options = keptOptions(*s_.arguments);
    c.command = s_.arguments->line;
    c.again = sameSamples(s_);
    c.stem = s_.scene.stem();
    c.seconds = now.result.seconds;
    c.warnings = job_.notes.warnings();
    now.result.spp = film.done() - film.begin();
    c.recipe = recipe(s_, loaded_, view_, display_, film, now);
    c.depth = centres().depth;
    c.lamp = centres().lamp;
    writeCheckpoint(s_.checkpoint.file, c, film, stateOf(integrator));
}

} // namespace chiaro::cli
