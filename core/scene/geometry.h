// Geometry out of a primitive: attributes, winding and later shapes, in the space of its mesh or in that of the world.
#pragma once
#include "core/scene/accel.h"
#include <optional>

namespace chiaro {

// With a map, in world space. The material has this number.
Geometry makeGeometry(PrimitiveDesc, const std::optional<Affine>& toWorld, uint32_t number, const MaterialDesc&);
// That it holds, all shapes together.
std::size_t bytesOf(const Geometry&) noexcept;

} // namespace chiaro
