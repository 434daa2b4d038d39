// Growth with triangles: one room, one lamp, and in it a rough stone of ten thousand, a hundred thousand, a million triangles: what it
// takes to build, to keep and to ask.
#include "materials/closure_table.h"
#include "scenes/shapes.h"
#include "tools/bench/memory.h"
#include "tools/bench/rays.h"
#include "tools/bench/rendering.h"
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <malloc.h>
#include <numbers>

namespace chiaro::bench {
namespace {

constexpr std::array<uint64_t, 3> steps = {10'000, 100'000, 1'000'000};
constexpr uint32_t recordedPixels = 1 << 16;
constexpr std::size_t figuresBefore = 4; // columns before the rates

// Bumps of every size: seven octaves of waves, about its radius of 1 m.
double stoneRadius(double x, double y, double z) {
    double r = 1, amplitude = 0.12, frequency = 2.5;
    for (int octave = 0; octave < 7; ++octave, amplitude *= 0.55, frequency *= 2.1)
        r += amplitude * std::sin(frequency * x + 1.3 * octave) * std::sin(frequency * y + 2.1 * octave) *
             std::sin(frequency * z + 0.7 * octave);
    return r;
}

// A grid over the sphere of about so many triangles, rows x 2 rows cells, with smooth normals.
PrimitiveDesc stone(uint64_t triangles) {
    const uint32_t rows = uint32_t(std::max(2.0, std::sqrt(double(triangles) / 4))), columns = 2 * rows;
    PrimitiveDesc p;
    for (uint32_t i = 0; i <= rows; ++i)
        for (uint32_t j = 0; j < columns; ++j) {
            const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
            const double x = std::sin(theta) * std::cos(phi), y = std::cos(theta), z = std::sin(theta) * std::sin(phi),
                         r = stoneRadius(x, y, z);
            p.positions.push_back({float(r * x), float(r * y), float(r * z)});
        }
    p.normals.assign(p.positions.size(), {});
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        const Vec3 n = cross(p.positions[b] - p.positions[a], p.positions[c] - p.positions[a]);
        for (const uint32_t v : {a, b, c}) {
            p.indices.push_back(v);
            p.normals[v] += n;
        }
    };
    for (uint32_t i = 0; i < rows; ++i)
        for (uint32_t j = 0; j < columns; ++j) {
            const uint32_t right = (j + 1) % columns, a = i * columns + j, b = i * columns + right, c = a + columns, d = b + columns;
            if (i > 0) add(a, b, c);
            if (i + 1 < rows) add(b, d, c);
        }
    for (Vec3& n : p.normals) n = dot(n, n) > 0 ? normalize(n) : Vec3{0, 1, 0};
    return p;
}

SceneDesc stoneRoom(uint64_t triangles) {
    using namespace shapes;
    SceneDesc s;
    s.name = fmt::format("stone of {} triangles", triangles);
    const int white = add(s, diffuse("white", Spectrum(0.7f))), grey = add(s, diffuse("grey", Spectrum(0.5f))),
              light = add(s, lamp("lamp", Spectrum(20)));
    add(s, "room", insideOut(box({2, 1.6, 2})), white);
    add(s, "stone", stone(triangles), grey);
    add(s, "lamp", quad({-0.4, 1.59, -0.4}, {0.4, 1.59, -0.4}, {0.4, 1.59, 0.4}, {-0.4, 1.59, 0.4}), light);
    addCamera(s, "main", 0.9, lookAt({1.3, 0.9, 1.7}, {0, 0, 0}));
    return s;
}

// before: resident bytes without the stone; 0: unknown.
std::optional<std::vector<double>> measure(const Request& request, SceneDesc desc, std::size_t before, const Executor& run,
                                           Stopwatch& watch, double& spread, FunctionRef<void()> built) {
    const auto begin = Clock::now();
    const auto scene = Scene::compile(std::move(desc), request.notes, request.isa, &run, ClosureTable::make);
    const double seconds = secondsSince(begin), n = double(scene->counts().triangles);
    built();
    const double peak = before > 0 ? double(peakBytes()) - double(before) : NAN;
    View view;
    view.width = request.width;
    view.height = request.height;
    view.crop = {0, 0, view.width, view.height};
    view.camera = Camera(scene->cameras()[0], view.width, view.height, {});
    const PathClasses classes;
    const Job job{
        {*scene, classes, {}, request.seed, SamplerKind::sobol, run, request.stop, request.progress, request.notes, request.memoryLimit},
        view};
    std::vector<double> cells = {n, seconds, double(scene->counts().bytes.total()) / n, peak / n};
    const RecordedRays rays = recordRays(job, recordedPixels);
    for (int k = 0; k < rayKinds; ++k) {
        const auto rate = watch.rate([&] { return double(traceAll(*scene, run, rays, RayKind(k), request.stop).rays); });
        if (!rate) return {};
        if (k == 0) spread = rate->spread;
        cells.push_back(1e-6 * rate->perSecond);
    }
    Rendering path(job, chooseIntegrator("path"));
    const auto samples = watch.rate([&] { return path.pass(); });
    if (!samples) return {};
    cells.push_back(1e-6 * samples->perSecond);
    return cells;
}

} // namespace

