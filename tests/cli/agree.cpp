// chiaro agree as a user runs it: verdicts and exit codes on scenes and on pictures with error layers, what it refuses, what it writes.
#include "io/picture.h"
#include "program.h"
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

using namespace program;
using Json = nlohmann::json;

namespace {

using Words = std::vector<std::string>;
Outcome agree(const Folder& folder, Words words) {
    words.insert(words.begin(), "agree");
    words.insert(words.end(), {"--progress", "none"});
    return run(folder, words);
}

double noiseAt(uint32_t i) { // uniform on -1..1, a pure function of i (Wellons' lowbias32)
    i ^= i >> 16;
    i *= 0x7feb352du;
    i ^= i >> 15;
    i *= 0x846ca68bu;
    i ^= i >> 16;
    return (i >> 8) / 8388608.0 - 1;
}

// A grey picture with an honest error layer: relative error 2 % a value.
void writeNoisy(const fs::path& file, uint32_t seed, double (*factor)(uint32_t x, uint32_t y), bool errors = true, uint32_t size = 64) {
    chiaro::Picture p{.width = size, .height = size, .window = {0, 0, size, size}, .names = {}, .planes = {}, .metadata = {}};
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float>& plane = p.add(name);
        for (uint32_t i = 0; i < plane.size(); ++i) {
            const uint32_t at = (seed * 3 + uint32_t(name[0])) * 1'000'003u + i;
            plane[i] = float(factor(i % size, i / size) * (1 + 0.02 * std::sqrt(3.0) * noiseAt(at)));
        }
    }
    if (errors)
        for (const char* name : {"error.R", "error.G", "error.B"}) p.add(name).assign(p.window.area(), 0.02f);
    chiaro::writeExr(file, p);
}
double one(uint32_t, uint32_t) { return 1; }
double twoPercent(uint32_t, uint32_t) { return 1.02; }
double balanced(uint32_t x, uint32_t y) { return x < 8 && y < 8 ? 1.05 : x >= 56 && y < 8 ? 0.95 : 1; }

} // namespace

