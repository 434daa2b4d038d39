// Malformed and hostile files, all made here: each gives one clear line with the file, the place and the fix; none crashes or hangs.
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>
#include <functional>
#include <sys/stat.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

void checkFailure(const fs::path& file, Exit code, const std::vector<std::string>& parts, const GltfOptions& options = {}) {
    const Failure f = failure(file, options);
    CAPTURE(f.message);
    CHECK(f.code == code);
    CHECK(f.message.starts_with(file.string()));
    CHECK(f.message.size() < 600);
    for (const char c : f.message) CHECK(static_cast<unsigned char>(c) >= 0x20);
    for (const std::string& part : parts) CHECK(f.message.find(part) != std::string::npos);
}

// The same scene with one change, as .glb.
void checkChanged(const std::function<void(Builder&)>& change, const std::vector<std::string>& parts, Exit code = Exit::file) {
    const Folder folder("hostile");
    Builder b = Builder::triangle();
    change(b);
    checkFailure(folder.write("bad.glb", b.asGlb()), code, parts);
}

void checkText(const std::string& name, const std::string& content, const std::vector<std::string>& parts, Exit code = Exit::file) {
    const Folder folder("hostile");
    checkFailure(folder.write(name, content), code, parts);
}
json& accessor(Builder& b) { return b.root["accessors"][0]; }
json& primitive(Builder& b) { return b.root["meshes"][0]["primitives"][0]; }
json& node(Builder& b) { return b.root["nodes"][0]; }

} // namespace

TEST_SUITE("hostile_container") {
    TEST_CASE("absent, with the nearest name; a folder; empty; no file at all") {
        const Folder folder("absent");
        folder.write("scene_v2.glb", "");
        checkFailure(folder.path / "scene.glb", Exit::file, {"scene.glb: no such file; similar here: scene_v2.glb"});
        checkFailure(folder.path, Exit::file, {"is a folder"});
        checkFailure(folder.path / "scene_v2.glb", Exit::file, {"is empty"});
        checkFailure(folder.path / "no/such/place.glb", Exit::file, {"no such file"});
        mkfifo((folder.path / "pipe.glb").c_str(), 0600);
        checkFailure(folder.path / "pipe.glb", Exit::file, {"not a regular file"});
    }

    TEST_CASE("truncated .glb, at every byte") {
        const Folder folder("truncated");
        const std::string whole = Builder::triangle().asGlb();
        for (size_t n = 1; n < whole.size(); ++n) checkFailure(folder.write("a.glb", whole.substr(0, n)), Exit::file, {});
        checkFailure(folder.write("a.glb", whole.substr(0, whole.size() - 20)), Exit::file,
                     {"a.glb: chunk 1 says 36 bytes, file ends after " + std::to_string(whole.size() - 20) +
                      ". The file is truncated; download or export it again."});
    }

    TEST_CASE("headers that lie") {
        const std::string whole = Builder::triangle().asGlb();
        const auto patched = [&](size_t at, uint32_t value) { return std::string(whole).replace(at, 4, u32(value)); };
        checkText("a.glb", patched(4, 1), {"glTF binary version 1"}, Exit::unsupported);
        checkText("a.glb", patched(8, 0xffffffff), {"header says 4294967295 bytes"});
        checkText("a.glb", patched(8, 0), {"no JSON chunk"});
        checkText("a.glb", patched(12, 0xfffffff0), {"chunk 0 says 4294967280 bytes"});
        checkText("a.glb", patched(16, 0x004E4942), {"chunk 0 has type", "not JSON"});
        checkText("a.glb", patched(12, 0), {});
    }

    TEST_CASE("JSON that is none, or is deep") {
        checkText("a.gltf", "{\"asset\": {\"version\": \"2.0\"", {"is not valid JSON"});
        checkText("a.gltf", "{\"asset\":\x01\n\xff}", {"is not valid JSON"});
        checkText("a.gltf", "[1, 2]", {"not a glTF object"});
        checkText("a.gltf", "PK\x03\x04 a zip", {"is not valid JSON"});
        checkText("a.gltf", std::string(200000, '['), {"nested more than 100 deep at byte 100"});
        checkText("a.gltf", std::string("{\"extras\":") + std::string(200000, '[') + std::string(200000, ']') + "}",
                  {"nested more than 100 deep"});
        checkText("a.glb", Builder::glb(std::string(200000, '['), ""), {"nested more than 100 deep"});
        std::string objects;
        for (int i = 0; i < 200000; ++i) objects += "{\"a\":";
        checkText("a.gltf", objects, {"nested more than 100 deep"});
        checkText("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"scale\":[1e999,1,1]}]}",
                  {"is not valid JSON", "number overflow"});
        checkText("a.gltf", "{}", {"a.gltf: has no \"asset\""});
        CHECK(failure(Folder("brackets")
                          .write("a.gltf", "{\"asset\":{\"version\":\"2.0\",\"generator\":\"" + std::string(500, '[') + "\\\"[\"}}"))
                  .code == Exit::done);
    }

    TEST_CASE("versions and required extensions") {
        checkChanged([](Builder& b) { b.root["asset"]["version"] = "1.0"; }, {"is glTF \"1.0\", this build reads 2.0"}, Exit::unsupported);
        checkChanged([](Builder& b) { b.root["asset"]["minVersion"] = "2.1"; }, {"is glTF \"2.1\""}, Exit::unsupported);
        checkChanged([](Builder& b) { b.root["asset"]["minVersion"] = 7; }, {"/asset/minVersion must be a string"});
        checkChanged([](Builder& b) { b.root["asset"].erase("version"); }, {"/asset has no \"version\""});
        const Folder folder("required");
        Builder b = Builder::triangle();
        b.root["extensionsRequired"] = {"KHR_texture_basisu"};
        const fs::path city = folder.write("city.glb", b.asGlb());
        const Failure f = failure(city);
        CHECK(f.code == Exit::unsupported);
        CHECK(f.message == city.string() + " needs KHR_texture_basisu, which this build cannot read. Try: gltf-transform ktxdecompress " +
                               city.string() + " out.glb");
        checkChanged([](Builder& c) { c.root["extensionsRequired"] = {"EVIL_\n\x1b[31m"}; }, {"needs EVIL_??[31m"}, Exit::unsupported);
    }
}