Table trianglesSuite(const Request& request) {
    Table table{
        .suite = "triangles",
        .title = "a rough stone in a lit room, of more and more triangles",
        .columns = {{"triangles", ""}, {"build", "s"}, {"kept", "bytes each"}, {"peak", "bytes each"}},
        .rows = {},
        .notes = {"build: from the description in memory to the first ray; kept: all of the scene; peak: what the process grew by"}};
    for (int k = 0; k < rayKinds; ++k) table.columns.push_back({std::string(rayKindName(RayKind(k))), "M rays/s"});
    table.columns.push_back({"path", "M samples/s"});
    Stopwatch watch(request.seconds, steps.size() * (rayKinds + 1) * request.threads.size(), request.runs, request.stop);
    for (const unsigned threads : request.threads) {
        double before = 0; // what the last stone took to make and to build
        for (const uint64_t triangles : steps) {
            if (request.stop.requested()) {
                table.stopped = true;
                return table;
            }
            if (10 * before > watch.left()) {
                table.notes.push_back(fmt::format("{} triangles with {} thread{} left out, about {:.0f} s; give more --time", triangles,
                                                  threads, threads == 1 ? "" : "s", 10 * before));
                continue;
            }
            request.progress.phase(fmt::format("triangles {} {} thread{}", triangles, threads, threads == 1 ? "" : "s"));
            const Executor run(threads);
            malloc_trim(0); // what the last stone has left counts for nobody
            const std::size_t without = resetPeak() ? residentBytes() : 0;
            const auto begin = Clock::now();
            SceneDesc desc = stoneRoom(triangles);
            double spread = 0, built = 0;
            auto cells = measure(request, std::move(desc), without, run, watch, spread, [&] { built = secondsSince(begin); });
            before = built;
            table.stopped = !cells;
            if (!cells) return table;
            table.rows.push_back({"stone", fmt::format("{} triangles", triangles), threads, spread, std::move(*cells)});
        }
    }
    return table;
}

std::vector<Panel> trianglesPlot(const Table& table) {
    Panel rays{"rays and samples, most threads", "triangles", "M/s", {}},
        build{"building, most threads", "triangles", "s", {{"build", {}}}};
    for (std::size_t c = figuresBefore; c < table.columns.size(); ++c) rays.curves.push_back({table.columns[c].name, {}});
    unsigned most = 0;
    for (const Row& r : table.rows) most = std::max(most, r.threads);
    for (const Row& r : table.rows) {
        if (r.threads != most) continue;
        build.curves[0].points.emplace_back(r.cells[0], r.cells[1]);
        for (std::size_t c = figuresBefore; c < r.cells.size(); ++c)
            rays.curves[c - figuresBefore].points.emplace_back(r.cells[0], r.cells[c]);
    }
    return {rays, build};
}

} // namespace chiaro::bench
