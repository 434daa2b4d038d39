// ShadowMap: which surface a lamp sees first in every direction, as a table of distances (Williams, Casting Curved Shadows on Curved
// Surfaces, 1978). A point is in shadow where the table says that something lies nearer. The first pass is traced from the lamp, 16 rays at
// a time, coherent; the second is a look-up at every visible point.
//
// A lamp that has a place sees through the six faces of a cube, size x size texels each; a directional light through one parallel view of
// the sphere about the scene. The nearest texel answers, so that shadow edges are stairs of texels: that is what these maps are for here.
// Lamps that move are taken where they are in the middle of the shutter.
#pragma once
#include "integrators/local_light.h"
#include <vector>

namespace chiaro {

struct Job;

class ShadowMap {
public:
    ShadowMap(const Job&, const LocalLights&, uint32_t lamp, uint32_t size);

    // bias: how much nearer something must lie, in texels as wide as they are there, growing with the slope of the surface against the
    // light: with 1 a flat surface does not shadow itself; with 0 it does, in stripes (acne); with many, shadows come off their casters.
    bool shadowed(const SurfacePoint& at, float bias) const noexcept;

    static uint64_t bytes(const LocalLights&, uint32_t lamp, uint32_t size) noexcept;

private:
    struct Texel {
        std::size_t index;
        float depth, width; // metres: of the point, from the lamp; of the texel there
        Vec3 towardsLamp;
    };
    Texel texelAt(const Vec3& p) const noexcept;
    Ray rayThrough(uint32_t face, uint32_t row, uint32_t column) const noexcept;
    void traceRow(const Scene&, const LocalLights&, uint32_t lamp, uint32_t face, uint32_t row) noexcept;

    uint32_t size_;
    bool parallel_ = false;
    Vec3 centre_, normal_; // of a lamp that has a place; zero normal: it shines all around
    bool doubleSided_ = true;
    Frame frame_;      // of a directional light, z towards it
    float radius_ = 1; // of the scene
    float time_ = 0, margin_ = 0;
    std::vector<float> depths_; // face by face, row by row; infinite where nothing is seen
};

} // namespace chiaro
