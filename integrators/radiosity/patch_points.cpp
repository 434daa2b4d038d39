#include "integrators/radiosity/patch_points.h"

namespace chiaro::radiosity {

PointNumbers::PointNumbers(const PatchMesh& mesh, const std::vector<uint32_t>& segments) : mesh_(mesh) {
    numberCorners();
    numberEdges(segments);
}

void PointNumbers::numberCorners() {
    uint32_t corners = 0;
    for (const Facet& f : mesh_.facets) {
        firstCorner_.push_back(corners);
        corners += f.corners;
    }
    Sets sets(corners);
    std::vector<uint32_t> last(mesh_.edges.size(), ~0u); // a facet corner at the beginning of each smooth edge
    std::vector<uint32_t> facetOfCorner(corners);
    for (uint32_t i = 0; i < mesh_.facets.size(); ++i)
        for (uint32_t k = 0; k < mesh_.facets[i].corners; ++k) {
            const Facet& f = mesh_.facets[i];
            facetOfCorner[firstCorner_[i] + k] = i;
            if (!(f.smooth >> k & 1)) continue;
            uint32_t& other = last[f.edge[k]];
            const uint32_t here = firstCorner_[i] + k, next = firstCorner_[i] + (k + 1) % f.corners;
            if (other == ~0u) {
                other = here;
                continue;
            }
            const uint32_t g = facetOfCorner[other], gk = other - firstCorner_[g]; // runs the other way
            sets.join(here, firstCorner_[g] + (gk + 1) % mesh_.facets[g].corners);
            sets.join(next, other);
        }
    cornerNumber_.assign(corners, ~0u);
    for (uint32_t c = 0; c < corners; ++c) {
        const uint32_t root = sets.find(c);
        cornerNumber_[c] = root == c ? numbers_++ : cornerNumber_[root];
    }
}

void PointNumbers::numberEdges(const std::vector<uint32_t>& segments) {
    std::vector<uint32_t> ofSmooth(mesh_.edges.size(), ~0u);
    firstOfEdge_.assign(cornerNumber_.size(), 0);
    firstInside_.assign(mesh_.facets.size(), 0);
    for (uint32_t i = 0; i < mesh_.facets.size(); ++i)
        for (uint32_t k = 0; k < mesh_.facets[i].corners; ++k) {
            const Facet& f = mesh_.facets[i];
            const uint32_t inner = segments[mesh_.edges[f.edge[k]].strand] - 1;
            uint32_t& shared = ofSmooth[f.edge[k]];
            const bool known = (f.smooth >> k & 1) && shared != ~0u;
            firstOfEdge_[firstCorner_[i] + k] = known ? shared : numbers_;
            shared = firstOfEdge_[firstCorner_[i] + k];
            if (!known) numbers_ += inner;
        }
}

void PointNumbers::addInside(uint32_t facet, uint64_t cells) {
    firstInside_[facet] = numbers_;
    numbers_ += uint32_t(cells) * 2; // never more than that
}

uint32_t PointNumbers::of(uint32_t facet, const Cut& cut, uint32_t point) const {
    const Facet& f = mesh_.facets[facet];
    const Cut::Point& p = cut.points[point];
    if (point < f.corners) return cornerNumber_[firstCorner_[facet] + point];
    if (p.edge == 255) {
        uint32_t rim = f.corners;
        for (uint32_t k = 0; k < f.corners; ++k) rim += cut.segments[k] - 1;
        return firstInside_[facet] + point - rim;
    }
    const PatchMesh::Edge& e = mesh_.edges[f.edge[p.edge]];
    const uint32_t along = f.point[p.edge] == e.a ? p.position : cut.segments[p.edge] - p.position;
    return firstOfEdge_[firstCorner_[facet] + p.edge] + along - 1;
}

} // namespace chiaro::radiosity
