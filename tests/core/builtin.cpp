// Every built-in scene is what its page says: a table over builtinScenes() for what all share, then one case a scene.
#include "scenes/builtin.h"
#include "scenes/shapes.h"
#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <string>

using namespace chiaro;

namespace {

// The triangles of one instance in the world, in double.
struct WorldTriangle {
    Vec3d a, b, c;
    Vec3d area() const { return cross(b - a, c - a) * 0.5; } // along the front's normal
    Vec3d centre() const { return (a + b + c) * (1.0 / 3); }
};
std::vector<WorldTriangle> trianglesOf(const SceneDesc& s, const InstanceDesc& instance) {
    std::vector<WorldTriangle> out;
    for (const PrimitiveDesc& p : s.meshes[std::size_t(instance.mesh)].primitives)
        for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) { return instance.toWorld.point(cast<double>(p.positions[p.indices[i + k]])); };
            out.push_back({corner(0), corner(1), corner(2)});
        }
    return out;
}
const InstanceDesc& instanceOf(const SceneDesc& s, std::string_view name) {
    for (const InstanceDesc& i : s.instances)
        if (i.name == name) return i;
    FAIL("no instance named ", name);
    return s.instances.front();
}
const MaterialDesc& materialOf(const SceneDesc& s, const InstanceDesc& i) {
    return s.materials[std::size_t(s.meshes[std::size_t(i.mesh)].primitives.front().material)];
}

// The volume that the fronts enclose: positive when they look outwards.
double signedVolume(const std::vector<WorldTriangle>& triangles) {
    double sum = 0;
    for (const WorldTriangle& t : triangles) sum += dot(t.a, cross(t.b, t.c));
    return sum / 6;
}
// Every directed edge once, and its reverse once.
bool watertight(const PrimitiveDesc& p) {
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k)
            if (!edges.insert({p.indices[i + k], p.indices[i + (k + 1) % 3]}).second) return false;
    for (const auto& [from, to] : edges)
        if (!edges.contains({to, from})) return false;
    return true;
}
// Is `inside` behind the front of every triangle (or, with side -1, in front of it)?
bool allFace(const std::vector<WorldTriangle>& triangles, const Vec3d& from, double side) {
    for (const WorldTriangle& t : triangles)
        if (!(dot(t.area(), t.centre() - from) * side > 0)) return false;
    return true;
}

void checkPrimitive(const SceneDesc& s, const PrimitiveDesc& p) {
    REQUIRE(!p.positions.empty());
    REQUIRE(p.indices.size() % 3 == 0);
    CHECK(p.material >= 0);
    CHECK(std::size_t(p.material) < s.materials.size());
    CHECK((p.normals.empty() || p.normals.size() == p.positions.size()));
    CHECK((p.uv[0].empty() || p.uv[0].size() == p.positions.size()));
    std::size_t outOfRange = 0, degenerate = 0, notUnit = 0, wrongSide = 0;
    for (uint32_t i : p.indices) outOfRange += i >= p.positions.size();
    REQUIRE(outOfRange == 0);
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) { return cast<double>(p.positions[p.indices[i + k]]); };
        const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
        degenerate += !(length(n) > 0);
        if (p.normals.empty()) continue;
        for (std::size_t k = 0; k < 3; ++k) wrongSide += !(dot(n, cast<double>(p.normals[p.indices[i + k]])) > 0.98 * length(n));
    }
    for (const Vec3& n : p.normals) notUnit += !(std::abs(length(n) - 1) < 1e-6f);
    CHECK(degenerate == 0);
    CHECK(notUnit == 0);
    CHECK(wrongSide == 0);
}

} // namespace

