// chiaro bake: what is baked is what the path tracer says, in whatever form it is written; what cannot be baked is said.
#include "io/picture.h"
#include "program.h"
#include "tools/bake/layout.h"
#include "tools/bake/pack.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

using namespace program;
using nlohmann::json;

namespace {

json gltfOf(const fs::path& file) {
    const std::string text = readAll(file);
    if (file.extension() == ".gltf") return json::parse(text);
    uint32_t size = 0;
    REQUIRE(text.size() > 20);
    std::memcpy(&size, text.data() + 12, 4);
    return json::parse(text.substr(20, size));
}

const std::vector<float>& plane(const chiaro::Picture& p, const char* name) {
    const std::vector<float>* found = p.find(name);
    REQUIRE(found);
    return *found;
}

// Means over the texels that were sampled in both.
struct Means {
    double a = 0, b = 0, difference = 0; // difference: mean absolute
};
Means means(const chiaro::Picture& a, const chiaro::Picture& b, const char* channel) {
    Means m;
    double n = 0;
    const auto &u = plane(a, channel), &v = plane(b, channel), &su = plane(a, "sampled"), &sv = plane(b, "sampled");
    REQUIRE(u.size() == v.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
        if (su[i] == 0 || sv[i] == 0) continue;
        m.a += double(u[i]), m.b += double(v[i]), m.difference += std::fabs(double(u[i]) - double(v[i]));
        ++n;
    }
    REQUIRE(n > 0);
    return {m.a / n, m.b / n, m.difference / n};
}

// A baked file seen with its own light alone, against the scene rendered: mean relative difference of pixels that do not clip.
double shownDifference(const Folder& folder, const std::string& scene, const std::string& baked, double exposure, double& bias) {
    REQUIRE(run(folder, {"render", scene, "--size", "64x64", "--spp", "256", "-o", "original.exr", "-q", "--aov", "none"}).code == 0);
    REQUIRE(run(folder, {"render", baked, "--size", "64x64", "--spp", "64", "--max-depth", "0", "--env", "none", "-o", "shown.exr", "-q",
                         "--aov", "none"})
                .code == 0);
    const chiaro::Picture a = chiaro::readPicture(folder / "original.exr"), b = chiaro::readPicture(folder / "shown.exr");
    const double scale = std::exp2(-exposure);
    double sum = 0, signedSum = 0, whole = 0;
    for (const char* channel : {"R", "G", "B"})
        for (std::size_t i = 0; i < plane(a, channel).size(); ++i) {
            const double original = double(plane(a, channel)[i]), shown = double(plane(b, channel)[i]) * scale;
            if (original > 0.9 * scale) continue; // a lamp
            sum += std::fabs(shown - original);
            signedSum += shown - original;
            whole += original;
        }
    bias = signedSum / whole;
    return sum / whole;
}

} // namespace

