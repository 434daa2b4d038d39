#include "scenes/shapes.h"
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace chiaro::shapes {
namespace {

using Triangle = std::array<uint32_t, 3>;

struct Ball {
    std::vector<Vec3d> vertices; // on the unit sphere
    std::vector<Triangle> triangles;
};

// The regular icosahedron: the cyclic permutations of (0, +-1, +-phi), phi the golden ratio (Euclid, Elements XIII.16).
Ball icosahedron() {
    const double phi = std::numbers::phi;
    Ball ball;
    for (const auto& [a, b] : {std::pair{1.0, phi}, {-1.0, phi}, {1.0, -phi}, {-1.0, -phi}})
        for (const Vec3d& corner : {Vec3d{0, a, b}, Vec3d{a, b, 0}, Vec3d{b, 0, a}}) ball.vertices.push_back(normalize(corner));
    // A face is three corners at the edge's distance of each other, turned outwards.
    const double edge = 2 / std::sqrt(1 + phi * phi);
    const auto joins = [&](uint32_t i, uint32_t j) { return length(ball.vertices[i] - ball.vertices[j]) < 1.01 * edge; };
    for (uint32_t i = 0; i < 12; ++i)
        for (uint32_t j = i + 1; j < 12; ++j)
            for (uint32_t k = j + 1; k < 12; ++k)
                if (joins(i, j) && joins(j, k) && joins(k, i)) {
                    const Vec3d &a = ball.vertices[i], &b = ball.vertices[j], &c = ball.vertices[k];
                    const bool outwards = dot(cross(b - a, c - a), a) > 0;
                    ball.triangles.push_back(outwards ? Triangle{i, j, k} : Triangle{i, k, j});
                }
    return ball;
}

// Each triangle in four, the midpoints of the edges lifted to the sphere; an edge's midpoint is shared by its two triangles.
Ball divided(const Ball& coarse) {
    Ball fine{coarse.vertices, {}};
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> midpoints;
    const auto midpoint = [&](uint32_t i, uint32_t j) {
        const auto [at, isNew] = midpoints.try_emplace(std::minmax(i, j), uint32_t(fine.vertices.size()));
        if (isNew) fine.vertices.push_back(normalize(coarse.vertices[i] + coarse.vertices[j]));
        return at->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
        fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    return fine;
}

} // namespace

PrimitiveDesc quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    PrimitiveDesc p;
    p.positions = {cast<float>(a), cast<float>(b), cast<float>(c), cast<float>(d)};
    p.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    p.indices = {0, 1, 2, 0, 2, 3};
    return p;
}

PrimitiveDesc box(const Vec3d& h) {
    const auto corner = [&](int x, int y, int z) { return Vec3d{x * h.x, y * h.y, z * h.z}; };
    PrimitiveDesc p;
    p = joined(std::move(p), quad(corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1)));
    p = joined(std::move(p), quad(corner(1, -1, -1), corner(-1, -1, -1), corner(-1, 1, -1), corner(1, 1, -1)));
    p = joined(std::move(p), quad(corner(1, -1, 1), corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1)));
    p = joined(std::move(p), quad(corner(-1, -1, -1), corner(-1, -1, 1), corner(-1, 1, 1), corner(-1, 1, -1)));
    p = joined(std::move(p), quad(corner(-1, 1, 1), corner(1, 1, 1), corner(1, 1, -1), corner(-1, 1, -1)));
    return joined(std::move(p), quad(corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1)));
}

PrimitiveDesc disc(double radius, int segments) {
    PrimitiveDesc p;
    p.positions.push_back({0, 0, 0});
    for (int i = 0; i < segments; ++i) {
        const double angle = 2 * std::numbers::pi * i / segments;
        p.positions.push_back({float(radius * std::sin(angle)), 0, float(radius * std::cos(angle))});
        p.indices.insert(p.indices.end(), {0, uint32_t(1 + i), uint32_t(1 + (i + 1) % segments)});
    }
    return p;
}

