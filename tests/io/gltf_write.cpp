// The writer of glTF scenes: what is described is read back, what a file says survives, light lands where it belongs.
#include "io/gltf_write.h"
#include "gltf_builder.h"
#include <doctest/doctest.h>

using namespace chiaro;
using test::Builder;
using test::json;

namespace {

json jsonOf(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!text.starts_with("glTF")) return json::parse(text);
    uint32_t size = 0;
    std::memcpy(&size, text.data() + 12, 4);
    return json::parse(text.substr(20, size));
}

SceneDesc example() {
    SceneDesc s;
    s.name = "example";
    ImageDesc image{"checks", 2, 1, 3, PixelType::u8, std::vector<std::byte>(6, std::byte(7))};
    image.pixels[0] = std::byte(200);
    s.images.push_back(image);
    s.textures.push_back({0, Wrap::clamp, Wrap::mirror, TextureFilter::nearest});
    MaterialDesc m;
    m.name = "painted";
    m.baseColor = {0.5f, 0.25f, 1};
    m.alpha = 0.75f;
    m.alphaMode = AlphaMode::blend;
    m.baseColorTexture.texture = 0;
    const float turned[2][3] = {{0, 2, 0.5f}, {-3, 0, 0.25f}}; // scale (3, 2), a quarter turn
    std::memcpy(m.baseColorTexture.transform, turned, sizeof turned);
    m.emission = {40, 20, 0};
    m.doubleSided = true;
    m.ior = 1.3f;
    m.specular = 0.5f;
    m.transmission = 0.25f;
    m.volume = true;
    m.attenuationDistance = 2;
    m.attenuationColor = {0.5f, 1, 1};
    s.materials.push_back(m);
    PrimitiveDesc p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    p.normals.assign(4, {0, 0, 1});
    p.uv[0] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    p.colors.assign(4, {1, 0.5f, 0.25f, 1});
    p.indices = {0, 1, 2, 2, 1, 3};
    p.material = 0;
    s.meshes.push_back({"sheet", {p}});
    Affine moved;
    moved.m[0][3] = 5;
    s.instances.push_back({0, Affine{}, "here"});
    s.instances.push_back({0, moved, "there"});
    CameraDesc c;
    c.name = "eye";
    c.aspect = 1.5;
    c.toWorld.m[2][3] = 9;
    s.cameras.push_back(c);
    PunctualDesc l;
    l.name = "spot";
    l.kind = PunctualKind::spot;
    l.intensity = {100, 50, 25};
    l.range = 7;
    l.innerCone = 0.25;
    l.outerCone = 0.5;
    s.lights.push_back(l);
    return s;
}

// Both triangles with light: a vertex more, and one interpolated.
BakedPart lit(uint32_t instance) {
    BakedPart part;
    part.instance = instance;
    part.look = BakedLook::lit;
    for (uint32_t v = 0; v < 4; ++v) part.vertices.push_back({{v, 0, 0}, {1, 0, 0}});
    part.vertices.push_back({{1, 2, 0}, {0.5f, 0.5f, 0}});
    part.indices = {0, 1, 4, 0, 4, 2, 2, 4, 3, 4, 1, 3};
    part.uv.assign(5, {0.25f, 0.5f});
    return part;
}

} // namespace

