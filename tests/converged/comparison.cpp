#include "tests/converged/comparison.h"
#include "tests/scene_kit.h"
#include "tools/judge/convergence.h"
#include <algorithm>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace chiaro::test {

namespace {

constexpr double familyAlpha = 1e-3, margin = 0.01;
constexpr uint32_t tileSize = 8, longFactor = 8, largeSize = 64;
// Methods that are judged in a limit render four pictures for each of the others, each with a pre-pass of its own: a sixteenth of the
// samples in the short run, on one scene. The suites of photons and of radiosity hold them to path and to closed forms besides.
constexpr uint32_t limitFactor = 4; // fewer samples and fewer replicates
constexpr double shortLimitWidth = 0.015;
constexpr std::string_view limitScene = "@cornell";
constexpr uint64_t secondStageSeed = 100'000, liveSeed = 200'000;

judge::AgreementSettings settings(uint32_t spp) {
    judge::AgreementSettings s;
    s.alpha = judge::sidak(familyAlpha, double(rows().size() * entrants().size()));
    s.margin = margin;
    s.samplesPerReplicate = spp;
    return s;
}
judge::Evidence evidenceOf(const judge::Replicates& r) { return r.evidence(r.badTiles()); }

// What an integrator is held against.
struct Target {
    judge::Evidence evidence;
    std::string origin;
};
Target target(const Stage& stage, const Paths& paths, const Design& d) {
    if (stage.name == "@furnace") return {constantEvidence(furnaceRadiance(paths), d.size, tileSize), "formula"};
    if (d.size == Design().size) {
        const ReferenceFile file = loadReference(stage);
        if (const Reference* r = file.find(paths)) return {r->evidence, fmt::format("{} x {} spp of {}", r->replicates, r->spp, r->commit)};
        fmt::print("{}: no entry for covers \"{}\", misses \"{}\" in {}: path is rendered on the spot; run sh tools/references.sh\n",
                   stage.name, paths.covers, paths.misses, referencePath(stage.name).string());
    }
    Design live = d;
    live.firstSeed = liveSeed;
    live.replicates *= 2;
    return {evidenceOf(replicatesOf(stage, chooseIntegrator("path"), paths, live)),
            fmt::format("path live, {} x {} spp", live.replicates, live.spp)};
}

// The same at a smaller parameter, to be extrapolated: one more than the unknowns of the fit.
bool limitAgrees(const Stage& stage, const Entrant& e, const Paths& paths, const judge::Evidence& reference, Design d, double alpha,
                 Outcome& out) {
    std::vector<judge::FitPoint> points;
    double h = e.choice.options.real(e.traits.convergesOver);
    for (std::size_t k = 0; k < e.traits.convergencePowers.size() + 2; ++k, h *= e.traits.convergenceStep) {
        IntegratorChoice choice = e.choice;
        choice.options.set(e.traits.convergesOver, fmt::format("{:.9g}", h), choice.entry->name);
        const judge::Estimate mean = evidenceOf(replicatesOf(stage, choice, paths, d)).image[0];
        points.push_back({choice.options.real(e.traits.convergesOver), mean.mean, mean.error});
        d.firstSeed += d.replicates;
    }
    const auto limit = judge::convergesTo(reference.image[0], points, e.traits.convergencePowers, alpha);
    if (!limit) {
        out.verdict = "no fit over " + e.traits.convergesOver;
        return false;
    }
    out.limitWidth = (limit->interval.high - limit->interval.low) / 2;
    out.verdict = fmt::format("limit over {} off by {:+.2g} % [{:+.2g}, {:+.2g}], p {:.2g}, p of the fit {:.2g}", e.traits.convergesOver,
                              100 * limit->relative, 100 * limit->interval.low, 100 * limit->interval.high, limit->limit.p, limit->fit.p);
    return limit->agrees;
}

Outcome judged(const Stage& stage, const Entrant& e, const Paths& paths, const Target& reference, const Design& d, bool weak) {
    const judge::AgreementSettings s = settings(d.spp);
    Outcome out;
    out.agreement = judge::decide(evidenceOf(replicatesOf(stage, e.choice, paths, d)), reference.evidence, s);
    const judge::Agreement& a = out.agreement;
    out.verdict = judge::describe(a, s);
    if (e.traits.unbiased)
        out.sound = a.verdict != judge::Verdict::biased && a.verdict != judge::Verdict::differs;
    else if (e.traits.convergesOver.empty())
        out.sound = a.equivalenceP <= s.alpha || (weak && a.verdict == judge::Verdict::cannotTell);
    else
        out.sound = limitAgrees(stage, e, paths, reference.evidence, d, s.alpha, out);
    fmt::print(
        "{}{} {}{}, {}x{}: {} [p image {:.2g} tiles {:.2g} pixels {:.2g}; resolution {:.2g} %, tiles {:.2g} %; skewness {:.2g}; {}]\n",
        weak ? "weak: " : "", stage.name, e.choice.entry->name, paths.misses.empty() ? "" : " without " + paths.misses, d.size, d.size,
        out.verdict, a.image.p, a.tiles.p, a.pixels.p, 100 * a.resolution, 100 * a.tileResolution, a.skewness, reference.origin);
    return out;
}

} // namespace

