// chiaro merge: ranges of samples that were rendered apart, as the one picture. Films are sums of integers, so that the result is that of
// the render that was never cut, to the last bit, whatever the order of the parts. No scene is needed: a part keeps what a picture wants.
#include "io/replace_file.h"
#include "tools/cli/checkpointing.h"
#include "tools/cli/memory.h"
#include "tools/cli/picture_output.h"
#include "tools/cli/report.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

struct MergeSettings {
    std::vector<std::string> outputs; // patterns of pictures
    std::string checkpoint;           // pattern; empty: none
    std::optional<double> exposure;
    std::size_t memory = ~std::size_t(0);
    bool strict = false, json = false, quiet = false;
};

MergeSettings readMerge(const Arguments& a) {
    MergeSettings s;
    s.outputs = readOutputs(a, {"{scene}.exr", "{scene}.png"}, s.checkpoint);
    if (a.text("exposure") != "auto") s.exposure = parseReal("exposure", a.text("exposure"), -100, 100);
    if (a.given("aov")) readLayers(a.text("aov"));
    s.memory = readMemoryBudget(a).bytes;
    s.strict = a.on("strict");
    s.json = a.on("json");
    s.quiet = a.on("quiet");
    return s;
}

struct Part {
    std::filesystem::path file;
    CheckpointHead head;
    std::string range() const { return fmt::format("{}:{}", head.begin, head.done); }
    std::string named() const { return fmt::format("{} ({})", file.string(), range()); }
    // Stopped before the end of its range.
    bool unfinished() const {
        const std::string asked = valueOf(head.key, "samples");
        return asked.substr(std::min(asked.find(':'), asked.size() - 1) + 1) != std::to_string(head.done) && asked != "all";
    }
    std::string finish() const {
        return fmt::format("chiaro render {} --resume {}", shellQuoted(valueOf(head.key, "scene")), shellQuoted(file.string()));
    }
};

[[noreturn]] void refuse(const std::string& why) { throw Error(Exit::unsupported, why); }

// Against the first: scene, then every setting but the range.
void checkFits(const Part& first, const Part& other, Diagnostics& notes) {
    const FileKey &a = first.head.key, &b = other.head.key;
    if (valueOf(a, "hash") != valueOf(b, "hash"))
        refuse(fmt::format("{} and {} are of different scenes: {} (content {}) and {} (content {})", first.file.string(),
                           other.file.string(), valueOf(a, "scene"), valueOf(a, "hash"), valueOf(b, "scene"), valueOf(b, "hash")));
    FileKey plainA = a, plainB = b;
    for (FileKey* key : {&plainA, &plainB})
        for (auto& [name, value] : *key)
            if (name == "samples" || name == "isa") value.clear();
    if (const std::string what = keyDifference(plainA, plainB); !what.empty())
        refuse(fmt::format("{} and {} do not belong together: the first was rendered {}", first.file.string(), other.file.string(), what));
    if (valueOf(a, "isa") != valueOf(b, "isa"))
        notes.warn(fmt::format("{} was rendered with {}, {} with {}: Embree's answers differ in the last bits between them, and so may the "
                               "picture from that of one machine. Fix it with --isa.",
                               first.file.string(), valueOf(a, "isa"), other.file.string(), valueOf(b, "isa")));
}

void checkMergeable(const Part& part) {
    const std::string name = valueOf(part.head.key, "integrator");
    const IntegratorChoice choice = chooseIntegrator(name);
    if (!choice.entry->traits(choice.options).mergeable)
        refuse(fmt::format("{}: {} remembers what earlier samples found; its parts cannot be merged", part.file.string(), name));
    if (!part.head.even)
        refuse(fmt::format("{} was stopped inside a pass: some of its pixels have more samples than others. Finish it: {}",
                           part.file.string(), part.finish()));
    if (part.head.done == part.head.begin) refuse(fmt::format("{} holds no sample. Finish it: {}", part.file.string(), part.finish()));
}

// In the order of their samples; they must follow each other.
std::vector<Part> readParts(const std::vector<std::string>& files, Diagnostics& notes) {
    std::vector<Part> parts;
    for (const std::string& file : files) parts.push_back({file, readCheckpointHead(file)});
    for (const Part& part : parts) checkMergeable(part);
    for (std::size_t i = 1; i < parts.size(); ++i) checkFits(parts[0], parts[i], notes);
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.head.begin < b.head.begin; });
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const Part &a = parts[i - 1], &b = parts[i];
        if (b.head.begin < a.head.done)
            refuse(fmt::format("{} and {} overlap: samples {}:{} are in both. Leave one of them out", a.named(), b.named(), b.head.begin,
                               std::min(a.head.done, b.head.done)));
        if (b.head.begin > a.head.done)
            refuse(fmt::format("samples {}:{} are missing between {} and {}. {}", a.head.done, b.head.begin, a.named(), b.named(),
                               a.unfinished() ? "Finish the first: " + a.finish()
                                              : fmt::format("Render them: --sample-range {}:{}", a.head.done, b.head.begin)));
    }
    return parts;
}

