// SlotReader: the textures of a material at one hit. Every parameter of a closure reads its slot through it, so that how far a look-up is
// filtered is decided in one place: as far as the cone of the ray that came is wide (core/scene/ray_cone.h).
#pragma once
#include "core/scene/ray_cone.h"
#include "core/scene/scene.h"

namespace chiaro {

class SlotReader {
public:
    // At full sharpness.
    SlotReader(const Scene& scene, const SurfacePoint& at) noexcept : scene_(scene), at_(at) {}
    // here: the footprint where the ray has arrived; wo: the way it came from.
    SlotReader(const Scene& scene, const SurfacePoint& at, const Vec3& wo, const Footprint& here) noexcept
        : scene_(scene), at_(at), wo_(wo), width_(here.width) {}
    // RGBA; white without a texture.
    Vec4 operator()(const TextureSlot& slot, Transfer transfer) const noexcept {
        if (slot.texture < 0) return {1, 1, 1, 1};
        if (width_ > 0) { // the same for all slots: found for the first one that has a texture
            section_ = scene_.section(at_, wo_, width_);
            width_ = 0;
        }
        return section_.none() ? scene_.sample(slot, at_, transfer) : scene_.sample(slot, at_, transfer, section_);
    }

private:
    const Scene& scene_;
    const SurfacePoint& at_;
    Vec3 wo_;
    mutable float width_ = 0; // of the cone, until its section is known
    mutable ConeSection section_;
};

} // namespace chiaro