Stage::Stage(std::string_view builtin) : name(builtin), scene(compiled(findBuiltin(builtin)->make())), camera(scene->cameras()[0]) {}

PathClasses Paths::classes() const {
    return PathClasses::make({.paths = {}, .split = {}, .maxDepth = unlimitedDepth, .within = covers, .without = misses});
}

judge::Replicates replicatesOf(const Stage& stage, const IntegratorChoice& choice, const Paths& paths, const Design& d) {
    const PathClasses classes = paths.classes();
    judge::Replicates all(d.size, d.size, {}, tileSize);
    for (uint32_t r = 0; r < d.replicates; ++r) {
        Settings how{d.size, d.size, d.spp};
        how.threads = d.threads;
        how.seed = d.firstSeed + r;
        Bench bench(*stage.scene, stage.camera, how);
        bench.classes = classes;
        FilmLayout layout = bench.layout();
        layout.splats = choice.entry->traits(choice.options).splats;
        Film film(layout);
        chiaro::render(bench.job, *choice.entry->make(choice.options), film, {d.spp, infinity}, bench.stop);
        judge::Picture picture;
        picture.width = picture.height = d.size;
        for (uint32_t y = 0; y < d.size; ++y)
            for (uint32_t x = 0; x < d.size; ++x) {
                const Spectrum v = film.mean({x, y});
                picture.rgb.insert(picture.rgb.end(), v.c.begin(), v.c.end());
            }
        all.add(picture);
    }
    return all;
}

// Every wall point sends out 1 + 1/2 + 1/4 ...: a term of each depth whose path L D^n E is wanted.
double furnaceRadiance(const Paths& paths) {
    const PathClasses classes = paths.classes();
    PathState state = classes.eye();
    double sum = 0;
    for (int depth = 0; depth < 60; ++depth) {
        if (classes.reached(state, LightKind::area) != 0) sum += std::ldexp(1.0, -depth);
        state = classes.eye(state, Event::DR);
    }
    return sum;
}

judge::Evidence constantEvidence(double radiance, uint32_t size, uint32_t tile) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    judge::Evidence e;
    e.width = e.height = size;
    e.tile = tile;
    e.tilesX = e.tilesY = (size + tile - 1) / tile;
    const judge::Estimate exact{radiance, 0, std::numeric_limits<double>::infinity()};
    e.pixels.assign(std::size_t(size) * size, {unknown, 0, 0});
    e.tiles.assign(std::size_t(e.tilesX) * e.tilesY, exact);
    e.image.fill(exact);
    e.replicates = std::numeric_limits<double>::infinity();
    e.compared = e.pixels.size();
    return e;
}

Entrant::Entrant(IntegratorChoice c)
    : choice(std::move(c)), traits(choice.entry->traits(choice.options)), paths{traits.covers, traits.misses} {}

std::vector<Entrant> entrants() {
    std::vector<Entrant> all;
    for (const IntegratorEntry& entry : integrators())
        if (Entrant e(chooseIntegrator(entry.name)); e.traits.lightTransport) all.push_back(std::move(e));
    return all;
}

Outcome compare(const Stage& stage, const Entrant& e, const Paths& paths, const Design& design, bool weak) {
    const Target reference = target(stage, paths, design);
    Outcome first = judged(stage, e, paths, reference, design, weak);
    if (first.sound) return first;
    Design again = design;
    again.firstSeed += secondStageSeed;
    again.replicates *= 4;
    Outcome second = judged(stage, e, paths, reference, again, weak);
    second.stages = 2;
    return second;
}

bool longTier() {
    const char* asked = std::getenv("CHIARO_LONG");
    return asked && *asked && std::string(asked) != "0";
}

