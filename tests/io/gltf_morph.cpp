// Morph targets: positions in closed form at three times and over the shutter, what changes along, and files that lie.
#include "tests/io/gltf_deforming.h"
#include <cmath>
#include <functional>

using namespace chiaro;
using namespace chiaro::test;

namespace {

void checkUv(const PrimitiveDesc& p, const std::vector<Point2>& expected) {
    REQUIRE(p.uv[0].size() == expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        CAPTURE(i);
        CHECK(p.uv[0][i].x == expected[i].x);
        CHECK(p.uv[0][i].y == expected[i].y);
    }
}

} // namespace

TEST_SUITE("gltf_morph") {
    TEST_CASE("weights of the mesh, of the node, of an animation at three times; none: the mesh itself, shared") {
        const Folder folder("weights");
        Deforming b;
        b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
        b.target({0, 0, 0, 2, 0, 0, 2, 0, 0, 0, 0, 0});
        const int mesh = b.square();
        b.node({{"mesh", mesh}});
        b.node({{"mesh", mesh}, {"weights", {0.25, 0}}});
        const int moving = b.node({{"mesh", mesh}, {"weights", {9, 9}}, {"translation", {0, 0, 10}}});
        b.node({{"mesh", mesh}});
        b.animate(moving, "weights", {1, 3}, {0, 0.5f, 1, 0});
        for (const auto& [time, share] : {std::pair{0., 0.}, {1.5, .25}, {2., .5}, {7., 1.}}) {
            CAPTURE(time);
            const SceneDesc s = b.at(folder, time);
            checkNear(corner(s, 1), {1, 0, 0});
            checkNear(corner(s, 1, 1), {1, 0, 0.25});
            checkNear(corner(s, 1, 2), {1 + 2 * 0.5 * (1 - share), 0, 10 + share});
            checkNear(corner(s, 0, 2), {0, 0, 10 + share});
            CHECK(s.instances[0].mesh == s.instances[3].mesh);
            CHECK(shown(s, 2).steps.empty());
        }
        b.root["meshes"][0]["weights"] = {1, 0};
        checkNear(corner(b.at(folder, 0), 1), {1, 0, 1});
        checkNear(corner(b.at(folder, 0), 1, 1), {1, 0, 0.25});
    }

    TEST_CASE("STEP, CUBICSPLINE, integers and sparse targets with and without a base") {
        const Folder folder("kinds");
        const auto at = [&](const char* how, const Numbers& values, double time) {
            Deforming b;
            b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
            b.animate(b.node({{"mesh", b.square()}}), "weights", {0, 2}, values, how);
            return corner(b.at(folder, time), 2).z;
        };
        CHECK(at("STEP", {0.5f, 1}, 1.9) == doctest::Approx(0.5));
        CHECK(at("LINEAR", {0.5f, 1}, 1.5) == doctest::Approx(0.875));
        // In-tangent, value, out-tangent at two keys 2 s apart, half way: (0 + 1) / 2 + 2 (1 - 3) / 8
        CHECK(at("CUBICSPLINE", {7, 0, 1, 3, 1, 7}, 1) == doctest::Approx(0.5 + 2 * (1. - 3.) / 8));
        for (const bool based : {true, false}) {
            Deforming b;
            b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
            json& a = b.root["accessors"].back();
            const uint8_t where[] = {1, 3};
            const float values[] = {0, 0, 5, 0, 6, 0};
            if (!based) a.erase("bufferView");
            a["sparse"] = {{"count", 2},
                           {"indices", {{"bufferView", b.view({reinterpret_cast<const char*>(where), 2})}, {"componentType", 5121}}},
                           {"values", {{"bufferView", b.view({reinterpret_cast<const char*>(values), sizeof values})}}}};
            b.node({{"mesh", b.square()}, {"weights", {1}}});
            const SceneDesc s = b.at(folder, 0);
            checkNear(corner(s, 0), {0, 0, based ? 1. : 0.});
            checkNear(corner(s, 1), {1, 0, 5});
            checkNear(corner(s, 3), {0, 7, 0});
        }
        Deforming b; // KHR_mesh_quantization
        b.more["targets"] = {{{"POSITION", b.accessor<int8_t>({0, 0, 127, 0, 0, 127, 0, 0, -127, 0, 0, 0}, 3, "VEC3", true, 4)}}};
        b.node({{"mesh", b.square()}, {"weights", {2}}});
        checkNear(corner(b.at(folder, 0), 2), {1, 1, -2});
    }

    TEST_CASE("normals and tangents change along, made ones are made again") {
        const Folder folder("directions");
        Deforming b;
        b.attributes["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3, "VEC3");
        b.attributes["TANGENT"] = b.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1}, 4, "VEC4");
        // Stood up: y becomes z.
        b.target({0, 0, 0, 0, 0, 0, 0, -1, 1, 0, -1, 1}, {0, -1, -1, 0, -1, -1, 0, -1, -1, 0, -1, -1});
        b.more["targets"][0]["TANGENT"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3, "VEC3");
        b.node({{"mesh", b.square()}, {"weights", {1}}});
        const PrimitiveDesc given = shown(b.at(folder, 0));
        checkNear(cast<double>(given.normals[2]), {0, -1, 0});
        CHECK(given.tangents[2].x == doctest::Approx(std::sqrt(0.5)));
        CHECK(given.tangents[2].z == doctest::Approx(std::sqrt(0.5)));
        CHECK(given.tangents[2].w == -1);
        b.attributes.erase("TANGENT");
        b.attributes["TEXCOORD_0"] = b.accessor<float>({0, 0, 0, 1, 1, 1, 1, 0}, 2, "VEC2"); // u along y
        b.root["images"] = {{{"uri", "data:image/png;base64,"}}};
        b.root["textures"] = {{{"source", 0}}};
        b.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
        b.more["material"] = 0;
        b.root["nodes"][0]["mesh"] = b.square();
        Diagnostics notes;
        GltfOptions options;
        options.missingTexture = MissingTexture::grey;
        const SceneDesc s = b.read(folder, notes, options);
        REQUIRE(shown(s).tangents.size() == 4);
        for (const Vec4& t : shown(s).tangents) checkNear({double(t.x), double(t.y), double(t.z)}, {0, 0, 1});
    }

    TEST_CASE("texture coordinates and colours change along; a colour stays one") {
        const Folder folder("looks");
        Deforming b;
        b.attributes["TEXCOORD_0"] = b.accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, 2, "VEC2");
        b.attributes["COLOR_0"] = b.accessor<uint8_t>({51, 102, 153, 255, 0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255}, 4, "VEC4", true);
        b.target({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
        json& target = b.more["targets"][0];
        target["TEXCOORD_0"] = b.accessor<int8_t>({127, 0, 0, 0, 0, -127, 0, 0}, 2, "VEC2", true, 4);
        target["TEXCOORD_1"] = b.accessor<float>(Numbers(8, 9), 2, "VEC2"); // the mesh has none
        target["COLOR_0"] = b.accessor<float>({.2f, .2f, .2f, -.5f, .2f, .4f, .6f, 1, 4, -4, 0, 0, 0, 0, 0, 0}, 4, "VEC4");
        const int rests = b.node({{"mesh", b.square()}, {"weights", {0.5}}}), moves = b.node({{"mesh", 0}});
        const PrimitiveDesc p = shown(b.at(folder, 0), size_t(rests));
        checkUv(p, {{0.5f, 0}, {1, 0}, {1, 0.5f}, {0, 1}});
        CHECK(p.uv[1].empty());
        const float expected[][4] = {{.3f, .5f, .7f, .75f}, {.1f, .2f, .3f, 1}, {1, 0, 1, 1}, {0, 0, 0, 1}};
        REQUIRE(p.colors.size() == 4);
        for (size_t i = 0; i < 4; ++i) {
            CHECK(p.colors[i].x == doctest::Approx(expected[i][0]));
            CHECK(p.colors[i].y == doctest::Approx(expected[i][1]));
            CHECK(p.colors[i].z == doctest::Approx(expected[i][2]));
            CHECK(p.colors[i].w == doctest::Approx(expected[i][3]));
        }
        b.animate(moves, "weights", {0, 2}, {0, 1});
        Diagnostics notes;
        const SceneDesc s = b.read(folder, notes, {.shutter = {0, 2}});
        CHECK(warns(notes, "changes texture coordinates or colours while the shutter is open"));
        checkUv(shown(s, size_t(moves)), {{0.5f, 0}, {1, 0}, {1, 0.5f}, {0, 1}});
        const SceneDesc late = b.at(folder, 2);
        checkUv(shown(late, size_t(moves)), {{1, 0}, {1, 0}, {1, 0}, {0, 1}});
    }

    TEST_CASE("over the shutter: two shapes where weights go linearly, more where they do not") {
        const Folder folder("blur");
        Deforming b;
        b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
        const int straight = b.node({{"mesh", b.square()}}), bent = b.node({{"mesh", 0}}), curved = b.node({{"mesh", 0}});
        b.node({{"mesh", 0}, {"weights", {1}}});
        b.animate(straight, "weights", {0, 4}, {0, 4});
        b.animate(bent, "weights", {0, 1, 2}, {0, 1, 0});
        b.animate(curved, "weights", {0, 2}, {0, 0, 0, 0, 1, 0}, "CUBICSPLINE");
        const SceneDesc s = b.at(folder, 0, {0, 2});
        CHECK(shown(s, 0).steps.size() == 1);
        CHECK(shown(s, 1).steps.size() == 2);
        CHECK(shown(s, 2).steps.size() == 64);
        CHECK(shown(s, 3).steps.empty());
        for (const double t : {0., 0.3, 0.5, 1.}) {
            checkNear(during(s, 1, t, 0), {1, 0, 2 * t});
            checkNear(during(s, 1, t, 1), {1, 0, t < 0.5 ? 2 * t : 2 - 2 * t}, 1e-6);
            checkNear(during(s, 1, t, 2), {1, 0, 3 * t * t - 2 * t * t * t}, 1e-3);
        }
        Diagnostics notes;
        Deforming jump = b;
        jump.animate(3, "weights", {0, 0.7f}, {0, 1}, "STEP");
        CHECK(shown(jump.read(folder, notes, {.shutter = {0, 2}}), 3).steps.size() == 128);
        CHECK(warns(notes, "/nodes/3 changes its shape by jumps while the shutter is open"));
    }

    TEST_CASE("files that lie are one error line") {
        const Folder folder("morph-lies");
        const auto fails = [&](const char* part, const std::function<void(Deforming&)>& change) {
            Deforming b;
            b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
            b.node({{"mesh", b.square()}, {"weights", {1}}});
            change(b);
            const Failure f = failure(folder.write("scene.glb", b.asGlb()));
            CAPTURE(f.message);
            CHECK(f.code == Exit::file);
            CHECK(f.message.find(part) != std::string::npos);
        };
        fails("/nodes/0/weights has 2 numbers, /meshes/0 has 1 morph targets", [](Deforming& b) {
            b.root["nodes"][0]["weights"] = {1, 2};
        });
        fails("/meshes/0/weights has 3 numbers, /meshes/0 has 1 morph targets", [](Deforming& b) {
            b.root["meshes"][0]["weights"] = {1, 2, 3};
            b.root["nodes"][0].erase("weights");
        });
        fails("/nodes/0/weights/0 must be a number", [](Deforming& b) { b.root["nodes"][0]["weights"] = {"1"}; });
        fails("targets/0/POSITION has 3 elements, POSITION has 4", [](Deforming& b) {
            b.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = b.accessor<float>(Numbers(9), 3, "VEC3");
        });
        fails("targets/0/POSITION has type VEC2", [](Deforming& b) {
            b.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = b.accessor<float>(Numbers(8), 2, "VEC2");
        });
        fails("targets/0/TEXCOORD_0 has type VEC3, must be VEC2", [](Deforming& b) {
            b.root["meshes"][0]["primitives"][0]["targets"][0]["TEXCOORD_0"] = b.accessor<float>(Numbers(12), 3, "VEC3");
        });
        fails("targets/0/COLOR_0 has 3 elements, POSITION has 4", [](Deforming& b) {
            b.root["meshes"][0]["primitives"][0]["targets"][0]["COLOR_0"] = b.accessor<float>(Numbers(9), 3, "VEC3");
        });
        fails("targets/0/POSITION element 2 is not finite", [](Deforming& b) {
            Numbers n(12);
            n[7] = NAN;
            b.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = b.accessor<float>(n, 3, "VEC3");
        });
        fails("beyond 1e18 m", [](Deforming& b) { b.root["nodes"][0]["weights"] = {1e30}; });
        fails("/output has 3 elements, its 2 times of 1 morph targets need 2", [](Deforming& b) {
            b.animate(0, "weights", {0, 1}, {0, 1, 2});
        });
        fails("has 20000 morph targets, more than 16384", [](Deforming& b) {
            json many = json::array();
            for (int i = 0; i < 20000; ++i) many.push_back(json::object());
            b.root["meshes"][0]["primitives"][0]["targets"] = many;
        });
        const auto sparse = [&](const char* part, const std::vector<uint8_t>& where, int count = 0) {
            fails(part, [&](Deforming& b) {
                const Numbers values(where.size() * 3, 1.f);
                b.root["accessors"][2]["sparse"] = {
                    {"count", count ? count : int(where.size())},
                    {"indices",
                     {{"bufferView", b.view({reinterpret_cast<const char*>(where.data()), where.size()})}, {"componentType", 5121}}},
                    {"values", {{"bufferView", b.view({reinterpret_cast<const char*>(values.data()), values.size() * 4})}}}};
            });
        };
        sparse("names element 4 of 4", {1, 4});
        sparse("names element 1 after 2, must rise", {2, 1});
        sparse("names element 2 after 2, must rise", {2, 2});
        sparse("the accessor has 4 elements", {0, 1, 2, 3, 3});
        sparse("up to byte 4", {0, 1}, 4);
    }
} // TEST_SUITE
