// The ray trees of a batch of camera samples, grown side by side: the camera hits 16 at a time, then 16 trees in step, one node of each, so
// that the rays of all of them are traced and the shadow rays towards one lamp are asked in packets of 16. A tree of its own is walked
// depth first, mirror before refraction, in every grouping: the sums of a sample have one order and its bits do not depend on its company.
// Everything lies on the stack. What a tree may not hold (WhittedSettings::maxNodes, mostPending) is left out and counted.
//
// At a node (Whitted, An Improved Illumination Model for Shaded Display, 1980):
//   L = emission + ambient rho + sum over lamps of S_l f |cos| E_l + sum over mirror and refraction of weight L(next)
// S_l is 1, 0, or the product of what the surfaces on the straight way to the lamp leave (Hall and Greenberg 1983): transmission, 1 -
// alpha.
#pragma once
#include "core/render/integrator.h"
#include "integrators/whitted_plain.h"
#include "integrators/whitted_surface.h"
#include <atomic>

namespace chiaro {

struct WhittedScene { // what a render's trees share
    const WhittedSettings* settings = nullptr;
    LocalLights lamps;
    bool filters = false;             // shadow rays may pass something
    bool blends = false;              // by its alpha
    bool absorbs = false;             // some solid dims what passes it
    std::vector<PlainMaterial> plain; // empty: every hit goes the general way
};

class WhittedTrees {
public:
    WhittedTrees(const WhittedScene&, const Job&, std::span<PathStart>, std::span<Outputs>) noexcept;
    // How many branches had to be left out.
    uint32_t run() noexcept;

private:
    static constexpr std::size_t width = 16, mostTrees = 256, mostPending = 48;
    struct Node {
        Ray ray;
        Footprint footprint;               // where the ray begins; once it has arrived, there
        Spectrum throughput{1}, weight{1}; // to the eye; of the event that led here
        Vec3 ng;                           // of the surface that the ray leaves, and its material: what it may run inside of
        uint32_t material = PathLog::none; // none: a camera ray
        uint32_t parent = PathLog::none;   // vertex of the log
        uint32_t depth = 0;                // scatterings before
        Wavelengths lambda;
        PathState state = 0;
        Event event = Event::SR;
        bool glossy = false;
    };
    struct Visit { // one node, its hit and what follows from it
        Node node;
        Hit hit;
        uint32_t tree = 0;
        SurfacePoint at;
        alignas(WhittedSurface) std::byte surface[sizeof(WhittedSurface)];
        bool lit = false; // has a surface that answers lamps
        int children = 0;
        Node child[TreeBranches::most];
        const WhittedSurface& closure() const noexcept { return *reinterpret_cast<const WhittedSurface*>(surface); }
    };
    struct Pending { // a lamp's answer that waits for its shadow ray
        Visit* visit = nullptr;
        LightSample light;
        BsdfValue value;
        PathState state[2] = {};
        Spectrum arriving; // at the eye, but for f and shadow
    };
    struct Lane; // the nodes of one tree that wait

    bool takePlain(const Hit&, const Ray&, uint32_t tree, uint32_t depth, PathState, const Spectrum& throughput, bool glossy) noexcept;
    void expand(std::span<Visit>) noexcept;
    void arrive(Visit&) noexcept;
    bool found(Visit&, Outputs&) noexcept;
    void sky(const Ray&, PathState, const Spectrum& throughput, uint32_t depth, bool glossy, Outputs&) const noexcept;
    void branch(Visit&, Outputs&) noexcept;
    void lamps(std::span<Visit>) noexcept;
    bool ask(Visit&, const LightSample&, Pending&) const noexcept;
    void settle(std::span<Pending>, uint32_t lamp) noexcept;
    Spectrum passed(Pending&, uint32_t lamp, Outputs&) const noexcept;
    void log(const Pending&, const Spectrum& shadow, const Spectrum& added, PathLog&) const;

    const WhittedScene& shared_;
    const WhittedSettings& settings_;
    const Job& job_;
    std::span<PathStart> starts_;
    std::span<Outputs> outputs_;
    WhittedPlain plain_;
    uint32_t nodes_[mostTrees];
    Pending pending_[width];
    uint32_t cut_ = 0;
};

} // namespace chiaro
