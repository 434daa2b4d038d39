#include "io/gltf_primitive.h"
#include "io/gltf_needs.h"
#include "io/gltf_winding.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace chiaro::gltf {

namespace {

constexpr int alwaysKept = 2; // UV sets that are kept whether a texture reads them or not: light is baked into one

// One primitive on its way: where it stands, for messages, and how many vertices it has.
struct Source {
    const GltfFile& from;
    const tinygltf::Primitive& primitive;
    std::string place;
    std::vector<std::string>& warnings;
    size_t vertices = 0;
    const GltfFile& file() const { return from; }
    void warn(std::string what) const { warnings.push_back(std::move(what)); }
};

bool finite(const float* v, size_t n) {
    for (size_t i = 0; i < n; ++i)
        if (!std::isfinite(v[i])) return false;
    return true;
}

// The accessor of an attribute, or null. Every attribute has as many elements as POSITION.
const Accessor* attribute(const Source& source, const std::string& name, const std::set<std::string>& types) {
    const auto found = source.primitive.attributes.find(name);
    if (found == source.primitive.attributes.end()) return nullptr;
    const std::string place = fmt::format("{}/attributes/{}", source.place, name);
    const Accessor& a = source.file().accessors[size_t(found->second)];
    if (!types.contains(a.type))
        source.file().fail(place, fmt::format("has type {}, must be {}. Export the file again.", a.type, *types.begin()));
    if (source.vertices && a.count != source.vertices)
        source.file().fail(place, fmt::format("has {} elements, POSITION has {}. Export the file again.", a.count, source.vertices));
    return &a;
}

// Its elements, each as many floats as V holds; nothing where there is no such attribute.
template <class V> std::vector<V> vectors(const Source& source, const std::string& name, const char* type, size_t spare = 0) {
    static_assert(std::is_trivially_copyable_v<V> && sizeof(V) % sizeof(float) == 0);
    const Accessor* a = attribute(source, name, {type});
    if (!a) return {};
    std::vector<V> out;
    out.reserve(a->count + spare);
    out.resize(a->count);
    readFloats(source.file(), size_t(source.primitive.attributes.at(name)),
               {reinterpret_cast<float*>(out.data()), out.size() * sizeof(V) / sizeof(float)});
    return out;
}

std::vector<Vec3> positions(const Source& source) {
    std::vector<Vec3> out = vectors<Vec3>(source, "POSITION", "VEC3", 1); // room for one more: Scene::compile adds it
    for (size_t i = 0; i < out.size(); ++i)
        if (!chiaro::finite(out[i]) || maxAbs(out[i]) > 1e18f) // a BVH squares it
            source.file().fail(
                source.place + "/attributes/POSITION",
                fmt::format("vertex {} is ({}, {}, {}). Mend the mesh and export it again.", i, out[i].x, out[i].y, out[i].z));
    return out;
}

std::vector<Point2> texCoords(const Source& source, int set) {
    std::vector<Point2> out = vectors<Point2>(source, fmt::format("TEXCOORD_{}", set), "VEC2");
    size_t bad = 0;
    for (Point2& p : out) {
        if (std::isfinite(p.x) && std::isfinite(p.y)) continue;
        p = {};
        ++bad;
    }
    if (bad)
        source.warn(fmt::format("{}/attributes/TEXCOORD_{} has {} elements that are not finite; they became 0.", source.place, set, bad));
    return out;
}

// COLOR_0 is linear and, when it is an integer, always normalized, whether the accessor says so or not.
std::vector<Vec4> colors(const Source& source) {
    const Accessor* found = attribute(source, "COLOR_0", {"VEC3", "VEC4"});
    if (!found) return {};
    const Accessor& a = *found;
    const std::vector<float> numbers = readFloats(source.file(), size_t(source.primitive.attributes.at("COLOR_0")));
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
    p.normals = vectors<Vec3>(source, "NORMAL", "VEC3");
    std::vector<bool> bad(p.normals.size());
    size_t count = 0;
    for (size_t i = 0; i < p.normals.size(); ++i) {
        const Vec3d n = cast<double>(p.normals[i]);
        const double size = length(n);
        bad[i] = !(size > 0 && std::isfinite(size));
        count += bad[i];
        p.normals[i] = bad[i] ? Vec3{} : cast<float>(n * (1 / size));
    }
    if (!count) return;
    source.warn(
        fmt::format("{}/attributes/NORMAL has {} elements that are no direction; the faces' normals stand in.", source.place, count));
    repairNormals(p, bad);
}

void readTangents(const Source& source, PrimitiveDesc& p) {
    p.tangents = vectors<Vec4>(source, "TANGENT", "VEC4");
    for (size_t i = 0; i < p.tangents.size(); ++i) {
        Vec4& tangent = p.tangents[i];
        const Vec3d t{tangent.x, tangent.y, tangent.z};
        const double size = length(t);
        if (!(size > 0 && std::isfinite(size))) {
            source.warn(
                fmt::format("{}/attributes/TANGENT element {} is no direction; the tangents follow from the texture coordinates instead.",
                            source.place, i));
            p.tangents.clear();
            return;
        }
        tangent = {float(t.x / size), float(t.y / size), float(t.z / size), tangent.w < 0 ? -1.f : 1.f};
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
        const uint32_t restart = a.component == 5121 ? 0xffu : a.component == 5123 ? 0xffffu : 0xffffffffu;
        for (size_t i = 0; i < v.size(); ++i) {
            if (v[i] == restart) // glTF 3.7.2.1
                file.fail(place, fmt::format("element {} is {}, by which some programs restart a strip; glTF has no such thing. Export the "
                                             "file with separate primitives.",
                                             i, restart));
            if (v[i] >= source.vertices)
                file.fail(place, fmt::format("element {} names vertex {} of {}. Export the file again.", i, v[i], source.vertices));
        }
    } else {
        v.resize(source.vertices);
        for (size_t i = 0; i < v.size(); ++i) v[i] = uint32_t(i);
    }
    if (source.primitive.mode != TINYGLTF_MODE_TRIANGLES) return toTriangles(v, source.primitive.mode);
    if (v.size() % 3) source.warn(fmt::format("{} has {} indices, no multiple of three; the rest is left out.", source.place, v.size()));
    v.resize(v.size() / 3 * 3);
    return v;
}

template <class T> void keep(std::vector<T>& values, const std::vector<uint32_t>& from, size_t spare = 0) {
    if (values.empty()) return;
    std::vector<T> kept;
    kept.reserve(from.size() + spare);
    for (const uint32_t i : from) kept.push_back(values[i]);
    values = std::move(kept);
}

// Primitives often share one large vertex buffer, each using a part of it: keep that part. Which vertices were kept; empty: all.
std::vector<uint32_t> dropUnusedVertices(PrimitiveDesc& p) {
    std::vector<bool> used(p.positions.size());
    for (const uint32_t v : p.indices) used[v] = true;
    const auto count = size_t(std::count(used.begin(), used.end(), true));
    if (count == p.positions.size()) return {};
    std::vector<uint32_t> fresh(p.positions.size()), from;
    from.reserve(count);
    for (size_t i = 0; i < fresh.size(); ++i)
        if (used[i]) {
            fresh[i] = uint32_t(from.size());
            from.push_back(uint32_t(i));
        }
    for (uint32_t& v : p.indices) v = fresh[v];
    keep(p.positions, from, 1);
    keep(p.normals, from);
    keep(p.tangents, from);
    for (auto& uv : p.uv) keep(uv, from);
    keep(p.colors, from);
    return from;
}

// Tangents where the material asks for them and the file has none. A vertex whose corners need several gets a copy for each but the first.
void makeTangents(ReadPrimitive& read, int set) {
    PrimitiveDesc& p = read.desc;
    if (!p.tangents.empty() || p.uv[set].empty()) return;
    auto space = std::make_shared<TangentSpace>(p.positions, p.normals, p.uv[set], p.indices);
    constexpr uint32_t none = ~0u;
    std::vector<uint32_t> from(p.positions.size()), group(p.positions.size(), none);
    for (size_t v = 0; v < from.size(); ++v) from[v] = uint32_t(v);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies; // of a vertex for a group
    for (size_t c = 0; c < p.indices.size(); ++c) {
        const uint32_t v = p.indices[c], g = space->group(c);
        if (group[v] == none) group[v] = g;
        if (group[v] == g) continue;
        const auto [copy, isNew] = copies.try_emplace({v, g}, uint32_t(from.size()));
        if (isNew) {
            from.push_back(v);
            group.push_back(g);
        }
        p.indices[c] = copy->second;
    }
    const std::vector<Vec4> tangents = space->tangents(p.positions, p.normals); // by the corners as they were
    if (from.size() > p.positions.size()) {
        keep(p.positions, from, 1);
        keep(p.normals, from);
        for (auto& uv : p.uv) keep(uv, from);
        keep(p.colors, from);
        if (read.kept.empty())
            read.kept = from;
        else
            keep(read.kept, from);
        space->renumber(p.indices);
    }
    for (const uint32_t g : group) p.tangents.push_back(tangents[g == none ? 0 : g]);
    read.tangentSpace = std::move(space);
    read.tangentGroup = std::move(group);
}

void warnUnknownAttributes(const Source& source) {
    static const std::set<std::string> known = {"POSITION", "NORMAL", "TANGENT", "COLOR_0"};
    for (const auto& [name, accessor] : source.primitive.attributes)
        if (!known.contains(name) && !name.starts_with("_") && !name.starts_with("TEXCOORD_") && !name.starts_with("JOINTS_") &&
            !name.starts_with("WEIGHTS_"))
            source.warn(fmt::format("has vertex attribute {}, which is not applied.", shown(name)));
}

// Of a solid all faces must look outwards.
void warnTurnedFaces(const Source& source, const PrimitiveDesc& p) {
    const size_t turned = turnedEdges(p);
    if (turned == 0) return;
    source.warn(fmt::format("{} is a solid (KHR_materials_volume) whose faces do not agree on what is outside, at {} {}: light that enters "
                            "by a turned face is refracted as if it left. Recalculate the outside of the mesh and export it again.",
                            source.place, turned, turned == 1 ? "edge" : "edges"));
}

} // namespace

