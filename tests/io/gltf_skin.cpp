// Skins: positions in closed form at three times and over the shutter, what has no say, and files that lie. Which scene of a file is read.
#include "tests/io/gltf_deforming.h"
#include <cmath>
#include <functional>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr double pi64 = std::numbers::pi;

} // namespace

TEST_SUITE("gltf_skin") {
    TEST_CASE("two joints at three times; the node of the mesh has no say") {
        const Folder folder("joints");
        Deforming b;
        b.attributes["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3, "VEC3");
        const int second = b.skinned();
        const int parent = b.node({{"translation", {100, 0, 0}}, {"scale", {5, 5, 5}}});
        b.root["nodes"][size_t(parent)]["children"] = {b.add("nodes", {{"mesh", b.square()}, {"skin", 0}})};
        // The second joint turns about x by 90 degrees in a second, the first moves along z.
        const float h = float(std::sqrt(0.5));
        b.animate(second, "rotation", {0, 1}, {0, 0, 0, 1, h, 0, 0, h});
        b.animate(1, "translation", {0, 1}, {0, 0, 0, 0, 0, 4});
        for (const double t : {0., 0.5, 1.}) {
            CAPTURE(t);
            const SceneDesc s = b.at(folder, t);
            REQUIRE(s.instances.size() == 1);
            const double a = t * pi64 / 2;
            checkNear(corner(s, 0), {0, 0, 4 * t});
            checkNear(corner(s, 1), {1, 0, 4 * t});
            checkNear(corner(s, 2), {1, std::cos(a), 4 * t + std::sin(a)});
            checkNear(corner(s, 3), {0, 1, 4 * t});
            checkNear(cast<double>(shown(s).normals[2]), {0, -std::sin(a), std::cos(a)});
            checkNear(cast<double>(shown(s).normals[3]), {0, 0, 1});
        }
        const SceneDesc open = b.at(folder, 0, {0.25f, 0.75f});
        CHECK(open.instances[0].motion.empty());
        CHECK(shown(open).steps.size() > 1);
        for (const double share : {0., 0.2, 0.5, 1.}) {
            const double t = 0.25 + 0.5 * share, a = t * pi64 / 2;
            checkNear(during(open, 2, share), {1, std::cos(a), 4 * t + std::sin(a)}, 3e-3);
            checkNear(during(open, 0, share), {0, 0, 4 * t}, 1e-6);
        }
    }

    TEST_CASE(
        "weights are blended and made to sum to one, of several sets and kinds; without inverse bind matrices they are the identity") {
        const Folder folder("blend");
        Deforming b;
        const int second = b.skinned("none");
        b.root["nodes"][size_t(second)]["translation"] = {0, 0, 8};
        b.attributes["JOINTS_0"] = b.accessor<uint16_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0}, 4, "VEC4");
        b.attributes["WEIGHTS_0"] = b.accessor<uint8_t>({255, 0, 0, 0, 51, 204, 0, 0, 51, 51, 0, 0, 0, 0, 0, 0}, 4, "VEC4", true);
        b.attributes["JOINTS_1"] = b.accessor<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0}, 4, "VEC4");
        b.attributes["WEIGHTS_1"] = b.accessor<uint16_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2 * 13107, 0, 65535, 0, 0, 0}, 4, "VEC4", true);
        b.node({{"mesh", b.square()}, {"skin", 0}});
        const SceneDesc s = b.at(folder, 0);
        checkNear(corner(s, 0), {0, 0, 0});
        checkNear(corner(s, 1), {1, 0, 6.4});
        checkNear(corner(s, 2), {1, 1, 6}); // 0.2, 0.2 and 0.4: three quarters
        checkNear(corner(s, 3), {0, 1, 8});
    }

    TEST_CASE("a morph goes before the skin, and several nodes wear one mesh each in its own way") {
        const Folder folder("both");
        Deforming b;
        b.skinned();
        b.target({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
        const int mesh = b.square();
        const int third = b.node({{"translation", {0, 50, 0}}, {"scale", {2, 2, 2}}});
        b.add("skins", {{"joints", {third, third}}});
        b.node({{"mesh", mesh}, {"skin", 0}, {"weights", {0.5}}});
        b.node({{"mesh", mesh}, {"skin", 1}, {"weights", {1}}});
        b.node({{"mesh", mesh}});
        const SceneDesc s = b.at(folder, 0);
        REQUIRE(s.instances.size() == 3);
        checkNear(corner(s, 2, 0), {1, 1, 0.5});
        checkNear(corner(s, 2, 1), {2, 52, 2});
        checkNear(corner(s, 2, 2), {1, 1, 0});
        CHECK(s.meshes.size() == 3);
    }

    TEST_CASE("far from the origin the digits stay; joints that mirror keep the front outside") {
        const Folder folder("far");
        Deforming b;
        b.attributes["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3, "VEC3");
        b.skinned();
        b.node({{"mesh", b.square()}, {"skin", 0}});
        b.root["nodes"][1]["translation"] = {1e6, 0, 0};
        b.root["nodes"][1]["scale"] = {1, 1, -1};
        const SceneDesc s = b.at(folder, 0);
        CHECK(maxAbs(shown(s).positions[2]) < 3);
        checkNear(corner(s, 2), {1e6 + 1, 1, 0}, 1e-6);
        CHECK(shown(s).indices == std::vector<uint32_t>{0, 2, 1, 0, 3, 2});
        checkNear(cast<double>(shown(s).normals[0]), {0, 0, -1});
    }

    TEST_CASE("what cannot be right is said") {
        const Folder folder("said");
        Deforming b;
        b.skinned();
        b.attributes["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4, "VEC4");
        b.node({{"mesh", b.square()}, {"skin", 0}});
        Diagnostics notes;
        checkNear(corner(b.read(folder, notes), 1), {1, 0, 0});
        CHECK(warns(notes, "/meshes/0/primitives/0 has 1 vertices whose joints have no weight"));
        Deforming bare;
        bare.skinned();
        bare.attributes.erase("JOINTS_0");
        bare.attributes.erase("WEIGHTS_0");
        bare.node({{"mesh", bare.square()}, {"skin", 0}, {"translation", {0, 0, 7}}});
        checkNear(corner(bare.read(folder, notes), 1), {1, 0, 7});
        CHECK(warns(notes, "has a skin but no JOINTS_0; it follows its node"));
        Deforming flat; // a joint that shrinks to nothing takes its part of the mesh with it
        flat.skinned();
        flat.node({{"mesh", flat.square()}, {"skin", 0}});
        flat.root["nodes"][0]["scale"] = {0, 0, 0};
        checkNear(corner(flat.at(folder, 0), 2), {1, 0, 0});
    }

    TEST_CASE("files that lie are one error line") {
        const Folder folder("skin-lies");
        const auto fails = [&](const char* part, const std::function<void(Deforming&)>& change) {
            Deforming b;
            b.skinned();
            b.node({{"mesh", b.square()}, {"skin", 0}});
            change(b);
            const Failure f = failure(folder.write("scene.glb", b.asGlb()));
            CAPTURE(f.message);
            CHECK(f.code == Exit::file);
            CHECK(f.message.find(part) != std::string::npos);
        };
        const auto attribute = [](Deforming& b, const char* name, int accessor) {
            b.root["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
        };
        fails("attributes/JOINTS_0 vertex 2 names joint 2 of 2", [&](Deforming& b) {
            attribute(b, "JOINTS_0", b.accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}, 4, "VEC4"));
        });
        fails("has 3 elements, POSITION has 4",
              [&](Deforming& b) { attribute(b, "JOINTS_0", b.accessor<uint8_t>(std::vector<uint8_t>(12), 4, "VEC4")); });
        fails("has type VEC3 of component 5121",
              [&](Deforming& b) { attribute(b, "JOINTS_0", b.accessor<uint8_t>(std::vector<uint8_t>(12), 3, "VEC3")); });
        fails("must be VEC4 of 5121 or 5123", [&](Deforming& b) { attribute(b, "JOINTS_0", b.accessor<float>(Numbers(16), 4, "VEC4")); });
        fails("vertex 1 has weight -1", [&](Deforming& b) {
            attribute(b, "WEIGHTS_0", b.accessor<float>({1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4, "VEC4"));
        });
        fails("vertex 1 has weight nan", [&](Deforming& b) {
            attribute(b, "WEIGHTS_0", b.accessor<float>({1, 0, 0, 0, NAN, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4, "VEC4"));
        });
        fails("has no WEIGHTS_1",
              [&](Deforming& b) { attribute(b, "JOINTS_1", b.accessor<uint8_t>(std::vector<uint8_t>(16), 4, "VEC4")); });
        fails("more than 32", [&](Deforming& b) {
            for (int set = 1; set < 12; ++set) attribute(b, ("JOINTS_" + std::to_string(set)).c_str(), 0);
        });
        fails("/skins/0/joints is empty", [](Deforming& b) { b.root["skins"][0]["joints"] = json::array(); });
        fails("has 2 matrices, the skin has 3 joints", [](Deforming& b) { b.root["skins"][0]["joints"] = {0, 1, 0}; });
        fails("must be MAT4 of floats",
              [](Deforming& b) { b.root["skins"][0]["inverseBindMatrices"] = b.accessor<float>(Numbers(32), 4, "VEC4"); });
        fails("matrix 0 is not affine",
              [](Deforming& b) { b.root["skins"][0]["inverseBindMatrices"] = b.accessor<float>(Numbers(32), 16, "MAT4"); });
        fails("number 3 of matrix 0 is nan", [](Deforming& b) {
            Numbers n(32);
            n[3] = NAN;
            b.root["skins"][0]["inverseBindMatrices"] = b.accessor<float>(n, 16, "MAT4");
        });
        fails("beyond 1e18 m", [](Deforming& b) { b.root["nodes"][1]["scale"] = {1e30, 1e30, 1e30}; });
        fails("joints, more than 16384", [](Deforming& b) { b.root["skins"][0]["joints"] = std::vector<int>(20000, 0); });
        fails("vertices and indices, more than", [](Deforming& b) { // a small file that would ask for all memory
            const size_t many = 3'000'000;
            b.root["meshes"][0]["primitives"][0] = {
                {"attributes", {{"POSITION", b.add("accessors", {{"componentType", 5126}, {"count", many}, {"type", "VEC3"}})}}}};
            b.root["nodes"][0]["translation"] = {0, 0, 1};
            for (int i = 0; i < 100; ++i) b.node({{"mesh", 0}, {"skin", 0}});
        });
    }

    TEST_CASE("two scenes: by the file, by number, by name; another is an error with the nearest name") {
        const Folder folder("scenes");
        Builder b = Builder::triangle();
        b.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 5}}});
        b.root["scenes"][0]["name"] = "front";
        b.add("scenes", {{"name", "r\xc3\xbc"
                                  "ckw\xc3\xa4rts"},
                         {"nodes", {1}}});
        const auto z = [&](const std::string& which) {
            Diagnostics notes;
            GltfOptions options;
            options.scene = which;
            GltfContents found;
            const SceneDesc s = readGltf(folder.write("scene.glb", b.asGlb()), options, notes, &found);
            CHECK(found.scenes.size() == 2);
            CHECK(s.instances.size() == 1);
            return std::pair{s.instances[0].toWorld.m[2][3], found.scene};
        };
        using Two = std::pair<double, size_t>;
        CHECK(z("") == Two{0, 0});
        CHECK(z("1") == Two{5, 1});
        CHECK(z("r\xc3\xbc"
                "ckw\xc3\xa4rts") == Two{5, 1});
        b.root["scene"] = 1;
        CHECK(z("") == Two{5, 1});
        CHECK(z("front") == Two{0, 0});
        GltfOptions options;
        options.scene = "fron";
        const Failure f = failure(folder.path / "scene.glb", options);
        CHECK(f.code == Exit::usage);
        CHECK(f.message.find("have 0 to 1, by name \"front\"") != std::string::npos);
        CHECK(f.message.find("did you mean \"front\"?") != std::string::npos);
    }
} // TEST_SUITE
