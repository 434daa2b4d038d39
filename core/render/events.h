// Scattering events as Heckbert (Adaptive Radiosity Textures, 1990) names them: D diffuse, G glossy (a rough lobe), S specular (a delta
// lobe), each reflected (R) or transmitted (T); and the kinds of light a path may begin at.
#pragma once
#include <cstdint>

namespace chiaro {

enum class Event : uint8_t { DR, DT, GR, GT, SR, ST };
inline constexpr int eventCount = 6;
enum class LightKind : uint8_t { area, delta, environment }; // La, Ld, Le
inline constexpr int lightKindCount = 3;

} // namespace chiaro
