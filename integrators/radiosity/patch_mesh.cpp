#include "integrators/radiosity/patch_mesh.h"
#include "core/math/sampler.h"
#include "core/scene/surface_math.h"
#include <algorithm>
#include <bit>
#include <numeric>
#include <unordered_map>

namespace chiaro::radiosity {

Sets::Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
uint32_t Sets::find(uint32_t i) noexcept {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
}
void Sets::join(uint32_t i, uint32_t j) noexcept {
    i = find(i), j = find(j);
    if (i != j) parent_[std::max(i, j)] = std::min(i, j);
}

namespace {

constexpr float leastParallel = 0.9f; // of opposite edges of a quadrilateral, shorter to longer
constexpr float mostSkew = 0.75f;     // cosine of its angles
constexpr float smoothCosine = 0.99f; // between the shading normals of two triangles at a corner that they share
constexpr float rightAngle = 0.02f;   // cosine below which a corner counts as square

// Places to numbers; equal are the very same floats (a zero has no sign).
class Welder {
public:
    explicit Welder(std::vector<Vec3>& points) : points_(points) {}
    uint32_t number(const Vec3& p) {
        const Key key{p.x + 0.f, p.y + 0.f, p.z + 0.f};
        const auto [at, added] = numbers_.try_emplace(key, uint32_t(points_.size()));
        if (added) points_.push_back(p);
        return at->second;
    }
    void reserve(std::size_t n) { numbers_.reserve(n); }

private:
    struct Key {
        float x, y, z;
        bool operator==(const Key&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Key& k) const noexcept {
            const auto bits = [](float f) { return uint64_t(std::bit_cast<uint32_t>(f)); };
            return hashCombine(bits(k.x) << 32 | bits(k.y), bits(k.z));
        }
    };
    std::vector<Vec3>& points_;
    std::unordered_map<Key, uint32_t, Hash> numbers_;
};

// One triangle with all that pairing asks for.
struct Flat {
    uint32_t part, triangle;
    std::array<uint32_t, 3> point; // counter-clockwise seen from the front
    bool flipped = false;          // against the order of Hit's weights
    Vec3 normal;
    float error = 0;
    std::array<Vec3, 3> ns; // shading normals at the corners
    std::array<uint32_t, 3> edge{};
};

// A side of a triangle as the edge that it lies on.
struct Side {
    uint64_t key; // both points, the lesser first
    uint32_t flat;
    uint8_t k;
};

class Mesher {
public:
    Mesher(const Scene& scene, Interval shutter, PatchMesh& mesh) : scene_(scene), shutter_(shutter), mesh_(mesh) {}
    void build() {
        gather();
        findEdges();
        pair();
        finish();
    }

private:
    void gather();
    void addTriangle(const DrawnPart&, uint32_t part, uint32_t triangle, Welder&);
    bool moves(const DrawnPart&) const;
    void findEdges();
    void pair();
    // The facet of two triangles that share side k of the first; nothing where they form no quadrilateral to speak of. skew: of its angles.
    bool quadrilateral(const Side&, const Side&, Facet&, float& skew) const;
    bool smoothAcross(const Side&, const Side&) const;
    void finish();
    Facet single(const Flat&) const;

