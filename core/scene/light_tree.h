// LightTree: chooses one of many lights for a point about in proportion to what it could bring there, unshadowed, in a time that grows with
// the logarithm of their number (Conty Estevez and Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018; the bounds
// after Pharr, Jakob, Humphreys, Physically Based Rendering, 4th edition, 2023, section 12.6). A node knows of each of its eight children a
// sphere that holds the emitters, a cone that holds where they face, and their intensity. All eight are weighed at once, in the lanes of
// the machine; the probability of a light is the product of its shares on the way down.
// No light that can reach the point has probability zero: bounds err on the safe side, both faces of the receiver count alike.
#pragma once
#include "core/math/vec.h"
#include <cstdint>
#include <span>
#include <vector>

namespace chiaro {

class Executor;

class LightTree {
public:
    static constexpr uint32_t none = ~0u;
    static constexpr std::size_t width = 8; // children of a node

    // A light in space. It faces within the angle `spread` of the axis and shines within the angle `reach` of where it faces.
    struct Emitter {
        Vec3 centre;
        float radius = 0; // of a sphere about the centre that holds it, metres
        Vec3 axis{0, 0, 1};
        float cosSpread = 1;    // -1: faces everywhere
        float cosReach = 0;     // of a surface 0
        bool bothSides = false; // shines along -axis as well
        float intensity = 0;    // cd along the axis; 0: never chosen
        float area = 0;         // of its surface, square metres
        uint32_t light = 0;     // its number, below `lights`
    };
    struct Pick {
        uint32_t light = none; // none: nothing here can reach the point
        float pmf = 0;
    };

    LightTree() = default;
    // run: builds in parallel; null: in this thread. The tree does not depend on it.
    LightTree(std::span<const Emitter>, uint32_t lights, const Executor* run = nullptr);

    bool empty() const noexcept { return nodes_.empty(); } // also where all lights are one patch: their intensity says all
    // For a point and the normal of its surface, whichever side that is on. u in [0, 1), with 32 random bits.
    Pick choose(const Vec3& p, const Vec3& normal, double u) const noexcept;
    float pmf(uint32_t light, const Vec3& p, const Vec3& normal) const noexcept; // 0 of a light that is not in the tree
    std::size_t bytes() const noexcept {
        return nodes_.size() * (sizeof(Node) + 4) + members_.size() * sizeof(Member) + places_.size() * sizeof(Place);
    }

    // Eight children side by side, 48 bytes each. An empty place has no intensity.
    struct alignas(64) Node {
        float x[width], y[width], z[width], radius[width];
        float axisX[width], axisY[width], axisZ[width];
        float cosSpread[width], sinSpread[width], cosReach[width];
        float intensity[width]; // negative: shines on both sides
        uint32_t child[width];  // a node, or from `leaf` on a light, or from `patch` on the first member of a patch
    };
    // Of a patch: the shares of its members, added up, end at 1. Before the first lies their number, with a share of 0.
    struct Member {
        uint32_t light = 0;
        float upTo = 0;
    };

private:
    friend class LightTreeBuilder;
    static constexpr uint32_t patch = 0x40000000u, leaf = 0x80000000u;
    struct Place {
        uint32_t at = none; // node * width + child; none: not in the tree
        float share = 1;    // of its patch
    };
    std::vector<Node> nodes_;       // the root first
    std::vector<uint32_t> parents_; // of each node: the place that it hangs on
    std::vector<Member> members_;
    std::vector<Place> places_; // of each light
};

} // namespace chiaro
