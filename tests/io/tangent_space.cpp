// Tangents made from texture coordinates: closed forms, angle weights, mirrored seams, what joins and what does not.
#include "io/tangent_space.h"
#include "tests/io/gltf_builder.h"
#include <cmath>
#include <doctest/doctest.h>
#include <map>
#include <numbers>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Mesh {
    std::vector<Vec3> positions, normals;
    std::vector<Point2> uv;
    std::vector<uint32_t> indices;
    TangentSpace space() const { return {positions, normals, uv, indices}; }
    Vec4 at(const TangentSpace& s, size_t corner) const { return s.tangents(positions, normals)[s.group(corner)]; }
};

void checkTangent(const Vec4& t, const Vec3& direction, float sign, double tolerance = 1e-6) {
    INFO(t.x << ", " << t.y << ", " << t.z << " for " << direction.x << ", " << direction.y << ", " << direction.z);
    CHECK(length(Vec3{t.x, t.y, t.z} - direction) <= tolerance);
    CHECK(t.w == sign);
}

// A unit square in z = 0 whose texture coordinates are a linear map of x and y.
Mesh square(float ux, float uy, float vx, float vy) {
    Mesh m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    m.normals.assign(4, {0, 0, 1});
    for (const Vec3& p : m.positions) m.uv.push_back({ux * p.x + uy * p.y, vx * p.x + vy * p.y});
    m.indices = {0, 1, 2, 0, 2, 3};
    return m;
}

