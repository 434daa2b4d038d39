// SlotReader: the textures of a material at one hit. Every parameter of a closure reads its slot through it, so that how far a look-up is
// filtered is decided in one place.
#pragma once
#include "core/scene/scene.h"

namespace chiaro {

class SlotReader {
public:
    SlotReader(const Scene& scene, const SurfacePoint& at) noexcept : scene_(scene), at_(at) {}
    // RGBA; white without a texture.
    Vec4 operator()(const TextureSlot& slot, Transfer transfer) const noexcept { return scene_.sample(slot, at_, transfer); }

private:
    const Scene& scene_;
    const SurfacePoint& at_;
};

} // namespace chiaro