TEST_SUITE("bake") {
    TEST_CASE("usage") {
        if (absent()) return;
        const Folder folder;
        const auto fails = [&](std::vector<std::string> words, int code, const std::string& says) {
            words.insert(words.begin(), "bake");
            const Outcome o = run(folder, words);
            INFO(o.err);
            CHECK(o.code == code);
            CHECK(contains(o.err, says));
            CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
        };
        fails({"@cornell", "-o", "x.png"}, 64, ".glb and .gltf");
        fails({"@cornell", "-o", "no/such/x.glb"}, 4, "no/such");
        fails({"@cornell", "-i", "light"}, 3, "-i path");
        fails({"@cornell", "-i", "ao", "--estimate", "gather"}, 64, "--estimate look");
        fails({"@cornell", "--size", "64", "--density", "3"}, 64, "give one of them");
        fails({"@cornell", "--to", "vertex", "--uv", "new"}, 64, "light maps");
        fails({"@cornell", "--estimate", "look", "--light", "direct"}, 64, "gather");
        fails({"@cornell", "--siez", "64"}, 64, "--size");
        folder.write("empty.gltf",
                     R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "nothing"}]})");
        const Outcome o = run(folder, {"bake", "empty.gltf", "-q"});
        CHECK(o.code == 3);
        CHECK(contains(o.err, "no triangles"));
        folder.write("one.gltf", triangle());
        CHECK(run(folder, {"bake", "one.gltf", "-o", "one.gltf"}).code == 64);
        const Outcome large = run(folder, {"bake", "one.gltf", "--density", "1e6", "-q"});
        CHECK(large.code == 6);
        CHECK(contains(large.err, "--density"));
        const Outcome memory = run(folder, {"bake", "one.gltf", "--size", "4096", "--max-memory", "100M", "-q"});
        CHECK(memory.code == 6);
        CHECK(contains(memory.err, "--size"));
        const Outcome keep = run(folder, {"bake", "one.gltf", "--uv", "keep", "-q"});
        CHECK(keep.code == 3);
        CHECK(contains(keep.err, "no texture coordinates"));
    }

    TEST_CASE("packed rectangles do not overlap, and stay inside") {
        std::vector<chiaro::bake::Extent> all;
        uint32_t x = 7;
        for (int i = 0; i < 200; ++i) {
            x = x * 1664525u + 1013904223u;
            all.push_back({1 + (x >> 28), 1 + (x >> 20 & 15)});
        }
        const auto places = chiaro::bake::pack(all, 140);
        REQUIRE(places);
        std::vector<int> used(140 * 140, 0);
        for (std::size_t i = 0; i < all.size(); ++i)
            for (uint32_t v = 0; v < all[i].h; ++v)
                for (uint32_t u = 0; u < all[i].w; ++u) ++used.at(((*places)[i].y + v) * 140 + (*places)[i].x + u);
        CHECK(*std::max_element(used.begin(), used.end()) == 1);
        CHECK_FALSE(chiaro::bake::pack(all, 40));
    }

    TEST_CASE("an existing layout that does not overlap is kept to the letter, one that does is replaced") {
        if (absent()) return;
        const Folder folder;
        const auto scene = [](const char* uv) { // one triangle, and its coordinates as a second buffer
            return std::string(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
                "nodes": [{"mesh": 0, "name": "left", "extras": {"mine": 1}}, {"mesh": 0, "translation": [0, 0, -4], "name": "right"}],
                "meshes": [{"name": "shared", "primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "_CUSTOM": 2}}]}],
                "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"},
                            {"byteLength": 24, "uri": "data:application/octet-stream;base64,)") +
                   uv + R"("}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteLength": 24}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                              {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                              {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                "animations": [{"name": "still here", "channels": [], "samplers": []}]})";
        };
        folder.write("two.gltf", scene("AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/")); // (0,0) (1,0) (0,1)
        const Outcome o = run(folder, {"bake", "two.gltf", "--size", "32", "--spp", "4", "--json", "-q", "-o", "out.gltf"});
        INFO(o.err);
        REQUIRE(o.code == 0);
        const json told = json::parse(o.out);
        CHECK(told["lightMap"]["keptParts"] == 2); // both fit; together they overlap, so that each becomes one chart
        CHECK(told["lightMap"]["literal"] == false);
        CHECK(told["lightMap"]["overlaps"] == 0);
        const json g = gltfOf(folder / "out.gltf");
        CHECK(g["nodes"][0]["extras"]["mine"] == 1);
        CHECK(g["nodes"][1]["name"] == "right");
        CHECK(g["nodes"][0]["mesh"] != g["nodes"][1]["mesh"]); // each place has its own light
        CHECK(g["animations"].size() >= 1);
        const json first = g["meshes"][g["nodes"][0]["mesh"].get<std::size_t>()],
                   second = g["meshes"][g["nodes"][1]["mesh"].get<std::size_t>()];
        CHECK(first["name"] == "shared");
        const json a = first["primitives"][0]["attributes"], b = second["primitives"][0]["attributes"];
        CHECK(a["POSITION"] == b["POSITION"]); // shared as before
        CHECK(a["_CUSTOM"] == 2);
        CHECK(a["TEXCOORD_1"] != b["TEXCOORD_1"]);
        CHECK(run(folder, {"info", "out.gltf"}).code == 0);
        const Outcome fresh = run(folder, {"bake", "two.gltf", "--size", "32", "--spp", "1", "--uv", "new", "--json", "-q"});
        REQUIRE(fresh.code == 0);
        CHECK(json::parse(fresh.out)["lightMap"]["keptParts"] == 0);
        folder.write("line.gltf", scene("AAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAA")); // squeezed onto a line: no room
        const Outcome keep = run(folder, {"bake", "line.gltf", "--uv", "keep", "-q"});
        CHECK(keep.code == 3);
        const Outcome automatic = run(folder, {"bake", "line.gltf", "--spp", "1", "--size", "32", "--json", "-q"});
        REQUIRE(automatic.code == 0);
        CHECK(json::parse(automatic.out)["lightMap"]["keptParts"] == 0);
    }

    TEST_CASE("a surface below a one-sided floor is said to leak") {
        if (absent()) return;
        const Folder folder;
        // Two equal triangles, the upper one showing its back to the lower one, which is tiny beside it.
        folder.write("leak.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0, "scale": [100, 100, 1], "translation": [-30, -30, 0.1]}, {"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]})");
        const Outcome o = run(folder, {"bake", "leak.gltf", "--size", "64", "--spp", "16", "--env", "white", "--json", "-o", "out.glb"});
        REQUIRE(o.code == 0);
        CHECK(json::parse(o.out)["leaks"] > 0);
        CHECK(contains(o.err, "meet backs"));
        CHECK(run(folder, {"bake", "leak.gltf", "--size", "64", "--spp", "2", "--env", "white", "-q", "--strict", "-o", "out.glb"}).code ==
              1);
    }
}