// z up, u around, v down from the north pole; poles left open.
Mesh globe(int around, int down) {
    Mesh m;
    for (int j = 0; j <= down; ++j)
        for (int i = 0; i <= around; ++i) {
            const double phi = 2 * std::numbers::pi * i / around, theta = std::numbers::pi * (0.1 + 0.8 * j / down);
            const Vec3d p{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
            m.positions.push_back(i == around ? m.positions[m.positions.size() - size_t(around)] : cast<float>(p));
            m.normals.push_back(m.positions.back());
            m.uv.push_back({float(i) / float(around), float(j) / float(down)});
        }
    const auto at = [&](int i, int j) { return uint32_t(j * (around + 1) + i); };
    for (int j = 0; j < down; ++j)
        for (int i = 0; i < around; ++i)
            m.indices.insert(m.indices.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    return m;
}

} // namespace

TEST_SUITE("tangent_space") {
    TEST_CASE("a plane: along growing u, the bitangent against growing v") {
        struct Case {
            float ux, uy, vx, vy;
            Vec3 tangent;
            float sign;
        };
        const float h = float(std::sqrt(0.5));
        for (const Case& c : {Case{1, 0, 0, -1, {1, 0, 0}, 1},
                              {1, 0, 0, 1, {1, 0, 0}, -1},
                              {-1, 0, 0, -1, {-1, 0, 0}, -1},
                              {0, 3, 2, 0, {0, 1, 0}, 1},
                              {0, 1, -1, 0, {0, 1, 0}, -1},
                              {1, 1, 1, -1, {h, h, 0}, 1}}) {
            const Mesh m = square(c.ux, c.uy, c.vx, c.vy);
            const TangentSpace s = m.space();
            CHECK(s.groups() == 4);
            for (size_t k = 0; k < 6; ++k) checkTangent(m.at(s, k), c.tangent, c.sign);
        }
    }

    TEST_CASE("normals that lean: in the plane of each, unit, and without normals those of the faces") {
        Mesh m = square(1, 0, 0, -1);
        m.normals[0] = normalize(Vec3{1, 0, 1});
        checkTangent(m.at(m.space(), 0), normalize(Vec3{1, 0, -1}), 1);
        m.normals.clear();
        const TangentSpace flat = m.space();
        CHECK(flat.groups() == 4);
        for (size_t k = 0; k < 6; ++k) checkTangent(m.at(flat, k), {1, 0, 0}, 1);
    }

    TEST_CASE("a globe: tangents run along the circles of latitude, over the seam each on its own") {
        const Mesh m = globe(64, 32);
        const TangentSpace s = m.space();
        const std::vector<Vec4> all = s.tangents(m.positions, m.normals);
        double worst = 0, inside = 0;
        for (size_t k = 0; k < m.indices.size(); ++k) {
            const Vec3 n = m.normals[m.indices[k]];
            const Vec4 t = all[s.group(k)];
            const Vec3 east = normalize(Vec3{-n.y, n.x, 0});
            const double off = double(std::acos(std::min(1.f, dot(east, {t.x, t.y, t.z}))));
            const uint32_t column = m.indices[k] % 65, row = m.indices[k] / 65;
            worst = std::max(worst, off);
            if (column % 64 != 0 && row % 32 != 0) inside = std::max(inside, off);
            CHECK(t.w == 1);
        }
        CHECK(inside < 1e-3);
        CHECK(worst < std::numbers::pi / 64); // at the seam a corner sees one side only, half a step away
        CHECK(s.groups() == m.positions.size());
    }

    TEST_CASE("the mean at a corner is weighted by angle") {
        // A fan about the origin: a triangle of 90 degrees whose u grows along x, one of 45 whose u grows along another direction, sharing
        // an edge and the texture coordinates on it.
        Mesh m;
        m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
        m.normals.assign(4, {0, 0, 1});
        m.uv = {{0, 0}, {1, 0}, {0, 1}, {0.5f, 1}}; // first: u = x, v = y; second: u = -x / 2, v = y
        m.indices = {0, 1, 2, 0, 2, 3};
        const TangentSpace s = m.space();
        // The second is mirrored: it stands alone.
        checkTangent(m.at(s, 0), {1, 0, 0}, -1);
        checkTangent(m.at(s, 3), {-1, 0, 0}, 1);
        m.uv[3] = {-1, 3}; // second: u = x, v = y + ... : u = x, v = y - 2 x
        const TangentSpace again = m.space();
        // u by (x, y): du = dx; the tangent is the direction in which u grows and v stays: v = y - 2 x, so along (1, 2).
        const Vec3d first{1, 0, 0}, second = normalize(Vec3d{1, 2, 0});
        const Vec3d mean = normalize(first * (std::numbers::pi / 2) + second * (std::numbers::pi / 4));
        checkTangent(m.at(again, 0), cast<float>(mean), -1);
        CHECK(again.group(0) == again.group(3));
        checkTangent(m.at(again, 1), {1, 0, 0}, -1);
        checkTangent(m.at(again, 5), cast<float>(second), -1);
    }

    TEST_CASE("corners join over an edge only, and only with one texture coordinate") {
        Mesh m; // two triangles that touch in a point
        m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
        m.normals.assign(5, {0, 0, 1});
        m.uv = {{0, 0}, {1, 0}, {1, 1}, {-1, 0}, {-1, -1}};
        m.indices = {0, 1, 2, 0, 3, 4};
        CHECK(m.space().group(0) != m.space().group(3));
        Mesh seam = square(1, 0, 0, -1); // the diagonal with other coordinates on its second side
        for (const uint32_t v : {0u, 2u}) {
            seam.positions.push_back(seam.positions[v]);
            seam.normals.push_back({0, 0, 1});
            seam.uv.push_back({seam.uv[v].x + 5, seam.uv[v].y});
        }
        seam.uv[3].x += 5;
        seam.indices = {0, 1, 2, 4, 5, 3};
        CHECK(seam.space().groups() == 6);
        for (size_t k = 0; k < 6; ++k) checkTangent(seam.at(seam.space(), k), {1, 0, 0}, 1);
        Mesh copied = seam; // the same numbers in other vertices: one
        for (const size_t v : {4u, 5u}) copied.uv[v].x -= 5;
        copied.uv[3].x -= 5;
        CHECK(copied.space().groups() == 4);
    }

    TEST_CASE("a mirrored seam has a tangent for each side, and its vertices are split") {
        Mesh m; // u runs away from the middle x = 0 on both sides
        m.positions = {{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {1, 0, 0}, {1, 1, 0}};
        m.normals.assign(6, {0, 0, 1});
        for (const Vec3& p : m.positions) m.uv.push_back({std::fabs(p.x), 1 - p.y});
        m.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
        const TangentSpace s = m.space();
        CHECK(s.groups() == 8);
        for (size_t k = 0; k < 6; ++k) checkTangent(m.at(s, k), {-1, 0, 0}, -1);
        for (size_t k = 6; k < 12; ++k) checkTangent(m.at(s, k), {1, 0, 0}, 1);

        // Through the reader: two vertices more, which know where they come from.
        const Folder folder("mirrored");
        Builder b;
        std::vector<float> positions, uv;
        for (const Vec3& p : m.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
        for (const Point2& p : m.uv) uv.insert(uv.end(), {p.x, p.y});
        std::vector<float> normals;
        for (int i = 0; i < 6; ++i) normals.insert(normals.end(), {0, 0, 1});
        b.root["images"] = {{{"uri", "data:image/png;base64,"}}};
        b.root["textures"] = {{{"source", 0}}};
        b.root["materials"] = {{{"normalTexture", {{"index", 0}, {"texCoord", 2}}}}, json::object()};
        const json attributes = {{"POSITION", b.accessor(positions, 3, "VEC3")},
                                 {"NORMAL", b.accessor(normals, 3, "VEC3")},
                                 {"TEXCOORD_2", b.accessor(uv, 2, "VEC2")}};
        const int indices = b.accessor<uint32_t>(m.indices, 1, "SCALAR");
        b.node({{"mesh", b.mesh(attributes, {{"indices", indices}, {"material", 0}})}});
        b.node({{"mesh", b.mesh(attributes, {{"indices", indices}, {"material", 1}})}});
        Diagnostics notes;
        GltfContents found;
        GltfOptions options;
        options.missingTexture = MissingTexture::grey;
        const SceneDesc scene = readGltf(folder.write("scene.glb", b.asGlb()), options, notes, &found);
        const PrimitiveDesc &p = scene.meshes[0].primitives[0], &plain = scene.meshes[1].primitives[0];
        REQUIRE(p.positions.size() == 8);
        REQUIRE(p.tangents.size() == 8);
        for (const size_t k : {0u, 1u, 2u, 3u, 4u, 5u}) checkTangent(p.tangents[p.indices[k]], {-1, 0, 0}, -1);
        for (const size_t k : {6u, 7u, 8u, 9u, 10u, 11u}) checkTangent(p.tangents[p.indices[k]], {1, 0, 0}, 1);
        const auto& kept = found.origin.meshes[0][0].vertices;
        REQUIRE(kept.size() == 8);
        for (size_t v = 0; v < 8; ++v) CHECK(p.positions[v] == m.positions[kept[v]]);
        CHECK(plain.tangents.empty()); // nothing asks for them, nor for the third set
        CHECK(plain.uv[2].empty());
        CHECK(p.uv[2].size() == 8);
    }

    TEST_CASE("triangles without area, in space or in the texture, take what is beside them") {
        Mesh m = square(1, 0, 0, -1);
        m.positions.push_back({2, 0.5f, 0}); // its texture coordinates lie on the edge that it shares
        m.normals.push_back({0, 0, 1});
        m.uv.push_back({1, -0.5f});
        m.indices.insert(m.indices.end(), {1, 4, 2});
        m.indices.insert(m.indices.end(), {0, 1, 1});
        const TangentSpace s = m.space();
        for (size_t k = 0; k < m.indices.size(); ++k) {
            if (m.indices[k] == 4) continue;
            checkTangent(m.at(s, k), {1, 0, 0}, 1);
        }
        const Vec4 alone = m.at(s, 7); // nobody says: any direction across the normal
        CHECK(alone.z == doctest::Approx(0));
        CHECK(length(Vec3{alone.x, alone.y, alone.z}) == doctest::Approx(1));
        Mesh nothing = square(0, 0, 0, 0);
        for (size_t k = 0; k < 6; ++k)
            CHECK(length(Vec3{nothing.at(nothing.space(), k).x, nothing.at(nothing.space(), k).y, 0}) == doctest::Approx(1));
    }

    TEST_CASE("many triangles at one edge end at once") {
        Mesh m;
        m.positions = {{0, 0, 0}, {1, 0, 0}};
        m.uv = {{0, 0}, {1, 0}};
        for (uint32_t i = 0; i < 200000; ++i) {
            m.positions.push_back({0.5f, 1, float(i)});
            m.uv.push_back({0.5f, 1 + float(i)});
            m.indices.insert(m.indices.end(), {i % 2, 1 - i % 2, i + 2});
        }
        CHECK(m.space().groups() > 0);
    }
} // TEST_SUITE
