// What chiaro trace tells of scenes whose answer is known by hand, and that it tells all that a sample adds.
#include "io/gltf.h"
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include "tools/cli/integrator_list.h"
#include "tools/cli/trace.h"
#include <algorithm>
#include <cstring>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <unistd.h>

using namespace chiaro;
using namespace chiaro::cli;
using chiaro::test::Bench;
using chiaro::test::Settings;
namespace fs = std::filesystem;

namespace {

constexpr double thousand = 1000;

// A mirror in the plane z = 0 that reflects (0.9, 0.8, 0.7), a camera two metres before it that looks straight at it, and behind the
// camera, four metres from the mirror, a lamp of 5 cd/m2: one path, La SR E, of 5 (0.9, 0.8, 0.7). All of it moved by `offset`.
SceneDesc mirrorAndLamp(const Vec3d& offset = {}) {
    SceneDesc s;
    s.name = "mirror";
    const int mirror = shapes::add(s, shapes::metal("mirror", Spectrum(0.9f, 0.8f, 0.7f), 0)),
              lamp = shapes::add(s, shapes::lamp("bulb", Spectrum(5)));
    const Affine back = test::rotation({0, 1, 0}, std::numbers::pi);
    shapes::add(s, "mirror", test::square(1), mirror, shapes::translation(offset));
    shapes::add(s, "lamp", test::square(1), lamp, shapes::translation(offset + Vec3d{0, 0, 4}) * back);
    shapes::addCamera(s, "eye", 1e-5, shapes::translation(offset + Vec3d{0, 0, 2}));
    return s;
}

// One side of a trace without a command line.
struct Told {
    std::unique_ptr<const Scene> scene;
    LightNames lights;
    TraceSide side;
    Trace trace;

    Told(SceneDesc desc, uint32_t size, Pixel pixel, uint32_t samples, const std::string& integrator = "path",
         const std::string& split = {})
        : scene(test::compiled(std::move(desc))), lights(*scene), trace{*scene, lights, "@hand", "eye", 0, pixel, {}} {
        Settings settings;
        settings.width = settings.height = size;
        Bench bench(*scene, scene->cameras()[0], settings);
        if (!split.empty()) bench.classes = PathClasses::make({.paths = {}, .split = split, .within = {}, .without = {}});
        side.settings.integrator = chooseIntegrator(integrator);
        side.recipe = integrator;
        const auto made = side.settings.integrator.entry->make(side.settings.integrator.options);
        made->prepare(bench.job);
        auto& camera = dynamic_cast<CameraIntegrator&>(*made);
        TracedSide traced{&side, {}};
        for (uint32_t i = 0; i < samples; ++i) {
            TracedSample s{.number = i, .ray = {}, .log = {}};
            const Replayed r = replay(bench.job, camera, pixel, i, &s.log);
            const Replayed quiet = replay(bench.job, camera, pixel, i);
            CHECK(r.value == quiet.value); // who looks on changes nothing
            s.ray = r.start.ray;
            s.value = r.value;
            s.rays = r.rays;
            s.depth = r.depth;
            traced.samples.push_back(std::move(s));
        }
        trace.sides.push_back(std::move(traced));
    }
    const TracedSample& sample(std::size_t i = 0) const { return trace.sides[0].samples[i]; }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_SUITE("trace parts") {

    TEST_CASE("a mirror and a lamp, by hand") {
        const Vec3d offset{10, 20, 30};
        const Told told(mirrorAndLamp(offset), 1, {0, 0}, 1);
        const std::vector<PathLog::Vertex>& v = told.sample().log.vertices();
        REQUIRE(v.size() == 2);
        CHECK(v[0].kind == PathLog::Kind::surface);
        CHECK(v[0].parent == PathLog::none);
        CHECK(!v[0].event);
        CHECK(v[0].t == doctest::Approx(2));
        CHECK(length(told.trace.world(v[0].p) - offset) < 1e-4);
        CHECK(v[1].parent == 0);
        CHECK(v[1].event == Event::SR);
        CHECK(v[1].delta);
        CHECK(v[1].pdfW == 1);
        CHECK(v[1].t == doctest::Approx(4));
        CHECK(length(told.trace.world(v[1].p) - offset - Vec3d{0, 0, 4}) < 1e-4);
        const float reflected[3] = {0.9f, 0.8f, 0.7f};
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(v[1].weight[c] == doctest::Approx(reflected[c]).epsilon(1e-5));
            CHECK(v[1].throughput[c] == doctest::Approx(reflected[c]).epsilon(1e-5));
            CHECK(v[1].contribution[c] == doctest::Approx(5 * reflected[c]).epsilon(1e-5));
        }
        CHECK(told.sample().rays == 2);
        CHECK(told.sample().depth == 1);
        const std::string text = traceText(told.trace);
        CAPTURE(text);
        for (const char* part :
             {"path   @hand camera \"eye\" pixel 0,0 seed 0", "0 camera at (10, 20, 32) looks along (", "   1 hit \"mirror\" at (",
              "  2 m  throughput 1\n", "   2   hit \"bulb\" at (", "  4 m  by SR  weight (0.9, 0.8, 0.7)  pmf 1  throughput ",
              "adds (4.5, 4, 3.5)  [La SR E]  -- absorbed\n", "   2 rays, depth 1\n"})
            CHECK_MESSAGE(has(text, part), part);
    }

