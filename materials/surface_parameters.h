// The parameters of the closure at a hit, textures read: for whoever builds another closure from them than the material's own, as the
// classical transparency models do.
#pragma once
#include "core/scene/scene.h"
#include "materials/parameters.h"

namespace chiaro {

class SlotReader;

BsdfParameters surfaceParameters(const Scene&, const SurfacePoint&) noexcept;
BsdfParameters surfaceParameters(const SlotReader&, const MaterialDesc&, const SurfacePoint&) noexcept;

} // namespace chiaro
