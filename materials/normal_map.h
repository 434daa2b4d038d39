// Normals and tangents of a material at a hit, from its textures.
#pragma once
#include "core/scene/scene.h"

namespace chiaro {

class SlotReader;

// The tangent frame of the file where there is one (KHR: bitangent = cross(n, t) * w), else that of the UVs, made orthogonal to the normal.
struct TangentFrame {
    Vec3 t, b;
    explicit operator bool() const noexcept { return lengthSquared(t) > 0; }
};
TangentFrame tangentFrame(const SurfacePoint&) noexcept;

// The interpolated normal where the slot is empty, else what its texture makes of it: on the front side, above the geometric horizon.
Vec3 mappedNormal(const SlotReader&, const TextureSlot&, float scale, const SurfacePoint&) noexcept;

} // namespace chiaro
