#include "integrators/radiosity/patch_cross.h"
#include <algorithm>
#include <map>

namespace chiaro::radiosity {
namespace {

constexpr std::size_t mostCuts = 8; // through one patch
constexpr float inset = 2e-3f;      // of the rays from the corners, of the way to the middle
constexpr float lift = 1e-3f;       // of the rays off the patch, of its longest edge
constexpr float least = 1e-4f;      // of the longest edge: a narrower strip is not cut off
constexpr uint64_t perChunk = 256;

struct Plane {
    Vec3 normal;
    float offset = 0;
    float distance(const Vec3& p) const noexcept { return dot(normal, p) - offset; }
};

// All that shows the same sheet says the same plane, whichever side it was met from.
Plane planeOf(const Patch& p) noexcept {
    const Vec3 n = p.normal.x + 0.9f * p.normal.y + 0.8f * p.normal.z < 0 ? -p.normal : p.normal;
    return {n, dot(n, p.corner[0])};
}

float longestEdge(const Patch& p) noexcept {
    float longest = 0;
    for (uint32_t k = 0; k < p.corners; ++k) longest = max(longest, length(p.corner[(k + 1) % p.corners] - p.corner[k]));
    return longest;
}

bool crosses(const Plane& plane, std::span<const Vec3> corners, float tolerance) noexcept {
    float low = 0, high = 0;
    for (const Vec3& c : corners) {
        const float d = plane.distance(c);
        low = min(low, d), high = max(high, d);
    }
    return low < -tolerance && high > tolerance;
}

class Probe {
public:
    Probe(const Work& work, const Patches& patches) : work_(work), patches_(patches) {}
    std::vector<Plane> planes(uint32_t front) const {
        std::vector<Plane> found;
        along(patches_[front], found);
        if (const uint32_t back = patches_[front].other; back != ~0u) along(patches_[back], found);
        return found;
    }

private:
    // Along every edge both ways, and from every corner to the middle of what is opposite.
    void along(const Patch& p, std::vector<Plane>& found) const {
        const float longest = longestEdge(p), high = max(lift * longest, 4 * p.error);
        std::array<Vec3, 4> corner;
        Vec3 middle{};
        for (uint32_t k = 0; k < p.corners; ++k) middle += p.corner[k] * (1 / float(p.corners));
        for (uint32_t k = 0; k < p.corners; ++k) corner[k] = p.corner[k] + (middle - p.corner[k]) * inset + p.normal * high;
        for (uint32_t k = 0; k < p.corners; ++k) {
            const Vec3 &a = corner[k], &b = corner[(k + 1) % p.corners], &c = corner[(k + 2) % p.corners];
            look(p, a, b, longest, found);
            look(p, b, a, longest, found);
            look(p, a, p.corners == 4 ? c : (b + c) * 0.5f, longest, found);
        }
    }
    void look(const Patch& p, const Vec3& a, const Vec3& b, float longest, std::vector<Plane>& found) const {
        const Vec3 way = b - a;
        const float l = length(way);
        if (!(l > 0) || found.size() >= mostCuts) return;
        const Ray ray{a, 0, way * (1 / l), l, patches_.time()};
        const Hit hit = work_.scene.intersect(ray);
        if (!hit) return;
        // A sheet with light on both sides; else one side is inside of something.
        const uint32_t met = patches_.seen(hit, ray.d), beyond = patches_.seen(hit, -ray.d);
        if (met == ~0u || beyond == ~0u || std::fabs(dot(patches_[met].normal, p.normal)) > 0.99f) return;
        const Plane plane = planeOf(patches_[met]);
        const float tolerance = max(least * longest, 8 * p.error);
        if (!crosses(plane, {p.corner.data(), p.corners}, tolerance)) return;
        for (const Plane& known : found)
            if (dot(known.normal, plane.normal) > 0.9999f && std::fabs(known.offset - plane.offset) < tolerance) return;
        found.push_back(plane);
    }
    const Work& work_;
    const Patches& patches_;
};

// One cell cut by planes, and what remains in triangles.
class Cutter {
public:
    Cutter(std::vector<Patch>& patches, uint32_t& points, Crossings& out) : patches_(patches), points_(points), out_(out) {}
    void cut(uint32_t front, std::span<const Plane> planes) {
        whole_ = patches_[front];
        index_ = front;
        first_ = true;
        tolerance_ = max(least * longestEdge(whole_), 8 * whole_.error);
        static constexpr Point2 square[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, wedge[3] = {{0, 0}, {1, 0}, {0, 1}};
        Polygon all;
        for (uint32_t k = 0; k < whole_.corners; ++k) {
            // The back runs the other way around.
            const uint32_t of = (whole_.corners - k) % whole_.corners;
            const uint32_t behind = whole_.other == ~0u ? 0 : patches_[whole_.other].vertex[of];
            all.push_back({whole_.corner[k], whole_.corners == 4 ? square[k] : wedge[k], whole_.vertex[k], behind});
        }
        out_.root[front] = divide(all, planes);
        ++out_.cut;
    }

private:
    struct Corner {
        Vec3 p;
        Point2 at;
        uint32_t front = 0, back = 0; // numbers of the point
    };
    using Polygon = std::vector<Corner>;

    int32_t divide(const Polygon& piece, std::span<const Plane> planes) {
        for (; !planes.empty(); planes = planes.subspan(1)) {
            std::vector<Vec3> corners;
            for (const Corner& c : piece) corners.push_back(c.p);
            if (!crosses(planes[0], corners, tolerance_)) continue;
            const int32_t node = add(planes[0]);
            const Polygon below = clipped(piece, planes[0], -1), above = clipped(piece, planes[0], 1);
            const int32_t a = divide(below, planes.subspan(1)), b = divide(above, planes.subspan(1));
            out_.nodes[std::size_t(node)].child = {a, b};
            return node;
        }
        if (piece.size() == 3) return leaf(piece);
        const Vec3 left = cross(whole_.normal, piece[2].p - piece[0].p); // of the diagonal; corner 1 lies on its right
        const int32_t node = add({left, dot(left, piece[0].p)});
        Polygon rest{piece[0]};
        rest.insert(rest.end(), piece.begin() + 2, piece.end());
        const int32_t a = leaf({piece[0], piece[1], piece[2]}), b = divide(rest, {});
        out_.nodes[std::size_t(node)].child = {a, b};
        return node;
    }
    int32_t add(const Plane& plane) {
        Crossings::Node& n = out_.nodes.emplace_back();
        for (uint32_t k = 0; k < whole_.corners; ++k) n.side[k] = plane.distance(whole_.corner[k]);
        return int32_t(out_.nodes.size()) - 1;
    }
    Polygon clipped(const Polygon& piece, const Plane& plane, int side) {
        Polygon kept;
        for (std::size_t k = 0; k < piece.size(); ++k) {
            const Corner &a = piece[k], &b = piece[(k + 1) % piece.size()];
            const float da = plane.distance(a.p) * float(side), db = plane.distance(b.p) * float(side);
            if (da >= -tolerance_) kept.push_back(a);
            if ((da > tolerance_ && db < -tolerance_) || (da < -tolerance_ && db > tolerance_))
                kept.push_back(a.front < b.front ? between(a, b, da / (da - db), side) : between(b, a, db / (db - da), side));
        }
        return kept;
    }
    // Light differs across the sheet: either side of the cut has points of its own, shared with the next cell along it.
    Corner between(const Corner& a, const Corner& b, float f, int side) {
        Corner c{a.p + (b.p - a.p) * f, {a.at.x + (b.at.x - a.at.x) * f, a.at.y + (b.at.y - a.at.y) * f}, 0, 0};
        const auto [known, fresh] = numbers_.try_emplace({a.front, b.front, uint32_t(f * 4096 + 0.5f), side}, points_);
        if (fresh) points_ += 2;
        c.front = known->second;
        c.back = known->second + 1;
        return c;
    }
    int32_t leaf(const Polygon& piece) {
        Crossings::Piece& to = out_.pieces.emplace_back();
        Patch p = whole_;
        p.corners = 3;
        p.centre = Vec3{};
        for (uint32_t k = 0; k < 3; ++k) {
            p.corner[k] = piece[k].p;
            p.vertex[k] = piece[k].front;
            p.centre += piece[k].p * (1 / 3.f);
            to.at[k] = piece[k].at;
        }
        p.corner[3] = Vec3{};
        p.vertex[3] = 0;
        const float area = length(cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0])) / 2;
        p.area = max(area * whole_.coverage, 1e-9f * whole_.area);
        to.front = first_ ? index_ : uint32_t(patches_.size());
        if (!first_) patches_.emplace_back();
        if (whole_.other != ~0u) {
            to.back = first_ ? whole_.other : uint32_t(patches_.size());
            if (!first_) patches_.push_back(patches_[whole_.other]);
            Patch& b = patches_[to.back];
            const Patch matter = b;
            b = p;
            b.reflectance = matter.reflectance, b.emission = matter.emission;
            b.normal = -p.normal;
            std::swap(b.corner[1], b.corner[2]);
            for (uint32_t k = 0; k < 3; ++k) b.vertex[k] = piece[(3 - k) % 3].back;
            b.other = to.front;
            p.other = to.back;
        }
        patches_[to.front] = p;
        first_ = false;
        return ~(int32_t(out_.pieces.size()) - 1);
    }