TEST_SUITE("bake-light") {
    TEST_CASE("a light map of @cornell shows what the path tracer shows") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"bake", "@cornell", "--size", "160", "--spp", "64", "-o", "map.glb", "--json", "-q"});
        INFO(o.err);
        REQUIRE(o.code == 0);
        const json told = json::parse(o.out);
        CHECK(told["leaks"] < 0.02 * told["sites"].get<double>()); // the gap above the lamp
        CHECK(told["lightMap"]["overlaps"] == 0);
        double bias = 0;
        const double difference = shownDifference(folder, "@cornell", "map.glb", told["exposure"], bias);
        INFO("difference " << difference << ", bias " << bias);
        CHECK(std::fabs(bias) < 0.01);
        CHECK(difference < 0.06); // texels of 9 cm at the edges of shadows, and noise
        CHECK(run(folder, {"info", "map.glb", "--strict"}).code == 0);
        const json g = gltfOf(folder / "map.glb");
        CHECK(g["extensions"]["KHR_materials_variants"]["variants"].size() == 2);
        CHECK(g["cameras"].size() == 1);
    }

    TEST_CASE("what arrives, gathered or seen: two independent ways to the same irradiance") {
        if (absent()) return;
        const Folder folder;
        REQUIRE(run(folder, {"bake", "@cornell", "--size", "96", "--spp", "128", "-o", "a.glb", "-q"}).code == 0);
        REQUIRE(run(folder, {"bake", "@cornell", "--size", "96", "--spp", "128", "--seed", "1", "--estimate", "look", "-o", "b.glb", "-q"})
                    .code == 0);
        const chiaro::Picture a = chiaro::readPicture(folder / "a.irradiance.exr"), b = chiaro::readPicture(folder / "b.irradiance.exr");
        for (const char* channel : {"R", "G", "B"}) {
            const Means m = means(a, b, channel);
            INFO(channel << " " << m.a << " " << m.b << " " << m.difference);
            CHECK(std::fabs(m.a / m.b - 1) < 0.01);
            CHECK(m.difference / m.b < 0.15);
        }
    }

    TEST_CASE("direct and indirect light add up, and depths are counted as everywhere") {
        if (absent()) return;
        const Folder folder;
        const auto bake = [&](const std::string& name, std::vector<std::string> more) {
            std::vector<std::string> words{"bake", "@cornell", "--size", "64", "--spp", "64", "-q", "-o", name + ".glb"};
            words.insert(words.end(), more.begin(), more.end());
            REQUIRE(run(folder, words).code == 0);
            return chiaro::readPicture(folder / (name + ".irradiance.exr"));
        };
        const chiaro::Picture all = bake("all", {}), direct = bake("direct", {"--light", "direct"}),
                              indirect = bake("indirect", {"--light", "indirect"}), one = bake("one", {"--max-depth", "1"}),
                              none = bake("none", {"--max-depth", "0"});
        const auto &a = plane(all, "G"), &d = plane(direct, "G"), &i = plane(indirect, "G");
        double worst = 0;
        for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::fabs(double(a[k]) - d[k] - i[k]) / (1 + double(a[k])));
        CHECK(worst < 1e-4); // the same samples
        CHECK(plane(one, "G") == d);
        CHECK(*std::max_element(plane(none, "G").begin(), plane(none, "G").end()) == 0);
        double sum = 0;
        for (const float v : plane(none, "outgoing.G")) sum += double(v);
        CHECK(sum > 0); // the lamp
    }

    TEST_CASE("the same bits for any number of threads") {
        if (absent()) return;
        const Folder folder;
        for (const char* threads : {"1", "3"})
            REQUIRE(
                run(folder, {"bake", "@cornell", "--size", "48", "--spp", "5", "-t", threads, "-q", "-o", std::string(threads) + ".glb"})
                    .code == 0);
        CHECK(readAll(folder / "1.glb") == readAll(folder / "3.glb"));
        CHECK(readAll(folder / "1.irradiance.exr") == readAll(folder / "3.irradiance.exr"));
    }

    TEST_CASE("colours of vertices, in a mesh as fine as is asked for") {
        if (absent()) return;
        const Folder folder;
        const Outcome o =
            run(folder, {"bake", "@cornell", "--to", "vertex", "--density", "4", "--spp", "64", "-o", "v.gltf", "--json", "-q"});
        INFO(o.err);
        REQUIRE(o.code == 0);
        const json told = json::parse(o.out), g = gltfOf(folder / "v.gltf");
        CHECK(told["triangles"] > 1000);
        CHECK(g["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
        CHECK(g["meshes"][0]["primitives"][0]["attributes"].contains("_IRRADIANCE"));
        double bias = 0;
        const double difference = shownDifference(folder, "@cornell", "v.gltf", told["exposure"], bias);
        INFO("difference " << difference << ", bias " << bias);
        CHECK(std::fabs(bias) < 0.02);
        CHECK(difference < 0.08);
    }

    TEST_CASE("other integrators bake what they believe; kept materials carry the light beside them") {
        if (absent()) return;
        const Folder folder;
        for (const char* name : {"whitted", "distributed", "ao"}) {
            const Outcome o = run(folder, {"bake", "@cornell", "-i", name, "--size", "48", "--spp", "8", "-o", "x.glb", "-q", "--json"});
            INFO(name << o.err);
            REQUIRE(o.code == 0);
            CHECK(json::parse(o.out)["meanIrradiance"][1] > 0);
        }
        std::vector<double> same; // methods that see all light of a diffuse room
        for (const char* name : {"path", "radiosity", "photon"}) {
            const Outcome o = run(folder, {"bake", "@cornell", "-i", name, "--size", "48", "--spp", "48", "-o", "x.glb", "-q", "--json"});
            INFO(name << o.err);
            REQUIRE(o.code == 0);
            same.push_back(json::parse(o.out)["meanIrradiance"][1]);
        }
        CHECK(std::fabs(same[1] / same[0] - 1) < 0.02);
        CHECK(std::fabs(same[2] / same[0] - 1) < 0.02);
        REQUIRE(run(folder, {"bake", "@cornell", "--mode", "keep", "--size", "48", "--spp", "2", "-o", "k.glb", "-q"}).code == 0);
        const json g = gltfOf(folder / "k.glb");
        std::size_t mapped = 0;
        for (const json& m : g["materials"]) mapped += m.contains("extensions") && m["extensions"].contains("MOZ_lightmap");
        CHECK(mapped == 4); // white, green, red, lamp
        REQUIRE(run(folder, {"bake", "@cornell", "--mode", "keep", "--to", "vertex", "--spp", "2", "-o", "k.glb", "-q"}).code == 0);
        CHECK_FALSE(gltfOf(folder / "k.glb")["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
    }
}
