// Photon maps and radiosity converge: photon and sppm are rendered at radii 1, 1/2, 1/4 and 1/8 of their own, radiosity with patches of 1,
// 0.71, 0.5 and 0.35 of the size given, every replicate is extrapolated to 0 by least squares over the powers that the method names, and
// the limit is held against path, or where path is blind (light without extent through glass) against light, on the paths that both sides
// cover: of radiosity all of them and bounce by bounce. All sides of a replicate share a seed: photons, rays and points of the pixels are
// the same, so that the noise of the extrapolation is that of one picture.
//
// Short: @caustic, and @cornell by radiosity. All scenes, those of ../shared/scenes too: CHIARO_LONG=1 sh tools/test.sh -R
// converged.limits; one scene:
//   CHIARO_LONG=1 build/release/tests/chiaro_tests_converged --test-suite=limits --test-case="*caustic-ring*"
// What was found is in docs/photons.md and docs/radiosity.md.
#include "io/gltf.h"
#include "io/image_read.h"
#include "tests/converged/comparison.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include "tools/judge/convergence.h"
#include <algorithm>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double alpha = 1e-4; // of one comparison, two-sided; some thirty of them
constexpr int radii = 4;       // one more than the unknowns: the last is the residual
constexpr uint64_t firstSeed = 300'000;

struct Case {
    std::string_view method, reference; // with their options
    std::string_view paths;             // empty: all
    double width;                       // half of the 95 % interval that is reached, relative
    uint32_t spp = 16, referenceSpp = 64, replicates = 16;
    std::vector<double> powers = {}; // of the radius, where it is known which; empty: those that the method names
    bool bounces = false;            // the paths in sum, and those of one, two and three scatterings each
};

struct Seen {
    std::unique_ptr<const Scene> scene;
    CameraDesc camera;
    uint32_t width = 48, height = 48, maxDepth = unlimitedDepth;
};
std::optional<Seen> seen(const std::string& name) {
    Seen s;
    if (name[0] == '@') {
        s.scene = compiled(findBuiltin(name)->make());
    } else {
        const std::filesystem::path folder = "../shared/scenes/" + name;
        if (!std::filesystem::exists(folder / "scene.json")) return {};
        const auto sheet = nlohmann::json::parse(std::ifstream(folder / "scene.json"));
        Diagnostics notes;
        SceneDesc desc = readGltf(folder / sheet["file"].get<std::string>(), {}, notes);
        if (sheet.contains("environment")) {
            desc.environment = readEnvironment(folder / sheet["environment"]["file"].get<std::string>(), notes);
            desc.environment->scale *= sheet["environment"]["scale"].get<float>();
        }
        s.scene = compiled(std::move(desc));
        s.height = uint32_t(std::lround(48 * sheet["height"].get<double>() / sheet["width"].get<double>()));
        s.maxDepth = sheet["max_depth"].get<uint32_t>();
    }
    s.camera = s.scene->cameras()[0];
    return s;
}

// Mean luminance of the picture and of the layers named, of one render.
std::vector<double> luminancesOf(const Seen& s, const IntegratorChoice& choice, const PathClasses& classes,
                                 const std::vector<std::string>& layers, uint32_t spp, uint64_t seed) {
    Bench bench(*s.scene, s.camera, {.width = s.width, .height = s.height, .spp = spp, .seed = seed});
    bench.classes = classes;
    FilmLayout layout = bench.layout();
    layout.layers = classes.layerNames();
    layout.splats = choice.entry->traits(choice.options).splats;
    Film film(layout);
    chiaro::render(bench.job, *choice.entry->make(choice.options), film, {spp, infinity}, bench.stop);
    std::vector<double> means{double(luminance(meanOf(film)))};
    for (const std::string& name : layers) {
        const auto at = std::find(layout.layers.begin(), layout.layers.end(), name);
        REQUIRE(at != layout.layers.end());
        double sum = 0;
        for (uint32_t y = 0; y < s.height; ++y)
            for (uint32_t x = 0; x < s.width; ++x) sum += double(luminance(film.mean({x, y}, int(at - layout.layers.begin()))));
        means.push_back(sum / (double(s.width) * s.height));
    }
    return means;
}

