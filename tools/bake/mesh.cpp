#include "tools/bake/mesh.h"
#include "core/math/sampler.h"
#include <algorithm>
#include <fmt/format.h>
#include <unordered_map>

namespace chiaro::bake {
namespace {

uint64_t pairOf(uint32_t a, uint32_t b) noexcept { return uint64_t(std::min(a, b)) << 32 | std::max(a, b); }
struct PairHash {
    std::size_t operator()(uint64_t v) const noexcept { return hashMix(v); }
};

// Is the order of corners the other way round than in the file? Only where the mesh was placed when the scene was compiled.
bool turned(const DrawnPart& part, const Mirrored& mirrored) { return part.instance == Hit::none && mirrored[part.node]; }

uint32_t vertexCount(const Scene& scene, const DrawnPart& part) {
    uint32_t n = 0;
    for (uint32_t t = 0; t < part.triangles; ++t)
        for (const uint32_t v : scene.vertices(part, t)) n = std::max(n, v + 1);
    return n;
}

using Weights = std::array<float, 3>;
struct Piece { // of a triangle of the scene
    uint32_t triangle = 0;
    std::array<uint32_t, 3> vertex{};
    std::array<Weights, 3> at{}; // its corners by those of the triangle
};

// The pieces of one part.
class Divider {
public:
    Divider(const Scene& scene, const DrawnPart& part, float time) : scene_(scene), part_(part), time_(time) {
        for (uint32_t v = 0; v < vertexCount(scene, part); ++v) vertices_.push_back({{v, 0, 0}, {1, 0, 0}});
        for (uint32_t t = 0; t < part.triangles; ++t)
            pieces_.push_back({t, scene.vertices(part, t), {Weights{1, 0, 0}, Weights{0, 1, 0}, Weights{0, 0, 1}}});
    }
    void divide(double longest, std::size_t most) {
        for (bool again = true; again;) {
            again = false;
            std::unordered_map<uint64_t, uint32_t, PairHash> middles; // of this round
            std::vector<Piece> next;
            for (const Piece& p : pieces_) {
                const auto corner = positions(p);
                std::array<uint32_t, 3> middle{}; // of the edge from corner k
                std::array<bool, 3> cut{};
                for (std::size_t k = 0; k < 3; ++k) {
                    cut[k] = double(length(corner[(k + 1) % 3] - corner[k])) > longest * (1 + 1e-5);
                    if (cut[k]) middle[k] = middleOf(p, k, middles);
                }
                again = again || cut[0] || cut[1] || cut[2];
                split(p, cut, middle, next);
                if (vertices_.size() > most)
                    throw Error(Exit::resources,
                                fmt::format("--density: edges of {:g} m take more than {} vertices; give fewer a metre", longest, most));
            }
            pieces_ = std::move(next);
        }
    }
    std::vector<BakedVertex> takeVertices() { return std::move(vertices_); }
    const std::vector<Piece>& pieces() const { return pieces_; }

private:
    std::array<Vec3, 3> positions(const Piece& p) const {
        const auto c = scene_.corners(part_, p.triangle, time_);
        std::array<Vec3, 3> at;
        for (std::size_t k = 0; k < 3; ++k) at[k] = c[0] * p.at[k][0] + c[1] * p.at[k][1] + c[2] * p.at[k][2];
        return at;
    }
    static Weights between(const Weights& a, const Weights& b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }
    uint32_t middleOf(const Piece& p, std::size_t k, std::unordered_map<uint64_t, uint32_t, PairHash>& middles) {
        const uint32_t a = p.vertex[k], b = p.vertex[(k + 1) % 3];
        const auto [at, isNew] = middles.try_emplace(pairOf(a, b), uint32_t(vertices_.size()));
        if (!isNew) return at->second;
        BakedVertex v{{}, {0, 0, 0}};
        std::size_t used = 0;
        for (const uint32_t end : {std::min(a, b), std::max(a, b)}) {
            const BakedVertex from = vertices_[end];
            for (std::size_t j = 0; j < 3; ++j) {
                if (from.weight[j] == 0) continue;
                std::size_t slot = 0;
                while (slot < used && v.from[slot] != from.from[j]) ++slot;
                used = std::max(used, slot + 1);
                v.from[slot] = from.from[j];
                v.weight[slot] += from.weight[j] / 2;
            }
        }
        vertices_.push_back(v);
        return at->second;
    }
    // One cut edge: two pieces; two: three; three: four.
    static void split(const Piece& p, const std::array<bool, 3>& cut, const std::array<uint32_t, 3>& middle, std::vector<Piece>& to) {
        const int cuts = cut[0] + cut[1] + cut[2];
        if (cuts == 0) return to.push_back(p);
        // Turned so that an uncut edge (of two cuts), or the cut one (of one), is the first.
        std::size_t r = 0;
        while (cuts == 1 ? !cut[r] : cuts == 2 && cut[r]) ++r;
        const std::size_t a = r, b = (r + 1) % 3, c = (r + 2) % 3;
        struct End {
            uint32_t vertex;
            Weights at;
        };
        const auto corner = [&](std::size_t k) { return End{p.vertex[k], p.at[k]}; };
        const auto half = [&](std::size_t k) { return End{middle[k], between(p.at[k], p.at[(k + 1) % 3])}; };
        const auto add = [&](const End& x, const End& y, const End& z) {
            to.push_back({p.triangle, {x.vertex, y.vertex, z.vertex}, {x.at, y.at, z.at}});
        };
        if (cuts == 1) {
            add(corner(a), half(a), corner(c));
            add(half(a), corner(b), corner(c));
        } else if (cuts == 2) { // b-c and c-a are cut
            add(half(b), corner(c), half(c));
            add(corner(a), corner(b), half(b));
            add(corner(a), half(b), half(c));
        } else {
            add(corner(a), half(a), half(c));
            add(half(a), corner(b), half(b));
            add(half(c), half(b), corner(c));
            add(half(a), half(b), half(c));
        }
    }

