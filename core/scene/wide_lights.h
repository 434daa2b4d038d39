// WideLights: the lights of a scene as loops over lanes want them, one record of 64 bytes each, a line of the caches, and the table that
// chooses among them. Made once before a render, read by all threads. What lanes cannot do (textured, moving or cut-out emitters, the
// choice by a light tree) is asked of the Lights themselves, one lane at a time, and gives the same sample.
#pragma once
#include "core/scene/light_tree_view.h"
#include "core/scene/lights.h"
#include <vector>

namespace chiaro {

struct alignas(64) WideLight {
    enum Flag : uint32_t { doubleSided = 1, ask = 2, punctual = 4, directional = 8, spot = 16 };
    float p[3];        // a corner, or the place of a punctual light
    float e1[3];       // edge; axis of a punctual light, the way the light goes
    float e2[3];       // edge; intensity of a punctual light
    float inverse;     // 1 over twice the area, negative where the front is the clockwise side; range of a punctual light
    float pmf;         // of choosing it by power, the environment's share taken off
    float emission[3]; // cd/m2; scale and offset of a spot light
    float error;       // of the corners, metres
    uint32_t flags;
};

// What is asked lane by lane: where, what was drawn, the answer.
struct alignas(64) LightLanes {
    static constexpr uint32_t size = 16, sky = ~0u, unchosen = ~1u;
    float px[size], py[size], pz[size], nx[size], ny[size], nz[size], error[size], time[size]; // the receiver: position, geometric normal
    uint32_t pick[size];                                                                       // 32 random bits
    float ux[size], uy[size];
    uint32_t light[size]; // sky: the environment
    float pmf[size];
    float wx[size], wy[size], wz[size], r[size], g[size], b[size], pdfW[size];    // pdfW 0: no light comes
    float ox[size], oy[size], oz[size], dx[size], dy[size], dz[size], tfar[size]; // shadow ray
    uint32_t delta[size];
};

class WideLights {
public:
    explicit WideLights(const Scene&);
    const float* records() const noexcept { return records_.empty() ? nullptr : records_[0].p; }
    const float* cells() const noexcept { return cells_.data(); }
    uint32_t finite() const noexcept { return uint32_t(cells_.size() / 4); } // that can be chosen
    // Where there are at most sixteen: the table by members, then that of the cells, each a register.
    static constexpr uint32_t few = 16, members = 16;
    const float (*fields() const noexcept)[few] { return records_.size() <= few ? fields_ : nullptr; }
    double edge() const noexcept { return edge_; } // the environment's share of all choices
    bool byTree() const noexcept { return tree_.nodes != nullptr; }
    const LightTreeView& tree() const noexcept { return tree_; }
    double treeShare() const noexcept { return treeShare_; } // of the choices that the environment leaves
    bool environment() const noexcept { return sky_ != nullptr; }
    const Sky* sky() const noexcept { return sky_; } // null: there is none
    // Choices of sampleTowards() by light and what is left of ux, for lanes of a mask that a tree does not decide.
    void choose(LightLanes&, uint32_t lanes) const noexcept;
    // The samples of lanes whose light is chosen: pdfW with the choice in it.
    void sample(LightLanes&, uint32_t lanes) const noexcept;

private:
    const Scene& scene_;
    std::vector<WideLight> records_;
    std::vector<float> cells_; // four a light: probability of staying, where to else, both pmfs
    alignas(64) float fields_[members + 4][few] = {};
    double edge_ = 0;
    LightTreeView tree_;
    double treeShare_ = 0;
    const Sky* sky_ = nullptr;
};

} // namespace chiaro
