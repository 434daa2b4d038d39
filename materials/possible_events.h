// Which scattering events a scene's materials can make at all: what an integrator cannot see is only worth a warning where it occurs.
#pragma once
#include "core/render/path_expression.h"
#include "core/scene/scene.h"

namespace chiaro {

// The events of one material, as letters of a path expression. Where a texture decides, both sides of the decision count.
LetterSet possibleEvents(const MaterialDesc&) noexcept;
// The events and the kinds of light of a whole scene.
LetterSet possibleLetters(const Scene&) noexcept;

} // namespace chiaro
