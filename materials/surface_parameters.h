// The parameters of the closure at a hit, textures read: for whoever builds another closure from them than the material's own, as the
// classical transparency models do.
#pragma once
#include "core/scene/scene.h"
#include "materials/parameters.h"

namespace chiaro {

class SlotReader;

BsdfParameters surfaceParameters(const Scene&, const SurfacePoint&) noexcept;
BsdfParameters surfaceParameters(const SlotReader&, const MaterialDesc&, const SurfacePoint&) noexcept;

// Has it lobes beyond metal, coated diffuse and glass of one index: a layer on top, a brush, a film, parted colours, light through a leaf,
// a reflectance of its own? Loops over lanes and tables of plain materials leave such to the closure.
bool hasFurtherLobes(const MaterialDesc&) noexcept;

// Is there an inside, which light can be in?
bool hasInside(const MaterialDesc&) noexcept;
// n^2 inside a solid that refracts, else 1: radiance is larger there by that factor (Veach 1997, section 5.2), and the throughput of a path
// that looks in is smaller. What leaves multiplies it again, so that roulette must not take it for loss.
float squaredIndexInside(const MaterialDesc&) noexcept;

} // namespace chiaro