    TEST_CASE("the contributions told sum to the sample, exactly") {
        for (const char* name : {"@cornell-spheres", "@caustic", "@veach-mis"})
            // One path at a time: lanes may round otherwise than what is told.
            for (const char* integrator :
                 {"path:wide=off", "path:wide=off,nee=off", "path:wide=off,mis=off", "path:wide=off,rr-depth=0", "normals", "albedo"}) {
                CAPTURE(name);
                CAPTURE(integrator);
                const Told told(findBuiltin(name)->make(), 24, {13, 15}, 40, integrator);
                for (const TracedSample& s : told.trace.sides[0].samples) CHECK(s.sum() == s.value);
            }
    }

    TEST_CASE("with layers they sum to it but for the order of additions") {
        const Told told(findBuiltin("@cornell-spheres")->make(), 24, {9, 17}, 60, "path:wide=off", "paths");
        double sum = 0, value = 0;
        for (const TracedSample& s : told.trace.sides[0].samples) {
            for (std::size_t c = 0; c < 3; ++c) CHECK(s.sum()[c] == doctest::Approx(s.value[c]).epsilon(1e-5));
            sum += double(luminance(s.sum()));
            value += double(luminance(s.value));
        }
        CHECK(value > 0);
        CHECK(sum == doctest::Approx(value).epsilon(1e-6));
    }

    TEST_CASE("every integrator that tells of its paths tells all of them") {
        for (const IntegratorEntry& e : integrators()) {
            CAPTURE(std::string(e.name));
            if (!dynamic_cast<CameraIntegrator*>(e.make(Options(e.options)).get())) continue;
            const Told told(findBuiltin("@cornell-spheres")->make(), 24, {13, 15}, 8, std::string(e.name));
            if (!told.trace.sides[0].told()) continue;
            for (const TracedSample& s : told.trace.sides[0].samples)
                for (std::size_t c = 0; c < 3; ++c) CHECK(s.sum()[c] == doctest::Approx(s.value[c]).epsilon(1e-4));
        }
    }

    TEST_CASE("throughput times weight is carried on, vertex by vertex, and lengths are distances") {
        const Told told(findBuiltin("@cornell")->make(), 24, {11, 20}, 30);
        for (const TracedSample& s : told.trace.sides[0].samples)
            for (const PathLog::Vertex& v : s.log.vertices()) {
                if (v.parent == PathLog::none) continue;
                const PathLog::Vertex& from = s.log.vertices()[v.parent];
                for (std::size_t c = 0; c < 3; ++c)
                    CHECK(v.throughput[c] == doctest::Approx(from.throughput[c] * v.weight[c]).epsilon(1e-5));
                if (std::isfinite(v.t)) CHECK(v.t == doctest::Approx(length(v.p - from.p)).epsilon(1e-3));
            }
    }

    TEST_CASE("the lines begin at the camera and lie where the path was") {
        for (const Vec3d& offset : {Vec3d{10, 20, 30}, Vec3d{thousand * thousand, 0, -thousand * thousand}}) {
            const Told told(mirrorAndLamp(offset), 1, {0, 0}, 1);
            const fs::path file = fs::temp_directory_path() / ("chiaro-trace-" + std::to_string(getpid()) + ".glb");
            writeTrace(file, told.trace);
            Diagnostics notes;
            const SceneDesc back = readGltf(file, {}, notes); // well-formed, and nothing in it to render
            CHECK(back.meshes.size() == 1);
            CHECK(notes.warnings().size() == 1);
            const std::string bytes = [&] {
                std::ifstream in(file, std::ios::binary);
                return std::string(std::istreambuf_iterator<char>(in), {});
            }();
            fs::remove(file);
            uint32_t jsonSize = 0;
            std::memcpy(&jsonSize, bytes.data() + 12, 4);
            const auto json = nlohmann::json::parse(bytes.substr(20, jsonSize));
            CHECK(json["nodes"][0]["name"] == "trace of @hand, pixel 0,0");
            CHECK(json["nodes"][1]["name"] == "path");
            CHECK(json["nodes"][2]["name"] == "path sample 0");
            CHECK(json["nodes"][3]["name"] == "path sample 0, rays");
            float p[12] = {}; // camera, mirror; mirror, lamp
            std::memcpy(p, bytes.data() + 28 + jsonSize, sizeof p);
            Vec3d origin;
            if (json["nodes"][0].contains("translation")) {
                const auto& t = json["nodes"][0]["translation"];
                origin = {t[0], t[1], t[2]};
            }
            CHECK(json["nodes"][0].contains("translation") == (offset.x > thousand));
            const double z[4] = {2, 0, 0, 4};
            for (int i = 0; i < 4; ++i)
                CHECK(length(origin + Vec3d{double(p[3 * i]), double(p[3 * i + 1]), double(p[3 * i + 2])} - offset - Vec3d{0, 0, z[i]}) <
                      1e-3);
        }
    }

    TEST_CASE("names that would break a terminal or a file") {
        SceneDesc desc = mirrorAndLamp();
        desc.materials[0].name = "a\x1b[31m\"\n\\\xff";
        desc.materials[1].name = "";
        const Told told(std::move(desc), 1, {0, 0}, 1);
        const std::string text = traceText(told.trace);
        CHECK(!has(text, "\x1b"));
        CHECK(std::count(text.begin(), text.end(), '\n') == 6); // title, sample, camera, two vertices, value
        CHECK(has(text, "material 1"));
        const auto json = nlohmann::json::parse(traceJson(told.trace, {}, {}));
        CHECK(json["integrators"][0]["samples"][0]["vertices"].size() == 2);
    }
}