    std::vector<Patch>& patches_;
    uint32_t& points_;
    Crossings& out_;
    Patch whole_;
    uint32_t index_ = 0;
    bool first_ = true;
    float tolerance_ = 0;
    std::map<std::tuple<uint32_t, uint32_t, uint32_t, int>, uint32_t> numbers_;
};

} // namespace

Point2 within(const Crossings::Piece& piece, float s, float t) noexcept {
    const Point2 &o = piece.at[0], a{piece.at[1].x - o.x, piece.at[1].y - o.y}, b{piece.at[2].x - o.x, piece.at[2].y - o.y};
    const float x = s - o.x, y = t - o.y, det = a.x * b.y - a.y * b.x;
    if (det == 0) return {0, 0};
    const float u = clamp01((x * b.y - y * b.x) / det);
    return {u, std::clamp((a.x * y - a.y * x) / det, 0.f, 1 - u)};
}

Crossings cutCrossed(const Work& work, const Patches& seen, std::vector<Patch>& patches, uint32_t& points) {
    Crossings out;
    if (work.scene.lights().count() == 0) return out;
    const uint32_t n = uint32_t(patches.size());
    const Probe probe(work, seen);
    std::vector<std::vector<std::pair<uint32_t, std::vector<Plane>>>> found((n + perChunk - 1) / perChunk);
    work.run.chunks(
        found.size(),
        [&](uint64_t chunk) {
            for (uint32_t i = uint32_t(chunk * perChunk); i < std::min<uint64_t>(n, (chunk + 1) * perChunk); ++i) {
                if (patches[i].other != ~0u && patches[i].other < i) continue; // with its front
                if (std::vector<Plane> planes = probe.planes(i); !planes.empty()) found[chunk].emplace_back(i, std::move(planes));
            }
        },
        &work.stop);
    Cutter cutter(patches, points, out);
    for (const auto& chunk : found)
        for (const auto& [front, planes] : chunk) {
            if (out.root.empty()) out.root.assign(n, -1);
            cutter.cut(front, planes);
        }
    return out;
}

} // namespace chiaro::radiosity
