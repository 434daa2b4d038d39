// What a material says about one point, and which way the quantity on the path flows: all that a closure is made from.
#pragma once
#include "core/math/vec.h"

namespace chiaro {

enum class Transport : uint8_t { radiance, importance };

// The parameters of the closure after all textures were read: what a material says about one point.
struct BsdfParameters {
    Spectrum baseColor{1};
    float metallic = 0, roughness = 1; // alpha = roughness squared
    float ior = 1.5f;                  // 0: infinite
    float specular = 1;
    Spectrum specularColor{1};
    float transmission = 0;
    bool thin = true; // transmission through a pane: no refraction, both interfaces with all inner reflections
};

} // namespace chiaro
