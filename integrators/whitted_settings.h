// What the user may choose about `whitted`, as values, and what follows from it: the light paths that the picture then holds exactly.
#pragma once
#include "integrators/local_light.h"
#include "integrators/registry.h"

namespace chiaro {

struct WhittedSettings {
    enum class Area : uint8_t { centre, sample };
    enum class Shadows : uint8_t { filtered, opaque, none };
    enum class Fresnel : uint8_t { exact, schlick };
    enum class Glossy : uint8_t { direct, mirror };
    enum class Transparency : uint8_t { refractive, filtered, interpolated, specularAdded };
    enum class AntiAliasing : uint8_t { filter, centre, grid, jitter, poisson, adaptive };

    explicit WhittedSettings(const Options&); // Error(Exit::usage) for values that do not go together
    static std::span<const OptionSpec> specs();

    Area area = Area::centre;
    Shadows shadows = Shadows::filtered;
    Fresnel fresnel = Fresnel::exact;
    Glossy glossy = Glossy::direct;
    Transparency transparency = Transparency::refractive;
    Spectrum ambient{0}; // radiance of a constant ambient light, cd/m2
    Attenuation attenuation;
    bool rayFalloff = false; // radiance times min(1, 1 / distance) along every ray: a mistake of early texts, to show it
    float minWeight = 0;     // a ray whose share of the pixel is smaller is not cast
    uint32_t maxNodes = 1;   // of one ray tree
    AntiAliasing antiAliasing = AntiAliasing::filter;
    uint32_t samples = 1;  // positions of its pattern
    float contrast = 0.1f; // that makes adaptive anti-aliasing refine

    Traits traits() const;
};

} // namespace chiaro
