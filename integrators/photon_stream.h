// Streams of particles: some hundred paths from the lights walk at once, bounce by bounce, their rays traced and their hits on plain
// surfaces shaded sixteen at a time (photon_lanes.h); every other hit takes the step of the single walk (light_walk.h). The photons and
// their order are those of walks one after the other, to the last bit.
#pragma once
#include "core/render/fault.h"
#include "core/scene/flat_triangle.h"
#include "integrators/light_walk.h"
#include "integrators/photon_lanes.h"
#include "integrators/photon_trace.h"
#include "integrators/plain_lamps.h"
#include "integrators/plain_material.h"

namespace chiaro {

// Which photons are wanted, and how paths go on behind them.
struct PhotonRules {
    PhotonKinds kinds;
    bool stores(uint32_t depth, uint32_t deltas) const noexcept {
        return depth == 0 ? kinds.direct : deltas == depth ? kinds.caustic : kinds.indirect;
    }
    Onward onward(uint32_t depth, uint32_t deltas) const noexcept {
        if (kinds.indirect) return Onward::any;
        return kinds.caustic && deltas == depth ? Onward::delta : Onward::stop;
    }
};
inline Spectrum powerOf(const Spectrum& flux) noexcept { return fault(Fault::photonPowerBias) ? flux * 1.01f : flux; }
// Keeps them: keep(photon).
template <class Keep> struct PhotonVisitor {
    const PhotonRules& rules;
    Keep keep;
    Onward arrive(const Arrival& a, const Bsdf& bsdf, const Sampler&) const {
        if (rules.stores(a.depth, a.deltas) && bsdf.smooth() && !black(a.flux)) {
            const Vec3 wi = -a.ray.d, normal = dot(wi, a.at.ng) < 0 ? -a.at.ng : a.at.ng;
            keep(Photon{a.at.p, powerOf(a.flux), packDirection(wi), a.state, packNormal(normal)});
        }
        return rules.onward(a.depth, a.deltas);
    }
};

// The start of a path.
struct PhotonStart {
    Sampler sampler;                       // behind the departure
    Departure departure;                   // before anybody aimed it
    std::optional<LightEmission> emission; // nothing: the numbers meet no light
};
Sampler photonSampler(const Work&, const PhotonRequest&, uint64_t number) noexcept;
PhotonStart startPhoton(const Work&, const PhotonRequest&, uint64_t number) noexcept;

// What paths brought.
struct PhotonHarvest {
    PhotonList photons; // by path and vertex
    Fate fate;
    double emitted = 0, stored = 0; // lumen, luminance
};

// What of a scene is plain, for all streams through it.
struct PlainScene {
    explicit PlainScene(const Scene& scene) : materials(plainMaterials(scene)), lamps(scene) {}
    std::vector<PlainMaterial> materials;
    PlainLamps lamps;
};

class PhotonStream {
public:
    PhotonStream(const Work&, const PhotonRequest&, const PlainScene&);
    static constexpr uint64_t most = ParticleLanes::most; // paths at once
    // Walks the paths first, first + 1, ... (at most `most`, and none beyond a multiple of 2^32) and adds what they bring. counts: photons
    // of each path; empty: nobody asks.
    void walk(uint64_t first, uint64_t count, PhotonHarvest&, std::span<uint32_t> counts = {});

private:
    struct Known { // a triangle that was hit lately
        Hit hit;
        FlatTriangle triangle;
        const PlainMaterial* material = nullptr; // null: not plain
    };
    const Known& known(const Hit&) noexcept;
    Departure departureOf(std::size_t k) const noexcept;
    void depart(uint64_t first, uint64_t count, PhotonHarvest&);
    void bounce(uint32_t depth, PhotonHarvest&);
    void block(uint32_t depth, const Sampler& numbers, std::size_t first, std::size_t count, PhotonHarvest&);
    void trace(std::size_t first, std::size_t count) noexcept;
    bool takePlain(uint32_t depth, std::size_t lane, std::size_t i, PhotonHarvest&) noexcept;
    void goOnPlain(uint32_t depth, std::size_t lane, std::size_t i);
    void keep(uint16_t slot, const Photon&) noexcept;
    void goOnAny(uint32_t depth, const Sampler& numbers, std::size_t lane, std::size_t i, PhotonHarvest&);
    void sortInto(PhotonHarvest&, std::span<uint32_t> counts);

    static constexpr std::size_t remembered = 64;
    const Work& work_;
    const PhotonRequest& request_;
    const PlainScene& plain_;
    uint64_t first_ = 0; // number of the first path
    PhotonRules rules_;
    ParticleLanes lanes_;
    std::size_t kept_ = 0; // lanes that go on to the next bounce
    PlainHits hits_;
    HitPacket met_[PlainHits::most / laneWidth];
    StartLanes starts_;
    PathState next_[PlainHits::most]; // after a diffuse event
    FluxLanes ledger_;
    Known known_[remembered];
    // By bounce and path, and whose; more room than there are.
    PhotonList photons_;
    std::vector<uint16_t> slots_;
    std::size_t stored_ = 0;
    std::vector<uint32_t> places_; // of each path: how many, then where
};

} // namespace chiaro