    const Scene& scene_;
    const DrawnPart& part_;
    float time_;
    std::vector<BakedVertex> vertices_;
    std::vector<Piece> pieces_;
};

void addIndices(std::vector<uint32_t>& to, const std::array<uint32_t, 3>& v, bool turn) {
    to.insert(to.end(), {v[0], turn ? v[2] : v[1], turn ? v[1] : v[2]});
}

} // namespace

Mirrored mirroredInstances(const SceneDesc& desc) {
    Mirrored all;
    for (const InstanceDesc& i : desc.instances) all.push_back(i.toWorld.determinant() < 0);
    return all;
}

BakedPart mappedMesh(const Scene& scene, const PartLayout& layout, uint32_t mapSize, const Mirrored& mirrored) {
    const DrawnPart& part = scene.parts()[layout.part];
    BakedPart out;
    out.instance = part.node;
    out.primitive = part.primitive;
    const uint32_t count = vertexCount(scene, part);
    for (uint32_t v = 0; v < count; ++v) out.vertices.push_back({{v, 0, 0}, {1, 0, 0}});
    const bool literal = layout.literal;
    if (literal)
        out.uvSet = layout.kept;
    else
        out.uv.resize(count);
    std::vector<uint32_t> chartOf(count, noChart); // of a vertex that keeps its number
    std::unordered_map<uint64_t, uint32_t, PairHash> doubles;
    const auto number = [&](uint32_t v, uint32_t chart, Point2 at) {
        if (chart == noChart || literal) return v;
        const Point2 uv{at.x / float(mapSize), at.y / float(mapSize)};
        if (chartOf[v] == noChart) {
            chartOf[v] = chart;
            out.uv[v] = uv;
        }
        if (chartOf[v] == chart) return v;
        const auto [found, isNew] = doubles.try_emplace(uint64_t(v) << 32 | chart, uint32_t(out.vertices.size()));
        if (isNew) {
            out.vertices.push_back({{v, 0, 0}, {1, 0, 0}});
            out.uv.push_back(uv);
        }
        return found->second;
    };
    for (uint32_t t = 0; t < part.triangles; ++t) {
        const auto v = scene.vertices(part, t);
        std::array<uint32_t, 3> made{};
        for (std::size_t k = 0; k < 3; ++k) made[k] = number(v[k], layout.chart[t], layout.corners[t][k]);
        addIndices(out.indices, made, turned(part, mirrored));
    }
    return out;
}

VertexMesh vertexMesh(const Scene& scene, std::span<const uint32_t> parts, double longest, float time, const Mirrored& mirrored,
                      std::size_t most) {
    VertexMesh mesh;
    mesh.first.push_back(0);
    for (const uint32_t number : parts) {
        const DrawnPart& part = scene.parts()[number];
        Divider divider(scene, part, time);
        if (longest > 0) divider.divide(longest, most);
        BakedPart& out = mesh.parts.emplace_back();
        out.instance = part.node;
        out.primitive = part.primitive;
        out.vertices = divider.takeVertices();
        const std::size_t first = mesh.first.back(), count = out.vertices.size();
        if (first + count > most)
            throw Error(Exit::resources, fmt::format("more than {} vertices to bake. Bake less of the scene, or --to lightmap.", most));
        std::vector<std::vector<VertexCorner>> at(count);
        for (const Piece& p : divider.pieces()) {
            addIndices(out.indices, p.vertex, turned(part, mirrored));
            for (uint32_t k = 0; k < 3; ++k) at[p.vertex[k]].push_back({{number, p.triangle}, p.at, k});
        }
        for (std::vector<VertexCorner>& corners : at) {
            if (corners.empty())
                corners.push_back({{number, 0}, {Weights{1, 0, 0}, Weights{0, 1, 0}, Weights{0, 0, 1}}, 0}); // of no triangle
            mesh.begin.push_back(uint32_t(mesh.corners.size()));
            mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
        }
        mesh.first.push_back(uint32_t(first + count));
    }
    mesh.begin.push_back(uint32_t(mesh.corners.size()));
    return mesh;
}

} // namespace chiaro::bake
