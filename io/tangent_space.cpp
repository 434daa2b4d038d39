#include "io/tangent_space.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace chiaro {
namespace {

constexpr uint32_t none = ~0u;
constexpr size_t next(size_t corner) { return corner - corner % 3 + (corner + 1) % 3; }
constexpr size_t before(size_t corner) { return corner - corner % 3 + (corner + 2) % 3; }

using Key = std::array<uint32_t, 8>;
struct KeyHash {
    size_t operator()(const Key& k) const noexcept {
        uint64_t h = 0x9e3779b97f4a7c15;
        for (const uint32_t v : k) h = (h ^ v) * 0xff51afd7ed558ccd, h ^= h >> 32;
        return size_t(h);
    }
};
uint32_t bits(float v) { return std::bit_cast<uint32_t>(v + 0.f); } // -0 is 0

Vec3 faceNormal(std::span<const Vec3> p, const uint32_t* v) {
    const Vec3d a = cast<double>(p[v[0]]), n = cross(cast<double>(p[v[1]]) - a, cast<double>(p[v[2]]) - a);
    const double l = length(n);
    return l > 0 && std::isfinite(l) ? cast<float>(n * (1 / l)) : Vec3{0, 0, 1};
}

Vec3d unit(const Vec3d& v) {
    const double l = length(v);
    return l > 0 && std::isfinite(l) ? v * (1 / l) : Vec3d{};
}
Vec3d across(const Vec3d& v, const Vec3d& n) { return unit(v - n * dot(n, v)); } // in the plane of a normal

// Any unit vector across a normal: the x axis, or the y axis where that is the normal.
Vec3d anyAcross(const Vec3d& n) { return across(std::fabs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, n); }

} // namespace

TangentSpace::TangentSpace(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Point2> uv,
                           std::span<const uint32_t> indices)
    : indices_(indices.begin(), indices.end() - std::ptrdiff_t(indices.size() % 3)) {
    faces_.resize(indices_.size() / 3);
    for (size_t f = 0; f < faces_.size(); ++f) {
        const uint32_t* v = &indices_[3 * f];
        const Vec3 &a = positions[v[0]], &b = positions[v[1]], &c = positions[v[2]];
        const Point2 s = uv[v[0]], t = uv[v[1]], r = uv[v[2]];
        Face& face = faces_[f];
        face.du1 = t.x - s.x, face.dv1 = t.y - s.y, face.du2 = r.x - s.x, face.dv2 = r.y - s.y;
        const float area = face.du1 * face.dv2 - face.dv1 * face.du2;
        face.degenerate = a == b || b == c || c == a;
        face.flat = !(std::fabs(area) > std::numeric_limits<float>::min()) || !std::isfinite(area);
        face.mirrored = !(area > 0);
    }
    weld(positions, normals, uv);
    join();
    gather();
    adopt();
}

void TangentSpace::weld(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Point2> uv) {
    std::unordered_map<Key, uint32_t, KeyHash> known;
    known.reserve(positions.size());
    const auto number = [&](uint32_t v, const Vec3& n) {
        const Key key = {bits(positions[v].x), bits(positions[v].y), bits(positions[v].z), bits(n.x), bits(n.y), bits(n.z),
                         bits(uv[v].x),        bits(uv[v].y)};
        return known.try_emplace(key, uint32_t(known.size())).first->second;
    };
    welded_.resize(indices_.size());
    if (normals.empty()) {
        for (size_t c = 0; c < indices_.size(); ++c) welded_[c] = number(indices_[c], faceNormal(positions, &indices_[c - c % 3]));
        return;
    }
    std::vector<uint32_t> ofVertex(positions.size(), none);
    for (size_t c = 0; c < indices_.size(); ++c) {
        uint32_t& w = ofVertex[indices_[c]];
        if (w == none) w = number(indices_[c], normals[indices_[c]]);
        welded_[c] = w;
    }
}