std::optional<Paths> Row::paths(const Entrant& e) const {
    Paths p = e.paths;
    const auto leaveOut = [&](const std::string& some) {
        if (!some.empty()) p.misses += (p.misses.empty() ? "" : "|") + some;
    };
    leaveOut(without);
    if (const Exception* own = exceptionOf(e)) leaveOut(own->without);
    try {
        p.classes();
    } catch (const Error&) { return {}; } // no path is left
    return p;
}

const Row::Exception* Row::exceptionOf(const Entrant& e) const {
    const auto own =
        std::find_if(exceptions.begin(), exceptions.end(), [&](const auto& x) { return x.integrator == e.choice.entry->name; });
    return own == exceptions.end() ? nullptr : &*own;
}

double Row::resolutionOf(const Entrant& e) const {
    const Exception* own = exceptionOf(e);
    return own ? own->resolution : resolution;
}

std::span<const Row> rows() {
    static const Row all[] = {
        // Emission alone is light at the lamp's edge: its noise is that of few pixels.
        {"@cornell", "", 0.006, {{"raycast", 0.01}, {"whitted", 0.01}, {"distributed", 0.0075}, {"light", 0.0075}}},
        {"@cornell-spheres", "", 0.015},
        // Light tracing meets the narrow lobes of the plates with every connection to the camera.
        {"@veach-mis", "L (G .*)? E", 0.01, {{"light", 0.1}}},
        // The lamps themselves, the smallest far below a pixel.
        {"@veach-mis", "", 0.1, {{"raycast", 0.25}, {"whitted", 0.25}, {"light", 0.25}}},
        {"@caustic", "L S+ (D .*)? E", 0.01},
        // The lamp in the ball's mirror is far below a pixel: a path tracer finds it once in 10^4 samples of one pixel, by
        // Fresnel's chance, and cannot be the reference of those who follow both rays.
        {"@caustic", "L S+ E", 0.5},
        // The lamp in mirror and glass, its caustics, and for light tracing a plain that lies mostly out of view.
        {"@playground", "", 0.045, {{"raycast", 0.001}, {"whitted", 0.02}, {"light", 0.4}}},
        // Every lobe of the materials at once. Where a lobe of roughness 0.05 to 0.2 sends a particle to the eye, one connection of 10^5
        // carries all the light: light tracing is judged on the others.
        {"@gallery", "", 0.02, {{"light", 0.035, "L .* G E"}, {"whitted", 0.1}}, {32, 64, 32, 0, 1}},
        {"@furnace", "", 0.002, {{"light", 0.01}}, {32, 16, 32, 0, 1}},
    };
    return all;
}

void compareAll(std::string_view scene) {
    const Stage stage(scene);
    const auto check = [&](const Row& row, const Entrant& e, const Design& design, double limitWidth = 0) {
        const std::string integrator(e.choice.entry->name);
        const std::optional<Paths> paths = row.paths(e);
        if (!paths) {
            fmt::print("{} {}: covers none of the paths without {}\n", scene, integrator, row.without);
            return;
        }
        const double resolution = row.resolutionOf(e);
        const Outcome out = compare(stage, e, *paths, design, resolution > weakResolution);
        const std::string verdict = out.verdict, without = row.without;
        CAPTURE(integrator);
        CAPTURE(without);
        CAPTURE(verdict);
        CHECK(out.sound);
        CHECK(out.agreement.nonFinitePixels == 0);
        if (limitWidth > 0)
            CHECK(out.limitWidth <= limitWidth);
        else
            CHECK(out.agreement.resolution <= resolution);
    };
    for (const Row& row : rows()) {
        if (row.scene != scene) continue;
        Design d = row.design;
        if (longTier()) {
            d.replicates *= longFactor;
            d.threads = 0;
        }
        for (const Entrant& e : entrants()) {
            if (!e.traits.convergesOver.empty() && !longTier()) {
                if (scene == limitScene)
                    check(row, e, {d.size, d.spp / limitFactor, d.replicates / limitFactor, d.firstSeed, d.threads}, shortLimitWidth);
                else
                    fmt::print("{} {}: its limit is judged in the long run, CHIARO_LONG=1\n", scene, e.choice.entry->name);
                continue;
            }
            check(row, e, d);
            if (longTier()) check(row, e, {largeSize, d.spp, d.replicates / longFactor, 0, 0});
        }
    }
}

} // namespace chiaro::test