PrimitiveDesc sphere(double radius, int subdivisions) {
    Ball ball = icosahedron();
    for (int i = 0; i < subdivisions; ++i) ball = divided(ball);
    PrimitiveDesc p;
    for (const Vec3d& v : ball.vertices) {
        p.positions.push_back(cast<float>(v * radius));
        p.normals.push_back(cast<float>(v));
    }
    for (const Triangle& t : ball.triangles) p.indices.insert(p.indices.end(), t.begin(), t.end());
    return p;
}

PrimitiveDesc insideOut(PrimitiveDesc shape) {
    for (std::size_t i = 0; i + 2 < shape.indices.size(); i += 3) std::swap(shape.indices[i + 1], shape.indices[i + 2]);
    for (Vec3& n : shape.normals) n = -n;
    return shape;
}

PrimitiveDesc joined(PrimitiveDesc first, const PrimitiveDesc& second) {
    const auto offset = uint32_t(first.positions.size());
    first.positions.insert(first.positions.end(), second.positions.begin(), second.positions.end());
    first.normals.insert(first.normals.end(), second.normals.begin(), second.normals.end());
    first.uv[0].insert(first.uv[0].end(), second.uv[0].begin(), second.uv[0].end());
    for (uint32_t i : second.indices) first.indices.push_back(offset + i);
    return first;
}

double area(const PrimitiveDesc& shape) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < shape.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) { return cast<double>(shape.positions[shape.indices[i + k]]); };
        sum += length(cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
    }
    return sum;
}

MaterialDesc diffuse(std::string name, const Spectrum& reflectance) {
    MaterialDesc m;
    m.name = std::move(name);
    m.baseColor = reflectance;
    m.metallic = 0;
    m.specular = 0;
    m.doubleSided = true;
    return m;
}

MaterialDesc metal(std::string name, const Spectrum& atNormalIncidence, float roughness) {
    MaterialDesc m;
    m.name = std::move(name);
    m.baseColor = atNormalIncidence;
    m.roughness = roughness;
    m.doubleSided = true;
    return m;
}

MaterialDesc glass(std::string name, float ior) {
    MaterialDesc m;
    m.name = std::move(name);
    m.metallic = 0;
    m.roughness = 0;
    m.ior = ior;
    m.transmission = 1;
    m.volume = true;
    return m;
}

MaterialDesc lamp(std::string name, const Spectrum& radiance, const Spectrum& reflectance) {
    MaterialDesc m = diffuse(std::move(name), reflectance);
    m.emission = radiance;
    m.doubleSided = false;
    return m;
}

Affine translation(const Vec3d& t) { return {{{1, 0, 0, t.x}, {0, 1, 0, t.y}, {0, 0, 1, t.z}}}; }

Affine lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
    const Vec3d z = normalize(eye - target), x = normalize(cross(up, z)), y = cross(z, x);
    return {{{x.x, y.x, z.x, eye.x}, {x.y, y.y, z.y, eye.y}, {x.z, y.z, z.z, eye.z}}};
}

int add(SceneDesc& scene, MaterialDesc material) {
    scene.materials.push_back(std::move(material));
    return int(scene.materials.size()) - 1;
}

void add(SceneDesc& scene, const std::string& name, PrimitiveDesc shape, int material, const Affine& toWorld) {
    shape.material = material;
    MeshDesc mesh;
    mesh.name = name;
    mesh.primitives.push_back(std::move(shape));
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({int(scene.meshes.size()) - 1, toWorld, name});
}

void addCamera(SceneDesc& scene, const std::string& name, double yfov, const Affine& toWorld) {
    CameraDesc camera;
    camera.name = name;
    camera.yfov = yfov;
    camera.toWorld = toWorld;
    scene.cameras.push_back(std::move(camera));
}

} // namespace chiaro::shapes