    const Scene& scene_;
    Interval shutter_;
    PatchMesh& mesh_;
    std::vector<Flat> flats_;
    std::vector<Side> sides_; // sorted by edge
    std::vector<std::size_t> firstSide_;
};

bool Mesher::moves(const DrawnPart& part) const {
    if (!scene_.moves(part) || !(shutter_.close > shutter_.open)) return false;
    for (uint32_t triangle = 0; triangle < part.triangles; ++triangle) {
        const auto at = scene_.corners(part, triangle, shutter_.open);
        for (const float share : {0.37f, 1.f})
            if (scene_.corners(part, triangle, shutter_.open + (shutter_.close - shutter_.open) * share) != at) return true;
    }
    return false;
}

void Mesher::addTriangle(const DrawnPart& part, uint32_t number, uint32_t triangle, Welder& weld) {
    const std::array<Vec3, 3> at = scene_.corners(part, triangle, shutter_.open);
    Ray ray;
    ray.time = shutter_.open;
    const auto asked = [&](float u, float v) { return scene_.point({part.geometry, triangle, part.instance, u, v, 0}, ray); };
    const SurfacePoint middle = asked(1 / 3.f, 1 / 3.f);
    const Vec3 n = cross(at[1] - at[0], at[2] - at[0]);
    const float doubleArea = length(n), height = heightOf(at[1] - at[0], at[2] - at[0], doubleArea);
    if (!finite(at[0]) || !finite(at[1]) || !finite(at[2]) || !(doubleArea > 0) || !(height > 2 * middle.error)) {
        ++mesh_.degenerate; // thinner than the rounding of its own points: nothing can be said of it
        return;
    }
    Flat f{number,
           triangle,
           {weld.number(at[0]), weld.number(at[1]), weld.number(at[2])},
           dot(n, middle.ng) < 0,
           middle.ng,
           middle.error,
           {asked(0, 0).ns, asked(1, 0).ns, asked(0, 1).ns}};
    if (f.flipped) std::swap(f.point[1], f.point[2]), std::swap(f.ns[1], f.ns[2]);
    flats_.push_back(f);
}

void Mesher::gather() {
    uint64_t all = 0;
    for (const DrawnPart& part : scene_.parts()) {
        mesh_.first.push_back(all);
        all += part.triangles;
    }
    mesh_.facetOf.assign(all, ~0u);
    flats_.reserve(all);
    Welder weld(mesh_.points);
    weld.reserve(all);
    for (uint32_t number = 0; number < scene_.parts().size(); ++number) {
        const DrawnPart& part = scene_.parts()[number];
        if (moves(part)) mesh_.moving.push_back(number);
        for (uint32_t i = 0; i < part.triangles; ++i) addTriangle(part, number, i, weld);
    }
}

void Mesher::findEdges() {
    sides_.reserve(flats_.size() * 3);
    for (uint32_t f = 0; f < flats_.size(); ++f)
        for (uint8_t k = 0; k < 3; ++k) {
            const uint32_t a = flats_[f].point[k], b = flats_[f].point[(k + 1) % 3];
            sides_.push_back({uint64_t(std::min(a, b)) << 32 | std::max(a, b), f, k});
        }
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
        return a.key != b.key ? a.key < b.key : a.flat != b.flat ? a.flat < b.flat : a.k < b.k;
    });
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        if (i == 0 || sides_[i].key != sides_[i - 1].key) {
            mesh_.edges.push_back({uint32_t(sides_[i].key >> 32), uint32_t(sides_[i].key), 0});
            firstSide_.push_back(i);
        }
        flats_[sides_[i].flat].edge[sides_[i].k] = uint32_t(mesh_.edges.size() - 1);
    }
    firstSide_.push_back(sides_.size());
}

bool Mesher::smoothAcross(const Side& x, const Side& y) const {
    const Flat &f = flats_[x.flat], &g = flats_[y.flat];
    const std::size_t fa = x.k, fb = (x.k + 1) % 3, ga = (y.k + 1) % 3, gb = y.k; // y runs the other way
    return f.part == g.part && f.point[fa] == g.point[ga] && dot(f.ns[fa], g.ns[ga]) > smoothCosine &&
           dot(f.ns[fb], g.ns[gb]) > smoothCosine;
}

bool Mesher::quadrilateral(const Side& x, const Side& y, Facet& q, float& skew) const {
    const Flat &f = flats_[x.flat], &g = flats_[y.flat];
    const uint32_t a = f.point[x.k], b = f.point[(x.k + 1) % 3], c = f.point[(x.k + 2) % 3], d = g.point[(y.k + 2) % 3];
    if (f.part != g.part || g.point[y.k] != b || c == d) return false; // not one after the other around the edge
    const std::array<uint32_t, 4> corner{a, d, b, c};
    std::array<Vec3, 4> p, e;
    for (std::size_t k = 0; k < 4; ++k) p[k] = mesh_.points[corner[k]];
    for (std::size_t k = 0; k < 4; ++k) e[k] = p[(k + 1) % 4] - p[k];
    const float error = max(f.error, g.error), l[4] = {length(e[0]), length(e[1]), length(e[2]), length(e[3])};
    for (std::size_t k = 0; k < 2; ++k)
        if (min(l[k], l[k + 2]) < leastParallel * max(l[k], l[k + 2])) return false;
    // Flat to the rounding of its own corners.
    const float away = std::fabs(dot(f.normal, p[1] - p[0]));
    if (!(away <= 8 * error + 1e-6f * max(l[0], l[1])) || dot(f.normal, g.normal) < 0.999f) return false;
    skew = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 &in = e[(k + 3) % 4], &out = e[k];
        if (!(dot(cross(in, out), f.normal) > 0)) return false;
        skew = max(skew, std::fabs(dot(in, out)) / (l[k] * l[(k + 3) % 4]));
    }
    if (skew > mostSkew) return false;
    q.part = f.part;
    q.corners = 4;
    q.point = corner;
    q.edge = {g.edge[(y.k + 1) % 3], g.edge[(y.k + 2) % 3], f.edge[(x.k + 1) % 3], f.edge[(x.k + 2) % 3]};
    q.triangle = {f.triangle, g.triangle};
    q.normal = f.normal;
    q.error = error + away;
    const Vec3 s = e[0], t = p[3] - p[0], w = p[2] - p[0] - s - t; // w in the frame of s and t
    const float ss = dot(s, s), st = dot(s, t), tt = dot(t, t), det = ss * tt - st * st;
    q.twistS = (dot(w, s) * tt - dot(w, t) * st) / det;
    q.twistT = (dot(w, t) * ss - dot(w, s) * st) / det;
    if (max(std::fabs(q.twistS), std::fabs(q.twistT)) < 1e-6f) q.twistS = q.twistT = 0; // to rounding, a parallelogram
    const auto cornerOf = [&corner](const Flat& flat) {
        std::array<uint8_t, 3> of{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t vertex = flat.flipped && k > 0 ? 3 - k : k;
            of[vertex] = uint8_t(std::find(corner.begin(), corner.end(), flat.point[k]) - corner.begin());
        }
        return of;
    };
    q.cornerOf = {cornerOf(f), cornerOf(g)};
    return true;
}

