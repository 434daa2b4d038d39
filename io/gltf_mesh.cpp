#include "io/gltf_file.h"
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace chiaro::gltf {

namespace {

// One primitive on its way: where it stands, for messages, and how many vertices it has.
struct Source {
    Conversion& to;
    const tinygltf::Primitive& primitive;
    std::string place;
    size_t vertices = 0;
    const GltfFile& file() const { return to.file; }
};

bool finite(const float* v, size_t n) {
    for (size_t i = 0; i < n; ++i)
        if (!std::isfinite(v[i])) return false;
    return true;
}

// The numbers of an attribute, or nothing where there is none. Every attribute has as many elements as POSITION.
std::vector<float> attribute(const Source& source, const std::string& name, const std::set<std::string>& types) {
    const auto found = source.primitive.attributes.find(name);
    if (found == source.primitive.attributes.end()) return {};
    const std::string place = fmt::format("{}/attributes/{}", source.place, name);
    const Accessor& a = source.file().accessors[size_t(found->second)];
    if (!types.contains(a.type))
        source.file().fail(place, fmt::format("has type {}, must be {}. Export the file again.", a.type, *types.begin()));
    if (source.vertices && a.count != source.vertices)
        source.file().fail(place, fmt::format("has {} elements, POSITION has {}. Export the file again.", a.count, source.vertices));
    return readFloats(source.file(), size_t(found->second));
}

std::vector<Vec3> positions(const Source& source) {
    const std::vector<float> numbers = attribute(source, "POSITION", {"VEC3"});
    std::vector<Vec3> out(numbers.size() / 3);
    for (size_t i = 0; i < out.size(); ++i) {
        out[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
        if (!finite(&numbers[3 * i], 3) || maxAbs(out[i]) > 1e18f) // a BVH squares it
            source.file().fail(
                source.place + "/attributes/POSITION",
                fmt::format("vertex {} is ({}, {}, {}). Mend the mesh and export it again.", i, out[i].x, out[i].y, out[i].z));
    }
    return out;
}

std::vector<Point2> texCoords(const Source& source, int set) {
    const std::vector<float> numbers = attribute(source, fmt::format("TEXCOORD_{}", set), {"VEC2"});
    std::vector<Point2> out(numbers.size() / 2);
    size_t bad = 0;
    for (size_t i = 0; i < out.size(); ++i) {
        if (finite(&numbers[2 * i], 2))
            out[i] = {numbers[2 * i], numbers[2 * i + 1]};
        else
            ++bad;
    }
    if (bad)
        source.file().warn(
            fmt::format("{}/attributes/TEXCOORD_{} has {} elements that are not finite; they became 0.", source.place, set, bad));
    return out;
}

// COLOR_0 is linear and, when it is an integer, always normalized, whether the accessor says so or not.
std::vector<Vec4> colors(const Source& source) {
    const auto found = source.primitive.attributes.find("COLOR_0");
    const std::vector<float> numbers = attribute(source, "COLOR_0", {"VEC3", "VEC4"});
    if (numbers.empty()) return {};
    const Accessor& a = source.file().accessors[size_t(found->second)];
    const float unit = a.normalized || a.component == 5126 ? 1.f
                       : a.component == 5121               ? 1 / 255.f
                       : a.component == 5123               ? 1 / 65535.f
                                                           : 1.f;
    const size_t width = size_t(a.width);
    std::vector<Vec4> out(a.count);
    for (size_t i = 0; i < out.size(); ++i) {
        const float* c = &numbers[i * width];
        if (!finite(c, width))
            source.file().fail(source.place + "/attributes/COLOR_0",
                               fmt::format("element {} is not finite. Mend the mesh and export it again.", i));
        const auto positive = [&](float v) { return std::max(v * unit, 0.f); };
        out[i] = {positive(c[0]), positive(c[1]), positive(c[2]), width == 4 ? positive(c[3]) : 1.f};
    }
    return out;
}

// A vertex whose normal is no direction gets the area-weighted mean of its faces' normals.
void repairNormals(PrimitiveDesc& p, const std::vector<bool>& bad) {
    for (size_t i = 0; i + 2 < p.indices.size(); i += 3) {
        const uint32_t* v = &p.indices[i];
        if (!bad[v[0]] && !bad[v[1]] && !bad[v[2]]) continue;
        const Vec3 face = cross(p.positions[v[1]] - p.positions[v[0]], p.positions[v[2]] - p.positions[v[0]]);
        for (int k = 0; k < 3; ++k)
            if (bad[v[k]] && chiaro::finite(face)) p.normals[v[k]] += face;
    }
    for (size_t i = 0; i < bad.size(); ++i)
        if (bad[i]) {
            const float size = length(p.normals[i]);
            p.normals[i] = size > 0 && std::isfinite(size) ? p.normals[i] * (1 / size) : Vec3{0, 1, 0};
        }
}

void readNormals(const Source& source, PrimitiveDesc& p) {
    const std::vector<float> numbers = attribute(source, "NORMAL", {"VEC3"});
    if (numbers.empty()) return;
    p.normals.resize(source.vertices);
    std::vector<bool> bad(source.vertices);
    size_t count = 0;
    for (size_t i = 0; i < p.normals.size(); ++i) {
        const Vec3d n{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
        const double size = length(n);
        bad[i] = !(size > 0 && std::isfinite(size));
        count += bad[i];
        if (!bad[i]) p.normals[i] = cast<float>(n * (1 / size));
    }
    if (!count) return;
    source.file().warn(
        fmt::format("{}/attributes/NORMAL has {} elements that are no direction; the faces' normals stand in.", source.place, count));
    repairNormals(p, bad);
}

void readTangents(const Source& source, PrimitiveDesc& p) {
    const std::vector<float> numbers = attribute(source, "TANGENT", {"VEC4"});
    p.tangents.resize(numbers.size() / 4);
    for (size_t i = 0; i < p.tangents.size(); ++i) {
        const Vec3d t{numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]};
        const double size = length(t);
        if (!(size > 0 && std::isfinite(size))) {
            source.file().warn(
                fmt::format("{}/attributes/TANGENT element {} is no direction; the tangents follow from the texture coordinates instead.",
                            source.place, i));
            p.tangents.clear();
            return;
        }
        p.tangents[i] = {float(t.x / size), float(t.y / size), float(t.z / size), numbers[4 * i + 3] < 0 ? -1.f : 1.f};
    }
}

// glTF 3.7.2.1, equations for strips and fans. Triangles with a repeated index only joined strips.
std::vector<uint32_t> toTriangles(const std::vector<uint32_t>& v, int mode) {
    std::vector<uint32_t> out;
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        if (a != b && b != c && c != a) out.insert(out.end(), {a, b, c});
    };
    for (size_t i = 0; i + 2 < v.size(); ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            add(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
        else
            add(v[i + 1], v[i + 2], v[0]);
    }
    return out;
}

std::vector<uint32_t> triangles(const Source& source) {
    const GltfFile& file = source.file();
    std::vector<uint32_t> v;
    if (source.primitive.indices >= 0) {
        const Accessor& a = file.accessors[size_t(source.primitive.indices)];
        const std::string place = source.place + "/indices";
        if (a.type != "SCALAR" || (a.component != 5121 && a.component != 5123 && a.component != 5125))
            file.fail(place, fmt::format("has type {} of component {}, must be SCALAR of 5121, 5123 or 5125. Export the file again.",
                                         a.type, a.component));
        v = readIndices(file, size_t(source.primitive.indices));
        for (size_t i = 0; i < v.size(); ++i)
            if (v[i] >= source.vertices)
                file.fail(place, fmt::format("element {} names vertex {} of {}. Export the file again.", i, v[i], source.vertices));
    } else {
        v.resize(source.vertices);
        for (size_t i = 0; i < v.size(); ++i) v[i] = uint32_t(i);
    }
    if (source.primitive.mode != TINYGLTF_MODE_TRIANGLES) return toTriangles(v, source.primitive.mode);
    if (v.size() % 3) file.warn(fmt::format("{} has {} indices, no multiple of three; the rest is left out.", source.place, v.size()));
    v.resize(v.size() / 3 * 3);
    return v;
}

template <class T> void keep(std::vector<T>& values, const std::vector<uint32_t>& from) {
    if (values.empty()) return;
    std::vector<T> kept(from.size());
    for (size_t i = 0; i < from.size(); ++i) kept[i] = values[from[i]];
    values = std::move(kept);
}

// Primitives often share one large vertex buffer, each using a part of it: keep that part. Which vertices were kept; empty: all.
std::vector<uint32_t> dropUnusedVertices(PrimitiveDesc& p) {
    std::vector<uint32_t> fresh(p.positions.size(), 0), from;
    for (const uint32_t v : p.indices) fresh[v] = 1;
    for (size_t i = 0; i < fresh.size(); ++i)
        if (fresh[i]) {
            fresh[i] = uint32_t(from.size());
            from.push_back(uint32_t(i));
        }
    if (from.size() == p.positions.size()) return {};
    for (uint32_t& v : p.indices) v = fresh[v];
    keep(p.positions, from);
    keep(p.normals, from);
    keep(p.tangents, from);
    keep(p.uv[0], from);
    keep(p.uv[1], from);
    keep(p.colors, from);
    return from;
}

void warnUnknownAttributes(const Source& source) {
    static const std::set<std::string> known = {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
    for (const auto& [name, accessor] : source.primitive.attributes)
        if (!known.contains(name) && !name.starts_with("_") && !name.starts_with("TEXCOORD_") && !name.starts_with("JOINTS_") &&
            !name.starts_with("WEIGHTS_"))
            source.file().warn(fmt::format("has vertex attribute {}, which is not applied.", shown(name)));
}

// Before anything is allocated.
void countElements(Source& source, uint64_t vertices) {
    Conversion& to = source.to;
    const uint64_t indices = source.primitive.indices >= 0 ? source.file().accessors[size_t(source.primitive.indices)].count : vertices;
    to.verticesRead += vertices;
    to.indices += indices * (source.primitive.mode == TINYGLTF_MODE_TRIANGLES ? 1 : 3);
    if (to.verticesRead > maxVerticesRead || to.vertices + std::min(vertices, indices) > freeVertices + to.bufferBytes / 4 ||
        to.indices > freeIndices + 3 * to.bufferBytes)
        source.file().fail(
            source.place,
            fmt::format("brings the meshes to {} vertices and {} indices, more than {} bytes of buffers can mean. Split the scene.",
                        to.vertices + std::min(vertices, indices), to.indices, to.bufferBytes));
}

void convertPrimitive(Source& source, MeshDesc& mesh, GltfOrigin::Primitive& origin) {
    const GltfFile& file = source.file();
    if (source.primitive.mode < TINYGLTF_MODE_TRIANGLES) return file.warn("has points or lines, which are not drawn.");
    const auto position = source.primitive.attributes.find("POSITION");
    if (position == source.primitive.attributes.end()) return file.warn(fmt::format("{} has no POSITION and is not drawn.", source.place));
    countElements(source, file.accessors[size_t(position->second)].count);
    PrimitiveDesc p;
    p.positions = positions(source);
    source.vertices = p.positions.size();
    p.indices = triangles(source);
    readNormals(source, p);
    readTangents(source, p);
    for (int set = 0; set < 2; ++set) p.uv[set] = texCoords(source, set);
    p.colors = colors(source);
    warnUnknownAttributes(source);
    if (p.indices.empty()) return file.warn(fmt::format("{} has no triangle.", source.place));
    origin.vertices = dropUnusedVertices(p);
    source.to.vertices += p.positions.size();
    if (source.primitive.material >= 0) p.material = convertMaterial(source.to, source.primitive.material);
    mesh.primitives.push_back(std::move(p));
}

} // namespace

int convertMesh(Conversion& to, int mesh) {
    int& converted = to.meshes[size_t(mesh)];
    if (converted >= 0) return converted;
    const tinygltf::Mesh& from = to.file.model.meshes[size_t(mesh)];
    MeshDesc desc;
    desc.name = from.name;
    std::vector<GltfOrigin::Primitive> origin;
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        Source source{to, from.primitives[i], fmt::format("/meshes/{}/primitives/{}", mesh, i)};
        if (!from.primitives[i].targets.empty()) to.file.warn("has morph targets, which are not applied.");
        GltfOrigin::Primitive part{i, {}};
        convertPrimitive(source, desc, part);
        if (desc.primitives.size() > origin.size()) origin.push_back(std::move(part));
    }
    to.scene.meshes.push_back(std::move(desc));
    to.origin.meshes.push_back(std::move(origin));
    return converted = int(to.scene.meshes.size()) - 1;
}

} // namespace chiaro::gltf
