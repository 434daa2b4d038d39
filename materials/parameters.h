// What a material says about one point, and which way the quantity on the path flows: all that a closure is made from.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

enum class Transport : uint8_t { radiance, importance };
// Which densities are asked for: of the direction that was taken, or of its reverse too, which methods that connect two walks weigh by.
enum class Densities : uint8_t { forward, both };

// The parameters of the closure after all textures were read: what a material says about one point. Vectors are in world space, on the
// front side of the surface.
struct BsdfParameters {
    Spectrum baseColor{1};
    float metallic = 0, roughness = 1; // alpha = roughness squared
    float ior = 1.5f;                  // 0: infinite
    float specular = 1;
    Spectrum specularColor{1};
    float transmission = 0;
    bool thin = true;        // transmission through a pane: no refraction, both interfaces with all inner reflections
    bool compensated = true; // what rough facets send to each other leaves at last; false: single scattering alone

    float anisotropy = 0;                                     // strength, from round to a brushed line along the tangent
    Vec3 tangent{};                                           // of the brush; zero: any
    float iridescence = 0, filmIor = 1.3f, filmThickness = 0; // nanometres
    float dispersion = 0;                                     // 20 / Abbe number
    float diffuseTransmission = 0;
    Spectrum diffuseTransmissionColor{1};
    float clearcoat = 0, clearcoatRoughness = 0;
    Vec3 clearcoatNormal{}; // zero: that of the surface below
    Spectrum sheenColor{0};
    float sheenRoughness = 0;

    bool layered() const noexcept { return clearcoat > 0 || maxComponent(sheenColor) > 0; }
};

} // namespace chiaro
