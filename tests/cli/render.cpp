// chiaro render as a user meets it: files, streams, budgets, signals.
#include "io/picture.h"
#include "program.h"
#include <cstring>
#include <nlohmann/json.hpp>

using namespace program;
using chiaro::Picture;
using chiaro::readPicture;

namespace {

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool samePixels(const Picture& a, const Picture& b) {
    if (a.names != b.names) return false;
    for (std::size_t c = 0; c < a.planes.size(); ++c)
        if (!sameBits(a.planes[c], b.planes[c])) return false;
    return true;
}

std::string attribute(const Picture& p, const std::string& name) {
    const chiaro::MetadataValue* value = p.attribute(name);
    return value && std::holds_alternative<std::string>(*value) ? std::get<std::string>(*value) : "";
}

} // namespace

TEST_SUITE("render") {

    TEST_CASE("the lines of a run, on stderr alone") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"render", "@cornell", "--spp", "2", "--size", "32x32"});
        CHECK(o.code == 0);
        CHECK(o.out.empty());
        for (const char* part : {"chiaro ", "  embree ", "scene    @cornell   32 triangles, 1 emissive mesh, camera \"main\"",
                                 "path     2 spp, depth unlimited (roulette from 5), seed 0", "done     2 spp in ", "   0 non-finite",
                                 "wrote    cornell.exr  linear Rec.709 float32, 1.0 = 1 cd/m2", "wrote    cornell.png  sRGB, exposure ",
                                 "(auto)      keep it with: --exposure "})
            CHECK_MESSAGE(contains(o.err, part), part, " not in ", o.err);
        CHECK(!contains(o.err, "\x1b")); // no terminal, no colour, no cursor
        CHECK(fs::exists(folder / "cornell.exr"));
        CHECK(fs::exists(folder / "cornell.png"));
        const Outcome quiet = run(folder, {"render", "@cornell", "--spp", "1", "--size", "8x8", "-q"});
        CHECK(quiet.err.empty());
        CHECK(quiet.out.empty());
    }

    TEST_CASE("the printed exposure gives the same picture") {
        if (absent()) return;
        const Folder folder;
        const Outcome automatic = run(folder, {"render", "@cornell", "--spp", "2", "--size", "32x32", "-o", "a.png"});
        const std::string key = "--exposure ";
        const std::size_t at = automatic.err.find(key) + key.size();
        const std::string exposure = automatic.err.substr(at, automatic.err.find('\n', at) - at);
        CAPTURE(exposure);
        CHECK(run(folder, {"render", "@cornell", "--spp", "2", "--size", "32x32", "-o", "b.png", "--exposure", exposure}).code == 0);
        CHECK(samePixels(readPicture(folder / "a.png"), readPicture(folder / "b.png")));
        CHECK(std::stod(attribute(readPicture(folder / "b.png"), "chiaro:exposure")) == doctest::Approx(std::stod(exposure)));
        CHECK(attribute(readPicture(folder / "b.png"), "chiaro:view") == "Standard");
    }

    TEST_CASE("names of outputs") {
        if (absent()) return;
        const Folder folder;
        CHECK(run(folder, {"render", "@cornell", "--spp", "3", "--size", "8x8", "-i", "normals", "-o", "{scene}-{integrator}-{spp}.exr",
                           "-o", "second.png"})
                  .code == 0);
        CHECK(fs::exists(folder / "cornell-normals-3.exr"));
        CHECK(fs::exists(folder / "second.png"));
        CHECK(!fs::exists(folder / "cornell.exr"));
        for (const auto& entry : fs::directory_iterator(folder.path())) CHECK(!contains(entry.path().filename().string(), ".tmp"));
    }

    TEST_CASE("the picture does not depend on the number of threads") {
        if (absent()) return;
        const Folder folder;
        for (const char* threads : {"1", "2", "5"})
            CHECK(run(folder, {"render", "@cornell", "--spp", "4", "--size", "48x48", "-t", threads, "-o", std::string(threads) + ".exr"})
                      .code == 0);
        const Picture one = readPicture(folder / "1.exr");
        CHECK(samePixels(one, readPicture(folder / "2.exr")));
        CHECK(samePixels(one, readPicture(folder / "5.exr")));
        CHECK(run(folder, {"render", "@cornell", "--spp", "4", "--size", "48x48", "-o", "seed.exr", "--seed", "1"}).code == 0);
        CHECK(!samePixels(one, readPicture(folder / "seed.exr")));
    }

    TEST_CASE("a crop is the same window of the whole") {
        if (absent()) return;
        const Folder folder;
        CHECK(run(folder, {"render", "@cornell", "--spp", "4", "--size", "40x40", "-o", "whole.exr"}).code == 0);
        CHECK(run(folder, {"render", "@cornell", "--spp", "4", "--size", "40x40", "--crop", "13x9+7+21", "-o", "part.exr"}).code == 0);
        const Picture whole = readPicture(folder / "whole.exr"), part = readPicture(folder / "part.exr");
        CHECK(part.width == 40);
        CHECK(part.window == chiaro::Rect{7, 21, 20, 30});
        for (const char* name : {"R", "G", "B", "Z", "albedo.R", "normal.X", "samples"}) {
            const std::vector<float>*a = whole.find(name), *b = part.find(name);
            REQUIRE((a && b));
            for (uint32_t y = 0; y < 9; ++y)
                for (uint32_t x = 0; x < 13; ++x) CHECK(std::memcmp(&(*a)[(y + 21) * 40 + x + 7], &(*b)[y * 13 + x], sizeof(float)) == 0);
        }
    }

    TEST_CASE("one sample again") {
        if (absent()) return;
        const Folder folder;
        const std::vector<std::string> common = {"render", "@furnace", "--size", "16x16", "-q"};
        auto words = common;
        words.insert(words.end(), {"--pixel", "5,6", "--sample", "0"});
        const Outcome sample = run(folder, words);
        CHECK(sample.code == 0);
        CHECK(fs::is_empty(folder / ".err"));
        CHECK(!fs::exists(folder / "furnace.exr"));
        words = common;
        words.insert(words.end(), {"--spp", "1", "-o", "one.exr"});
        CHECK(run(folder, words).code == 0);
        const Picture one = readPicture(folder / "one.exr");
        CHECK(std::stof(sample.out) == (*one.find("R"))[6 * 16 + 5]);
    }

    TEST_CASE("the file tells how it was made") {
        if (absent()) return;
        const Folder folder;
        CHECK(
            run(folder, {"render", "@cornell", "--spp", "2", "--size", "8x8", "--seed", "7", "--filter", "box", "--rr-depth", "3"}).code ==
            0);
        const Picture p = readPicture(folder / "cornell.exr");
        CHECK(attribute(p, "chiaro:command") == "chiaro render @cornell --spp 2 --size 8x8 --seed 7 --filter box --rr-depth 3");
        CHECK(attribute(p, "chiaro:scene") == "@cornell");
        CHECK(attribute(p, "chiaro:sceneHash").size() == 16);
        CHECK(attribute(p, "chiaro:integrator") == "path:rr-depth=3");
        CHECK(attribute(p, "chiaro:seed") == "7");
        CHECK(attribute(p, "chiaro:spp") == "2");
        CHECK(attribute(p, "chiaro:sampler") == "sobol");
        CHECK(attribute(p, "chiaro:filter") == "box");
        CHECK(attribute(p, "chiaro:view") == "Standard");
        CHECK(!attribute(p, "chiaro:isa").empty());
        CHECK(!attribute(p, "chiaro:version").empty());
        CHECK(!attribute(p, "chiaro:commit").empty());
        CHECK(p.attribute("chiaro:seconds"));
        CHECK(!p.attribute("DateTime"));
    }

    TEST_CASE("command line before configuration before default") {
        if (absent()) return;
        const Folder folder;
        folder.write("a.json", R"({"spp": 3, "size": "8x8", "output": ["x.exr", "x.png"], "quiet": true, "seed": 5})");
        const Outcome o = run(folder, {"render", "@cornell", "--config", "a.json", "--spp", "2"});
        CHECK(o.code == 0);
        CHECK(o.err.empty());
        const Picture p = readPicture(folder / "x.exr");
        CHECK(attribute(p, "chiaro:spp") == "2");
        CHECK(attribute(p, "chiaro:seed") == "5");
        CHECK(attribute(p, "chiaro:filter") == "blackman-harris");
        CHECK(p.width == 8);
        CHECK(fs::exists(folder / "x.png"));
    }

    TEST_CASE("a time budget ends the render") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"render", "@cornell", "--time", "300ms", "--size", "32x32", "--json"});
        CHECK(o.code == 0);
        const auto summary = nlohmann::json::parse(o.out);
        CHECK(summary["ended"] == "time");
        CHECK(summary["spp"].get<int>() >= 1);
        CHECK(summary["files"].size() == 2);
        CHECK(summary["exit"] == 0);
    }

    TEST_CASE("what a scene lacks is added and announced") {
        if (absent()) return;
        const Folder folder;
        folder.write("bare.gltf", triangle());
        const Outcome o = run(folder, {"render", "bare.gltf", "--spp", "1", "--size", "16x16"});
        CHECK(o.code == 0);
        CHECK(contains(o.err, "keep it with: --camera auto"));
        CHECK(contains(o.err, "keep it with: --env studio"));
        const Outcome dark = run(folder, {"render", "bare.gltf", "--spp", "1", "--size", "16x16", "--env", "none"});
        CHECK(dark.code == 0);
        CHECK(contains(dark.err, "warning: no light and --env none: the picture will be black. Add --env studio, or a KHR_lights_punctual "
                                 "or emissive material."));
        CHECK(contains(dark.err, "exposure 0.0 (auto)"));
        CHECK(run(folder, {"render", "bare.gltf", "--spp", "1", "--size", "16x16", "--env", "none", "--strict"}).code == 1);
        CHECK(run(folder,
                  {"render", "bare.gltf", "--spp", "1", "--size", "16x16", "--env", "white", "--env-rotate", "-30", "--env-scale", "2"})
                  .code == 0);
    }

    TEST_CASE("Ctrl-C keeps what there is") {
        if (absent()) return;
        const Folder folder;
        Running running(folder, {"render", "@cornell", "--spp", "1M", "--size", "32x32", "--progress", "json"});
        REQUIRE(running.awaitStderr("{\"progress\"")); // a second in: samples are there
        running.send(SIGINT);
        const Outcome o = running.wait();
        CHECK(o.code == 5);
        CHECK(contains(o.err, "stopped at "));
        CHECK(contains(o.err, "/1000000 spp; wrote cornell.exr, cornell.png"));
        const Picture p = readPicture(folder / "cornell.exr");
        CHECK(p.width == 32);
        CHECK(fs::exists(folder / "cornell.png"));
    }

    TEST_CASE("samples that are no numbers are told with what brings them back, and only with that") {
        if (absent()) return;
        const Folder folder;
        folder.write("hot.gltf", triangle(R"({"name": "wall"})", R"(, "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3e38}]}})"));
        using Words = std::vector<std::string>;
        std::string text = readAll(folder / "hot.gltf");
        const auto replace = [&](const std::string& from, const std::string& to) { text.replace(text.find(from), from.size(), to); };
        replace(R"([{"nodes": [0]}])", R"([{"nodes": [0, 1, 2]}])");
        replace(R"([{"mesh": 0}])",
                R"([{"mesh": 0}, {"translation": [0.25, 0.25, 0.1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"camera": 0, "translation": [0.3, 0.3, 1]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}])");
        folder.write("hot.gltf", text);
        const Words small{"hot.gltf", "--size", "8x8", "--spp", "4", "--env", "none"};
        const auto with = [&](Words words) {
            words.insert(words.begin(), "render");
            words.insert(words.begin() + 1, small.begin(), small.end());
            return run(folder, words);
        };
        const Outcome o = with({"-i", "raycast:aa=centre"});
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(contains(o.err, "non-finite samples dropped (material \"wall\"). Reproduce: chiaro render "));
        const std::size_t at = o.err.find("--pixel ");
        REQUIRE(at != std::string::npos);
        const std::string pixel = o.err.substr(at + 8, o.err.find(' ', at + 8) - at - 8);
        CHECK(contains(with({"-i", "raycast:aa=centre", "--pixel", pixel}).err, "not finite"));
        const Outcome light = with({"-i", "light"});
        CAPTURE(light.err);
        CHECK(contains(light.err, "non-finite samples dropped, the first at pixel "));
        CHECK(contains(light.err, ". Reproduce: chiaro trace hot.gltf "));
        const std::size_t path = light.err.find("Follow it: chiaro trace -i light --sample ");
        REQUIRE(path != std::string::npos);
        const std::string number = std::to_string(std::stoul(light.err.substr(path + 42)));
        const Outcome told =
            run(folder, {"trace", "hot.gltf", "-i", "light", "--pixel", "0,0", "--sample", number, "--size", "8x8", "--env", "none", "-q"});
        CHECK(contains(told.out, "inf"));
    }

    TEST_CASE("SIGTERM is answered alike") {
        if (absent()) return;
        const Folder folder;
        Running running(folder, {"render", "@cornell", "--spp", "1M", "--size", "32x32", "--progress", "json"});
        REQUIRE(running.awaitStderr("{\"progress\""));
        running.send(SIGTERM);
        CHECK(running.wait().code == 5);
    }

    TEST_CASE("a second Ctrl-C ends at once, and the old files stay") {
        if (absent()) return;
        const Folder folder;
        folder.write("cornell.exr", "old");
        // Large enough that stopping and writing take longer than the next request.
        Running running(folder, {"render", "@cornell", "--spp", "1M", "--size", "1200x1200", "-o", "cornell.exr", "--progress", "json"});
        REQUIRE(running.awaitStderr("{\"progress\""));
        for (int i = 0; i < 20; ++i) { // signals that wait for a process without a core become one
            running.send(SIGINT);
            usleep(5'000);
        }
        const Outcome o = running.wait();
        CHECK(o.code == 130);
        CHECK(readAll(folder / "cornell.exr") == "old");
    }

} // TEST_SUITE
