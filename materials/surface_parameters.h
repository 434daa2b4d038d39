// The parameters of the closure at a hit, textures read: for whoever builds another closure from them than the material's own, as the
// classical transparency models do.
#pragma once
#include "core/scene/scene.h"
#include "materials/parameters.h"

namespace chiaro {

BsdfParameters surfaceParameters(const Scene&, const SurfacePoint&) noexcept;

} // namespace chiaro
