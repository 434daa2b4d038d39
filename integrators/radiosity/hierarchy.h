// A tree over the patches, so that far surfaces exchange light as wholes and near ones piece by piece: elements of a hierarchy (Hanrahan,
// Salzman, Aupperle, A Rapid Hierarchical Radiosity Algorithm, 1991), the upper ones clusters of whatever lies together and faces the same
// way (Smits, Arvo, Greenberg, A Clustering Algorithm for Radiosity in Complex Environments, 1994). Leaves are the patches. Nodes are
// numbered depth first, children behind their parent: one pass forward pushes, one pass backward pulls.
#pragma once
#include "integrators/radiosity/patches.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

class Hierarchy {
public:
    struct Node {
        static constexpr uint32_t none = ~0u;
        uint32_t first = 0, count = 0; // of order()
        uint32_t right = none;         // the second child; the first is the next node; none: a leaf
        Vec3 centre;
        float radius = 0; // of a sphere about the centre that holds it
        Vec3 axis;        // mean normal
        float spread = 0; // largest angle of a normal with it, radians
        double area = 0;
        float depth = 0;   // of its points from the plane through the centre
        float error = 0;   // bound of the rounding of its points, metres
        bool flat = false; // in one plane: it cannot see itself
        bool leaf() const noexcept { return right == none; }
    };
    explicit Hierarchy(const Patches&);
    std::span<const Node> nodes() const noexcept { return nodes_; }
    const Node& operator[](std::size_t i) const noexcept { return nodes_[i]; }
    uint32_t left(uint32_t node) const noexcept { return node + 1; }
    uint32_t patch(uint32_t node) const noexcept { return order_[nodes_[node].first]; } // of a leaf
    // A patch of the node, in proportion to area.
    uint32_t pick(uint32_t node, float u) const noexcept;

    // Radiosity of the nodes: means over area of what the leaves have (pull); irradiance of the patches: what arrived at them and at all
    // above them (push).
    void pull(std::span<const Light> patches, std::span<Light> nodes) const noexcept;
    void push(std::span<const Light> nodes, std::span<Light> patches) const noexcept;
    std::size_t bytes() const noexcept { return nodes_.size() * sizeof(Node) + order_.size() * 12; }

private:
    void build(uint32_t first, uint32_t count, int depth);
    void describe(Node&) const;
    const Patches& patches_;
    float radius_ = 1;            // of everything
    std::vector<uint32_t> order_; // patches, those of a node together
    std::vector<double> areas_;   // running sums in that order
    std::vector<Node> nodes_;
};

} // namespace chiaro::radiosity