Checkpoint mergeAll(const std::vector<Part>& parts, std::size_t memory) {
    Checkpoint all = readCheckpoint(parts[0].file, memory);
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const Checkpoint part = readCheckpoint(parts[i].file, memory);
        if (part.film->layout() != all.film->layout())
            throw Error(Exit::file, fmt::format("{}: its film is not that of its settings; render it again", parts[i].file.string()));
        all.film->merge(*part.film);
        all.film->setDone(all.film->done());
        all.seconds += part.seconds;
        for (const std::string& w : part.warnings)
            if (std::find(all.warnings.begin(), all.warnings.end(), w) == all.warnings.end()) all.warnings.push_back(w);
    }
    const Film& film = *all.film;
    const std::string range = film.begin() == 0 ? "all" : fmt::format("{}:{}", film.begin(), film.done());
    for (auto& [name, value] : all.key)
        if (name == "samples") value = range;
    all.options.erase("sample-range");
    all.options.erase("output");
    all.options.erase("checkpoint-every");
    if (film.begin() > 0) all.options["sample-range"] = {range};
    return all;
}

void setAttribute(Metadata& m, std::string_view name, MetadataValue value) {
    for (auto& [n, v] : m)
        if (n == name) v = value;
}

// The recipe of the parts, as it is of them all.
Metadata mergedRecipe(const Checkpoint& all, const Arguments& a, const DisplayTransform& display, double exposure) {
    Metadata m = all.recipe;
    std::erase_if(m, [&](const auto& entry) { return entry.first == "chiaro:samples"; });
    setAttribute(m, "chiaro:command", a.line);
    setAttribute(m, "chiaro:spp", fmt::format("{}", all.film->done() - all.film->begin()));
    setAttribute(m, "chiaro:dropped", fmt::format("{}", all.film->dropped()));
    setAttribute(m, "chiaro:exposure", exposure);
    setAttribute(m, "chiaro:display", display.display());
    setAttribute(m, "chiaro:view", display.view());
    setAttribute(m, "chiaro:ocio", display.source());
    setAttribute(m, "chiaro:seconds", all.seconds);
    return m;
}

void warnOf(const Checkpoint& all, Diagnostics& notes) {
    for (const std::string& w : all.warnings)
        if (w.find("non-finite samples dropped") == w.npos) notes.warn(w);
    if (const std::vector<DroppedSample> dropped = all.film->droppedSamples(); !dropped.empty())
        notes.warn(fmt::format("{} non-finite samples dropped. Reproduce: {} --pixel {},{} --sample {} --seed {}", all.film->dropped(),
                               all.again, dropped[0].pixel.x, dropped[0].pixel.y, dropped[0].sample, valueOf(all.key, "seed")));
    const auto asked = all.options.find("spp");
    if (const uint32_t done = all.film->done(); asked != all.options.end() && parseCount(asked->second.back()) > done)
        notes.warn(fmt::format("--spp {} was asked for; the parts end at sample {}", asked->second.back(), done));
}

nlohmann::ordered_json summary(const Checkpoint& all, const std::vector<Part>& parts, const Rendered& r,
                               std::span<const std::filesystem::path> files, const Diagnostics& notes, int code) {
    nlohmann::ordered_json inputs = nlohmann::ordered_json::array(), outputs = nlohmann::ordered_json::array();
    for (const Part& p : parts) inputs.push_back({{"file", p.file.string()}, {"samples", {p.head.begin, p.head.done}}});
    for (const std::filesystem::path& f : files) outputs.push_back(f.string());
    return {{"version", version},
            {"scene", valueOf(all.key, "scene")},
            {"sceneHash", valueOf(all.key, "hash")},
            {"integrator", valueOf(all.key, "integrator")},
            {"parts", inputs},
            {"samples", {all.film->begin(), all.film->done()}},
            {"seconds", all.seconds},
            {"noise", finiteOrNull(r.noise)},
            {"mean", finiteOrNull(r.mean.value)},
            {"meanInterval", finiteOrNull(relativeInterval(r.mean))},
            {"dropped", all.film->dropped()},
            {"exposure", r.exposure},
            {"files", outputs},
            {"checkpoint", r.checkpoint.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(r.checkpoint.string())},
            {"warnings", notes.warnings()},
            {"exit", code}};
}