ReadPrimitive readPrimitive(const GltfFile& file, const tinygltf::Primitive& primitive, const std::string& place) {
    ReadPrimitive read;
    Source source{file, primitive, place, read.warnings};
    PrimitiveDesc& p = read.desc;
    p.positions = positions(source);
    source.vertices = p.positions.size();
    p.indices = triangles(source);
    readNormals(source, p);
    if (!p.normals.empty()) readTangents(source, p); // flat normals come with tangents of their own (glTF 3.7.2.1)
    const VertexNeeds needs = needsOf(file, primitive.material);
    for (int set = 0; set < uvSets; ++set)
        if (set < alwaysKept || needs.uv[size_t(set)]) p.uv[set] = texCoords(source, set);
    p.colors = colors(source);
    warnUnknownAttributes(source);
    if (needs.solid) warnTurnedFaces(source, p);
    if (p.indices.empty())
        source.warn(fmt::format("{} has no triangle.", place));
    else
        read.kept = dropUnusedVertices(p);
    if (needs.frame) makeTangents(read, *needs.frame);
    return read;
}

size_t vertexBytes(const GltfFile& file, const tinygltf::Primitive& primitive) {
    static constexpr std::pair<const char*, size_t> kept[] = {
        {"POSITION", sizeof(Vec3)}, {"NORMAL", sizeof(Vec3)}, {"TANGENT", sizeof(Vec4)}, {"COLOR_0", sizeof(Vec4)}};
    const auto has = [&](const std::string& name) { return primitive.attributes.contains(name); };
    const VertexNeeds needs = needsOf(file, primitive.material);
    size_t sum = 0;
    for (const auto& [name, bytes] : kept)
        if (has(name)) sum += bytes;
    for (int set = 0; set < uvSets; ++set)
        if (has(fmt::format("TEXCOORD_{}", set)) && (set < alwaysKept || needs.uv[size_t(set)])) sum += sizeof(Point2);
    if (needs.frame && !has("TANGENT") && has(fmt::format("TEXCOORD_{}", *needs.frame))) sum += sizeof(Vec4);
    return sum;
}

} // namespace chiaro::gltf