Facet Mesher::single(const Flat& f) const {
    Facet t;
    t.part = f.part;
    t.point = {f.point[0], f.point[1], f.point[2], 0};
    t.edge = {f.edge[0], f.edge[1], f.edge[2], 0};
    t.triangle = {f.triangle, ~0u};
    t.cornerOf[0] = f.flipped ? std::array<uint8_t, 3>{0, 2, 1} : std::array<uint8_t, 3>{0, 1, 2};
    t.normal = f.normal;
    t.error = f.error;
    return t;
}

// The squarest pairs first, then in the order of the triangles.
void Mesher::pair() {
    struct Candidate {
        int group;
        uint32_t edge;
        Facet facet;
        uint32_t f, g;
    };
    std::vector<Candidate> candidates;
    for (uint32_t e = 0; e < mesh_.edges.size(); ++e) {
        if (firstSide_[e + 1] - firstSide_[e] != 2) continue;
        const Side &x = sides_[firstSide_[e]], &y = sides_[firstSide_[e] + 1];
        Candidate c{0, e, {}, x.flat, y.flat};
        float skew = 0;
        if (x.flat == y.flat || !quadrilateral(x, y, c.facet, skew)) continue;
        c.group = skew < rightAngle ? 0 : skew < 0.5f ? 1 : 2;
        candidates.push_back(c);
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.group != b.group ? a.group < b.group : std::min(a.f, a.g) < std::min(b.f, b.g);
    });
    std::vector<uint32_t> pairOf(flats_.size(), ~0u);
    std::vector<Facet> pairs;
    for (const Candidate& c : candidates) {
        if (pairOf[c.f] != ~0u || pairOf[c.g] != ~0u) continue;
        pairOf[c.f] = pairOf[c.g] = uint32_t(pairs.size());
        pairs.push_back(c.facet);
    }
    std::vector<uint32_t> placed(pairs.size(), ~0u);
    for (uint32_t i = 0; i < flats_.size(); ++i) {
        const Flat& f = flats_[i];
        uint32_t facet = uint32_t(mesh_.facets.size()), half = 0;
        if (pairOf[i] == ~0u) {
            mesh_.facets.push_back(single(f));
        } else if (uint32_t& at = placed[pairOf[i]]; at == ~0u) {
            at = facet;
            mesh_.facets.push_back(pairs[pairOf[i]]);
            half = mesh_.facets.back().triangle[0] == f.triangle ? 0 : 1;
        } else {
            facet = at;
            half = mesh_.facets[at].triangle[0] == f.triangle ? 0 : 1;
        }
        mesh_.facetOf[mesh_.first[f.part] + f.triangle] = facet * 2 + half;
    }
}

void Mesher::finish() {
    Sets strands(mesh_.edges.size());
    std::vector<uint8_t> smooth(mesh_.edges.size(), 0);
    for (uint32_t e = 0; e < mesh_.edges.size(); ++e)
        if (firstSide_[e + 1] - firstSide_[e] == 2 && smoothAcross(sides_[firstSide_[e]], sides_[firstSide_[e] + 1])) smooth[e] = 1;
    for (Facet& f : mesh_.facets) {
        if (f.corners == 4) strands.join(f.edge[0], f.edge[2]), strands.join(f.edge[1], f.edge[3]);
        for (uint32_t k = 0; k < f.corners; ++k) f.smooth = uint8_t(f.smooth | smooth[f.edge[k]] << k);
    }
    std::vector<uint32_t> number(mesh_.edges.size(), ~0u);
    for (uint32_t e = 0; e < mesh_.edges.size(); ++e) {
        uint32_t& n = number[strands.find(e)];
        if (n == ~0u) n = mesh_.strands++;
        mesh_.edges[e].strand = n;
    }
}

} // namespace

PatchMesh patchMesh(const Scene& scene, Interval shutter) {
    PatchMesh mesh;
    Mesher(scene, shutter, mesh).build();
    return mesh;
}

} // namespace chiaro::radiosity
