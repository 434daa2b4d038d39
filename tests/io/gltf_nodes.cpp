// The node graph: placement, instancing, cameras, punctual lights, which scene is drawn.
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

void checkNear(const Vec3d& a, const Vec3d& b) {
    CHECK(a.x == doctest::Approx(b.x));
    CHECK(a.y == doctest::Approx(b.y));
    CHECK(a.z == doctest::Approx(b.z));
}

int triangleMesh(Builder& b) { return b.mesh({{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")}}); }

int light(Builder& b, json entry) {
    json& lights = b.root["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(entry));
    return int(lights.size()) - 1;
}

json lightNode(int index) { return {{"extensions", {{"KHR_lights_punctual", {{"light", index}}}}}}; }

} // namespace

TEST_SUITE("gltf_nodes") {
    TEST_CASE("TRS and the matrix that says the same give the same placement") {
        const Folder folder("trs");
        Builder b;
        const int mesh = triangleMesh(b);
        const double s = std::sqrt(0.5); // a quarter turn about +Z
        b.node({{"mesh", mesh}, {"name", "trs"}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, s, s}}, {"scale", {2, 3, -4}}});
        b.node({{"mesh", mesh}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, -4, 0, 1, 2, 3, 1}}});
        b.node({{"mesh", mesh}, {"rotation", {0, 0, 7, 7}}}); // quaternions are normalized
        const SceneDesc scene = b.read(folder);
        REQUIRE(scene.instances.size() == 3);
        CHECK(scene.meshes.size() == 1);
        CHECK(scene.instances[0].name == "trs");
        for (int i = 0; i < 2; ++i) checkNear(scene.instances[size_t(i)].toWorld.point({1, 1, 1}), {-2, 4, -1});
        CHECK(scene.instances[0].toWorld.determinant() == doctest::Approx(-24)); // negative scale stays
        checkNear(scene.instances[2].toWorld.point({1, 0, 0}), {0, 1, 0});
    }

    TEST_CASE("a hierarchy composes from the root down, in double") {
        const Folder folder("hierarchy");
        Builder b;
        const int mesh = triangleMesh(b);
        const int leaf = b.add("nodes", {{"mesh", mesh}, {"translation", {0.001, 0, 0}}});
        const int middle = b.add("nodes", {{"mesh", mesh}, {"scale", {2, 2, 2}}, {"children", {leaf}}});
        b.node({{"translation", {1e7, 0, 0}}, {"children", {middle}}});
        const SceneDesc scene = b.read(folder);
        REQUIRE(scene.instances.size() == 2);
        CHECK(scene.instances[1].toWorld.m[0][3] - 1e7 == doctest::Approx(0.002));
    }

    TEST_CASE("the default scene, else the first, else all roots") {
        const Folder folder("scenes");
        Builder b;
        const int mesh = triangleMesh(b);
        for (const char* name : {"a", "b", "c"}) b.add("nodes", {{"mesh", mesh}, {"name", name}});
        CHECK(b.read(folder).instances.size() == 3);
        b.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2, 1}}}};
        CHECK(b.read(folder).instances[0].name == "a");
        CHECK(b.read(folder).instances.size() == 1);
        b.root["scene"] = 1;
        CHECK(b.read(folder).instances[0].name == "c");
        b.root["scenes"] = {json::object(), json::object()};
        CHECK(b.read(folder).instances.empty());
    }

    TEST_CASE("a node of zero scale is left out with a warning") {
        const Folder folder("flat");
        Builder b;
        const int mesh = triangleMesh(b);
        b.node({{"mesh", mesh}, {"scale", {1, 0, 1}}});
        b.node({{"mesh", mesh}, {"matrix", {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
        b.node({{"mesh", mesh}, {"scale", {1e-5, 1e-5, 1e-5}}});
        Diagnostics notes;
        CHECK(b.read(folder, notes).instances.size() == 1);
        CHECK(warns(notes, "/nodes/0 has a scale of zero"));
        CHECK(warns(notes, "/nodes/1 has a scale of zero"));
    }

    TEST_CASE("EXT_mesh_gpu_instancing expands inside the node's frame") {
        const Folder folder("instancing");
        Builder b;
        const int mesh = triangleMesh(b);
        const json attributes = {{"TRANSLATION", b.accessor<float>({0, 0, 0, 5, 0, 0}, 3, "VEC3")},
                                 {"ROTATION", b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, 4, "VEC4", true)},
                                 {"SCALE", b.accessor<float>({1, 1, 1, 2, 2, 2}, 3, "VEC3")},
                                 {"_ID", b.accessor<float>({1, 2}, 1, "SCALAR")}};
        b.node({{"mesh", mesh}, {"translation", {0, 0, 9}}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
        b.node({{"mesh", mesh},
                {"extensions",
                 {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", b.accessor<int8_t>({0, 127, 0, 0}, 4, "VEC4", true)}}}}}}}});
        b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
        const SceneDesc scene = b.read(folder);
        REQUIRE(scene.instances.size() == 3);
        CHECK(scene.meshes.size() == 1);
        checkNear(scene.instances[0].toWorld.point({1, 0, 0}), {1, 0, 9});
        checkNear(scene.instances[1].toWorld.point({1, 0, 0}), {5, 2, 9});
        checkNear(scene.instances[2].toWorld.point({1, 0, 0}), {-1, 0, 0});
    }

    TEST_CASE("cameras: order of the traversal, lens, axes without scale") {
        const Folder folder("cameras");
        Builder b;
        b.root["cameras"] = {
            {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 10}}}},
            {{"type", "perspective"}, {"name", "main"}, {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}},
            {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
        const int child = b.add("nodes", {{"camera", 1}, {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}});
        b.node({{"scale", {10, 20, 30}}, {"translation", {1, 2, 3}}, {"children", {child}}});
        b.node({{"camera", 0}, {"name", "plan"}});
        b.node({{"camera", 2}});
        const SceneDesc scene = b.read(folder);
        REQUIRE(scene.cameras.size() == 3);
        CHECK(scene.cameras[0].name == "main");
        CHECK(scene.cameras[0].yfov == 0.5);
        CHECK(scene.cameras[0].aspect == 1.5);
        checkNear(scene.cameras[0].toWorld.point({}), {1, 2, 3});
        checkNear(scene.cameras[0].toWorld.vector({0, 0, -1}), {-1, 0, 0});
        checkNear(scene.cameras[0].toWorld.vector({1, 0, 0}), {0, 0, -1});
        CHECK(scene.cameras[0].toWorld.determinant() == doctest::Approx(1));
        CHECK(scene.cameras[1].name == "plan");
        CHECK(scene.cameras[1].projection == Projection::orthographic);
        CHECK(scene.cameras[1].xmag == 4);
        CHECK(scene.cameras[1].ymag == 2);
        CHECK(scene.cameras[2].aspect == 0);
    }

    TEST_CASE("KHR_lights_punctual: kinds, units, cones; scale does not change a light") {
        const Folder folder("lights");
        Builder b;
        const int point = light(b, {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"range", 4}, {"name", "bulb"}});
        const int spot = light(b, {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}});
        const int plainSpot = light(b, {{"type", "spot"}});
        const int sun = light(b, {{"type", "directional"}, {"intensity", 100000}});
        json scaled = lightNode(point);
        scaled["scale"] = {100, 100, 100};
        scaled["translation"] = {0, 7, 0};
        b.node(scaled);
        b.node(lightNode(spot));
        b.node(lightNode(plainSpot));
        json turned = lightNode(sun); // -Z to -Y
        turned["rotation"] = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
        turned["scale"] = {1, 1, 5};
        b.node(turned);
        json flat = lightNode(point);
        flat["scale"] = {0, 0, 0};
        flat["translation"] = {3, 0, 0};
        b.node(flat);
        const SceneDesc scene = b.read(folder);
        REQUIRE(scene.lights.size() == 5);
        CHECK(scene.lights[0].name == "bulb");
        CHECK(scene.lights[0].intensity == Spectrum(8, 4, 0));
        CHECK(scene.lights[0].range == 4);
        CHECK(scene.lights[0].toWorld.determinant() == doctest::Approx(1));
        checkNear(scene.lights[0].toWorld.point({}), {0, 7, 0});
        CHECK(scene.lights[1].kind == PunctualKind::spot);
        CHECK(scene.lights[1].innerCone == 0.1);
        CHECK(scene.lights[1].outerCone == 0.2);
        CHECK(scene.lights[2].innerCone == 0);
        CHECK(scene.lights[2].outerCone == doctest::Approx(0.78539816));
        CHECK(scene.lights[2].intensity == Spectrum(1));
        CHECK(scene.lights[3].kind == PunctualKind::directional);
        CHECK(scene.lights[3].intensity[0] == 100000.f);
        checkNear(scene.lights[3].toWorld.vector({0, 0, -1}), {0, -1, 0});
        checkNear(scene.lights[4].toWorld.point({}), {3, 0, 0});
    }

    TEST_CASE("thousands of siblings and a deep chain are no trouble") {
        const Folder folder("many");
        Builder b;
        const int mesh = triangleMesh(b);
        int below = -1;
        for (int i = 0; i < 900; ++i) {
            json n = {{"translation", {1, 0, 0}}};
            if (below >= 0)
                n["children"] = {below};
            else
                n["mesh"] = mesh;
            below = b.add("nodes", n);
        }
        b.root["scenes"] = {{{"nodes", {below}}}};
        for (int i = 0; i < 5000; ++i) b.node({{"mesh", mesh}});
        const SceneDesc scene = b.read(folder);
        CHECK(scene.instances.size() == 5001);
        CHECK(scene.instances[0].toWorld.m[0][3] == 900);
    }
}