TEST_SUITE("agree") {

    TEST_CASE("the path tracer agrees with itself, however it samples") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = agree(folder, {"@furnace", "-i", "path,path:nee=off,path:mis=off", "--size", "24x24", "--replicates", "16",
                                         "--spp", "16", "--json", "out.json", "--csv", "out.csv", "-o", "maps"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(contains(o.out, "path:nee=off  agrees"));
        CHECK(contains(o.out, "path:mis=off agrees: a bias of"));
        CHECK(contains(o.out, "L (D|G|S)* E without Ld S+ (D|G) .* E"));
        const Json json = Json::parse(readAll(folder / "out.json"));
        REQUIRE(json["integrators"].size() == 3);
        CHECK(json["exitCode"] == 0);
        CHECK(json["alpha"].get<double>() == 1e-3);
        for (const Json& i : json["integrators"]) {
            CHECK(i["verdict"] == "agrees");
            CHECK(i["alpha"].get<double>() == doctest::Approx(1e-3 / 3));
            CHECK(i["samples"].get<double>() >= 256);
            CHECK(i["resolution"].get<double>() <= 0.01);
            CHECK(i["bias"]["Y"]["low"].get<double>() <= i["bias"]["Y"]["relative"].get<double>());
            CHECK(i["image"]["tests"] == 4);
            CHECK(i["tiles"]["tests"] == 9);
        }
        const Json& seeds = json["stages"][0]["firstSeeds"];
        CHECK(seeds["path"]["reference"] == seeds["path:mis=off"]["reference"]); // one reference for the same paths
        CHECK(seeds["path"]["reference"] != seeds["path:nee=off"]["reference"]); // which cannot find delta lights
        CHECK(seeds["path"]["levels"][0] != seeds["path:nee=off"]["levels"][0]);
        CHECK(seeds["path"]["levels"][0] != seeds["path"]["reference"]); // with itself there is nothing to share
        CHECK(seeds["path:mis=off"]["levels"][0] == seeds["path:mis=off"]["reference"]);
        CHECK(json["integrators"][0]["paired"] == false);
        CHECK(json["integrators"][2]["paired"] == true);
        for (const char* name : {"path", "path-nee-off", "path-mis-off"}) {
            CHECK(fs::exists(folder / "maps" / (std::string(name) + ".png")));
            const chiaro::Picture map = chiaro::readPicture(folder / "maps" / (std::string(name) + ".exr"));
            for (const char* channel : {"z.tile", "z.pixel", "test.Y", "reference.Y"}) REQUIRE(map.find(channel));
            CHECK(std::abs((*map.find("z.tile"))[0]) < 6);
            CHECK((*map.find("reference.Y"))[300] > 0);
        }
        const std::string csv = readAll(folder / "out.csv");
        CHECK(std::count(csv.begin(), csv.end(), '\n') == 4);
    }

    TEST_CASE("where nothing but the points of the pixels is drawn by lot, all noise is shared") {
        if (absent()) return;
        const Folder folder;
        const Outcome o =
            agree(folder, {"@cornell", "-i", "whitted,raycast", "--size", "24x24", "--spp", "32", "--filter", "box", "--json", "-"});
        CAPTURE(o.err);
        CHECK(o.code == 0);
        for (const Json& i : Json::parse(o.out)["integrators"]) {
            CHECK(i["verdict"] == "agrees");
            CHECK(i["sharedNoise"].get<double>() > 0.999);
            CHECK(std::abs(i["bias"]["Y"]["relative"].get<double>()) < 1e-5);
            CHECK(i["resolution"].get<double>() > 0);
        }
    }

    TEST_CASE("the same command gives the same numbers, another seed others, threads none") {
        if (absent()) return;
        const Folder folder;
        const auto bias = [&](Words more) {
            Words words{"@cornell", "-i", "path", "--size", "16x16", "--replicates", "4", "--spp", "2", "--json", "-"};
            words.insert(words.end(), more.begin(), more.end());
            const Outcome o = agree(folder, words);
            CAPTURE(o.err);
            REQUIRE(!o.out.empty());
            return Json::parse(o.out)["integrators"][0]["bias"]["Y"]["difference"].get<double>();
        };
        const double first = bias({});
        CHECK(bias({"-t", "1"}) == first);
        CHECK(bias({"--seed", "1"}) != first);
    }

    TEST_CASE("too few samples cannot tell, and say how many are missing") {
        if (absent()) return;
        const Folder folder;
        const Outcome o =
            agree(folder, {"@cornell", "-i", "path:nee=off,path:mis=off", "--size", "24x24", "--replicates", "8", "--spp", "1"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        CHECK(o.code == 1);
        CHECK(contains(o.out, "path:mis=off cannot tell yet: needs "));
        CHECK(contains(o.out, " more samples a pixel to see a bias of 1 %"));
        CHECK(contains(o.err, "next     chiaro agree @cornell -i path:nee=off,path:mis=off --replicates 8 --size 24x24 "));
    }

    TEST_CASE("paths and depth restrict both sides") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = agree(folder, {"@furnace", "-i", "path:nee=off", "--paths", "L D E", "--max-depth", "3", "--size", "16x16",
                                         "--replicates", "16", "--spp", "16", "--margin", "5%"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(contains(o.out, "L D E without Ld .* E | Ld S+ (D|G) .* E, depth 3 at most"));
    }

    TEST_CASE("a pilot plans the samples and says how to keep the plan") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = agree(folder, {"@furnace", "-i", "path,raycast,whitted,distributed,light", "--size", "16x16", "--margin", "2"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(contains(o.err, "plan     32 replicates of "));
        CHECK(contains(o.err, "keep it with: --spp "));
        CHECK(o.out.find_first_not_of(' ', o.out.find("\npath ") + 5) == o.out.find("agrees")); // the first row, however wide
    }

    TEST_CASE("without a list all that transport light are judged") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = agree(folder, {"@cornell", "--size", "4x4", "--spp", "1", "--replicates", "2", "--paths", "L E"});
        CAPTURE(o.out);
        CAPTURE(o.err);
        for (const char* name : {"path", "raycast", "whitted", "distributed", "light", "photon", "sppm", "radiosity"})
            CHECK(contains(o.out, std::string("\n") + name + " "));
    }

    TEST_CASE("Ctrl-C ends with what is known") {
        if (absent()) return;
        const Folder folder;
        Running running(
            folder, {"agree", "@cornell", "-i", "path", "--size", "32x32", "--replicates", "60000", "--spp", "1", "--progress", "json"});
        REQUIRE(running.awaitStderr("\"spp\":")); // JSON progress begins after a second
        running.send(SIGINT);
        const Outcome o = running.wait();
        CAPTURE(o.err);
        CHECK(o.code == 5);
        CHECK(contains(o.err, "stopped at "));
        CHECK(contains(o.out, "cannot tell yet"));
    }

    TEST_CASE("what makes no sense is refused before anything is rendered") {
        if (absent()) return;
        const Folder folder;
        struct Row {
            Words words;
            std::string message;
            int code = 64;
        };
        const Row rows[] = {
            {{"@cornell", "-i", "normals"},
             "error: -i normals: a debug view, its picture is not light: there is nothing to agree on; have path"},
            {{"@cornell", "-i", "path,albedo"}, "-i albedo: a debug view"},
            {{"@cornell", "-i", "path:nee=off,foo"}, "no integrator \"foo\"; have path"},
            {{"@cornell", "-i", "nee=off,path"}, "\"nee=off\" is an option; the name of its integrator comes first"},
            {{"@cornell", "-i", "path,path"}, "path is named twice"},
            {{"@cornell", "-i", "path,path:nee=off", "-o", "map.png"}, "put {integrator} into the name"},
            {{"@cornell", "-i", "path", "--paths", "Ld S D E"}, "-i path: nothing to judge on Ld S D E"},
            {{"@cornell", "-i", "path", "--replicates", "1"}, "--replicates"},
            {{"@cornell", "-i", "path", "--alpha", "2"}, "--alpha"},
            {{"a.exr", "b.exr"}, "a.exr: no such file", 4},
            {{"a.exr", "b.exr", "-i", "path"}, "--integrator is about rendering"},
            {{"@cornell", "-i", "path", "-o", "-"}, "a map does not go to stdout"},
        };
        for (const Row& row : rows) {
            const Outcome o = agree(folder, row.words);
            CAPTURE(o.err);
            CAPTURE(row.message);
            CHECK(o.code == row.code);
            CHECK(o.out.empty());
            CHECK(contains(o.err, row.message));
        }
    }

    TEST_CASE("two pictures by their error layers") {
        if (absent()) return;
        const Folder folder;
        writeNoisy(folder / "a.exr", 1, one);
        writeNoisy(folder / "same.exr", 2, one);
        writeNoisy(folder / "brighter.exr", 3, twoPercent);
        writeNoisy(folder / "elsewhere.exr", 4, balanced);
        writeNoisy(folder / "bare.exr", 5, one, false);
        writeNoisy(folder / "small.exr", 6, one, true, 32);
        const auto against = [&](const std::string& name, Words more = {}) {
            more.insert(more.begin(), {name, "a.exr"});
            return agree(folder, more);
        };
        const Outcome same = against("same.exr", {"-o", "m.png", "-o", "m.exr"});
        CAPTURE(same.out);
        CHECK(same.code == 0);
        CHECK(contains(same.out, "same.exr agrees: a bias of"));
        CHECK(fs::exists(folder / "m.png"));
        CHECK(chiaro::readPicture(folder / "m.exr").find("z.pixel"));

        const Outcome brighter = against("brighter.exr", {"--json", "-"});
        CHECK(brighter.code == 2);
        const Json json = Json::parse(brighter.out);
        CHECK(json["integrators"][0]["verdict"] == "biased");
        CHECK(json["integrators"][0]["bias"]["Y"]["relative"].get<double>() == doctest::Approx(0.02).epsilon(0.1));
        CHECK(contains(brighter.err, "brighter.exr biased by +"));

        const Outcome elsewhere = against("elsewhere.exr");
        CAPTURE(elsewhere.out);
        CHECK(elsewhere.code == 2);
        CHECK(contains(elsewhere.out, "elsewhere.exr differs: 2 of 64 tiles"));
        CHECK(against("elsewhere.exr", {"--crop", "32x32+16+16"}).code == 0); // the middle is untouched

        const Outcome few = against("same.exr", {"--margin", "0.01"});
        CHECK(few.code == 1);
        CHECK(contains(few.out, "more samples for each that both have"));

        const Outcome bare = against("bare.exr");
        CHECK(bare.code == 3);
        CHECK(contains(bare.err, "bare.exr: no error layer"));
        CHECK(against("small.exr").code == 3);
    }
}
