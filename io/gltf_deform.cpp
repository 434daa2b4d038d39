#include "io/gltf_deform.h"
#include "core/render/in_parallel.h"
#include "core/scene/motion.h"
#include "io/gltf_animation.h"
#include "io/gltf_mesh.h"
#include "io/gltf_morph.h"
#include "io/gltf_skin.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::gltf {

namespace {

// Vertices of all shapes together above which a scene is refused or has its blur coarsened.
constexpr uint64_t maxShapeVertices = uint64_t(1) << 26;

// One primitive of the mesh.
struct Part {
    const ReadPrimitive* base = nullptr;
    size_t number = 0; // in the mesh of the file
    std::string place;
    std::vector<MorphTarget> targets;
    Influences influences;
    bool mirrored = false; // its joints turn it inside out
    size_t vertices() const { return base->desc.positions.size(); }
};

class Deformer {
public:
    Deformer(Conversion& to, size_t node, const Deformation& by, const Path& path) : to_(to), node_(node), by_(by), path_(path) {
        if (by_.skin < 0) return;
        anchor_ = to.joints.at(jointsOf(to.file, size_t(by_.skin)).front()).opening().point({0, 0, 0});
        maps_ = skinMaps(to.file, size_t(by_.skin), to.joints, anchor_);
    }
    DeformedMesh convert(int mesh);

private:
    void addPart(int mesh, size_t number, const ReadPrimitive&);
    size_t samples() const;
    Vec3d morphed(const Part&, size_t vertex, size_t sample) const;
    Affine blended(const Part&, size_t vertex, size_t sample) const;
    Vec3d placed(const Part& part, size_t vertex, size_t sample) const {
        const Vec3d p = morphed(part, vertex, sample);
        return by_.skin < 0 ? p : blended(part, vertex, sample).point(p);
    }
    ShapeDesc shape(Part&, size_t sample) const;
    void morphLooks(const Part&, PrimitiveDesc&) const;
    void morphDirections(const Part&, size_t sample, ShapeDesc&) const;
    void skin(Part&, size_t sample, ShapeDesc&) const;
    void check(const ShapeDesc&) const;
    size_t segments();
    size_t withinLimits(size_t segments);
    std::string where() const { return fmt::format("/nodes/{}", node_); }

    Conversion& to_;
    size_t node_;
    const Deformation& by_;
    const Path& path_;
    Vec3d anchor_;
    std::vector<Path> maps_; // of the joints
    std::vector<Part> parts_;
};

size_t Deformer::samples() const {
    bool moves = by_.weights.size() > 1;
    for (const Path& map : maps_) moves |= !map.rests();
    if (by_.skin >= 0)
        for (const Part& part : parts_) moves |= part.influences.each == 0 && !path_.rests();
    return moves ? Path::samples : 1;
}

Vec3d Deformer::morphed(const Part& part, size_t vertex, size_t sample) const {
    Vec3d p = cast<double>(part.base->desc.positions[vertex]);
    for (size_t k = 0; k < part.targets.size(); ++k)
        if (!part.targets[k].positions.empty())
            p += cast<double>(part.targets[k].positions[vertex]) * by_.weights[by_.weights.size() == 1 ? 0 : sample][k];
    return p;
}

// Without joints a primitive goes where the node goes.
Affine Deformer::blended(const Part& part, size_t vertex, size_t sample) const {
    const Influences& all = part.influences;
    Affine sum;
    if (all.each == 0) {
        sum = path_[sample];
        sum.m[0][3] -= anchor_.x, sum.m[1][3] -= anchor_.y, sum.m[2][3] -= anchor_.z;
        return sum;
    }
    for (auto& row : sum.m) std::fill(std::begin(row), std::end(row), 0.0);
    for (size_t k = vertex * all.each; k < (vertex + 1) * all.each; ++k) {
        if (all.weights[k] == 0) continue;
        const Affine& m = maps_[all.joints[k]][sample];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j) sum.m[i][j] += m.m[i][j] * double(all.weights[k]);
    }
    return sum;
}

