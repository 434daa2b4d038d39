// Prepass: what was solved before the picture and does not depend on the view: photon maps, radiosity. Solved once, shared by all the
// integrators that want its diffuse field, its time billed to each of them. Its answer is the light that arrives at a diffuse surface after
// at least one scattering; direct light is never in it, so that nothing is counted twice.
#pragma once
#include "core/render/film.h"

namespace chiaro {

struct Work;
struct SurfacePoint;

class Prepass {
public:
    virtual ~Prepass() = default;
    virtual void solve(const Work&) = 0;
    // Adds, in the layers of their classes, the light paths L ... D that end at the diffuse part of this point: weight is what the eye path
    // multiplies the radiance leaving there by (throughput; the diffuse albedo is the pre-pass's own business), eye its state on arrival.
    virtual void addIndirect(const PathClasses&, const SurfacePoint&, PathState eye, const Spectrum& weight, Outputs&) const noexcept = 0;
};

} // namespace chiaro
