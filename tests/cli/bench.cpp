// chiaro bench: what its tables hold, and that their figures hang together. No figure itself is judged: machines differ.
#include "tools/bench/bench.h"
#include "scenes/builtin.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"
#include "tools/bench/memory.h"
#include "tools/bench/profile.h"
#include "tools/bench/rays.h"
#include "tools/bench/symbols.h"
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

using namespace chiaro;
using program::absent, program::contains, program::Folder, program::run, program::Outcome;
using Json = nlohmann::json;

namespace {

struct Machine {
    explicit Machine(const std::string& name = "@cornell-spheres") : scene(test::compiled(findBuiltin(name)->make())) {
        view.camera = Camera(scene->cameras()[0], 64, 64, {});
        view.width = view.height = 64;
        view.crop = {0, 0, 64, 64};
        request.scenes = {{name, scene.get(), view}};
        request.threads = {1, 2};
        request.seconds = 0.5;
        request.runs = 2;
        request.memoryLimit = std::size_t(1) << 30;
    }
    std::unique_ptr<const Scene> scene;
    View view;
    StopToken stop;
    Progress progress;
    Diagnostics notes;
    bench::Request request{.scenes = {}, .integrators = {}, .threads = {}, .stop = stop, .progress = progress, .notes = notes};
};

// Every row has a number or an honest gap in every column, and its threads are those asked for.
void checkShape(const bench::Table& t, const bench::Request& request) {
    CHECK(!t.stopped);
    CHECK(!t.rows.empty());
    for (const bench::Row& r : t.rows) {
        CAPTURE(r.subject);
        CHECK(r.cells.size() == t.columns.size());
        CHECK(std::count(request.threads.begin(), request.threads.end(), r.threads) == 1);
        CHECK(std::isfinite(r.cells[0]));
        CHECK(r.cells[0] > 0);
        CHECK(r.spread >= 0);
        for (const double v : r.cells) CHECK((std::isnan(v) || v >= 0));
    }
}

} // namespace