// {scene} {integrator} {spp} of the parts.
std::vector<std::filesystem::path> namedFiles(const std::vector<std::string>& patterns, const CheckpointHead& head, uint32_t spp) {
    std::vector<std::filesystem::path> files;
    const std::string integrator = valueOf(head.key, "integrator");
    for (const std::string& pattern : patterns)
        files.emplace_back(expandedName(pattern, head.stem, integrator.substr(0, integrator.find(':')), spp));
    return files;
}

} // namespace

std::string mergeNotes() {
    return R"(
Parts
  chiaro render SCENE --sample-range 0:64  -o a.chk        on one machine
  chiaro render SCENE --sample-range 64:128 -o b.chk       on another, with the same options else
  chiaro merge a.chk b.chk -o out.exr                      the bits of chiaro render SCENE --spp 128 -o out.exr
  Parts come in any order. Gaps, overlaps, other scenes and other settings are refused (exit 3); other instruction sets are warned of.
  With -o FILE.chk some parts become one, which can be merged again, or rendered on: chiaro render SCENE --resume FILE.chk --spp N.
)";
}

int runMerge(const Arguments& a) {
    const MergeSettings s = readMerge(a);
    Console console(s.quiet);
    Diagnostics notes;
    const DisplayTransform display(a.text("ocio"), a.text("view"));
    if (!display.note().empty()) notes.warn(display.note());
    const std::vector<Part> parts = readParts(a.operands, notes);
    const uint32_t begin = parts.front().head.begin, end = parts.back().head.done;
    if (begin > 0 && !s.outputs.empty())
        refuse(fmt::format("samples 0:{} are missing before {}. Render them: --sample-range 0:{}, or make one part of these: -o FILE.chk",
                           begin, parts.front().named(), begin));
    std::vector<std::filesystem::path> files = namedFiles(s.outputs, parts[0].head, end - begin);
    for (const std::filesystem::path& file : files) checkWritable(file);
    Rendered r;
    if (!s.checkpoint.empty()) checkWritable(r.checkpoint = namedFiles({s.checkpoint}, parts[0].head, end - begin)[0]);

    Checkpoint all = mergeAll(parts, s.memory);
    const Film& film = *all.film;
    warnOf(all, notes);
    if (parts.back().unfinished())
        notes.warn(fmt::format("{} was stopped before the end of its range. Finish it: {}", parts.back().named(), parts.back().finish()));
    const auto aov = all.options.find("aov");
    LayerChoice layers = a.given("aov")             ? readLayers(a.text("aov"))
                         : aov != all.options.end() ? readLayers(aov->second.back())
                                                    : LayerChoice();
    layers.cost = layers.cost && film.layout().costs;
    const PictureRequest request{files, layers, display, s.exposure, all.depth, all.lamp};
    r.automaticExposure = !s.exposure;
    r.exposure = exposureOf(request, film);
    r.result.spp = end - begin;
    r.result.seconds = all.seconds;
    r.noise = film.noise();
    r.mean = film.meanLuminance();
    if (!r.checkpoint.empty()) {
        all.recipe = mergedRecipe(all, a, display, 0);
        writeCheckpoint(r.checkpoint, all, film, all.state);
    }
    writePictures(request, film, r.exposure, mergedRecipe(all, a, display, r.exposure));
    console.warnings(notes);
    const IntegratorChoice choice = chooseIntegrator(valueOf(all.key, "integrator"));
    const Traits traits = choice.entry->traits(choice.options);
    console.phase("merged", fmt::format("{} parts, samples {}:{} of {}", parts.size(), begin, end, valueOf(all.key, "scene")));
    console.phase("done", doneText(film, r, traits.lightTransport && (!traits.unbiased || valueOf(all.key, "prepass") != "none")));
    tellPictures(files, display, r.exposure, r.automaticExposure, console);
    if (!r.checkpoint.empty()) console.phase("kept", fmt::format("{}  samples {}:{}", r.checkpoint.string(), begin, end));
    const int code = int(s.strict && !notes.warnings().empty() ? Exit::warning : Exit::done);
    if (s.json)
        fmt::print("{}\n",
                   summary(all, parts, r, files, notes, code).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return code;
}

} // namespace chiaro::cli
