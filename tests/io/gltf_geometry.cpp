// Accessors and primitives: every component type, strides, sparse parts, quantization, strips and fans, missing attributes.
#include "tests/io/gltf_builder.h"
#include <doctest/doctest.h>
#include <set>

using namespace chiaro;
using namespace chiaro::test;

namespace {

const PrimitiveDesc& only(const SceneDesc& scene) {
    REQUIRE(scene.meshes.size() == 1);
    REQUIRE(scene.meshes[0].primitives.size() == 1);
    return scene.meshes[0].primitives[0];
}

const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

Builder withAttribute(const char* name, int (*make)(Builder&)) {
    Builder b;
    json attributes = {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")}};
    attributes[name] = make(b);
    b.node({{"mesh", b.mesh(attributes)}});
    return b;
}

template <class T> void checkIndices(const Folder& folder) {
    Builder b;
    const int positions = b.accessor<float>(square, 3, "VEC3");
    b.node({{"mesh", b.mesh({{"POSITION", positions}}, {{"indices", b.accessor<T>({0, 1, 2, 0, 2, 3}, 1, "SCALAR")}})}});
    const SceneDesc scene = b.read(folder);
    CHECK(only(scene).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(only(scene).positions.size() == 4);
}

template <class T> void checkPositions(const Folder& folder, bool normalized, float unit) {
    Builder b;
    const T top = std::numeric_limits<T>::max(), low = std::numeric_limits<T>::lowest();
    const int a = b.accessor<T>({0, 0, low, top, 0, 0, 0, top, 1}, 3, "VEC3", normalized, (3 * sizeof(T) + 3) / 4 * 4);
    b.node({{"mesh", b.mesh({{"POSITION", a}})}});
    const SceneDesc scene = b.read(folder);
    const auto& p = only(scene).positions;
    REQUIRE(p.size() == 3);
    CHECK(p[1].x == doctest::Approx(double(top) * unit));
    CHECK(p[0].z == doctest::Approx(normalized ? std::max(double(low) * unit, -1.0) : double(low)));
    CHECK(p[2] == Vec3{0, float(double(top) * unit), unit});
}

} // namespace

TEST_SUITE("gltf_geometry") {
    TEST_CASE("indices of every type, and none") {
        const Folder folder("indices");
        checkIndices<uint8_t>(folder);
        checkIndices<uint16_t>(folder);
        checkIndices<uint32_t>(folder);
        const SceneDesc scene = Builder::triangle().read(folder);
        CHECK(only(scene).indices == std::vector<uint32_t>{0, 1, 2});
        CHECK(only(scene).material == -1);
        CHECK(only(scene).normals.empty());
        CHECK(scene.instances.size() == 1);
    }

    TEST_CASE("positions of every component type (KHR_mesh_quantization)") {
        const Folder folder("positions");
        checkPositions<int8_t>(folder, false, 1);
        checkPositions<int8_t>(folder, true, 1 / 127.f);
        checkPositions<uint8_t>(folder, false, 1);
        checkPositions<uint8_t>(folder, true, 1 / 255.f);
        checkPositions<int16_t>(folder, false, 1);
        checkPositions<int16_t>(folder, true, 1 / 32767.f);
        checkPositions<uint16_t>(folder, false, 1);
        checkPositions<uint16_t>(folder, true, 1 / 65535.f);
    }

    TEST_CASE("strides and offsets") {
        const Folder folder("strides");
        for (const size_t stride : {12, 16, 64, 252}) {
            Builder b;
            const int a = b.accessor<float>(square, 3, "VEC3", false, stride, 8);
            b.node({{"mesh", b.mesh({{"POSITION", a}}, {{"indices", b.accessor<uint8_t>({0, 1, 2, 0, 2, 3}, 1, "SCALAR")}})}});
            const SceneDesc scene = b.read(folder);
            CHECK(only(scene).positions[2] == Vec3{1, 1, 0});
            CHECK(only(scene).positions[3] == Vec3{0, 1, 0});
        }
    }

    TEST_CASE("sparse accessors, over values and over zeros") {
        const Folder folder("sparse");
        for (const bool based : {true, false}) {
            Builder b;
            const int a = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3");
            const uint16_t at[] = {1, 2};
            const float values[] = {5, 0, 0, 0, 7, 0};
            json& accessor = b.root["accessors"][size_t(a)];
            if (!based) accessor.erase("bufferView");
            accessor["sparse"] = {
                {"count", 2},
                {"indices", {{"bufferView", b.view({reinterpret_cast<const char*>(at), sizeof at})}, {"componentType", 5123}}},
                {"values", {{"bufferView", b.view({reinterpret_cast<const char*>(values), sizeof values})}}}};
            b.node({{"mesh", b.mesh({{"POSITION", a}})}});
            const SceneDesc scene = b.read(folder);
            CHECK(only(scene).positions == std::vector<Vec3>{{0, 0, 0}, {5, 0, 0}, {0, 7, 0}});
        }
    }

    TEST_CASE("an accessor without a bufferView is all zeros") {
        const Folder folder("zeros");
        Builder b = withAttribute("TEXCOORD_0", [](Builder& to) {
            return to.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
        });
        const SceneDesc scene = b.read(folder);
        REQUIRE(only(scene).uv[0].size() == 3);
        CHECK(only(scene).uv[0][2].x == 0);
    }

    TEST_CASE("normals: float, quantized, repaired; absent ones stay absent") {
        const Folder folder("normals");
        const SceneDesc floats = withAttribute("NORMAL", [](Builder& b) {
                                     return b.accessor<float>({0, 0, 2, 0, 1, 0, 0, 0, 1}, 3, "VEC3");
                                 }).read(folder);
        CHECK(only(floats).normals == std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}});
        const SceneDesc bytes = withAttribute("NORMAL", [](Builder& b) {
                                    return b.accessor<int8_t>({0, 0, 127, 90, 90, 0, 0, 0, -127}, 3, "VEC3", true, 4);
                                }).read(folder);
        CHECK(only(bytes).normals[1].x == doctest::Approx(std::sqrt(0.5)));
        CHECK(only(bytes).normals[2] == Vec3{0, 0, -1});
        Diagnostics notes;
        const SceneDesc bad = withAttribute("NORMAL", [](Builder& b) {
                                  return b.accessor<float>({0, 0, 0, NAN, 1, 0, 0, 1, 0}, 3, "VEC3");
                              }).read(folder, notes);
        CHECK(only(bad).normals == std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}});
        CHECK(warns(notes, "/meshes/0/primitives/0/attributes/NORMAL has 2 elements that are no direction"));
    }

    TEST_CASE("tangents keep the sign of the bitangent; broken ones are dropped, and those of flat normals are none") {
        const Folder folder("tangents");
        const auto with = [](const std::vector<float>& tangents, bool normals = true) {
            Builder b;
            json attributes = {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")},
                               {"TANGENT", b.accessor(tangents, 4, "VEC4")}};
            if (normals) attributes["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3, "VEC3");
            b.node({{"mesh", b.mesh(attributes)}});
            return b;
        };
        const std::vector<float> sound = {2, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1};
        CHECK(only(with(sound).read(folder)).tangents == std::vector<Vec4>{{1, 0, 0, 1}, {1, 0, 0, -1}, {1, 0, 0, 1}});
        CHECK(only(with(sound, false).read(folder)).tangents.empty());
        Diagnostics notes;
        CHECK(only(with({2, 0, 0, 1, 0, 0, 0, -1, 1, 0, 0, 1}).read(folder, notes)).tangents.empty());
        CHECK(warns(notes, "TANGENT element 1"));
    }

    TEST_CASE("texture coordinates: float and normalized, both sets") {
        const Folder folder("uv");
        const SceneDesc a = withAttribute("TEXCOORD_0", [](Builder& b) {
                                return b.accessor<float>({0, 0, 2.5f, 0, 0, -1}, 2, "VEC2");
                            }).read(folder);
        CHECK(only(a).uv[0][1].x == 2.5f);
        CHECK(only(a).uv[0][2].y == -1.f);
        CHECK(only(a).uv[1].empty());
        const SceneDesc c = withAttribute("TEXCOORD_1", [](Builder& b) {
                                return b.accessor<uint8_t>({0, 0, 255, 0, 0, 51}, 2, "VEC2", true, 4);
                            }).read(folder);
        CHECK(only(c).uv[1][1].x == 1.f);
        CHECK(only(c).uv[1][2].y == doctest::Approx(0.2));
        const SceneDesc d = withAttribute("TEXCOORD_1", [](Builder& b) {
                                return b.accessor<uint16_t>({0, 0, 65535, 0, 0, 13107}, 2, "VEC2", true);
                            }).read(folder);
        CHECK(only(d).uv[1][2].y == doctest::Approx(0.2));
    }

    TEST_CASE("vertex colours: RGB and RGBA, float, u8 and u16") {
        const Folder folder("colors");
        const Vec4 second{1, 0, 0.2f, 1};
        const auto near = [&](const Vec4& c, float alpha) {
            CHECK(c.x == doctest::Approx(second.x));
            CHECK(c.y == doctest::Approx(second.y));
            CHECK(c.z == doctest::Approx(second.z));
            CHECK(c.w == doctest::Approx(alpha));
        };
        near(only(withAttribute("COLOR_0",
                                [](Builder& b) {
                                    return b.accessor<float>({0, 0, 0, 1, 0, .2f, 1, 1, 1}, 3, "VEC3");
                                })
                      .read(folder))
                 .colors[1],
             1);
        near(only(withAttribute("COLOR_0",
                                [](Builder& b) {
                                    return b.accessor<uint8_t>({0, 0, 0, 0, 255, 0, 51, 102, 9, 9, 9, 9}, 4, "VEC4", true);
                                })
                      .read(folder))
                 .colors[1],
             0.4f);
        near(only(withAttribute("COLOR_0",
                                [](Builder& b) {
                                    return b.accessor<uint8_t>({0, 0, 0, 255, 0, 51, 9, 9, 9}, 3, "VEC3", false, 4);
                                })
                      .read(folder))
                 .colors[1],
             1);
        near(only(withAttribute("COLOR_0",
                                [](Builder& b) {
                                    return b.accessor<uint16_t>({0, 0, 0, 65535, 0, 13107, 9, 9, 9}, 3, "VEC3", true, 8);
                                })
                      .read(folder))
                 .colors[1],
             1);
    }

    TEST_CASE("strips and fans become triangles of the same winding; points and lines are named") {
        const Folder folder("modes");
        const auto read = [&](int mode, Diagnostics& notes) {
            Builder b;
            b.node({{"mesh", b.mesh({{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, 3, "VEC3")}},
                                    {{"mode", mode}})}});
            return b.read(folder, notes);
        };
        Diagnostics notes;
        CHECK(only(read(5, notes)).indices == std::vector<uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4});
        CHECK(only(read(6, notes)).indices == std::vector<uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0});
        CHECK(notes.warnings().empty());
        for (const int mode : {0, 1, 2, 3}) CHECK(read(mode, notes).instances.empty());
        CHECK(notes.warnings().size() == 1);
        CHECK(warns(notes, "/meshes/0 has a primitive of points or lines, which is not drawn."));
        CHECK(only(read(4, notes)).indices.size() == 3);
        CHECK(warns(notes, "no multiple of three"));
    }

    TEST_CASE("strips and fans with indices; triangles that only join a strip are dropped; several primitives of points are counted") {
        const Folder folder("indexed");
        const auto read = [&](int mode, const std::vector<uint16_t>& indices) {
            Builder b;
            std::vector<float> positions;
            for (int i = 0; i < 7; ++i) positions.insert(positions.end(), {float(i % 3), float(i / 3), 0});
            b.node({{"mesh", b.mesh({{"POSITION", b.accessor(positions, 3, "VEC3")}},
                                    {{"mode", mode}, {"indices", b.accessor(indices, 1, "SCALAR")}})}});
            return only(b.read(folder)).indices;
        };
        CHECK(read(5, {6, 5, 4, 3, 2, 1, 0}) == std::vector<uint32_t>{6, 5, 4, 5, 3, 4, 4, 3, 2, 3, 1, 2, 2, 1, 0});
        CHECK(read(5, {0, 1, 2, 2, 3, 3, 4, 5, 6}) == std::vector<uint32_t>{0, 1, 2, 3, 5, 4, 4, 5, 6});
        CHECK(read(6, {6, 0, 1, 1, 2, 3, 4, 5}) == std::vector<uint32_t>{0, 1, 6, 1, 2, 6, 2, 3, 6, 3, 4, 6, 4, 5, 6});
        Builder b = Builder::triangle();
        const json attributes = {{"POSITION", 0}};
        b.root["meshes"][0]["name"] = "dots";
        for (const int mode : {0, 1}) b.root["meshes"][0]["primitives"].push_back({{"attributes", attributes}, {"mode", mode}});
        Diagnostics notes;
        CHECK(only(b.read(folder, notes)).indices.size() == 3);
        CHECK(warns(notes, "/meshes/0 \"dots\" has 2 primitives of points or lines, which are not drawn."));
    }

    TEST_CASE("four sets of texture coordinates, those that a texture reads; of a fifth it is said") {
        const Folder folder("sets");
        Builder b;
        json attributes = {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3")}};
        for (int set = 0; set < 5; ++set)
            attributes["TEXCOORD_" + std::to_string(set)] = b.accessor<float>({float(set), 0, 1, 0, 0, 1}, 2, "VEC2");
        b.root["images"] = {{{"uri", "data:image/png;base64,"}}};
        b.root["textures"] = {{{"source", 0}}};
        const auto material = [](int set) { return json{{"emissiveTexture", {{"index", 0}, {"texCoord", set}}}}; };
        b.root["materials"] = {material(3), material(4)};
        for (const int m : {0, 1}) b.node({{"mesh", b.mesh(attributes, {{"material", m}})}});
        Diagnostics notes;
        GltfOptions options;
        options.missingTexture = MissingTexture::grey;
        const SceneDesc s = b.read(folder, notes, options);
        const PrimitiveDesc &third = s.meshes[0].primitives[0], &none = s.meshes[1].primitives[0];
        CHECK(s.materials[0].emissionTexture.uvSet == 3);
        CHECK(s.materials[1].emissionTexture.uvSet == 0);
        REQUIRE(third.uv[3].size() == 3);
        CHECK(third.uv[3][0].x == 3);
        CHECK(third.uv[2].empty());
        CHECK(none.uv[3].empty());
        CHECK(none.uv[1].size() == 3);
        CHECK(warns(notes, "uses TEXCOORD_4; only sets 0 to 3 are read, set 0 stands in"));
    }

    TEST_CASE("primitives keep only their part of a shared vertex buffer") {
        const Folder folder("shared");
        Builder b;
        std::vector<float> many(3000);
        for (size_t i = 0; i < many.size(); ++i) many[i] = float(i);
        const int a = b.accessor<float>(many, 3, "VEC3");
        b.node({{"mesh", b.mesh({{"POSITION", a}}, {{"indices", b.accessor<uint16_t>({900, 10, 500}, 1, "SCALAR")}})}});
        const SceneDesc scene = b.read(folder);
        CHECK(only(scene).indices == std::vector<uint32_t>{2, 0, 1});
        CHECK(only(scene).positions == std::vector<Vec3>{{30, 31, 32}, {1500, 1501, 1502}, {2700, 2701, 2702}});
    }

    TEST_CASE("what is not applied is named once a file") {
        const Folder folder("named");
        Builder b = Builder::triangle();
        const int position = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, "VEC3");
        for (int i = 0; i < 3; ++i)
            b.node({{"mesh", b.mesh({{"POSITION", position}, {"COLOR_1", position}, {"_MINE", position}},
                                    {{"targets", {{{"POSITION", position}, {"COLOR_1", position}}}}})},
                    {"weights", {1}},
                    {"extensions", {{"VENDOR_thing", json::object()}}}});
        Diagnostics notes;
        b.read(folder, notes);
        CHECK(notes.warnings().size() == 3);
        for (const char* part : {"VENDOR_thing", "morph targets that change \"COLOR_1\"", "COLOR_1"}) CHECK(warns(notes, part));
    }

    TEST_CASE("a solid whose faces do not agree on what is outside is named; what is open or no solid is not") {
        const Folder folder("winding");
        // A wedge: two triangles and three squares, each face with vertices of its own.
        const float c[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
        const std::vector<std::vector<uint32_t>> faces = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
        const auto said = [&](std::set<size_t> turned, size_t first = 0, double thickness = 1) {
            std::vector<float> positions;
            std::vector<uint16_t> indices;
            for (size_t f = first; f < faces.size(); ++f) {
                const auto base = uint16_t(positions.size() / 3);
                for (const uint32_t v : faces[f]) positions.insert(positions.end(), c[v], c[v] + 3);
                for (uint16_t k = 2; k < faces[f].size(); ++k) {
                    const auto a = uint16_t(base + k - 1), b = uint16_t(base + k);
                    indices.insert(indices.end(), {base, turned.contains(f) ? b : a, turned.contains(f) ? a : b});
                }
            }
            Builder b;
            b.root["materials"] = {{{"extensions",
                                     {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                      {"KHR_materials_volume", {{"thicknessFactor", thickness}}}}}}};
            b.node({{"mesh", b.mesh({{"POSITION", b.accessor<float>(positions, 3, "VEC3")}},
                                    {{"indices", b.accessor<uint16_t>(indices, 1, "SCALAR")}, {"material", 0}})}});
            Diagnostics notes;
            b.read(folder, notes);
            return notes.warnings().empty() ? std::string() : notes.warnings()[0];
        };
        CHECK(said({}) == "");
        CHECK(said({}, 1) == "");
        CHECK(said({0, 1, 2, 3, 4}) == ""); // a cavity looks like that
        CHECK(said({1}, 0, 0) == "");
        CHECK(said({1}).find("/meshes/0/primitives/0 is a solid (KHR_materials_volume) whose faces do not agree on what is outside, at 3 "
                             "edges") != std::string::npos);
        CHECK(said({2, 3, 4}).find("at 6 edges") != std::string::npos);
    }

    TEST_CASE("container: .glb, data: URI, external file with spaces, %20 and Unicode") {
        const Folder folder("container");
        const Builder b = Builder::triangle();
        Diagnostics notes;
        const SceneDesc fromGlb = readGltf(folder.write("a scene \xc3\xa9\xe4\xb8\xad.glb", b.asGlb()), {}, notes);
        CHECK(fromGlb.name == "a scene \xc3\xa9\xe4\xb8\xad");
        const SceneDesc fromData = readGltf(folder.write("b.gltf", b.asData()), {}, notes);
        CHECK(only(fromData).positions == only(fromGlb).positions);
        for (const std::string uri : {"my%20data%20\xc3\xbc.bin", "my data \xc3\xbc.bin", "sub/../my data \xc3\xbc.bin",
                                      "my%20data%20%C3%BC.bin", "100%.bin", "in\\side.bin"}) {
            folder.write("my data \xc3\xbc.bin", b.bytes);
            folder.write("sub/x", "");
            folder.write("100%.bin", b.bytes);
            folder.write("in/side.bin", b.bytes);
            json j = b.finished();
            j["buffers"][0]["uri"] = uri;
            const SceneDesc scene = readGltf(folder.write("c.gltf", "\xef\xbb\xbf" + j.dump()), {}, notes);
            CHECK(only(scene).positions == only(fromGlb).positions);
        }
        CHECK(notes.warnings().empty());
    }
}