TEST_SUITE("builtin scenes") {

    TEST_CASE("the list: names, sizes, pages") {
        std::set<std::string_view> names;
        REQUIRE(builtinScenes().size() == 7);
        for (const BuiltinScene& b : builtinScenes()) {
            CAPTURE(b.name);
            CHECK(b.name.starts_with("@"));
            CHECK(names.insert(b.name).second);
            CHECK(!b.summary.empty());
            CHECK(b.width >= 64);
            CHECK(b.height >= 64);
            CHECK(b.spp > 0);
            CHECK(findBuiltin(b.name) == &b);
            CHECK(b.make().name == b.name);
            CHECK(std::filesystem::exists("scenes/" + std::string(b.name.substr(1)) + ".md"));
        }
        CHECK(findBuiltin("@nowhere") == nullptr);
        CHECK(findBuiltin("cornell") == nullptr);
        CHECK(findBuiltin("") == nullptr);
    }

    TEST_CASE("descriptions are complete and within range") {
        for (const BuiltinScene& b : builtinScenes()) {
            CAPTURE(b.name);
            const SceneDesc s = b.make();
            std::set<std::string> names;
            for (const MeshDesc& mesh : s.meshes)
                for (const PrimitiveDesc& p : mesh.primitives) {
                    CAPTURE(mesh.name);
                    checkPrimitive(s, p);
                }
            bool lit = false;
            for (const InstanceDesc& i : s.instances) {
                REQUIRE(i.mesh >= 0);
                REQUIRE(std::size_t(i.mesh) < s.meshes.size());
                CHECK(names.insert(i.name).second);
                CHECK(i.toWorld.determinant() > 0);
                lit = lit || !black(materialOf(s, i).emission);
            }
            CHECK(lit);
            for (const ImageDesc& i : s.images) // made in code: no file is read
                CHECK(i.pixels.size() == std::size_t(i.width) * i.height * i.channels * (i.type == PixelType::u8 ? 1 : 4));
            for (const TextureDesc& t : s.textures) CHECK(std::size_t(t.image) < s.images.size());
            REQUIRE(!s.cameras.empty());
            CHECK(s.cameras.front().name == "main");
            for (const CameraDesc& c : s.cameras) CHECK(c.toWorld.determinant() == doctest::Approx(1).epsilon(1e-12));
        }
    }

    TEST_CASE("materials reflect no more than arrives; emitters shine from one side") {
        for (const BuiltinScene& b : builtinScenes()) {
            CAPTURE(b.name);
            for (const MaterialDesc& m : b.make().materials) {
                CAPTURE(m.name);
                for (std::size_t i = 0; i < 3; ++i) {
                    CHECK(m.baseColor[i] >= 0);
                    CHECK(m.baseColor[i] <= 1);
                    CHECK(m.emission[i] >= 0);
                }
                if (!black(m.emission)) CHECK(!m.doubleSided);
                if (m.metallic == 0 && m.transmission == 0 && m.iridescence == 0) CHECK(m.specular == 0);
                if (m.transmission > 0) CHECK((m.volume && !m.doubleSided && m.ior == 1.5f));
            }
        }
    }

    TEST_CASE("what is animated moves through the place that it has at rest, and keeps its size") {
        for (const BuiltinScene& b : builtinScenes()) {
            if (!b.animate) continue;
            CAPTURE(b.name);
            SceneDesc rest = b.make(), still = b.make(), moving = b.make();
            b.animate(still, 0, {});
            b.animate(moving, 0.25, {-0.25f, 0.75f});
            std::size_t moved = 0;
            for (std::size_t i = 0; i < rest.instances.size(); ++i) {
                CHECK(std::equal(&rest.instances[i].toWorld.m[0][0], &rest.instances[i].toWorld.m[0][0] + 12,
                                 &still.instances[i].toWorld.m[0][0]));
                CHECK(still.instances[i].motion.empty());
                const MotionDesc& m = moving.instances[i].motion;
                if (m.empty()) continue;
                ++moved;
                REQUIRE(m.size() >= 2);
                for (const Affine& a : m) CHECK(a.determinant() == doctest::Approx(rest.instances[i].toWorld.determinant()).epsilon(1e-12));
                CHECK(std::equal(&m[0].m[0][0], &m[0].m[0][0] + 12, &rest.instances[i].toWorld.m[0][0])); // 0.25 - 0.25: at the beginning
            }
            CHECK(moved > 0);
        }
    }

    TEST_CASE("two calls give the same bits") {
        for (const BuiltinScene& b : builtinScenes()) {
            const SceneDesc first = b.make(), second = b.make();
            REQUIRE(first.meshes.size() == second.meshes.size());
            for (std::size_t i = 0; i < first.meshes.size(); ++i) {
                CHECK(first.meshes[i].primitives[0].positions == second.meshes[i].primitives[0].positions);
                CHECK(first.meshes[i].primitives[0].indices == second.meshes[i].primitives[0].indices);
            }
        }
    }

    TEST_CASE("@cornell: the room looks inwards, the blocks outwards") {
        for (const char* name : {"@cornell", "@cornell-spheres"}) {
            const SceneDesc s = findBuiltin(name)->make();
            for (const char* part : {"floor", "ceiling", "back wall", "left wall", "right wall", "lamp"}) {
                CAPTURE(part);
                CHECK(allFace(trianglesOf(s, instanceOf(s, part)), {2.78, 2.7, 2.8}, -1));
            }
            CHECK(materialOf(s, instanceOf(s, "lamp")).emission == Spectrum{18.4f, 15.6f, 8.0f});
            CHECK(materialOf(s, instanceOf(s, "left wall")).baseColor == Spectrum{0.63f, 0.065f, 0.05f});
            CHECK(s.cameras.front().yfov == doctest::Approx(39.3077 * std::numbers::pi / 180).epsilon(3e-6));
        }
        const SceneDesc s = findBuiltin("@cornell")->make();
        std::size_t triangles = 0;
        for (const InstanceDesc& i : s.instances) triangles += trianglesOf(s, i).size();
        CHECK(triangles == 32);
        CHECK(allFace(trianglesOf(s, instanceOf(s, "short block")), {3.7, 0.8, 3.9}, 1));
        CHECK(allFace(trianglesOf(s, instanceOf(s, "tall block")), {1.87, 1.6, 2.08}, 1));
        // The lamp's measured size: 130 x 105 of the data's millimetres, a hundredth of the number in metres.
        double area = 0;
        for (const WorldTriangle& t : trianglesOf(s, instanceOf(s, "lamp"))) {
            area += length(t.area());
            CHECK(t.area().y < 0);
        }
        CHECK(area == doctest::Approx(1.3 * 1.05).epsilon(1e-6));
    }

    TEST_CASE("@cornell-spheres: closed balls that touch nothing") {
        const SceneDesc s = findBuiltin("@cornell-spheres")->make();
        for (const char* name : {"mirror ball", "glass ball"}) {
            const InstanceDesc& ball = instanceOf(s, name);
            CHECK(watertight(s.meshes[std::size_t(ball.mesh)].primitives.front()));
            CHECK(signedVolume(trianglesOf(s, ball)) == doctest::Approx(4 * std::numbers::pi / 3).epsilon(3e-4));
            const double x = ball.toWorld.m[0][3], y = ball.toWorld.m[1][3], z = ball.toWorld.m[2][3];
            CHECK(y > 1);
            CHECK(x - 1 > 0.064);
            CHECK(x + 1 < 5.56);
            CHECK(z - 1 > 0);
            CHECK(z + 1 < 5.592);
        }
        const auto &m = instanceOf(s, "mirror ball").toWorld.m, &g = instanceOf(s, "glass ball").toWorld.m;
        CHECK(std::hypot(m[0][3] - g[0][3], m[2][3] - g[2][3]) > 2);
    }

    TEST_CASE("@veach-mis: lamps of equal power, plates that mirror them to the eye") {
        const SceneDesc s = findBuiltin("@veach-mis")->make();
        const auto& camera = s.cameras.front().toWorld.m;
        const Vec3d eye{camera[0][3], camera[1][3], camera[2][3]};
        double radius = 0;
        float roughness = 0;
        for (int k = 1; k <= 4; ++k) {
            const InstanceDesc &lamp = instanceOf(s, "lamp " + std::to_string(k)), &plate = instanceOf(s, "plate " + std::to_string(k));
            const PrimitiveDesc& ball = s.meshes[std::size_t(lamp.mesh)].primitives.front();
            CHECK(watertight(ball));
            CHECK(signedVolume(trianglesOf(s, lamp)) > 0);
            const double power = std::numbers::pi * luminance(materialOf(s, lamp).emission) * shapes::area(ball);
            CHECK(power == doctest::Approx(100).epsilon(1e-6));
            const double r = length(ball.positions.front());
            CHECK(r > 2.9 * radius);
            radius = r;
            CHECK(materialOf(s, plate).roughness > roughness);
            roughness = materialOf(s, plate).roughness;
            // The law of reflection at the plate's centre, towards the point of the lamps' line straight behind it.
            const Vec3d centre = plate.toWorld.point({0, 0, 0}), up = plate.toWorld.vector({0, 1, 0});
            const Vec3d toEye = normalize(eye - centre),
                        toLamps = normalize(Vec3d{centre.x, lamp.toWorld.m[1][3], lamp.toWorld.m[2][3]} - centre);
            const Vec3d mirrored = up * (2 * dot(up, toEye)) - toEye;
            CHECK(length(mirrored - toLamps) < 1e-12);
        }
    }

    TEST_CASE("@caustic: the floor lies in the paraxial image of the lamp") {
        const SceneDesc s = findBuiltin("@caustic")->make();
        const InstanceDesc &ball = instanceOf(s, "ball"), &lamp = instanceOf(s, "lamp");
        const PrimitiveDesc& shell = s.meshes[std::size_t(ball.mesh)].primitives.front();
        CHECK(watertight(shell));
        CHECK(signedVolume(trianglesOf(s, ball)) > 0);
        const double R = length(shell.positions.front()), height = ball.toWorld.m[1][3], distance = lamp.toWorld.m[1][3] - height;
        const double n = materialOf(s, ball).ior, focal = n * R / (2 * (n - 1));
        CHECK(1 / distance + 1 / height == doctest::Approx(1 / focal).epsilon(1e-6));
        double area = 0;
        for (const WorldTriangle& t : trianglesOf(s, lamp)) {
            CHECK(t.area().y < 0);
            area += length(t.area());
        }
        // Illuminance at the ball's centre if the ball were not there, pi lux up to the 64 corners of the disc.
        const double illuminance = double(materialOf(s, lamp).emission[0]) * area / (distance * distance);
        CHECK(illuminance == doctest::Approx(std::numbers::pi).epsilon(0.002));
        REQUIRE(s.cameras.size() == 2);
        CHECK(s.cameras[1].projection == Projection::orthographic);
        CHECK(s.cameras[1].toWorld.m[1][3] < height - R);
        const Vec3d view = s.cameras[1].toWorld.vector({0, 0, -1});
        CHECK(length(view - Vec3d{0, -1, 0}) < 1e-12);
    }

    TEST_CASE("@furnace: closed, glowing inwards, flat facets") {
        const SceneDesc s = findBuiltin("@furnace")->make();
        REQUIRE(s.instances.size() == 1);
        const InstanceDesc& wall = s.instances.front();
        const PrimitiveDesc& shell = s.meshes[std::size_t(wall.mesh)].primitives.front();
        CHECK(watertight(shell));
        CHECK(shell.normals.empty());
        CHECK(signedVolume(trianglesOf(s, wall)) < 0);
        CHECK(materialOf(s, wall).emission == Spectrum{1});
        CHECK(materialOf(s, wall).baseColor == Spectrum{0.5f});
        const auto& c = s.cameras.front().toWorld.m;
        CHECK(allFace(trianglesOf(s, wall), {c[0][3], c[1][3], c[2][3]}, -1));
    }

} // TEST_SUITE
