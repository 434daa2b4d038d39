// Textures of the compiled scene: decoded pixels in the depth of the source, filtered after their transfer function. Look-ups take no lock.
// Coordinates are glTF's: (0, 0) is the upper left corner of the picture, texel centres lie at half integers.
#pragma once
#include "core/scene/desc.h"
#include <span>

namespace chiaro {

class Textures {
public:
    Textures() = default;
    Textures(std::vector<ImageDesc> images, std::vector<TextureDesc> textures);

    // The filtered texel under uv, already moved by the slot's transform. Missing channels read as grey (1), alpha as 1.
    Vec4 lookup(int texture, Point2 uv, Transfer) const noexcept;
    int width(int texture) const noexcept;
    int height(int texture) const noexcept;
    std::size_t bytes() const noexcept;
    std::span<const ImageDesc> images() const noexcept { return images_; }
    std::span<const TextureDesc> textures() const noexcept { return textures_; }

private:
    Vec4 texel(const ImageDesc&, int x, int y, Transfer) const noexcept;
    std::vector<ImageDesc> images_;
    std::vector<TextureDesc> textures_;
};

// IEC 61966-2-1:1999, both ways.
float srgbToLinear(float encoded) noexcept;
float linearToSrgb(float linear) noexcept;

Point2 apply(const float (&transform)[2][3], Point2 uv) noexcept;

} // namespace chiaro