Vec3 unitOrZero(const Vec3d& v) {
    const double l = length(v);
    return l > 0 && std::isfinite(l) ? cast<float>(v * (1 / l)) : Vec3{};
}

// Normals and tangents of the morphed mesh. Tangents that were made from the texture coordinates are made again (glTF 3.7.2.2).
void Deformer::morphDirections(const Part& part, size_t sample, ShapeDesc& shape) const {
    const auto& weights = by_.weights.empty() ? std::vector<double>() : by_.weights[by_.weights.size() == 1 ? 0 : sample];
    const auto add = [&](Vec3d& v, std::vector<Vec3> MorphTarget::*deltas, size_t i) {
        for (size_t k = 0; k < part.targets.size(); ++k)
            if (const auto& d = part.targets[k].*deltas; !d.empty()) v += cast<double>(d[i]) * weights[k];
    };
    for (size_t i = 0; i < shape.normals.size(); ++i) {
        Vec3d n = cast<double>(shape.normals[i]);
        add(n, &MorphTarget::normals, i);
        if (const Vec3 unit = unitOrZero(n); lengthSquared(unit) > 0) shape.normals[i] = unit;
    }
    if (part.base->tangentSpace) {
        const std::vector<Vec4> made = part.base->tangentSpace->tangents(shape.positions, shape.normals);
        for (size_t i = 0; i < shape.tangents.size(); ++i) shape.tangents[i] = made[part.base->tangentGroup[i]];
        return;
    }
    for (size_t i = 0; i < shape.tangents.size(); ++i) {
        Vec4& t = shape.tangents[i];
        Vec3d along{double(t.x), double(t.y), double(t.z)};
        add(along, &MorphTarget::tangents, i);
        if (const Vec3 unit = unitOrZero(along); lengthSquared(unit) > 0) t = {unit.x, unit.y, unit.z, t.w};
    }
}

void Deformer::skin(Part& part, size_t sample, ShapeDesc& shape) const {
    size_t mirrored = 0;
    for (size_t i = 0; i < shape.positions.size(); ++i) {
        const Affine m = blended(part, i, sample);
        const bool flip = m.determinant() < 0;
        mirrored += flip;
        shape.positions[i] = cast<float>(m.point(morphed(part, i, sample)));
        if (!shape.normals.empty()) shape.normals[i] = unitOrZero(m.normal(cast<double>(shape.normals[i])) * (flip ? -1 : 1));
        if (shape.tangents.empty()) continue;
        Vec4& t = shape.tangents[i];
        const Vec3 along = unitOrZero(m.vector({double(t.x), double(t.y), double(t.z)}));
        t = {along.x, along.y, along.z, flip ? -t.w : t.w};
    }
    if (sample == 0) part.mirrored = 2 * mirrored > shape.positions.size();
}

ShapeDesc Deformer::shape(Part& part, size_t sample) const {
    const PrimitiveDesc& base = part.base->desc;
    ShapeDesc s;
    s.positions.reserve(base.positions.size() + 1); // Scene::compile adds one
    for (size_t i = 0; i < base.positions.size(); ++i) s.positions.push_back(cast<float>(morphed(part, i, sample)));
    s.normals = base.normals;
    s.tangents = base.tangents;
    if (!part.targets.empty()) morphDirections(part, sample, s);
    if (by_.skin >= 0) skin(part, sample, s);
    check(s);
    return s;
}

