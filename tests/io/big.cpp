// Scenes that are large: read and built side by side, the same for any number of threads, stored once, in few bytes.
#include "core/render/executor.h"
#include "core/scene/scene.h"
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

// n x n quads with a bump each, (n + 1)^2 vertices.
struct Grid {
    std::vector<float> positions, normals, uv;
    std::vector<uint32_t> indices;
    explicit Grid(uint32_t n, float bump = 0.1f) {
        for (uint32_t y = 0; y <= n; ++y)
            for (uint32_t x = 0; x <= n; ++x) {
                positions.insert(positions.end(), {float(x), bump * float((x * 7 + y * 13) % 5), float(y)});
                normals.insert(normals.end(), {0, 1, 0});
                uv.insert(uv.end(), {float(x) / float(n), float(y) / float(n)});
            }
        for (uint32_t y = 0; y < n; ++y)
            for (uint32_t x = 0; x < n; ++x) {
                const uint32_t a = y * (n + 1) + x, b = a + n + 1;
                indices.insert(indices.end(), {a, b, a + 1, a + 1, b, b + 1});
            }
    }
};

json attributesOf(Builder& b, const Grid& g) {
    return {{"POSITION", b.accessor(g.positions, 3, "VEC3")},
            {"NORMAL", b.accessor(g.normals, 3, "VEC3")},
            {"TEXCOORD_0", b.accessor(g.uv, 2, "VEC2")}};
}

// Many meshes of different sizes, some of them drawn often, and a warning from every third.
Builder manyMeshes() {
    Builder b;
    for (uint32_t m = 0; m < 40; ++m) {
        Grid g(3 + m % 11, 0.02f * float(m));
        if (m % 3 == 0) g.uv[0] = std::numeric_limits<float>::infinity();
        const int mesh = b.mesh(attributesOf(b, g), {{"indices", b.accessor(g.indices, 1, "SCALAR")}});
        for (uint32_t k = 0; k < 1 + m % 4; ++k) b.node({{"mesh", mesh}, {"translation", {20.0 * m, 15.0 * k, 0.0}}});
    }
    return b;
}

} // namespace

TEST_SUITE("io-big") {

    TEST_CASE("the same scene and the same warnings for any number of threads") {
        const Folder folder("big");
        const Builder b = manyMeshes();
        Diagnostics first;
        const auto one = Scene::compile(b.read(folder, first), first);
        CHECK(first.warnings().size() == 14);
        CHECK(one->counts().instances > 40);
        for (const unsigned threads : {1u, 2u, 5u}) {
            CAPTURE(threads);
            const Executor run(threads);
            Diagnostics notes;
            const auto scene = Scene::compile(b.read(folder, notes, {.run = &run}), notes, {}, &run);
            CHECK(notes.warnings() == first.warnings());
            CHECK(scene->hash() == one->hash());
            CHECK(scene->counts().triangles == one->counts().triangles);
            for (uint32_t k = 0; k < 500; ++k) {
                const Vec3 from{float(k % 40) * 20 - 390 + float(k % 7), 60, float(k % 11) - 5};
                const Ray ray{from, 0, normalize(Vec3{0.01f * float(k % 13), -1, 0.02f * float(k % 5)}), infinity, 0};
                const Hit a = one->intersect(ray), c = scene->intersect(ray);
                CHECK(bool(a) == bool(c));
                CHECK((!a || (a.t == c.t && a.geometry == c.geometry && a.triangle == c.triangle && a.instance == c.instance)));
            }
        }
    }

    TEST_CASE("of several faults the first one in the file is told, whichever thread meets one") {
        const Folder folder("faults");
        Builder b;
        for (uint32_t m = 0; m < 30; ++m) {
            Grid g(4);
            if (m == 9 || m == 10 || m == 25) g.positions[3 * m] = std::numeric_limits<float>::quiet_NaN();
            const int mesh = b.mesh(attributesOf(b, g), {{"indices", b.accessor(g.indices, 1, "SCALAR")}});
            b.node({{"mesh", mesh}});
        }
        const fs::path file = folder.write("scene.glb", b.asGlb());
        const Executor run(4);
        for (int repeat = 0; repeat < 20; ++repeat) {
            const Failure f = failure(file, {.run = &run});
            CHECK(f.code == Exit::file);
            CHECK(f.message.find("/meshes/9/primitives/0/attributes/POSITION") != f.message.npos);
        }
    }

    TEST_CASE("meshes of the same accessors and materials are stored once") {
        const Folder folder("same");
        Builder b;
        const Grid g(20);
        const json attributes = attributesOf(b, g), indices = {{"indices", b.accessor(g.indices, 1, "SCALAR")}};
        json red = indices;
        red["material"] = b.add("materials", {{"name", "red"}});
        for (int i = 0; i < 10; ++i) b.node({{"mesh", b.mesh(attributes, indices)}, {"translation", {30.0 * i, 0.0, 0.0}}});
        b.node({{"mesh", b.mesh(attributes, red)}, {"translation", {0.0, 5.0, 0.0}}});
        GltfContents found;
        Diagnostics notes;
        SceneDesc desc = readGltf(folder.write("scene.glb", b.asGlb()), {}, notes, &found);
        CHECK(desc.meshes.size() == 2); // the red one is another
        CHECK(found.origin.instances.size() == 11);
        const auto scene = Scene::compile(std::move(desc), notes);
        CHECK(scene->counts().triangles == 2 * 800);
        CHECK(scene->counts().trianglesDrawn == 11 * 800);
    }

    TEST_CASE("what a file will take is told before it is read, and few bytes are taken") {
        const Folder folder("bytes");
        Builder b;
        const Grid g(200); // 80,000 triangles
        b.node({{"mesh", b.mesh(attributesOf(b, g), {{"indices", b.accessor(g.indices, 1, "SCALAR")}})}});
        const fs::path file = folder.write("scene.glb", b.asGlb());
        std::vector<SceneSizes> told;
        Diagnostics notes;
        const auto scene = Scene::compile(readGltf(file, {.admit = [&](const SceneSizes& s) { told.push_back(s); }}, notes), notes);
        REQUIRE(told.size() == 3);
        CHECK(told[0].fileBytes == fs::file_size(file));
        CHECK(told[1].triangles == 80'000);
        CHECK(told[1].vertexBytes == g.positions.size() / 3 * 32);
        const SceneForecast f = forecast(told[2]);
        const SceneBytes& bytes = scene->counts().bytes;
        CHECK(bytes.geometry >= f.kept.geometry);
        CHECK(double(bytes.geometry) < 1.01 * double(f.kept.geometry));
        CHECK(bytes.hierarchy > 0);
        CHECK(double(bytes.hierarchy) < 1.2 * double(f.kept.hierarchy));
        CHECK(bytes.total() / 80'000 < 200);
        CHECK(f.most > bytes.total());
        // Refused where it is told: nothing more is read.
        const auto refuse = [](const SceneSizes& s) {
            if (s.triangles > 0) throw Error(Exit::resources, "too much");
        };
        CHECK(failure(file, {.admit = refuse}).code == Exit::resources);
    }

} // TEST_SUITE
