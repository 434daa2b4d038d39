// chiaro info of a glTF file: everything that is in it is named, with what is done with it.
#include "program.h"
#include "tests/io/gltf_builder.h"
#include <nlohmann/json.hpp>

using namespace program;
using chiaro::test::Builder;
using chiaro::test::json;

namespace {

// A triangle in a coat, beside a line, an unused material, a second scene, an unknown extension and a picture that nothing reads.
std::string file() {
    Builder b;
    const int positions = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3");
    const int uv = b.accessor<float>({0, 0, 1, 0, 0, 1}, 2, "VEC2");
    const json attributes = {{"POSITION", positions}, {"TEXCOORD_0", uv}};
    b.root["asset"]["generator"] = "a test";
    b.root["extensionsUsed"] = {"KHR_materials_clearcoat", "VENDOR_glitter", "KHR_animation_pointer"};
    b.root["materials"] = {{{"name", "lacquer"},
                            {"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                            {"normalTexture", {{"index", 0}}},
                            {"occlusionTexture", {{"index", 0}}},
                            {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}, {"VENDOR_glitter", json::object()}}}},
                           {{"name", "spare"}}};
    b.root["images"] = {
        {{"uri", "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="}},
        {{"uri", "gone.png"}}};
    b.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
    const int mesh = b.mesh(attributes, {{"material", 0}});
    b.root["meshes"][0]["primitives"].push_back({{"attributes", attributes}, {"mode", 1}});
    b.node({{"mesh", mesh}, {"name", "\xc3\xbcnder"}});
    b.root["scenes"].push_back({{"name", "other"}});
    b.root["skins"] = {{{"name", "body"}, {"joints", {0}}}};
    return b.asGlb();
}

bool holds(const nlohmann::json& lines, const std::string& part) {
    for (const auto& l : lines)
        if (l.get<std::string>().find(part) != std::string::npos) return true;
    return false;
}

} // namespace

TEST_SUITE("info") {
    TEST_CASE("what is in a file, what is used, ignored and added") {
        if (absent()) return;
        const Folder folder;
        folder.write("all.glb", file());
        const Outcome o = run(folder, {"info", "all.glb", "--json"});
        REQUIRE(o.code == 0);
        const auto info = nlohmann::json::parse(o.out);
        CHECK(info["file"]["generator"] == "a test");
        CHECK(info["file"]["version"] == "2.0");
        CHECK(info["file"]["scenes"].size() == 2);
        CHECK(info["file"]["skins"][0]["joints"] == 1);
        const auto extensionNamed = [&](const std::string& name) {
            for (const auto& e : info["file"]["extensions"])
                if (e["name"] == name) return e;
            return nlohmann::json();
        };
        CHECK(extensionNamed("KHR_materials_clearcoat")["use"] == "applied");
        CHECK(extensionNamed("KHR_materials_clearcoat")["places"] == 1);
        CHECK(extensionNamed("VENDOR_glitter")["use"] == "ignored");
        CHECK(extensionNamed("KHR_animation_pointer")["places"] == 0);
        const auto& m = info["materials"][0];
        CHECK(m["name"] == "lacquer");
        CHECK(m["lobes"] == nlohmann::json({"diffuse", "dielectric", "clearcoat"}));
        CHECK(m["textures"]["normal"] == 0);
        const auto& picture = info["textures"]["images"][0];
        CHECK(picture["format"] == "PNG");
        CHECK(picture["depth"] == "8 bit");
        CHECK(picture["channels"] == "RGBA");
        CHECK(picture["bytes"] == 4);
        CHECK(holds(info["ignored"], "1 primitive of lines"));
        CHECK(holds(info["ignored"], "1 occlusion texture"));
        CHECK(holds(info["ignored"], "1 material that nothing shown wears"));
        CHECK(holds(info["ignored"], "1 picture that no material shown reads"));
        CHECK(holds(info["ignored"], "extension VENDOR_glitter"));
        CHECK(holds(info["added"], "1 primitive got tangents"));
        CHECK(holds(info["added"], "1 primitive without normals"));
        CHECK(holds(info["added"], "no camera in the scene"));
        CHECK(holds(info["added"], "no light in the scene"));
    }

    TEST_CASE("the same as text, its columns in line whatever the names are written in") {
        if (absent()) return;
        const Folder folder;
        folder.write("all.glb", file());
        const std::string text = run(folder, {"info", "all.glb"}).out;
        CHECK(contains(text, "glTF 2.0, written by a test"));
        CHECK(contains(text, "KHR_materials_clearcoat  applied"));
        CHECK(contains(text, "VENDOR_glitter           ignored"));
        CHECK(contains(text, "announced only"));
        CHECK(contains(text, "\"lacquer\"  dielectric  diffuse + dielectric + clearcoat  1 texture"));
        CHECK(contains(text, "1 x 1  RGBA  8 bit  PNG"));
        CHECK(contains(text, "\nignored      1 primitive of lines"));
    }

    TEST_CASE("built-in scenes have no file") {
        if (absent()) return;
        const Folder folder;
        const auto info = nlohmann::json::parse(run(folder, {"info", "@cornell", "--json"}).out);
        CHECK_FALSE(info.contains("file"));
        CHECK(info["ignored"].empty());
        CHECK(info["materials"].size() > 1);
    }
}