TEST_SUITE("hostile_references") {
    TEST_CASE("every reference out of range names its place") {
        const auto range = [](const char* place, const char* target, const std::function<void(Builder&)>& change) {
            checkChanged(change, {std::string(": ") + place + " is ", std::string("but ") + target + " has "});
        };
        range("/scene", "/scenes", [](Builder& b) { b.root["scene"] = 1; });
        range("/scenes/0/nodes/0", "/nodes", [](Builder& b) { b.root["scenes"][0]["nodes"] = {99}; });
        range("/nodes/0/children/0", "/nodes", [](Builder& b) { node(b)["children"] = {-1}; });
        range("/nodes/0/mesh", "/meshes", [](Builder& b) { node(b)["mesh"] = 4000000000u; });
        range("/nodes/0/camera", "/cameras", [](Builder& b) { node(b)["camera"] = 0; });
        range("/nodes/0/skin", "/skins", [](Builder& b) { node(b)["skin"] = 0; });
        range("/nodes/0/extensions/KHR_lights_punctual/light", "/extensions/KHR_lights_punctual/lights",
              [](Builder& b) { node(b)["extensions"]["KHR_lights_punctual"]["light"] = 0; });
        range("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/SCALE", "/accessors",
              [](Builder& b) { node(b)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = 7; });
        range("/meshes/0/primitives/0/attributes/POSITION", "/accessors",
              [](Builder& b) { primitive(b)["attributes"]["POSITION"] = 1e300; });
        range("/meshes/0/primitives/0/indices", "/accessors", [](Builder& b) { primitive(b)["indices"] = 1.5; });
        range("/meshes/0/primitives/0/material", "/materials", [](Builder& b) { primitive(b)["material"] = 0; });
        range("/meshes/0/primitives/0/targets/0/POSITION", "/accessors", [](Builder& b) { primitive(b)["targets"] = {{{"POSITION", 9}}}; });
        range("/accessors/0/bufferView", "/bufferViews", [](Builder& b) { accessor(b)["bufferView"] = 3; });
        range("/bufferViews/0/buffer", "/buffers", [](Builder& b) { b.root["bufferViews"][0]["buffer"] = 3; });
        range("/textures/0/source", "/images", [](Builder& b) { b.root["textures"] = {{{"source", 0}}}; });
        range("/textures/0/sampler", "/samplers", [](Builder& b) { b.root["textures"] = {{{"sampler", 0}}}; });
        range("/images/0/bufferView", "/bufferViews", [](Builder& b) { b.root["images"] = {{{"bufferView", 8}}}; });
        range("/materials/0/extensions/VENDOR_x/someTexture/index", "/textures", [](Builder& b) {
            b.root["materials"] = {{{"extensions", {{"VENDOR_x", {{"someTexture", {{"index", 5}}}}}}}}};
        });
        range("/skins/0/joints/0", "/nodes", [](Builder& b) { b.root["skins"] = {{{"joints", {77}}}}; });
    }

    TEST_CASE("members of the wrong type") {
        checkChanged([](Builder& b) { node(b)["mesh"] = "first"; }, {"/nodes/0/mesh must be an index, not \"\"first\"\""});
        checkChanged([](Builder& b) { node(b)["matrix"] = {1, 2}; }, {"/nodes/0/matrix must be a list of 16 numbers, not a list of 2"});
        checkChanged([](Builder& b) { node(b)["scale"] = {1, "2", 3}; }, {"/nodes/0/scale/1 must be a number"});
        checkChanged([](Builder& b) { node(b)["translation"] = {1e300, 0, 0}; }, {"/nodes/0/translation/0", "32-bit float"});
        checkChanged([](Builder& b) { b.root["nodes"] = 3; }, {"/nodes must be a list, not \"3\""});
        checkChanged([](Builder& b) { b.root["nodes"] = {nullptr}; }, {"/nodes/0 must be an object"});
        checkChanged([](Builder& b) { b.root["meshes"][0].erase("primitives"); }, {"/meshes/0 has no \"primitives\""});
        checkChanged([](Builder& b) { node(b)["extensions"] = {1, 2}; }, {"/nodes/0/extensions must be an object"});
        checkChanged([](Builder& b) { b.root["buffers"] = {{{"byteLength", "36"}}}; }, {"/buffers/0/byteLength must be a whole number"});
        checkChanged([](Builder& b) { b.root["materials"] = {{{"alphaMode", 1}}}; }, {"/materials/0/alphaMode must be a string"});
        checkChanged([](Builder& b) { b.root["materials"] = {{{"normalTexture", 0}}}; }, {"/materials/0/normalTexture must be an object"});
    }

    TEST_CASE("node graphs: cycles, two parents, depth, roots") {
        checkChanged([](Builder& b) { node(b)["children"] = {0}; }, {"/nodes/0 is its own ancestor"});
        checkChanged(
            [](Builder& b) {
                b.add("nodes", {{"children", {2}}});
                b.add("nodes", {{"children", {1}}});
            },
            {"/nodes/1 is its own ancestor"});
        checkChanged(
            [](Builder& b) {
                b.add("nodes", {{"children", {0}}});
                b.add("nodes", {{"children", {0}}});
            },
            {"/nodes/2/children names node 0, which node 1 has already"});
        checkChanged([](Builder& b) { b.root["scenes"][0]["nodes"] = {0, 0}; }, {"/scenes/0/nodes names node 0, which is there twice"});
        checkChanged([](Builder& b) { b.add("nodes", {{"children", {0}}}); }, {"/scenes/0/nodes names node 0, which is a child"});
        checkChanged(
            [](Builder& b) {
                for (int i = 1; i < 50000; ++i) b.add("nodes", {{"children", {i + 1}}});
                b.add("nodes", json::object());
            },
            {"lies more than 1000 nodes deep"});
    }

    TEST_CASE("cameras without a lens") {
        const auto camera = [](json entry, const char* part) {
            checkChanged(
                [&](Builder& b) {
                    node(b)["camera"] = 0;
                    b.root["cameras"] = {entry};
                },
                {"/cameras/0", part});
        };
        camera({{"type", "fisheye"}}, "/type \"fisheye\" is neither");
        camera({{"type", "perspective"}}, "has no \"perspective\"");
        camera({{"type", "perspective"}, {"perspective", {{"yfov", 4}}}}, "/perspective/yfov is 4, must lie between");
        camera({{"type", "orthographic"}, {"orthographic", {{"xmag", 0}, {"ymag", 1}}}}, "has an extent of zero");
    }

    TEST_CASE("transforms that are none") {
        checkChanged([](Builder& b) { node(b)["rotation"] = {0, 0, 0, 0}; }, {"/nodes/0/rotation is no quaternion"});
        checkChanged([](Builder& b) { node(b)["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
                     {"/nodes/0/matrix is not affine"});
        checkChanged(
            [](Builder& b) {
                const int t = b.accessor<float>({0, NAN, 0}, 3, "VEC3");
                node(b)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = t;
            },
            {"/nodes/0 places its mesh beyond 1e18 m"});
        checkChanged(
            [](Builder& b) {
                const int t = b.accessor<float>({0, 0, 0}, 3, "VEC3"), s = b.accessor<float>({1, 1, 1, 1, 1, 1}, 3, "VEC3");
                node(b)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", t}, {"SCALE", s}};
            },
            {"attributes/SCALE has 2 elements, the others have 1"});
    }
}

TEST_SUITE("hostile_bytes") {
    TEST_CASE("accessors and views that reach beyond their bytes") {
        checkChanged([](Builder& b) { accessor(b)["count"] = 4; },
                     {"/accessors/0 reads 4 elements up to byte 48, its bufferView 0 has 36"});
        checkChanged([](Builder& b) { accessor(b)["count"] = 2147483647; }, {"/accessors/0 reads 2147483647 elements"});
        checkChanged([](Builder& b) { accessor(b)["count"] = 1ull << 63; }, {"/accessors/0/count is"});
        checkChanged([](Builder& b) { accessor(b)["count"] = 0; }, {"/accessors/0/count is 0, must be"});
        checkChanged([](Builder& b) { accessor(b)["count"] = -3; }, {"/accessors/0/count is -3"});
        checkChanged([](Builder& b) { accessor(b)["byteOffset"] = 4; }, {"/accessors/0 reads 3 elements up to byte 40"});
        checkChanged([](Builder& b) { accessor(b)["byteOffset"] = 9007199254740992ull; }, {"/accessors/0 reads 3 elements"});
        checkChanged([](Builder& b) { accessor(b)["byteOffset"] = 18446744073709551615ull; }, {"/accessors/0/byteOffset is"});
        checkChanged([](Builder& b) { accessor(b)["componentType"] = 5124; }, {"/accessors/0/componentType 5124 is none of"});
        checkChanged([](Builder& b) { accessor(b)["type"] = "VEC5"; }, {"/accessors/0/type \"VEC5\" is unknown"});
        checkChanged([](Builder& b) { b.root["bufferViews"][0]["byteStride"] = 4; },
                     {"/bufferViews/0/byteStride is 4, elements of accessor /accessors/0 have 12"});
        checkChanged([](Builder& b) { b.root["bufferViews"][0]["byteStride"] = 253; }, {"/bufferViews/0/byteStride is 253, must be"});
        checkChanged([](Builder& b) { b.root["bufferViews"][0]["byteLength"] = 9007199254740992ull; },
                     {"/bufferViews/0 ends at byte 9007199254740992"});
        checkChanged([](Builder& b) { b.root["bufferViews"][0]["byteOffset"] = 36; },
                     {"/bufferViews/0 ends at byte 72, its buffer 0 has 36"});
        checkChanged(
            [](Builder& b) {
                b.root["buffers"] = {{{"byteLength", 1000000}}};
            },
            {"/buffers/0/byteLength says 1000000 bytes, its data has 36"});
        checkChanged([](Builder& b) { b.root["buffers"] = {{{"byteLength", 36}}, {{"byteLength", 36}}}; }, {"/buffers/1 has no \"uri\""});
    }

    TEST_CASE("sparse accessors that lie") {
        const auto sparse = [](Builder& b, size_t count, uint8_t index) {
            const int at = b.view(std::string(4, char(index))), values = b.view(std::string(48, '\0'));
            accessor(b)["sparse"] = {
                {"count", count}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}};
        };
        checkChanged([&](Builder& b) { sparse(b, 1, 200); }, {"/accessors/0/sparse/indices names element 200 of 3"});
        checkChanged([&](Builder& b) { sparse(b, 4, 0); }, {"/accessors/0/sparse/count is 4, the accessor has 3"});
        checkChanged(
            [&](Builder& b) {
                sparse(b, 3, 0);
                accessor(b)["sparse"]["indices"]["byteOffset"] = 2;
            },
            {"/accessors/0/sparse/indices reads 3 elements"});
        checkChanged(
            [&](Builder& b) {
                sparse(b, 3, 0);
                accessor(b)["sparse"]["indices"]["componentType"] = 5122;
            },
            {"/accessors/0/sparse/indices/componentType"});
    }

    TEST_CASE("meshes: indices out of range, NaN, unequal counts, wrong types") {
        checkChanged(
            [](Builder& b) {
                primitive(b)["indices"] = b.accessor<uint8_t>({0, 1, 3}, 1, "SCALAR");
            },
            {"/meshes/0/primitives/0/indices element 2 names vertex 3 of 3"});
        checkChanged(
            [](Builder& b) {
                primitive(b)["indices"] = b.accessor<uint32_t>({0, 1, 0xffffffff}, 1, "SCALAR");
            },
            {"/indices element 2 is 4294967295"});
        checkChanged([](Builder& b) { primitive(b)["indices"] = 0; }, {"/meshes/0/primitives/0/indices has type VEC3 of component 5126"});
        for (const float bad : {NAN, INFINITY, -INFINITY, 3e38f})
            checkChanged(
                [&](Builder& b) {
                    primitive(b)["attributes"]["POSITION"] = b.accessor<float>({0, 0, 0, 1, bad, 0, 0, 1, 0}, 3, "VEC3");
                },
                {"/meshes/0/primitives/0/attributes/POSITION vertex 1 is"});
        checkChanged(
            [](Builder& b) {
                primitive(b)["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1}, 3, "VEC3");
            },
            {"attributes/NORMAL has 1 elements, POSITION has 3"});
        checkChanged([](Builder& b) { primitive(b)["attributes"]["TEXCOORD_0"] = 0; },
                     {"attributes/TEXCOORD_0 has type VEC3, must be VEC2"});
        checkChanged([](Builder& b) { primitive(b)["mode"] = 7; }, {"/meshes/0/primitives/0/mode is 7"});
    }

    TEST_CASE("a small file that means gigabytes is refused before it is unfolded") {
        checkChanged(
            [](Builder& b) {
                accessor(b).erase("bufferView");
                accessor(b)["count"] = 2147483647;
            },
            {"has 2147483647 vertices without a byte behind them"});
        checkChanged(
            [](Builder& b) {
                accessor(b).erase("bufferView");
                accessor(b)["count"] = 1000000;
                json many = json::array();
                for (int i = 0; i < 100; ++i) many.push_back(primitive(b));
                b.root["meshes"][0]["primitives"] = many;
            },
            {"brings the meshes to", "Split the scene"});
        checkChanged(
            [](Builder& b) {
                json huge = accessor(b);
                huge.erase("bufferView");
                huge["count"] = 2000000000;
                node(b)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = b.add("accessors", huge);
            },
            {"brings the scene above 10000000 instances"});
    }

    TEST_CASE("paths that leave the scene's folder, and buffers that are not there") {
        for (const std::string uri : {"../secret.bin", "a/../../secret.bin", "/etc/hostname", "file:///etc/hostname", "%2e%2e/secret.bin",
                                      "..\\secret.bin", "http://example.com/a.bin", "..%2Fsecret.bin"}) {
            const Folder folder("outside");
            folder.write("secret.bin", std::string(36, 'x'));
            json j = Builder::triangle().finished();
            j["buffers"][0]["uri"] = uri;
            const fs::path file = folder.write("in/scene.gltf", j.dump());
            checkFailure(file, Exit::file,
                         {"/buffers/0/uri", uri.find(':') == uri.npos ? "leaves the scene's folder" : "is no relative path"});
            Builder b = Builder::triangle({{"material", 0}});
            b.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
            b.root["textures"] = {{{"source", 0}}};
            b.root["images"] = {{{"uri", uri}}};
            checkFailure(folder.write("in/textured.glb", b.asGlb()), Exit::file, {"/images/0/uri"}, {MissingTexture::grey});
        }
        const auto buffer = [](const std::string& uri, const std::string& part) {
            json j = Builder::triangle().finished();
            j["buffers"][0]["uri"] = uri;
            checkText("a.gltf", j.dump(), {"/buffers/0", part});
        };
        buffer("gone.bin", "/uri \"gone.bin\" not found. Put it beside the scene");
        buffer("", "not found");
        buffer("data:;base64,####", "malformed data: URI");
        buffer("data:;base64", "malformed data: URI");
        buffer("data:;base64,AAAA", "says 36 bytes, its data has 3");
        buffer(".", "not found");
        buffer(std::string("a\0b", 3), "not found");
    }

    TEST_CASE("embedded pictures that are none, or claim to be enormous") {
        const auto image = [](const std::string& bytes, const std::string& part) {
            checkChanged(
                [&](Builder& b) {
                    primitive(b)["material"] = 0;
                    b.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
                    b.root["textures"] = {{{"source", 0}}};
                    b.root["images"] = {{{"bufferView", b.view(bytes)}}};
                },
                {"/images/0/bufferView", part, "--missing-texture grey"});
        };
        image("not a picture", "no known picture format");
        image(std::string("\x89PNG\r\n\x1a\n", 8), "truncated");
        const std::string end = std::string(4, '\0') + "IEND\xae\x42\x60\x82";
        image(std::string("\x89PNG\r\n\x1a\n", 8) + end, "cannot be decoded");
        image(std::string("\xabKTX 20\xbb\r\n\x1a\n", 12), "KTX2");
        image("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n", "cannot be decoded");
        image("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n", "the limit is");
        image("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9000 +X 9000\n", "9000 x 9000 pixels, more than its");
        image("BM" + std::string(60, '\xff'), "cannot be decoded");
        image("RIFF" + u32(100) + "WEBPVP8 " + std::string(40, '\1'), "cannot be decoded");
        image("\xff\xd8\xff\xe0 broken", "cannot be decoded");
        image("\x76\x2f\x31\x01" + std::string(40, '\2'), "cannot be decoded");
        image(std::string("II*\0\x08\0\0\0\xff\xff", 10) + std::string(40, '\3'), "cannot be decoded");
    }
}

TEST_SUITE("hostile_noise") {
    // Whatever happens to single bytes of a good file: it reads, or it fails with an Error.
    TEST_CASE("thousands of damaged files") {
        const Folder folder("noise");
        Builder b = Builder::triangle();
        primitive(b)["indices"] = b.accessor<uint8_t>({0, 1, 2}, 1, "SCALAR");
        primitive(b)["attributes"]["NORMAL"] = 0;
        node(b)["children"] = {1};
        b.add("nodes", {{"camera", 0}, {"rotation", {0, 0, 0, 1}}});
        b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
        const std::string whole = b.asGlb();
        uint64_t state = 1;
        const auto random = [&] { return state = state * 6364136223846793005ull + 1442695040888963407ull, size_t(state >> 33); };
        size_t failed = 0;
        for (int round = 0; round < 1500; ++round) {
            std::string bad = whole;
            for (size_t i = 0; i <= random() % 3; ++i) {
                const size_t at = random() % bad.size();
                bad[at] = round % 2 ? char(random()) : "0123456789-[]{},\"e."[random() % 19];
            }
            const Failure f = failure(folder.write("noise.glb", bad));
            failed += f.code != Exit::done;
            CHECK((f.code == Exit::done || f.code == Exit::file || f.code == Exit::unsupported));
            CHECK(f.message.find('\n') == std::string::npos);
        }
        CHECK(failed > 500);
    }
}