TEST_SUITE("bench") {

    TEST_CASE("median and stopwatch") {
        CHECK(bench::median({}) == 0);
        CHECK(bench::median({3, 1, 2}) == 2);
        CHECK(bench::median({4, 1, 2, 3}) == 2.5);
        const StopToken never;
        int batches = 0;
        bench::Stopwatch watch(0.03, 1, 3, never);
        const auto rate = watch.rate([&] { return ++batches, 10.0; });
        REQUIRE(rate);
        CHECK(rate->runs >= 1);
        CHECK(rate->runs <= 3);
        CHECK(rate->perSecond > 0);
        CHECK(batches >= 2);                                              // one to warm up
        CHECK(bench::Stopwatch(0, 1, 3, never).rate([] { return 1.0; })); // no time: one batch all the same
        StopToken stop;
        stop.request();
        CHECK(!bench::Stopwatch(1, 1, 3, stop).rate([] { return 1.0; }));
    }

    TEST_CASE("single and wide rays have the same answers") {
        Machine m;
        for (const unsigned threads : {1u, 2u}) {
            const Executor executor(threads);
            const PathClasses classes;
            const Job job{{*m.scene, classes, {}, 0, SamplerKind::sobol, executor, m.stop, m.progress, m.notes}, m.view};
            const bench::RecordedRays rays = bench::recordRays(job, 4096);
            CHECK(rays.camera.size() == 4096);
            CHECK(rays.bounce.size() > 2000);
            CHECK(rays.shadow.size() % 16 == 0);
            CHECK(!rays.shadow.empty());
            for (std::size_t i = 0; i < rays.shadow.size(); i += 16) CHECK(length(rays.shadow[i].o - rays.shadow[i + 15].o) < 1e-3f);
            const auto traced = [&](bench::RayKind k) { return bench::traceAll(*m.scene, executor, rays, k, m.stop); };
            for (const auto& [one, wide] : {std::pair(bench::RayKind::cameraSingle, bench::RayKind::cameraWide),
                                            std::pair(bench::RayKind::bounceSingle, bench::RayKind::bounceWide),
                                            std::pair(bench::RayKind::shadowSingle, bench::RayKind::shadowWide)}) {
                const bench::Traced a = traced(one), b = traced(wide);
                CHECK(a.rays == b.rays);
                CHECK(a.hits == b.hits);
                CHECK(a.hits > 0);
                CHECK(a.hits <= a.rays);
            }
        }
    }

    TEST_CASE("every suite fills its table") {
        Machine m;
        checkShape(bench::raysSuite(m.request), m.request);
        CHECK(bench::raysSuite(m.request).rows.size() == 2 * bench::rayKinds);
        m.request.integrators = {chooseIntegrator("path"), chooseIntegrator("whitted"), chooseIntegrator("light")};
        const bench::Table integrators = bench::integratorsSuite(m.request);
        checkShape(integrators, m.request);
        REQUIRE(integrators.rows.size() == 6);
        for (const bench::Row& r : integrators.rows) {
            CHECK(r.cells[2] >= 1);                                        // rays a sample
            CHECK(r.cells[1] == doctest::Approx(r.cells[0] * r.cells[2])); // rays/s
            if (r.threads == 1) CHECK(r.cells[4] == doctest::Approx(1));
            CHECK((std::isnan(r.cells[6]) || r.cells[6] > 1)); // MB
        }
        m.request.integrators.clear();
        const bench::Table photons = bench::photonsSuite(m.request);
        checkShape(photons, m.request);
        for (const bench::Row& r : photons.rows) {
            CHECK(r.cells[5] >= 32); // bytes of a photon
            CHECK(r.cells[5] < 48);
            CHECK(r.cells[6] == doctest::Approx(1).epsilon(1e-6)); // no light is lost
        }
    }

    TEST_CASE("replay: the hits and distances of the render, and a ratio") {
        Machine m;
        m.request.integrators = {chooseIntegrator("path"), chooseIntegrator("whitted"), chooseIntegrator("light"),
                                 chooseIntegrator("normals")};
        const bench::Table t = bench::replaySuite(m.request);
        checkShape(t, m.request);
        CHECK(!t.failed);
        CHECK(t.columns[0].name == "replay_ratio");
        for (std::size_t i = 0; i < t.rows.size();) { // a render, then its classes
            CAPTURE(t.rows[i].subject);
            const bench::Row& whole = t.rows[i++];
            CHECK(whole.cells[2] >= 0.5); // rays a sample
            double rays = 0, shares = 0;
            for (; i < t.rows.size() && t.rows[i].subject.starts_with(whole.subject + ", "); ++i) {
                rays += t.rows[i].cells[4];
                shares += t.rows[i].cells[0];
                CHECK(t.rows[i].cells[5] >= 1); // rays a call
                CHECK(t.rows[i].cells[5] <= 16);
            }
            CHECK(rays == doctest::Approx(whole.cells[4]));
            CHECK(shares > 0);
        }
        CHECK(std::count_if(t.rows.begin(), t.rows.end(), [](const bench::Row& r) { return r.subject == "path"; }) == 2);
    }

    TEST_CASE("split: shares that add up, of parts that are known by their names") {
        Machine m;
        m.request.integrators = {chooseIntegrator("path")};
        m.request.threads = {1};
        m.request.seconds = 1;
        const bench::Table t = bench::splitSuite(m.request);
        REQUIRE(t.rows.size() == 1);
        const std::vector<double>& cells = t.rows[0].cells;
        CHECK(cells.back() > 10); // how often it asked
        CHECK(std::accumulate(cells.begin(), cells.end() - 2, 0.0) == doctest::Approx(100));
        CHECK(cells[std::size_t(bench::Part::trace)] > 10);
        using enum bench::Part;
        for (const auto& [name, part] :
             {std::pair("chiaro::Film::add", film), std::pair("chiaro::Accel::intersect", packets),
              std::pair("chiaro::Lights::sampleTowards", lights), std::pair("chiaro::Bsdf::sample", shading),
              std::pair("chiaro::Scene::point", shading), std::pair("chiaro::Textures::lookUp", textures),
              std::pair("chiaro::Sampler::get2D", sampler), std::pair("chiaro::PathIntegrator::radiance", walk), std::pair("main", other)})
            CHECK_MESSAGE(bench::partOf(name) == part, name);
    }

    TEST_CASE("addresses are told by the names of functions and libraries") {
        const bench::Symbols symbols;
        CHECK(symbols.at(uintptr_t(&bench::median)).name == "chiaro::bench::median");
        CHECK(symbols.at(uintptr_t(&std::malloc)).library);
        CHECK(symbols.at(0).name == "?");
    }

    TEST_CASE("memory: a peak, and a peak from now on") {
        if (bench::residentBytes() == 0) return;
        constexpr std::size_t size = 100'000'000;
        {
            std::vector<char> touched(size, 1);
            CHECK(bench::peakBytes() >= size);
            CHECK(touched[size / 2] == 1);
        }
        const std::size_t before = bench::peakOfAll();
        if (!bench::resetPeak()) return;
        CHECK(bench::peakBytes() + size / 2 < before);
        CHECK(bench::peakOfAll() >= before);
    }

    TEST_CASE("triangles: what there is time for; growth as a picture") {
        Machine m;
        m.request.scenes.clear();
        m.request.threads = {2};
        m.request.width = m.request.height = 32;
        const bench::Table t = bench::trianglesSuite(m.request);
        checkShape(t, m.request);
        CHECK(t.rows[0].cells[0] == doctest::Approx(10'000).epsilon(0.05));
        CHECK(t.rows[0].cells[2] > 50); // bytes a triangle
        CHECK(t.rows[0].cells[2] < 400);
        const std::string svg = bench::svgPlot(bench::trianglesPlot(t));
        CHECK(svg.starts_with("<svg"));
        CHECK(contains(svg, "diffuse bounce, 16 wide"));
        const std::string gaps = bench::svgPlot({{"a < b", "x", "y", {{"c", {{1, 2}, {0, 3}, {10, NAN}, {100, 2000}}}, {"none", {}}}}, {}});
        CHECK(contains(gaps, "a &lt; b"));
        CHECK(!contains(gaps, "nan"));
        CHECK(!contains(gaps, "inf"));
        CHECK(std::count(gaps.begin(), gaps.end(), 'r') > 10);
    }

    TEST_CASE("radiosity: errors fall towards the finest matrix, what does not fit is named") {
        Machine m("@cornell");
        m.request.seconds = 6;
        const bench::Table t = bench::radiositySuite(m.request);
        checkShape(t, {.scenes = {}, .integrators = {}, .threads = {2}, .stop = m.stop, .progress = m.progress, .notes = m.notes});
        CHECK(t.notes.size() > 1); // a million patches do not fit
        for (const bench::Row& r : t.rows) {
            CAPTURE(r.subject);
            CHECK(r.cells[1] + 1e-9 >= r.cells[2]);                        // all of it, its part
            if (std::isfinite(r.cells.back())) CHECK(r.cells.back() < 10); // percent
        }
    }

    TEST_CASE("a stop leaves whole rows") {
        Machine m;
        m.stop.request();
        for (const bench::Suite& s : bench::suites()) {
            CAPTURE(s.name);
            m.request.integrators = {chooseIntegrator("path")};
            const bench::Table t = s.run(m.request);
            CHECK(t.stopped);
            CHECK(t.rows.empty());
        }
    }

    TEST_CASE("the command: tables, JSON, wrong input") {
        if (absent()) return;
        const Folder folder;
        const Outcome table = run(folder, {"bench", "rays", "--scenes", "@furnace", "--time", "300ms", "--size", "32x32", "-t", "1"});
        CAPTURE(table.err);
        REQUIRE(table.code == 0);
        CHECK(contains(table.out, "camera, 16 coherent"));
        CHECK(contains(table.out, "M rays/s"));
        const Outcome json = run(folder, {"bench", "integrators", "-i", "path,whitted:ambient=0.1", "--scenes", "@furnace", "--time",
                                          "300ms", "--size", "16x16", "-t", "1,2", "--json", "-q"});
        CAPTURE(json.err);
        REQUIRE(json.code == 0);
        const Json j = Json::parse(json.out, nullptr, false);
        REQUIRE(j.is_object());
        REQUIRE(j["suites"].size() == 1);
        const Json& suite = j["suites"][0];
        CHECK(suite["rows"].size() == 4);
        for (const Json& row : suite["rows"]) CHECK(row["values"].size() == suite["columns"].size());
        CHECK(suite["rows"][2]["subject"] == "whitted:ambient=0.1"); // an integrator, its numbers of threads
        CHECK(j["machine"].is_string());
        CHECK(j["stopped"] == false);
        const Outcome replay = run(folder, {"bench", "replay", "-i", "path", "--scenes", "@cornell", "--time", "500ms", "--size", "64x64",
                                            "-t", "2", "--json", "-q"});
        CAPTURE(replay.err);
        REQUIRE(replay.code == 0);
        const Json r = Json::parse(replay.out, nullptr, false);
        REQUIRE(r.is_object());
        CHECK(r["suites"][0]["columns"][0]["name"] == "replay_ratio");
        CHECK(r["suites"][0]["rows"][0]["values"][0] > 0);
        CHECK(r["suites"][0]["failed"] == false);
        CHECK(r["peakMemory"] > 1e6);
        const Outcome plot =
            run(folder, {"bench", "triangles", "--time", "300ms", "--size", "32x32", "-t", "2", "-q", "--plot", "growth.svg"});
        CAPTURE(plot.err);
        REQUIRE(plot.code == 0);
        CHECK(program::readAll(folder / "growth.svg").ends_with("</svg>\n"));
        const auto wrong = [&](std::vector<std::string> words, int code, const std::string& text) {
            words.insert(words.begin(), "bench");
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == code);
            CHECK(contains(o.err, text));
        };
        wrong({"ray"}, 64, "did you mean rays?");
        wrong({"rays", "--scenes", "none.glb"}, 4, "none.glb");
        wrong({"rays", "--scenes", "@cornel"}, 64, "@cornell");
        wrong({"rays", "--scenes", "@cornell,,"}, 64, "a name is missing");
        wrong({"rays", "--plot", "a.svg"}, 64, "name triangles or radiosity");
        wrong({"triangles", "--plot", "a.png"}, 64, ".svg");
        wrong({"triangles", "--plot", "no/a.svg"}, 4, "no/a.svg");
        wrong({"rays", "-t", "0"}, 64, "--threads");
        wrong({"rays", "--size", "4x4"}, 64, "8x8");
        wrong({"rays", "--time", "soon"}, 64, "a duration");
        wrong({"integrators", "-i", "pth"}, 64, "did you mean path?");
    }

    TEST_CASE("Ctrl-C: the rows so far, exit 5") {
        if (absent()) return;
        const Folder folder;
        program::Running bench(folder, {"bench", "rays", "--scenes", "@cornell", "--time", "60s", "-t", "1", "--json"});
        REQUIRE(bench.awaitStderr("rays @cornell"));
        usleep(200'000);
        bench.send(SIGINT);
        const Outcome o = bench.wait();
        CHECK(o.code == 5);
        CHECK(Json::parse(o.out)["stopped"] == true);
    }

} // TEST_SUITE