TEST_SUITE("gltf-write") {
    TEST_CASE("a description is read back as it was") {
        const test::Folder folder("gltf-write");
        for (const char* name : {"a.glb", "a b.gltf"}) {
            GltfDocument::describe(example()).write(folder.path / name);
            Diagnostics notes;
            const SceneDesc s = readGltf(folder.path / name, {}, notes);
            CHECK(notes.warnings().empty());
            const SceneDesc e = example();
            REQUIRE(s.instances.size() == 2);
            CHECK(s.instances[1].toWorld == e.instances[1].toWorld);
            CHECK(s.instances[1].name == "there");
            REQUIRE(s.meshes.size() == 1);
            const PrimitiveDesc &p = s.meshes[0].primitives[0], &q = e.meshes[0].primitives[0];
            CHECK(p.positions == q.positions);
            CHECK(p.normals == q.normals);
            CHECK(p.colors == q.colors);
            CHECK(p.indices == q.indices);
            const MaterialDesc &m = s.materials[0], &n = e.materials[0];
            CHECK(m.name == n.name);
            CHECK(m.baseColor == n.baseColor);
            CHECK(m.alpha == n.alpha);
            CHECK(m.alphaMode == n.alphaMode);
            CHECK(m.emission == n.emission);
            CHECK(m.doubleSided);
            CHECK(m.ior == n.ior);
            CHECK(m.specular == n.specular);
            CHECK(m.transmission == n.transmission);
            CHECK(m.volume);
            CHECK(m.attenuationDistance == n.attenuationDistance);
            for (int i = 0; i < 2; ++i)
                for (int j = 0; j < 3; ++j)
                    CHECK(m.baseColorTexture.transform[i][j] == doctest::Approx(n.baseColorTexture.transform[i][j]).epsilon(1e-6));
            CHECK(s.textures[0].wrapS == Wrap::clamp);
            CHECK(s.textures[0].filter == TextureFilter::nearest);
            CHECK(s.images[0].pixels == e.images[0].pixels);
            REQUIRE(s.cameras.size() == 1);
            CHECK(s.cameras[0].aspect == 1.5);
            CHECK(s.cameras[0].toWorld == e.cameras[0].toWorld);
            REQUIRE(s.lights.size() == 1);
            CHECK(s.lights[0].intensity == e.lights[0].intensity);
            CHECK(s.lights[0].outerCone == e.lights[0].outerCone);
        }
    }

    TEST_CASE("light is written into a copy for its place; the other place and the old material stay") {
        const test::Folder folder("gltf-write");
        GltfDocument document = GltfDocument::describe(example());
        BakedScene baked;
        baked.generator = "test";
        baked.parts.push_back(lit(1));
        const uint8_t grey[3] = {128, 128, 128};
        baked.lightMap = pngBytes(1, 1, 3, PixelType::u8, grey, "map");
        baked.notes = {{"spp", 4}};
        document.apply(baked);
        document.write(folder.path / "b.glb");
        const json g = jsonOf(folder.path / "b.glb");
        CHECK(g["asset"]["extras"]["chiaro"]["spp"] == 4);
        CHECK(g["nodes"][0]["mesh"] == 0);
        CHECK(g["nodes"][1]["mesh"] == 1);
        const json p = g["meshes"][1]["primitives"][0];
        CHECK(p["attributes"].contains("_COLOR_0"));
        CHECK_FALSE(p["attributes"].contains("COLOR_0"));
        CHECK(p["extensions"]["KHR_materials_variants"]["mappings"][1]["material"] == 0);
        const json m = g["materials"][p["material"].get<std::size_t>()];
        CHECK(m["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] == 1);
        CHECK(m["extensions"].size() == 1);
        Diagnostics notes;
        const SceneDesc s = readGltf(folder.path / "b.glb", {}, notes);
        CHECK(notes.warnings().empty());
        const PrimitiveDesc& q = s.meshes[1].primitives[0];
        REQUIRE(q.positions.size() == 5);
        CHECK(q.positions[4] == Vec3{0.5f, 0.5f, 0});
        CHECK(q.normals[4] == Vec3{0, 0, 1});
        CHECK(q.uv[1][2].x == 0.25f);
        CHECK(s.materials[std::size_t(q.material)].unlit);
    }

    TEST_CASE("what a file says survives; buffers and pictures come along, instances become nodes") {
        const test::Folder folder("gltf-write");
        Builder b;
        const int positions = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 9, 9, 9}, 3, "VEC3"); // the last one is not used
        const int indices = b.accessor<uint16_t>({0, 1, 2}, 1, "SCALAR"),
                  bytes = b.accessor<uint8_t>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 3, "VEC3", true);
        const int mesh = b.mesh({{"POSITION", positions}, {"_MARK", bytes}}, {{"indices", indices}, {"extras", {{"kept", true}}}});
        const int places = b.accessor<float>({0, 0, 0, 0, 0, -3}, 3, "VEC3");
        b.node({{"mesh", mesh},
                {"name", "forest"},
                {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
        b.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing", "VENDOR_thing"};
        b.root["extensions"]["VENDOR_thing"] = {{"secret", 42}};
        json j = b.finished();
        j["buffers"][0]["uri"] = "far%20away.bin";
        folder.write("far away.bin", b.bytes);
        const auto file = folder.write("in.gltf", j.dump());
        Diagnostics notes;
        GltfContents found;
        const SceneDesc s = readGltf(file, {}, notes, &found);
        REQUIRE(s.instances.size() == 2);
        REQUIRE(s.meshes[0].primitives[0].positions.size() == 3);
        GltfDocument document = GltfDocument::read(file, found.origin, notes);
        CHECK(document.obstacle(1, 0).empty());
        CHECK_FALSE(document.animated(1));
        BakedScene baked;
        for (uint32_t i = 0; i < 2; ++i) {
            BakedPart& part = baked.parts.emplace_back();
            part.instance = i;
            part.look = BakedLook::shining;
            for (uint32_t v = 0; v < 3; ++v) part.vertices.push_back({{v, 0, 0}, {1, 0, 0}});
            part.indices = {0, 1, 2};
            part.colors.assign(3, {float(i), 0.5f, 0, 1});
            part.irradiance.assign(3, Spectrum(7));
        }
        document.apply(baked);
        document.write(folder.path / "out.glb");
        const json g = jsonOf(folder.path / "out.glb");
        CHECK(g["extensions"]["VENDOR_thing"]["secret"] == 42);
        CHECK_FALSE(g["buffers"][0].contains("uri"));
        CHECK(g["nodes"].size() == 3);
        CHECK(g["nodes"][0]["children"].size() == 2);
        CHECK(std::find(g["extensionsUsed"].begin(), g["extensionsUsed"].end(), "EXT_mesh_gpu_instancing") == g["extensionsUsed"].end());
        const SceneDesc again = readGltf(folder.path / "out.glb", {}, notes);
        REQUIRE(again.instances.size() == 2);
        CHECK(again.instances[1].toWorld == s.instances[1].toWorld);
        CHECK(again.meshes[1].primitives[0].colors[2] == Vec4{1, 0.5f, 0, 1});
        const json& p = g["meshes"][g["nodes"][1]["mesh"].get<std::size_t>()]["primitives"][0];
        CHECK(p["extras"]["kept"] == true);
        const json& mark = g["accessors"][p["attributes"]["_MARK"].get<std::size_t>()];
        CHECK(mark["componentType"] == 5121); // as it was stored
        CHECK(mark["normalized"] == true);
        CHECK(mark["count"] == 3);
    }
}
