// Packed geometry: what comes out is what went in, by every codec and filter; what lies is refused with its place; writers get plain files.
#include "io/gltf_write.h"
#include "tests/io/gltf_builder.h"
#include "tests/io/gltf_packing.h"
#include <cmath>
#include <doctest/doctest.h>
#include <functional>

using namespace chiaro;
using namespace chiaro::test;

namespace {

constexpr int side = 9;

// A hilly square of side x side vertices.
std::vector<float> positions() {
    std::vector<float> all;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) all.insert(all.end(), {float(x), std::sin(float(x * y)), float(y)});
    return all;
}
template <class T> std::vector<T> indices() {
    std::vector<T> all;
    for (int y = 0; y + 1 < side; ++y)
        for (int x = 0; x + 1 < side; ++x) {
            const T a = T(y * side + x), b = T(a + 1), c = T(a + side), d = T(c + 1);
            all.insert(all.end(), {a, c, b, b, c, d});
        }
    return all;
}

// A view of what these bytes unpack to, in a buffer that is not there.
int packedView(Builder& b, const std::string& bytes, size_t count, size_t stride, const char* mode, const char* filter = nullptr,
               const char* extension = "EXT_meshopt_compression") {
    const int data = b.view(bytes);
    json packed = b.root["bufferViews"][size_t(data)];
    packed["count"] = count;
    packed["byteStride"] = stride;
    packed["mode"] = mode;
    if (filter) packed["filter"] = filter;
    json view = {{"buffer", 1}, {"byteOffset", 0}, {"byteLength", count * stride}, {"extensions", {{extension, packed}}}};
    if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
    b.root["bufferViews"][size_t(data)] = view;
    b.root["buffers"] = {{{"byteLength", 0}}, {{"byteLength", 100000}, {"extensions", {{extension, {{"fallback", true}}}}}}};
    b.root["extensionsRequired"] = b.root["extensionsUsed"] = {extension};
    return data;
}
int accessor(Builder& b, int view, int component, size_t count, const char* type, bool normalized = false) {
    json a = {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
    if (normalized) a["normalized"] = true;
    return b.add("accessors", a);
}
std::string finished(Builder& b) {
    b.root["buffers"][0]["byteLength"] = b.bytes.size();
    return b.asGlb();
}

Builder packedScene(const char* indexMode, const char* extension = "EXT_meshopt_compression") {
    Builder b;
    const auto i = indices<uint16_t>();
    const int p = accessor(b, packedView(b, packedVertices(positions(), 12), side * side, 12, "ATTRIBUTES", nullptr, extension), 5126,
                           side * side, "VEC3");
    const bool triangles = std::string(indexMode) == "TRIANGLES";
    const int n = accessor(b,
                           packedView(b, triangles ? packedTriangles(i, side * side) : packedSequence(i, side * side), i.size(), 2,
                                      indexMode, "NONE", extension),
                           5123, i.size(), "SCALAR");
    b.node({{"mesh", b.mesh({{"POSITION", p}}, {{"indices", n}})}});
    return b;
}

void checkShape(const PrimitiveDesc& p) {
    const std::vector<float> expected = positions();
    REQUIRE(p.positions.size() == side * side);
    for (size_t i = 0; i < p.positions.size(); ++i)
        CHECK(p.positions[i] == Vec3{expected[3 * i], expected[3 * i + 1], expected[3 * i + 2]});
    // The encoder turns triangles around, and keeps their order and winding.
    const auto whole = indices<uint32_t>();
    REQUIRE(p.indices.size() == whole.size());
    for (size_t t = 0; t < whole.size(); t += 3) {
        size_t turn = 0;
        while (turn < 3 && p.indices[t + turn] != whole[t]) ++turn;
        REQUIRE(turn < 3);
        for (size_t k = 0; k < 3; ++k) CHECK(p.indices[t + (turn + k) % 3] == whole[t + k]);
    }
}

void checkRefused(Builder b, const std::function<void(json& packed)>& change, const std::string& part, Exit code = Exit::file) {
    const Folder folder("packed-bad");
    change(b.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
    const fs::path file = folder.write("bad.glb", finished(b));
    const Failure f = failure(file);
    CHECK(f.code == code);
    CHECK(f.message.starts_with(file.string() + ": /bufferViews/0/extensions/EXT_meshopt_compression"));
    CHECK_MESSAGE(f.message.find(part) != std::string::npos, f.message);
}

Builder dracoScene(int method, std::string* stream = nullptr, const std::string* instead = nullptr) {
    const std::string bytes = instead ? *instead : packedDraco(positions(), indices<uint32_t>(), 1.f / side, method);
    if (stream) *stream = bytes;
    Builder b;
    const int p = b.add("accessors", {{"componentType", 5126}, {"count", side * side}, {"type", "VEC3"}}),
              c = b.add("accessors", {{"componentType", 5126}, {"count", side * side}, {"type", "VEC2"}}),
              i = b.add("accessors", {{"componentType", 5123}, {"count", 6 * (side - 1) * (side - 1)}, {"type", "SCALAR"}});
    const json packed = {{"bufferView", b.view(bytes)}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
    b.node({{"mesh",
             b.mesh({{"POSITION", p}, {"TEXCOORD_0", c}}, {{"indices", i}, {"extensions", {{"KHR_draco_mesh_compression", packed}}}})}});
    b.root["extensionsRequired"] = b.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    return b;
}

double areaOf(const PrimitiveDesc& p) {
    double all = 0;
    for (size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const Vec3 &a = p.positions[p.indices[i]], &b = p.positions[p.indices[i + 1]], &c = p.positions[p.indices[i + 2]];
        all += 0.5 * double(length(cross(b - a, c - a)));
    }
    return all;
}

} // namespace

TEST_SUITE("gltf_compressed") {
    TEST_CASE("meshopt: vertices, triangles, sequences; under both names") {
        const Folder folder("packed");
        for (const char* mode : {"TRIANGLES", "INDICES"})
            for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
                Builder b = packedScene(mode, name);
                Diagnostics notes;
                const SceneDesc scene = readGltf(folder.write("a.glb", finished(b)), {}, notes);
                CHECK(notes.warnings().empty());
                checkShape(scene.meshes.at(0).primitives.at(0));
            }
    }

    TEST_CASE("meshopt: the three filters") {
        const Folder folder("filters");
        Builder b;
        const std::vector<float> at = positions();
        const size_t count = at.size() / 3;
        std::vector<uint32_t> exponents(at.size());
        meshopt_encodeFilterExp(exponents.data(), count, 12, 20, at.data());
        std::vector<float> directions;
        for (size_t i = 0; i < count; ++i) {
            const Vec3 d = normalize(Vec3{float(i % 5) - 2, 1, float(i % 7) - 3});
            directions.insert(directions.end(), {d.x, d.y, d.z, 0});
        }
        std::vector<int8_t> octahedral(4 * count);
        meshopt_encodeFilterOct(octahedral.data(), count, 4, 8, directions.data());
        const float turn[4] = {0, std::sin(0.4f), 0, std::cos(0.4f)};
        std::vector<int16_t> quaternion(4);
        meshopt_encodeFilterQuat(quaternion.data(), 1, 8, 12, turn);
        const int p = accessor(b, packedView(b, packedVertices(exponents, 12), count, 12, "ATTRIBUTES", "EXPONENTIAL"), 5126, count,
                               "VEC3"),
                  n = accessor(b, packedView(b, packedVertices(octahedral, 4), count, 4, "ATTRIBUTES", "OCTAHEDRAL"), 5120, count, "VEC3",
                               true),
                  r = accessor(b, packedView(b, packedVertices(quaternion, 8), 1, 8, "ATTRIBUTES", "QUATERNION"), 5122, 1, "VEC4", true),
                  i = b.accessor<uint16_t>(indices<uint16_t>(), 1, "SCALAR");
        b.node({{"mesh", b.mesh({{"POSITION", p}, {"NORMAL", n}}, {{"indices", i}})},
                {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", r}}}}}}}});
        Diagnostics notes;
        const SceneDesc scene = readGltf(folder.write("a.glb", finished(b)), {}, notes);
        const PrimitiveDesc& q = scene.meshes.at(0).primitives.at(0);
        REQUIRE(q.positions.size() == count);
        for (size_t v = 0; v < count; ++v) {
            CHECK(q.positions[v].y == doctest::Approx(double(at[3 * v + 1])).epsilon(1e-4));
            CHECK(dot(q.normals[v], Vec3{directions[4 * v], directions[4 * v + 1], directions[4 * v + 2]}) > 0.999f);
        }
        CHECK(scene.instances.at(0).toWorld.m[0][0] == doctest::Approx(std::cos(0.8)).epsilon(1e-3));
        CHECK(scene.instances.at(0).toWorld.m[0][2] == doctest::Approx(std::sin(0.8)).epsilon(1e-3));
    }

    TEST_CASE("meshopt that lies") {
        const Builder b = packedScene("TRIANGLES");
        checkRefused(
            b, [](json& p) { p["count"] = 2147483647; }, "more than its");
        checkRefused(
            b, [](json& p) { p["byteStride"] = 6; }, "/byteStride is 6, must be a multiple of 4");
        checkRefused(
            b, [](json& p) { p["mode"] = "POINTS"; }, "/mode \"POINTS\" is none of");
        checkRefused(
            b, [](json& p) { p["filter"] = "QUATERNION"; }, "/filter \"QUATERNION\" does not go with");
        checkRefused(
            b, [](json& p) { p["filter"] = "COLOR"; }, "filter COLOR, which this build cannot read. Try: ", Exit::unsupported);
        checkRefused(
            b, [](json& p) { p["byteOffset"] = 1000000; }, "its buffer has");
        checkRefused(
            b, [](json& p) { p["byteLength"] = 20; }, "cannot be unpacked");
        checkRefused(
            b, [](json& p) { p.erase("mode"); }, "has no \"mode\"");
        checkRefused(
            b, [](json& p) { p["buffer"] = 1; }, "its buffer has 0");
        Builder newer = b;
        newer.bytes[0] = '\xa1';
        checkRefused(
            newer, [](json&) {}, "version 1 of meshoptimizer's codec, this build reads 0", Exit::unsupported);
        Builder triangles = b;
        triangles.root["bufferViews"][1]["extensions"]["EXT_meshopt_compression"]["count"] = 385;
        const Folder folder("packed-bad");
        CHECK(failure(folder.write("a.glb", finished(triangles))).message.find("/count is 385, must be a multiple of 3") !=
              std::string::npos);
    }

    TEST_CASE("Draco: both methods; attributes by their numbers") {
        const Folder folder("draco");
        for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
            CAPTURE(method);
            Builder b = dracoScene(method);
            Diagnostics notes;
            const SceneDesc scene = b.read(folder, notes);
            CHECK(notes.warnings().empty());
            const PrimitiveDesc& p = scene.meshes.at(0).primitives.at(0);
            CHECK(p.positions.size() == side * side);
            CHECK(p.indices.size() == indices<int>().size());
            Builder plain;
            const int at = plain.accessor<float>(positions(), 3, "VEC3"), i = plain.accessor<uint16_t>(indices<uint16_t>(), 1, "SCALAR");
            plain.node({{"mesh", plain.mesh({{"POSITION", at}}, {{"indices", i}})}});
            CHECK(areaOf(p) == doctest::Approx(areaOf(plain.read(folder).meshes[0].primitives[0])).epsilon(1e-3));
            REQUIRE(p.uv[0].size() == p.positions.size());
            for (size_t v = 0; v < p.positions.size(); ++v)
                CHECK(p.uv[0][v].x == doctest::Approx(double(p.positions[v].x) / side).epsilon(1e-3));
        }
    }

    TEST_CASE("Draco that lies or is damaged") {
        std::string stream;
        dracoScene(draco::MESH_EDGEBREAKER_ENCODING, &stream);
        const Folder folder("draco-bad");
        const auto message = [&](const std::string& bytes) {
            const fs::path file = folder.write("bad.glb", dracoScene(draco::MESH_EDGEBREAKER_ENCODING, nullptr, &bytes).asGlb());
            const Failure f = failure(file);
            CHECK((f.code == Exit::done || f.message.starts_with(file.string() + ": ")));
            return f.message;
        };
        CHECK(message(stream).empty());
        CHECK(message("no Draco at all")
                  .find("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression cannot be unpacked: it is no Draco stream") !=
              std::string::npos);
        std::string other = stream;
        other[6] = 1;
        CHECK(message(other).find("it is Draco bitstream 2.1, glTF's is 2.2") != std::string::npos);
        std::string huge = stream; // after the header of 11 bytes and the kind of traversal: the number of vertices, as it is packed
        huge.replace(12, 1, "\xff\xff\xff\xff\x0f");
        CHECK(message(huge).find("it says 4294967295 elements, more than its") != std::string::npos);
        for (size_t n = 1; n < stream.size(); n += 7) CHECK(message(stream.substr(0, n)).find("cannot be unpacked") != std::string::npos);
        uint64_t state = 5;
        for (int round = 0; round < 300; ++round) {
            std::string bad = stream;
            state = state * 6364136223846793005ull + 1442695040888963407ull;
            bad[(state >> 33) % bad.size()] ^= char(1 << (state >> 30 & 7));
            message(bad);
        }
        Builder wide = dracoScene(draco::MESH_EDGEBREAKER_ENCODING);
        wide.root["accessors"][0]["type"] = "VEC4";
        CHECK(failure(folder.write("a.glb", wide.asGlb())).message.find("its attribute 0 has 3 numbers, the accessor 4") !=
              std::string::npos);
    }

    TEST_CASE("what is written again is plain") {
        const Folder folder("plain");
        Builder packed = packedScene("INDICES"), draco = dracoScene(draco::MESH_EDGEBREAKER_ENCODING);
        for (const std::string& bytes : {finished(packed), draco.asGlb()}) {
            const fs::path file = folder.write("in.glb", bytes);
            Diagnostics notes;
            GltfContents found;
            const SceneDesc scene = readGltf(file, {}, notes, &found);
            GltfDocument::read(file, found.origin, notes).write(folder.path / "out.glb");
            const SceneDesc again = readGltf(folder.path / "out.glb", {}, notes);
            CHECK(again.meshes.at(0).primitives.at(0).positions == scene.meshes[0].primitives[0].positions);
            CHECK(again.meshes[0].primitives[0].indices == scene.meshes[0].primitives[0].indices);
            std::ifstream in(folder.path / "out.glb", std::ios::binary);
            const std::string text{std::istreambuf_iterator<char>(in), {}};
            CHECK(text.find("_compression") == std::string::npos);
            CHECK(notes.warnings().empty());
        }
    }
}
