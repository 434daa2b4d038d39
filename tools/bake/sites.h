// Sites: the places of a scene whose light is baked, texels of a light map or vertices, each as the surface that it stands for: samples are
// spread over it. A texel stands for its square where that meets triangles; where a sample falls beside them, the nearest point on them is
// taken, so that no texel at the rim of a chart sees the inside of something else. A vertex stands for the half of its triangles that is
// nearest to it.
#pragma once
#include "tools/bake/layout.h"

namespace chiaro::bake {

// A triangle of a drawn part.
struct TriangleRef {
    uint32_t part = 0, triangle = 0; // part: of Scene::parts()
};

class Sites {
public:
    virtual ~Sites() = default;
    virtual std::size_t count() const noexcept = 0;
    // Of a sample: the hit that stands for it. u: uniform in the unit square.
    virtual Hit hit(std::size_t site, uint32_t sample, Point2 u) const noexcept = 0;
};

class TexelSites final : public Sites {
public:
    // Finds the texels that triangles meet, and the overlaps among their centres.
    TexelSites(const Scene&, const Layout&);
    std::size_t count() const noexcept override { return texels_.size(); }
    Hit hit(std::size_t site, uint32_t sample, Point2 u) const noexcept override;
    std::span<const uint32_t> texels() const noexcept { return texels_; } // of each site: y * size + x
    uint64_t overlapping() const noexcept { return overlapping_; }        // texels whose centre two triangles claim
    std::size_t bytes() const noexcept { return (texels_.size() * 2 + triangles_.size() * 2) * 4; }

private:
    struct Corner {
        uint32_t layout = 0, triangle = 0;
    };
    const std::array<Point2, 3>& cornersOf(const Corner& c) const noexcept { return layout_.parts[c.layout].corners[c.triangle]; }
    const Scene& scene_;
    const Layout& layout_;
    std::vector<uint32_t> texels_;
    std::vector<uint32_t> begin_; // of each site in triangles_, and the end
    std::vector<Corner> triangles_;
    uint64_t overlapping_ = 0;
};

// The vertices of parts as they will be written: each the end of corners of triangles. weights: of the three corners of that triangle.
struct VertexCorner {
    TriangleRef on;
    std::array<std::array<float, 3>, 3> corners; // of the piece of the triangle that ends there: where its own corners lie on it
    uint32_t corner = 0;                         // which of the three is the vertex
};
class VertexSites final : public Sites {
public:
    // corners of vertex i: from begin[i] to begin[i + 1].
    VertexSites(const Scene& scene, std::vector<uint32_t> begin, std::vector<VertexCorner> corners)
        : scene_(scene), begin_(std::move(begin)), corners_(std::move(corners)) {}
    std::size_t count() const noexcept override { return begin_.size() - 1; }
    Hit hit(std::size_t site, uint32_t sample, Point2 u) const noexcept override;

private:
    const Scene& scene_;
    std::vector<uint32_t> begin_;
    std::vector<VertexCorner> corners_;
};

} // namespace chiaro::bake