// Texture coordinates and colours of the morphed mesh: as they are half way through the shutter.
void Deformer::morphLooks(const Part& part, PrimitiveDesc& p) const {
    if (std::none_of(part.targets.begin(), part.targets.end(), [](const MorphTarget& t) { return t.looks(); })) return;
    const std::vector<double>& weights = by_.weights[by_.weights.size() / 2];
    for (size_t k = 0; k < part.targets.size(); ++k) {
        const MorphTarget& t = part.targets[k];
        const auto w = float(weights[k]);
        for (size_t set = 0; set < uvSets; ++set)
            for (size_t i = 0; i < t.uv[set].size(); ++i)
                p.uv[set][i] = {p.uv[set][i].x + w * t.uv[set][i].x, p.uv[set][i].y + w * t.uv[set][i].y};
        for (size_t i = 0; i < t.colors.size(); ++i) {
            const Vec4 &c = p.colors[i], &d = t.colors[i];
            p.colors[i] = {c.x + w * d.x, c.y + w * d.y, c.z + w * d.z, c.w + w * d.w};
        }
    }
    const auto finite = [](const auto&... x) { return (std::isfinite(x) && ...); };
    for (auto& uv : p.uv)
        for (Point2& at : uv)
            if (!finite(at.x, at.y)) to_.file.fail(where(), "takes texture coordinates beyond all numbers. Mend the morph targets.");
    for (Vec4& c : p.colors) c = {clamp01(c.x), clamp01(c.y), clamp01(c.z), clamp01(c.w)}; // glTF 3.7.2.2
    if (by_.weights.size() > 1)
        to_.file.warn(fmt::format("{} changes texture coordinates or colours while the shutter is open; they stay as they are half way.",
                                  part.place));
}

void Deformer::check(const ShapeDesc& shape) const {
    for (const Vec3& p : shape.positions)
        if (!chiaro::finite(p) || maxAbs(p) > 1e18f) // a BVH squares it
            to_.file.fail(where(),
                          "takes its mesh beyond 1e18 m, or not to a number. Mend the joints and morph targets and export it again.");
}

// How many equal steps of the shutter follow the vertices closely; some thousand of them tell.
size_t Deformer::segments() {
    const size_t count = samples();
    if (count == 1) return 0;
    size_t total = 0;
    for (const Part& part : parts_) total += part.vertices();
    const size_t stride = std::max<size_t>(1, total / 1024);
    std::vector<std::vector<Vec3d>> ways; // of each vertex that is asked
    double way = 0, size = 0;
    for (const Part& part : parts_)
        for (size_t v = 0; v < part.vertices(); v += stride) {
            std::vector<Vec3d> at;
            for (size_t i = 0; i < count; ++i) at.push_back(placed(part, v, i));
            for (const Vec3d& p : at) {
                way = std::max(way, length(p - at.front()));
                size = std::max(size, maxAbs(p));
            }
            ways.push_back(std::move(at));
        }
    if (way == 0) return 0;
    constexpr size_t most = Motion::mostKeys - 1;
    double off = 0;
    for (size_t segments = 1;; segments *= 2) {
        off = 0;
        const size_t each = (count - 1) / segments;
        for (const auto& at : ways)
            for (size_t i = 0; i < count; ++i) {
                const size_t first = std::min(i / each, segments - 1) * each;
                const double share = double(i - first) / double(each);
                off = std::max(off, length(at[i] - (at[first] * (1 - share) + at[first + each] * share)));
            }
        if (off <= 5e-4 * way + 1e-6 * size) return segments;
        if (segments == most) break;
    }
    if (off > 1e-2 * way)
        to_.file.warn(fmt::format("{} changes its shape by jumps while the shutter is open: in {} steps its blur is off by {:.2g} of the "
                                  "way. Shorten --shutter.",
                                  where(), most, off / way));
    return most;
}

// Before anything is allocated.
size_t Deformer::withinLimits(size_t segments) {
    uint64_t vertices = 0, indices = 0, bytes = 0;
    for (const Part& part : parts_) {
        const PrimitiveDesc& base = part.base->desc;
        vertices += part.vertices();
        indices += base.indices.size();
        bytes += part.vertices() * (sizeof(Vec3) + (base.normals.empty() ? 0 : sizeof(Vec3)) + (base.tangents.empty() ? 0 : sizeof(Vec4)));
    }
    const size_t wanted = segments;
    while (segments > 0 && to_.shapeVertices + vertices * (segments + 1) + indices > maxShapeVertices) segments /= 2;
    to_.shapeVertices += vertices * (segments + 1) + indices;
    if (to_.shapeVertices > maxShapeVertices)
        to_.file.fail(where(), fmt::format("brings what skins and morph targets make to {} vertices and indices, more than {}. Split the "
                                           "scene.",
                                           to_.shapeVertices, maxShapeVertices));
    if (segments < wanted)
        to_.file.warn(
            fmt::format("{} has too many vertices for {} shapes over the shutter; its blur has {}.", where(), wanted + 1, segments + 1));
    to_.sizes.vertexBytes += bytes * (segments + 1) + vertices * sizeof(Point2) * 2;
    to_.sizes.triangles += indices / 3;
    if (to_.options.admit) to_.options.admit(to_.sizes);
    return segments;
}

