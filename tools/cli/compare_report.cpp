// From what was rendered and read to the plain values of the report.
#include "tools/cli/agree_settings.h"
#include "tools/cli/compare_output.h"
#include "tools/cli/film_picture.h"
#include "tools/cli/version.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <thread>

namespace chiaro::cli {
namespace {

using report::Entry, report::Image;
constexpr float zScale = 6;

Image imageOf(judge::Picture p, std::string name) { return {std::move(name), p.width, p.height, std::move(p.rgb)}; }

// The options of the scene and the sampling that both commands have.
std::string sharedOptions(const Arguments& a) {
    const std::span<const Command> all = commands();
    const auto render = std::find_if(all.begin(), all.end(), [](const Command& c) { return c.name == "render"; });
    std::string line;
    for (const OptionRow& o : render->options)
        if (o.sample && o.name != "integrator" && o.name != "seed" && !o.name.starts_with("prepass") && findOption(*a.command, o.name) &&
            a.given(o.name))
            line += fmt::format(" --{} {}", o.name, shellQuoted(a.text(o.name)));
    return line + (a.given("crop") ? " --crop " + shellQuoted(a.text("crop")) : "");
}

// One seed: that of render. Several: their samples together.
std::string commandFor(const CompareSettings& s, const Contestant& c) {
    std::string what = fmt::format("{} -i {}", shellQuoted(s.base.scene.operand), shellQuoted(integratorRecipe(c.choice)));
    if (c.prepass) what += fmt::format(" --prepass {}", shellQuoted(prepassRecipe(*c.prepass)));
    if (c.prepass && !s.base.prepass.file.empty()) what += fmt::format(" --prepass-file {}", shellQuoted(s.base.prepass.file.string()));
    what += sharedOptions(*s.base.arguments);
    const auto spp = std::lround(std::max(1.0, c.spp()));
    if (c.runs.size() < 2) return fmt::format("chiaro render {} --spp {} --seed {}", what, spp, s.base.seed);
    return fmt::format("chiaro compare {} --equal spp --spp {} --seeds {} --seed {} --ref none", what, spp, c.runs.size(), s.base.seed);
}

void addMaps(Entry& e, const Flip* flip, Stands& stands, bool covered = false) {
    if (flip)
        e.maps.push_back({"FLIP",
                          fmt::format("what a person sees when both pictures alternate: 0 nothing, 1 everything{}",
                                      flip->reduced > 1 ? fmt::format("; of pictures averaged {0}x{0}", flip->reduced) : ""),
                          flip->map, 0, 1, false});
    if (!stands.z.empty())
        e.maps.push_back({"z-score",
                          fmt::format("difference to the reference in standard errors of both{}: within -3 and 3 it is noise",
                                      covered ? ", on the paths covered" : ""),
                          std::move(stands.z), -zScale, zScale, true});
    stands.z.clear();
}

// What the density estimates found, from nothing to what all but a hundredth of the pixels stay below.
void addPhotons(Entry& e, const Film& film) {
    const Rect& r = film.layout().crop;
    const auto add = [&](const char* name, const char* caption, float Gathered::*value) {
        report::Map map{name, caption, {}, 0, 0, false};
        for (uint32_t y = r.y0; y < r.y1; ++y)
            for (uint32_t x = r.x0; x < r.x1; ++x) map.values.push_back(film.gathered({x, y}).*value);
        std::vector<float> sorted = map.values;
        const auto at = sorted.begin() + std::ptrdiff_t(sorted.size() * 99 / 100);
        std::nth_element(sorted.begin(), at, sorted.end());
        map.high = *at;
        e.maps.push_back(std::move(map));
    };
    add("photon density", "photons per square metre where the first density estimate along the eye path was made", &Gathered::density);
    add("photon radius", "metres that it gathered in", &Gathered::radius);
    add("photon count", "photons that it found", &Gathered::count);
}

// The page has one scale for all maps of a name: the widest.
void shareScales(std::vector<Entry>& entries) {
    for (Entry& e : entries)
        for (report::Map& map : e.maps) {
            for (const Entry& other : entries)
                for (const report::Map& m : other.maps)
                    if (m.name == map.name) map.high = std::max(map.high, m.high);
            if (!(map.high > map.low)) map.high = map.low + 1; // nothing was found
        }
}

Entry entryOf(const CompareSettings& s, const Contestant& c, const Judged& judged, Stands& stands, const ErrorMeter* meter,
              const Executor& run) {
    Entry e;
    e.name = c.name;
    e.source = "integrator";
    e.covers = judged.covers;
    e.standing = stands.standing;
    e.verdict = stands.text;
    const judge::Picture merged = judgedPicture(*c.film, c.name);
    const ErrorMeter* used = c.traits.lightTransport ? meter : nullptr;
    std::optional<Flip> flip;
    if (used) flip = flipOf(merged, used->reference());
    e.metrics = metricsOf(c, merged, used, flip ? &*flip : nullptr, run);
    addMaps(e, flip ? &*flip : nullptr, stands, c.judgedLayer >= 0);
    if (c.film->layout().photons) addPhotons(e, *c.film);
    e.picture = imageOf(merged, c.name);
    const std::vector<std::string>& layers = c.film->layout().layers;
    for (std::size_t l = 0; l < layers.size(); ++l) e.layers.push_back(imageOf(judgedLayer(*c.film, int(l), layers[l]), layers[l]));
    e.seconds = c.seconds();
    e.prepassSeconds = c.prepassSeconds();
    e.prepareSeconds = c.prepareSeconds();
    e.spp = c.spp();
    e.seeds = uint32_t(c.runs.size());
    e.dropped = c.film->dropped();
    e.file = c.file;
    e.command = commandFor(s, c);
    return e;
}

uint64_t notFinite(const judge::Picture& p) {
    uint64_t n = 0;
    for (std::size_t i = 0; i < p.rgb.size(); i += 3)
        n += !std::isfinite(p.rgb[i]) || !std::isfinite(p.rgb[i + 1]) || !std::isfinite(p.rgb[i + 2]);
    return n;
}

Entry entryOf(const PictureSide& side, Stands& stands, const ErrorMeter* meter) {
    Entry e;
    e.name = side.file;
    e.source = "file";
    e.standing = stands.standing;
    e.verdict = stands.text;
    std::optional<Flip> flip;
    if (meter) flip = flipOf(side.picture, meter->reference());
    e.metrics = metricsOf(side.picture, meter, flip ? &*flip : nullptr);
    addMaps(e, flip ? &*flip : nullptr, stands);
    e.picture = imageOf(side.picture, side.file);
    e.dropped = notFinite(side.picture);
    e.file = side.file;
    return e;
}

Entry referenceEntry(const CompareSettings& s, const Comparison& c) {
    Entry e;
    e.standing = report::Standing::reference;
    e.source = "reference";
    e.name = c.files.reference ? c.files.reference->file : "reference";
    e.picture = imageOf(c.truth->picture, e.name);
    e.metrics = metricsOf(c.truth->picture, nullptr, nullptr);
    e.dropped = notFinite(c.truth->picture);
    e.file = c.files.reference ? c.files.reference->file : "reference.exr";
    if (const ReferenceSums* sums = c.truth->sums) {
        const IntegratorChoice path = chooseIntegrator(referenceName);
        const Traits traits = path.entry->traits(path.options);
        e.covers = traits.covers + (traits.misses.empty() ? "" : " without " + traits.misses);
        e.seconds = sums->seconds();
        e.spp = sums->samples();
        e.seeds = sums->replicas();
        e.dropped = sums->dropped();
        e.verdict = fmt::format("{} replicas of {} samples a pixel by {}, noise {}", sums->replicas(), sums->spp(), referenceName,
                                percent(sums->noise()));
        e.command = fmt::format("chiaro render {} -i {}{} --spp {:.0f}", shellQuoted(s.base.scene.operand), referenceName,
                                sharedOptions(*s.base.arguments), sums->samples());
    } else {
        e.verdict = c.truth->picture.error.empty() ? "a picture that does not know its own error" : "a picture with its own error layer";
    }
    return e;
}

std::string equalText(const CompareSettings& s) {
    switch (s.equal) {
    case Equal::time: return fmt::format("time, {:g} s for each integrator", s.seconds);
    case Equal::spp: return fmt::format("samples, {} a pixel for each integrator", s.spp);
    case Equal::noise: return fmt::format("noise, {:g} % for each integrator", 100 * s.noise);
    }
    return {};
}

void addSettings(report::Report& r, const CompareSettings& s, const Comparison& c, const SceneContext* context) {
    const auto add = [&](const char* name, std::string value) { r.settings.emplace_back(name, std::move(value)); };
    const Rect& a = c.files.area;
    if (context) add("scene", s.base.scene.operand);
    add("size", fmt::format("{}x{}", c.files.width, c.files.height));
    if (a.width() != c.files.width || a.height() != c.files.height)
        add("crop", fmt::format("{}x{}+{}+{}", a.width(), a.height(), a.x0, a.y0));
    if (!s.layer.empty()) add("layer of files", s.layer);
    if (!context) return;
    add("camera", context->camera);
    add("environment", context->loaded.environment);
    add("equal", equalText(s));
    add("seeds", fmt::format("{}, from {}", c.seeds, s.base.seed));
    add("depth", s.base.paths.maxDepth == unlimitedDepth ? "unlimited" : fmt::format("{}", s.base.paths.maxDepth));
    if (!s.base.paths.paths.empty()) add("paths", s.base.paths.paths);
    if (!s.base.paths.split.empty()) add("split", s.base.paths.split);
    if (s.base.prepass.choice)
        add("pre-pass", fmt::format("{}, {}", prepassRecipe(*s.base.prepass.choice),
                                    s.base.prepass.file.empty() ? "solved for each seed" : "one solution for all seeds"));
    add("sampler", samplerName(s.base.sampler));
    add("filter", filterName(s.base.filter));
    add("scene hash", fmt::format("{:016x}", context->loaded.scene->hash()));
    if (c.reference) add("reference", fmt::format("{}, {}", referenceName, c.goal.text()));
}

void addCurves(report::Report& r, const Comparison& c) {
    std::vector<bool> endless;
    uint32_t entry = 0;
    for (std::size_t i = 0; i < c.contestants.size(); ++i) {
        if (!c.contestants[i].film) continue;
        if (auto curve = curveOf(c.contestants[i], entry)) {
            r.curves.push_back(std::move(*curve));
            const report::Standing standing = r.entries[entry].standing;
            endless.push_back(c.contestants[i].traits.unbiased && c.judged[i].missing.empty() && standing != report::Standing::biased &&
                              standing != report::Standing::differs);
        }
        ++entry;
    }
    if (!r.curves.empty()) r.timeToError = timesToError(r.curves, endless);
}

std::string titleOf(const CompareSettings& s) {
    std::string names;
    for (const IntegratorChoice& i : s.integrators) names += (names.empty() ? "" : ", ") + integratorRecipe(i);
    for (const std::string& file : s.images) names += (names.empty() ? "" : ", ") + file;
    if (!s.hasScene && !s.referenceFile.empty()) names += ", " + s.referenceFile;
    return s.hasScene ? s.base.scene.operand + ": " + names : names;
}

// Of the reference, else of the first picture.
double exposureFor(const std::vector<Entry>& entries, const std::optional<uint32_t>& reference, const SceneContext* context) {
    if (entries.empty()) return 0;
    std::vector<float> rgb = entries[reference.value_or(0)].picture.rgb;
    for (float& v : rgb)
        if (!std::isfinite(v)) v = 0;
    return autoExposure(rgb, context ? std::span<const uint8_t>(context->lamp) : std::span<const uint8_t>());
}

} // namespace

std::string machineName(unsigned threads, const std::string& isa) {
    std::string cpu = "unknown processor";
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (const std::size_t colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos) {
            cpu = line.substr(colon + 2);
            break;
        }
    return fmt::format("{}, {} {}{}{}", cpu, threads, threads == 1 ? "thread" : "threads", isa.empty() ? "" : ", ", isa);
}

Told makeReport(const CompareSettings& s, const Comparison& c, const SceneContext* context, Diagnostics& notes) {
    Told told;
    report::Report& r = told.report;
    r.title = titleOf(s);
    r.version = fmt::format("chiaro {}", version);
    r.command = s.base.arguments->line;
    r.machine = machineName(context ? context->run.threads() : std::max(1u, std::thread::hardware_concurrency()),
                            context ? context->loaded.scene->isa() : "");
    std::size_t judged = c.files.pictures.size();
    for (const Contestant& one : c.contestants) judged += one.traits.lightTransport;
    told.rule = judgeRule(judged);
    const Truth* truth = c.truth ? &*c.truth : nullptr;
    std::optional<ErrorMeter> meter;
    if (truth) meter.emplace(truth->picture);
    const ErrorMeter* error = meter ? &*meter : nullptr;
    for (std::size_t i = 0; i < c.contestants.size(); ++i) {
        const Contestant& one = c.contestants[i];
        if (!one.film) continue;
        told.stands.push_back(standingOf(one, c.judged[i], truth, c.restrictedSums(i), told.rule));
        r.entries.push_back(entryOf(s, one, c.judged[i], told.stands.back(), error, context->run));
        if (!one.reached)
            notes.warn(fmt::format("{} did not reach the noise of {:g} %: --time or --spp ended it", one.name, 100 * s.noise));
    }
    for (const PictureSide& side : c.files.pictures) {
        told.stands.push_back(standingOf(side.picture, truth, told.rule));
        r.entries.push_back(entryOf(side, told.stands.back(), error));
    }
    if (truth) {
        r.reference = uint32_t(r.entries.size());
        r.entries.push_back(referenceEntry(s, c));
        told.stands.push_back({});
        told.stands.back().standing = report::Standing::reference;
    }
    shareScales(r.entries);
    addSettings(r, s, c, context);
    addCurves(r, c);
    r.exposure = s.base.exposure ? *s.base.exposure : exposureFor(r.entries, r.reference, context);
    r.notes = notes.warnings();
    for (const Diagnostics::Fact& f : notes.facts()) r.notes.push_back(fmt::format("{}: {}", f.subject, f.message));
    return told;
}

} // namespace chiaro::cli
