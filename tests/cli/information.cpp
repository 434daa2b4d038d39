// info, scenes, integrators, doctor, help, --version.
#include "program.h"
#include <nlohmann/json.hpp>

using namespace program;

TEST_SUITE("information") {

    TEST_CASE("version and help go to stdout") {
        if (absent()) return;
        const Folder folder;
        const Outcome version = run(folder, {"--version"});
        CHECK(version.code == 0);
        CHECK(version.out.starts_with("chiaro "));
        CHECK(version.err.empty());
        const Outcome help = run(folder, {"help"});
        CHECK(help.out == run(folder, {"--help"}).out);
        for (const char* command : {"render", "info", "scenes", "integrators", "doctor", "help"}) {
            CHECK(contains(help.out, std::string("chiaro ") + command));
            const Outcome one = run(folder, {"help", command});
            CHECK(one.code == 0);
            CHECK(contains(one.out, std::string("chiaro ") + command));
            CHECK(run(folder, {command, "--help"}).out.starts_with(std::string("chiaro ") + command));
        }
        for (const char* topic : {"units", "paths", "exit-codes", "scenes"}) {
            const Outcome o = run(folder, {"help", topic});
            CHECK(o.code == 0);
            CHECK(o.out.size() > 200);
        }
    }

    TEST_CASE("the help of render lists every option") {
        if (absent()) return;
        const Folder folder;
        const std::string help = run(folder, {"help", "render"}).out;
        for (const char* option : {"-i, --integrator", "-o, --output",  "--spp",        "--time",
                                   "--max-depth",      "--rr-depth",    "--size",       "--crop",
                                   "--pixel",          "--sample",      "--seed",       "-t, --threads",
                                   "--sampler",        "--filter",      "--isa",        "--missing-texture",
                                   "-c, --camera",     "--env",         "--env-rotate", "--env-scale",
                                   "--exposure",       "--view",        "--ocio",       "--strict",
                                   "-q, --quiet",      "-v, --verbose", "--json",       "--progress",
                                   "--config"})
            CHECK_MESSAGE(contains(help, std::string(option) + " "), option);
    }

    TEST_CASE("lists as text and JSON") {
        if (absent()) return;
        const Folder folder;
        CHECK(contains(run(folder, {"scenes"}).out, "@cornell"));
        const auto scenes = nlohmann::json::parse(run(folder, {"scenes", "--json"}).out);
        CHECK(scenes[0]["name"] == "@cornell");
        const std::string text = run(folder, {"integrators"}).out;
        CHECK(contains(text, "rr-depth="));
        const auto all = nlohmann::json::parse(run(folder, {"integrators", "--json"}).out);
        CHECK(all[0]["name"] == "path");
        CHECK(!all[0]["covers"].get<std::string>().empty());
        for (const auto& entry : all) {
            CHECK(contains(text, entry["name"].get<std::string>()));
            for (const auto& option : entry["options"]) CHECK(!option["range"].get<std::string>().empty());
        }
    }

    TEST_CASE("info of a scene and of a picture") {
        if (absent()) return;
        const Folder folder;
        folder.write("bare.gltf", triangle(R"({"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0}})"));
        const auto scene = nlohmann::json::parse(run(folder, {"info", "bare.gltf", "--json"}).out);
        CHECK(scene["triangles"]["stored"] == 1);
        CHECK(scene["triangles"]["drawn"] == 1);
        CHECK(scene["bounds"][1][0] == 1.0);
        CHECK(scene["materials"][0]["name"] == "paint");
        CHECK(scene["added"].size() >= 2);
        CHECK(contains(run(folder, {"info", "bare.gltf"}).out, "\"paint\"  dielectric"));
        const auto cornell = nlohmann::json::parse(run(folder, {"info", "@cornell", "--json"}).out);
        CHECK(cornell["lights"][0]["kind"] == "mesh");
        CHECK(cornell["lights"][0]["lumen"].get<double>() > 0);

        CHECK(run(folder, {"render", "bare.gltf", "--spp", "1", "--size", "8x4", "-q"}).code == 0);
        const auto picture = nlohmann::json::parse(run(folder, {"info", "bare.exr", "--json"}).out);
        CHECK(picture["size"] == nlohmann::json({8, 4}));
        CHECK(picture["metadata"]["chiaro:spp"] == "1");
        const Outcome text = run(folder, {"info", "bare.png"});
        CHECK(text.code == 0);
        CHECK(contains(text.out, "chiaro:exposure"));
    }

    TEST_CASE("doctor finds this installation well") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"doctor", "--json"});
        CHECK(o.code == 0);
        const auto report = nlohmann::json::parse(o.out);
        CHECK(report["ok"] == true);
        CHECK(report["checks"].size() >= 7);
    }

} // TEST_SUITE