void Deformer::addPart(int mesh, size_t number, const ReadPrimitive& base) {
    const tinygltf::Primitive& from = to_.file.model.meshes[size_t(mesh)].primitives[number];
    Part part;
    part.base = &base;
    part.number = number;
    part.place = placeOf(size_t(mesh), number);
    to_.verticesRead += to_.file.accessors[size_t(from.attributes.at("POSITION"))].count * (1 + 5 * by_.targets.size());
    if (to_.verticesRead > maxVerticesRead)
        to_.file.fail(part.place,
                      fmt::format("brings what is read for skins and morph targets above {} vertices. Split the scene.", maxVerticesRead));
    part.targets = readMorphTargets(to_, from, base, part.place, by_.targets);
    if (by_.skin >= 0) part.influences = readInfluences(to_.file, from, base, part.place, maps_.size());
    if (by_.skin >= 0 && part.influences.each == 0)
        to_.file.warn(fmt::format("{} has a skin but no JOINTS_0; it follows its node.", part.place));
    parts_.push_back(std::move(part));
}

DeformedMesh Deformer::convert(int mesh) {
    const int first = to_.sameAs[size_t(mesh)];
    const std::vector<ReadPrimitive>& read = to_.read.at(first);
    nameLeftOut(to_.file, first, read);
    for (size_t i = 0; i < read.size(); ++i)
        if (!read[i].desc.indices.empty()) addPart(first, i, read[i]);
    if (parts_.empty()) return {};
    const size_t steps = withinLimits(segments());
    std::vector<std::vector<ShapeDesc>> shapes(parts_.size(), std::vector<ShapeDesc>(steps + 1));
    inParallel(to_.options.run, parts_.size() * (steps + 1), [&](uint64_t i) {
        const size_t part = i / (steps + 1), step = i % (steps + 1);
        shapes[part][step] = shape(parts_[part], steps ? step * (Path::samples - 1) / steps : 0);
    });
    MeshDesc desc;
    desc.name = to_.file.model.meshes[size_t(mesh)].name;
    std::vector<GltfOrigin::Primitive> origin;
    for (size_t k = 0; k < parts_.size(); ++k) {
        const PrimitiveDesc& base = parts_[k].base->desc;
        PrimitiveDesc p;
        for (int set = 0; set < uvSets; ++set) p.uv[set] = base.uv[set];
        p.colors = base.colors;
        morphLooks(parts_[k], p);
        p.indices = base.indices;
        if (parts_[k].mirrored)
            for (size_t i = 0; i + 2 < p.indices.size(); i += 3) std::swap(p.indices[i + 1], p.indices[i + 2]);
        ShapeDesc& opening = shapes[k].front();
        p.positions = std::move(opening.positions);
        p.normals = std::move(opening.normals);
        p.tangents = std::move(opening.tangents);
        p.steps.assign(std::make_move_iterator(shapes[k].begin() + 1), std::make_move_iterator(shapes[k].end()));
        const int material = to_.file.model.meshes[size_t(first)].primitives[parts_[k].number].material;
        if (material >= 0) p.material = convertMaterial(to_, material);
        desc.primitives.push_back(std::move(p));
        origin.push_back({parts_[k].number, parts_[k].base->kept});
    }
    to_.scene.meshes.push_back(std::move(desc));
    to_.origin.meshes.push_back(std::move(origin));
    Affine place;
    place.m[0][3] = anchor_.x, place.m[1][3] = anchor_.y, place.m[2][3] = anchor_.z;
    return {int(to_.scene.meshes.size()) - 1, place};
}

} // namespace

DeformedMesh convertDeformed(Conversion& to, size_t node, const Deformation& by, const Path& path) {
    return Deformer(to, node, by, path).convert(to.file.model.nodes[node].mesh);
}

} // namespace chiaro::gltf
