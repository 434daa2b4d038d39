// The writer of lines and points: the container byte for byte as glTF 2.0 section 4.4 wants it, and read back by our own reader.
#include "io/glb_write.h"
#include "gltf_builder.h"
#include "io/gltf.h"
#include <doctest/doctest.h>
#include <limits>

using namespace chiaro;
using test::json;

namespace {

uint32_t u32At(const std::vector<std::byte>& bytes, std::size_t at) {
    uint32_t v = 0;
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
}

struct Parsed {
    json root;
    std::vector<std::byte> binary;
};
Parsed parsed(const std::vector<std::byte>& bytes) {
    REQUIRE(bytes.size() % 4 == 0);
    CHECK(std::memcmp(bytes.data(), "glTF", 4) == 0);
    CHECK(u32At(bytes, 4) == 2);
    CHECK(u32At(bytes, 8) == bytes.size());
    const uint32_t size = u32At(bytes, 12);
    CHECK(u32At(bytes, 16) == 0x4E4F534A);
    CHECK(size % 4 == 0);
    const auto* text = reinterpret_cast<const char*>(bytes.data()) + 20;
    Parsed p{json::parse(text, text + size), {}};
    if (bytes.size() > 20 + size) {
        CHECK(u32At(bytes, 20 + size) == bytes.size() - 28 - size);
        CHECK(u32At(bytes, 24 + size) == 0x004E4942);
        p.binary.assign(bytes.begin() + 28 + size, bytes.end());
    }
    return p;
}
Vec3 vectorAt(const Parsed& p, std::size_t accessor, std::size_t i) {
    const json& a = p.root["accessors"][accessor];
    const json& view = p.root["bufferViews"][a["bufferView"].get<std::size_t>()];
    float v[3] = {};
    std::memcpy(v, p.binary.data() + view["byteOffset"].get<std::size_t>() + 12 * i, 12);
    return {v[0], v[1], v[2]};
}

const Spectrum red(1, 0, 0), blue(0, 0, 1);

GlbScene example() {
    GlbScene s{"rays", "test", {}};
    s.nodes.push_back({"root", -1, {1e6, 0, -2}, {}, {{"seed", "7"}}});
    s.nodes.push_back({"lines", 0, {}, {{GlbMode::lines, {{0, 1, 2}, {3, -4, 5}}, {red, blue}}}, {}});
    s.nodes.push_back({"mixed",
                       0,
                       {},
                       {{GlbMode::points, {{1, 1, 1}}, {red}}, {GlbMode::lineStrip, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {red, red, blue}}},
                       {}});
    s.nodes.push_back({"empty", 2, {}, {{GlbMode::lines, {}, {}}}, {}});
    return s;
}

} // namespace

TEST_SUITE("glb writer") {

    TEST_CASE("container, nodes and accessors") {
        const Parsed p = parsed(glbBytes(example()));
        CHECK(p.root["asset"]["version"] == "2.0");
        CHECK(p.root["extensionsUsed"] == json::array({"KHR_materials_unlit"}));
        CHECK(p.root["scenes"][0]["nodes"] == json::array({0}));
        CHECK(p.root["nodes"][0]["children"] == json::array({1, 2}));
        CHECK(p.root["nodes"][0]["translation"] == json::array({1e6, 0.0, -2.0}));
        CHECK(p.root["nodes"][0]["extras"]["seed"] == "7");
        CHECK(p.root["nodes"][2]["children"] == json::array({3}));
        CHECK(!p.root["nodes"][3].contains("mesh"));
        CHECK(p.root["buffers"][0]["byteLength"] == p.binary.size());
        const json& line = p.root["meshes"][0]["primitives"][0];
        CHECK(line["mode"] == 1);
        CHECK(p.root["materials"][line["material"].get<std::size_t>()]["extensions"].contains("KHR_materials_unlit"));
        const std::size_t position = line["attributes"]["POSITION"], color = line["attributes"]["COLOR_0"];
        CHECK(vectorAt(p, position, 0) == Vec3{0, 1, 2});
        CHECK(vectorAt(p, position, 1) == Vec3{3, -4, 5});
        CHECK(vectorAt(p, color, 1) == Vec3{0, 0, 1});
        CHECK(p.root["accessors"][position]["min"] == json::array({0, -4, 2}));
        CHECK(p.root["accessors"][position]["max"] == json::array({3, 1, 5}));
        CHECK(p.root["meshes"][1]["primitives"][0]["mode"] == 0);
        CHECK(p.root["meshes"][1]["primitives"][1]["mode"] == 3);
        for (const json& a : p.root["accessors"]) {
            const json& view = p.root["bufferViews"][a["bufferView"].get<std::size_t>()];
            CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
            CHECK(view["byteLength"] == 12 * a["count"].get<std::size_t>());
            CHECK(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>() <= p.binary.size());
        }
    }

    TEST_CASE("our own reader takes it, and says that lines are not drawn") {
        const test::Folder folder("glb-write");
        const test::fs::path file = folder.path / "rays.glb";
        writeGlb(file, example());
        Diagnostics notes;
        const SceneDesc scene = readGltf(file, {}, notes);
        CHECK(scene.meshes.size() == 2);
        CHECK(scene.instances.empty()); // nothing to draw
        for (const MeshDesc& m : scene.meshes) CHECK(m.primitives.empty());
        CHECK(notes.warnings().size() == 2); // a mesh each
        for (const std::string& w : notes.warnings()) CHECK(w.find("points or lines") != std::string::npos);
    }

    TEST_CASE("nothing to draw is a file too, equal scenes equal bytes") {
        CHECK(parsed(glbBytes({"nothing", "test", {}})).binary.empty());
        const Parsed p = parsed(glbBytes({"nodes", "test", {{"a", -1, {}, {}, {}}}}));
        CHECK(!p.root.contains("meshes"));
        CHECK(!p.root.contains("extensionsUsed"));
        CHECK(glbBytes(example()) == glbBytes(example()));
    }

    TEST_CASE("names may hold anything") {
        const std::string hostile("\"}]\\ \n\x01 \xff\xfe \0 end", 16);
        const Parsed p =
            parsed(glbBytes({hostile, hostile, {{hostile, -1, {}, {{GlbMode::points, {{0, 0, 0}}, {red}}}, {{hostile, hostile}}}}}));
        CHECK(p.root["nodes"][0]["name"].get<std::string>().starts_with("\"}]\\ \n\x01 "));
        CHECK(p.root["nodes"].size() == 1);
    }

    TEST_CASE("what is no shape is refused") {
        const auto one = [](GlbShape shape) { return glbBytes({"", "", {{"n", -1, {}, {std::move(shape)}, {}}}}); };
        CHECK_THROWS_AS(one({GlbMode::lines, {{0, 0, 0}}, {red}}), Error);
        CHECK_THROWS_AS(one({GlbMode::lineStrip, {{0, 0, 0}}, {red}}), Error);
        CHECK_THROWS_AS(one({GlbMode::points, {{0, 0, 0}}, {}}), Error);
        CHECK_THROWS_AS(one({GlbMode::points, {{std::numeric_limits<float>::infinity(), 0, 0}}, {red}}), Error);
        CHECK_THROWS_AS(glbBytes({"", "", {{"n", 1, {}, {}, {}}}}), Error);
    }

    TEST_CASE("a place that cannot be written") {
        const test::Folder folder("glb-nowhere");
        CHECK_THROWS_AS(writeGlb(folder.path / "no" / "such.glb", example()), Error);
    }
}