// What a measurement at each of the radii weighs in the limit, and in the one combination of them that is nothing where the fit holds.
struct Weights {
    std::array<double, radii> limit{}, residual{};
};
Weights weights(const Traits& t, std::span<const double> powers) {
    std::vector<double> exponents{0};
    exponents.insert(exponents.end(), powers.begin(), powers.end());
    Weights w;
    for (std::size_t k = 0; k < radii; ++k) {
        std::vector<judge::FitPoint> points;
        for (std::size_t i = 0; i < radii; ++i) points.push_back({std::pow(t.convergenceStep, double(i)), i == k ? 1.0 : 0.0, 1});
        const judge::Fit fit = judge::fitPowers(points, exponents).value();
        w.limit[k] = fit.coefficient[0];
        w.residual[k] = k == 0 ? 1 : 0;
        for (std::size_t e = 0; e < exponents.size(); ++e) w.residual[k] -= fit.coefficient[e];
    }
    return w;
}

judge::Estimate estimateOf(const stats::Moments& m) { return {m.mean, m.error(), m.n - 1}; }

// Of one row of the table, over the replicates.
struct Row {
    std::string paths;
    stats::Moments limit, residual, level, first;

    void add(const Weights& w, const std::array<double, radii>& measured, double truth) {
        double at0 = 0, left = 0;
        for (std::size_t k = 0; k < radii; ++k) {
            at0 += w.limit[k] * measured[k];
            left += w.residual[k] * measured[k];
        }
        limit.add(at0 - truth);
        residual.add(left);
        first.add(measured[0] - truth);
        level.add(truth);
    }
    void judge(const std::string& name, const Case& c) const {
        const judge::Test off = judge::oneSample(estimateOf(limit), 0), fit = judge::oneSample(estimateOf(residual), 0);
        const judge::Interval interval = judge::confidenceInterval(off, 0.05),
                              own = judge::confidenceInterval(judge::oneSample(estimateOf(first), 0), 0.05);
        const auto percent = [&](double x) { return 100 * x / level.mean; };
        fmt::print("| {} | {} | `{}` | {} | {:+.2f} [{:+.2f}, {:+.2f}] | {:+.2f} [{:+.2f}, {:+.2f}] | {:.2g} | {:.2g} |\n", name, paths,
                   c.method, c.reference, percent(first.mean), percent(own.low), percent(own.high), percent(limit.mean),
                   percent(interval.low), percent(interval.high), off.p, fit.p);
        std::fflush(stdout);
        const std::string method_(c.method), reference_(c.reference);
        CAPTURE(method_);
        CAPTURE(reference_);
        CAPTURE(paths);
        CHECK(level.mean > 0);
        CHECK(off.p >= alpha);
        CHECK(fit.p >= alpha);
        CHECK(percent(interval.high - interval.low) / 2 <= 100 * c.width);
    }
};

void judgeCase(const std::string& name, const Seen& s, const Case& c) {
    const IntegratorChoice method = chooseIntegrator(c.method), reference = chooseIntegrator(c.reference);
    const Traits t = method.entry->traits(method.options), other = reference.entry->traits(reference.options);
    std::string misses = t.misses;
    if (!other.misses.empty()) misses += (misses.empty() ? "" : "|") + other.misses;
    const PathClasses classes = PathClasses::make(
        {.paths = std::string(c.paths), .split = c.bounces ? "bounces" : "", .maxDepth = s.maxDepth, .within = {}, .without = misses});
    const std::vector<std::string> layers =
        c.bounces ? std::vector<std::string>{"bounces-1", "bounces-2", "bounces-3"} : std::vector<std::string>{};
    std::vector<Row> rows{{c.paths.empty() ? "all" : fmt::format("`{}`", c.paths), {}, {}, {}, {}}};
    for (const std::string& layer : layers) rows.push_back({fmt::format("`{}`, {}", c.paths, layer), {}, {}, {}, {}});
    const Weights w = weights(t, c.powers.empty() ? t.convergencePowers : c.powers);
    for (uint64_t r = 0; r < c.replicates; ++r) {
        std::vector<std::array<double, radii>> measured(rows.size());
        double h = method.options.real(t.convergesOver);
        for (std::size_t k = 0; k < radii; ++k, h *= t.convergenceStep) {
            IntegratorChoice choice = method;
            choice.options.set(t.convergesOver, fmt::format("{:.9g}", h), choice.entry->name);
            const std::vector<double> values = luminancesOf(s, choice, classes, layers, c.spp, firstSeed + r);
            for (std::size_t i = 0; i < rows.size(); ++i) measured[i][k] = values[i];
        }
        const std::vector<double> truth = luminancesOf(s, reference, classes, layers, c.referenceSpp, firstSeed + r);
        for (std::size_t i = 0; i < rows.size(); ++i) rows[i].add(w, measured[i], truth[i]);
    }
    for (const Row& row : rows) row.judge(name, c);
}

