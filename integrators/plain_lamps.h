// Plain lamps: resting triangles that glow in one colour. What Lights::emit() looks up and computes anew for every particle is made once
// here; the particle is the same to the last bit. Every other light is asked itself.
#pragma once
#include "core/scene/scene.h"

namespace chiaro {

class PlainLamps {
public:
    explicit PlainLamps(const Scene&);
    // As Lights::emit(), but that the densities and the cosine are left at their defaults.
    std::optional<LightEmission> emit(const PickAndPoint& from, const PickAndPoint& towards, float time) const noexcept;

private:
    struct Lamp {
        Vec3 p, e1, e2, ng;
        float error = 0, pmf = 0; // pmf: the environment's share taken off
        Spectrum flux;            // of a particle, the choice of the lamp in it
        bool plain = false, doubleSided = false;
    };
    struct Cell {
        float keep = 1; // of the alias table
        uint32_t alias = 0;
    };
    const Scene& scene_;
    double edge_ = 0; // the environment's share
    std::vector<Lamp> lamps_;
    std::vector<Cell> cells_;
};

} // namespace chiaro
