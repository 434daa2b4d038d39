// Hits on plain surfaces, sixteen at a time: flat, diffuse, of one colour, and no lamp themselves. Most of what the classics are made of is
// such, and there a node of the tree is a position, a cosine for each lamp and a shadow ray: loops over lanes instead of a surface point
// and a closure each. The bits are those of the general way (WhittedTrees), which takes everything else.
#pragma once
#include "core/render/integrator.h"
#include "core/scene/flat_triangle.h"
#include "core/scene/ray_packet.h"
#include "integrators/plain_material.h"
#include "integrators/whitted_settings.h"
#include <span>
#include <vector>

namespace chiaro {

// By material. Where the settings ask for more than one shadow ray a lamp, none is plain.
std::vector<PlainMaterial> plainMaterials(const Scene&, const WhittedSettings&);

// The nodes that wait for the lamps, as arrays: some packets of them, since lanes that were written one by one a moment ago are slow to
// load as one.
struct PlainLanes {
    static constexpr std::size_t width = RayPacket::size, most = 4 * width;
    alignas(64) float px[most], py[most], pz[most], nx[most], ny[most], nz[most]; // position, geometric normal
    alignas(64) float side[most], reach[most], error[most], time[most];           // side: -1 where the back is seen
    alignas(64) float fr[most], fg[most], fb[most];                               // of the closure
    alignas(64) float tr[most], tg[most], tb[most];                               // throughput
    alignas(64) int32_t wanted[most];                                             // -1: asks the lamp
    uint32_t tree[most], depth[most];
    PathState state[most]; // with the event here taken
    Layer layer[most];     // of what the lamp sends
    std::size_t count = 0;
};
// The shadow rays to one lamp and what they bring: tfar is negative for lanes that have none.
struct LampLanes {
    RayPacket shadow;
    alignas(64) float r[PlainLanes::width], g[PlainLanes::width], b[PlainLanes::width];
};

class WhittedPlain {
public:
    WhittedPlain(const WhittedSettings& settings, const LocalLights& lamps, std::span<const PlainMaterial> materials, const Job& job,
                 std::span<Outputs> outputs) noexcept
        : settings_(settings), lamps_(lamps), materials_(materials), job_(job), outputs_(outputs) {}
    // Takes a hit that is plain, where there is room.
    bool take(const Hit&, const Ray&, uint32_t tree, uint32_t depth, PathState, const Spectrum& throughput) noexcept;
    bool full() const noexcept { return lanes_.count + PlainLanes::width > PlainLanes::most; } // has no room for sixteen
    // The light of the lamps for those taken, of which no two are of one tree.
    void answer() noexcept;

private:
    static constexpr std::size_t remembered = 8;
    struct Known { // a triangle that was hit lately
        Hit hit;
        FlatTriangle triangle;
        const PlainMaterial* material = nullptr; // null: not plain
    };
    const Known& known(const Hit&) noexcept;
    void answer(std::size_t first, std::size_t count) noexcept;
    void towards(uint32_t lamp, std::size_t first, std::size_t count) noexcept;

    const WhittedSettings& settings_;
    const LocalLights& lamps_;
    std::span<const PlainMaterial> materials_; // empty: nothing is plain
    const Job& job_;
    std::span<Outputs> outputs_;
    Known known_[remembered];
    PlainLanes lanes_;
    LampLanes lit_;
};

} // namespace chiaro