void judgeAll(const std::string& name, const std::vector<Case>& cases, bool always = false) {
    if (!always && !longTier()) {
        std::cout << name << ": its limits are judged in the long run, CHIARO_LONG=1\n";
        return;
    }
    const std::optional<Seen> s = seen(name);
    if (!s) {
        std::cout << name << ": there is no ../shared/scenes here\n";
        return;
    }
    for (const Case& c : cases) judgeCase(name, *s, c);
}

} // namespace

// Photons for caustics alone.
constexpr std::string_view causticPhoton = "photon:gather=0,count=1k,caustic-count=300k", causticSppm = "sppm:count=1k,caustic-count=16k";

// In sum, and by the number of scatterings.
Case byBounces(std::string_view radiosity, double width, uint32_t spp, uint32_t referenceSpp, uint32_t replicates) {
    return {radiosity, "path", "L D* E", width, spp, referenceSpp, replicates, {}, true};
}

TEST_SUITE("limits") {
    TEST_CASE("@cornell by radiosity") {
        judgeAll("@cornell", {{"radiosity:size=1.2", "path", "L D+ E", .004, 16, 128, 8}}, true);
        judgeAll("@cornell", {byBounces("radiosity:size=.5,light-rays=256", .004, 16, 1024, 32)});
    }
    TEST_CASE("lamp-room by radiosity") {
        judgeAll("lamp-room", {byBounces("radiosity:size=.5,light-rays=256,shots=256", .02, 16, 1024, 16)});
    }
    TEST_CASE("breakfast-room by radiosity") {
        judgeAll("breakfast-room", {byBounces("radiosity:size=.5,light-rays=256,shots=256", .02, 16, 1024, 16)});
    }
    TEST_CASE("@cornell") { judgeAll("@cornell", {{"photon", "path", "", .003, 16, 16, 32}, {"sppm", "path", "", .005, 16, 16, 32}}); }
    TEST_CASE("@cornell-spheres") {
        judgeAll("@cornell-spheres", {{"photon", "path", "", .01},
                                      {"sppm", "path", "", .02},
                                      {causticPhoton, "light", "L S+ D E", .02, 32},
                                      {causticSppm, "light", "L S+ D E", .02, 32}});
    }
    // The lamp in the ball is far below a pixel, and path meets it by accident: light is the measure. A floor without edges: what the blur
    // carries over the rim of the picture goes with the square of the radius.
    TEST_CASE("@caustic") {
        judgeAll("@caustic", {{causticPhoton, "light", "L S+ D E", .04, 32, 64, 10, {2}}}, true);
        judgeAll("@caustic", {{causticPhoton, "light", "L S+ D E", .02, 128, 64, 16, {2}},
                              {causticSppm, "light", "L S+ D E", .02, 128, 64, 16, {2}},
                              {"photon", "light", "", .02},
                              {"sppm", "light", "", .02}});
    }
    TEST_CASE("caustic-ring") {
        judgeAll("caustic-ring", {{"photon", "path", "", .003},
                                  {"sppm", "path", "", .003},
                                  {causticPhoton, "light", "L S+ D E", .02, 128},
                                  {causticSppm, "light", "L S+ D E", .02, 128}});
    }
    // Its sky through water is what path has noise of.
    TEST_CASE("caustic-pool") { judgeAll("caustic-pool", {{"photon", "path", "", .05, 16, 1024}, {"sppm", "path", "", .05, 16, 1024}}); }
    TEST_CASE("stained-glass-lamp") { judgeAll("stained-glass-lamp", {{"photon", "path", "", .02}, {"sppm", "path", "", .02}}); }
    TEST_CASE("lamp-room") { judgeAll("lamp-room", {{"photon", "path", "", .03, 16, 256}, {"sppm", "path", "", .03, 16, 256}}); }
} // TEST_SUITE