// Which faces share an edge that runs one way in the one and the other way in the other. Of more than two faces at an edge those that come
// first in each direction are neighbours, then the second ones.
void TangentSpace::join() {
    struct Edge {
        uint32_t low, high;
        uint32_t corner;
        bool up;
    };
    std::vector<Edge> edges;
    edges.reserve(indices_.size());
    for (size_t c = 0; c < indices_.size(); ++c) {
        if (faces_[c / 3].degenerate) continue;
        const uint32_t a = welded_[c], b = welded_[next(c)];
        edges.push_back({std::min(a, b), std::max(a, b), uint32_t(c), a < b});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tuple(a.low, a.high, !a.up, a.corner) < std::tuple(b.low, b.high, !b.up, b.corner);
    });
    neighbour_.assign(indices_.size(), none);
    for (size_t first = 0, end = 0; first < edges.size(); first = end) {
        size_t down = first;
        for (; end < edges.size() && edges[end].low == edges[first].low && edges[end].high == edges[first].high; ++end)
            if (edges[end].up) down = end + 1;
        for (size_t a = first, b = down; a < down && b < end; ++a, ++b) {
            neighbour_[edges[a].corner] = edges[b].corner / 3;
            neighbour_[edges[b].corner] = edges[a].corner / 3;
        }
    }
}

// From each corner that has no group yet over the edges at its point, as far as the handedness holds.
void TangentSpace::gather() {
    group_.assign(indices_.size(), none);
    counts_.assign(indices_.size(), false);
    std::vector<bool> settled(faces_.size()); // flat faces that have taken the handedness of a group
    std::vector<uint32_t> open;
    for (size_t start = 0; start < indices_.size(); ++start) {
        if (group_[start] != none || faces_[start / 3].degenerate || faces_[start / 3].flat) continue;
        const auto group = uint32_t(mirrored_.size());
        const bool mirrored = faces_[start / 3].mirrored;
        mirrored_.push_back(mirrored);
        open.assign(1, uint32_t(start / 3));
        while (!open.empty()) {
            const uint32_t f = open.back();
            open.pop_back();
            size_t c = size_t(f) * 3;
            while (welded_[c] != welded_[start]) ++c; // it shares an edge at this point
            if (group_[c] != none) continue;
            Face& face = faces_[f];
            if (face.flat && !settled[f]) face.mirrored = mirrored;
            if (face.flat) settled[f] = true;
            if (face.mirrored != mirrored) continue;
            group_[c] = group;
            counts_[c] = !face.flat;
            for (const size_t edge : {before(c), c})
                if (neighbour_[edge] != none) open.push_back(neighbour_[edge]);
        }
    }
}

// Corners of triangles without area follow whatever group is at their point; alone there they get one of their own.
void TangentSpace::adopt() {
    std::unordered_map<uint32_t, uint32_t> at;
    for (size_t c = 0; c < indices_.size(); ++c)
        if (group_[c] != none) at.try_emplace(welded_[c], group_[c]);
    for (size_t c = 0; c < indices_.size(); ++c) {
        if (group_[c] != none) continue;
        const auto [it, isNew] = at.try_emplace(welded_[c], groups());
        if (isNew) mirrored_.push_back(faces_[c / 3].mirrored);
        group_[c] = it->second;
    }
}

std::vector<Vec4> TangentSpace::tangents(std::span<const Vec3> positions, std::span<const Vec3> normals) const {
    std::vector<Vec3d> sum(groups()), normal(groups());
    for (size_t c = 0; c < indices_.size(); ++c) {
        const uint32_t* v = &indices_[c - c % 3];
        const Vec3d n = cast<double>(normals.empty() ? faceNormal(positions, v) : normals[indices_[c]]);
        normal[group_[c]] = n;
        if (!counts_[c]) continue;
        const Face& face = faces_[c / 3];
        const Vec3d a = cast<double>(positions[v[0]]), e1 = cast<double>(positions[v[1]]) - a, e2 = cast<double>(positions[v[2]]) - a;
        const Vec3d along = (e1 * double(face.dv2) - e2 * double(face.dv1)) * (face.mirrored ? -1 : 1);
        const Vec3d here = cast<double>(positions[indices_[c]]);
        const Vec3d to = across(cast<double>(positions[indices_[next(c)]]) - here, n),
                    from = across(cast<double>(positions[indices_[before(c)]]) - here, n);
        sum[group_[c]] += across(along, n) * std::acos(std::clamp(dot(to, from), -1.0, 1.0));
    }
    std::vector<Vec4> out;
    out.reserve(sum.size());
    for (uint32_t g = 0; g < groups(); ++g) {
        Vec3d t = unit(sum[g]);
        if (!(lengthSquared(t) > 0)) t = anyAcross(normal[g]);
        out.push_back({float(t.x), float(t.y), float(t.z), mirrored_[g] ? 1.f : -1.f});
    }
    return out;
}

} // namespace chiaro
