// The diffuse field of a solution, as it is looked up: irradiance at a point of a surface, by the number of scatterings that the light has
// behind it. Constant over a patch, or interpolated from values at the points that neighbours share: at such a point the mean of what the
// planes of its patches say there, each fitted to the patch and its neighbours by least squares. So linear light is met exactly, at the
// edges of walls too, and nothing gets far beyond what the neighbours have. Then the points are moved until the middles of the patches have
// again what the solution says, so that interpolating neither makes nor takes light. Where a point would have to be darker than black for
// that (a bright patch beside dark ones: the rim of a sharp shadow), the patches at it leave their neighbours: each keeps its own value in
// its middle, and of its slope what leaves its corners light (Barth, Jespersen 1989 limit slopes so).
// Which terms must be told apart is a question to the path classes: the layers of L D, L D D, L D D D ... as the eye paths ask for them.
#pragma once
#include "core/render/archive.h"
#include "core/render/path_classes.h"
#include "integrators/radiosity/patches.h"
#include "integrators/radiosity/solution.h"

namespace chiaro::radiosity {

class Field {
public:
    Field() = default;
    Field(const Executor&, const Patches&, const Solution&);

    uint32_t terms() const noexcept { return uint32_t(constant_.size()); }
    Spectrum onPatch(uint32_t term, uint32_t patch) const noexcept { return constant_[term][patch]; } // lux
    Spectrum interpolated(const Patches&, uint32_t term, const Patches::Place&) const noexcept;

    void save(Writer&) const;
    void load(const Executor&, const Patches&, Reader&);

private:
    void interpolate(const Executor&, const Patches&);
    Spectrum between(const Patch&, uint32_t term, float s, float t) const noexcept;
    Spectrum atMiddle(const Patch&, uint32_t term) const noexcept;
    float slopeWithin(const Patch&, uint32_t term, const Spectrum& value, const Spectrum& floor) const noexcept;
    std::vector<std::vector<Spectrum>> constant_, atPoints_; // by term, then by patch or by point
    std::vector<std::vector<float>> own_;                    // by term and patch: what is left of its slope, where it left its neighbours
};

// The kind of light that stands for all of a scene.
LightKind anyKind(const Scene&);
// How many terms the classes want one by one, for eye paths that arrive with one of these states: later ones all belong in one layer.
// Throws Error(Exit::unsupported) where the classes part the kinds of light that the scene has: here they are one.
uint32_t termsApart(const PathClasses&, const Scene&, std::span<const PathState> arrivals);
// States of eye paths after any number of glossy and specular events.
std::vector<PathState> arrivalsThroughMirrors(const PathClasses&);

} // namespace chiaro::radiosity
