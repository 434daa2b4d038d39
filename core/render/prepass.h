// Prepass: what was solved before the picture and does not depend on the view: photon maps, radiosity. Solved once, shared by all the
// integrators that want its diffuse field, its time billed to each of them. Its answer is the light that arrives at a diffuse surface after
// at least one scattering; direct light is never in it, so that nothing is counted twice.
#pragma once
#include "core/render/film.h"

namespace chiaro {

struct Work;
struct SurfacePoint;
class Bsdf; // of materials/: the point as it scatters
class Writer;
class Reader;

class Prepass {
public:
    virtual ~Prepass() = default;
    // A pure function of the work and of the options it was made with; tells what it chose by itself to the notes. Ends early when the stop
    // token says so; then it is of no use.
    virtual void solve(const Work&) = 0;
    // Adds, in the layers of their classes, the light paths L ... D that end at the diffuse part of this point, seen as its closure sees
    // it: weight is what the eye path multiplies the radiance leaving there by (throughput without the event here), eye its state on
    // arrival.
    virtual void addIndirect(const PathClasses&, const Hit&, const SurfacePoint&, const Bsdf&, PathState eye, const Spectrum& weight,
                             Outputs&) const noexcept = 0;
    // The solution as it is, instead of solve(): the same work, the same bits. What it belongs to is checked by the owner of the file.
    virtual void save(Writer&) const = 0;
    virtual void load(const Work&, Reader&) = 0;
};

} // namespace chiaro
