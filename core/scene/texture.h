// Textures of the compiled scene: decoded pixels in the depth of the source with a pyramid of means below each (core/scene/texel_store.h),
// filtered after their transfer function. Look-ups take no lock and read nothing but tables made here.
// Coordinates are glTF's: (0, 0) is the upper left corner of the picture, texel centres lie at half integers.
#pragma once
#include "core/scene/texel_store.h"
#include <optional>
#include <span>

namespace chiaro {

class Executor;

class Textures {
public:
    Textures() = default;
    // pyramids: by image, empty: all of both kinds. What only `nearest` textures read has none in any case. run: builds on its threads,
    // null: on this one.
    Textures(std::vector<ImageDesc> images, std::vector<TextureDesc> textures, std::vector<Pyramids> pyramids = {},
             const Executor* run = nullptr);

    // The texel under uv, already moved by the slot's transform, of the picture as it came: bilinear, or the nearest. Missing channels read
    // as grey (1), alpha as 1.
    Vec4 lookup(int texture, Point2 uv, Transfer) const noexcept;
    // The mean over an ellipse about uv whose diameters are these two steps: trilinear, with probes along the longer axis. Where the
    // ellipse is no wider than a texel, or the filter is `nearest`, the look-up above.
    Vec4 lookup(int texture, Point2 uv, Transfer, Point2 major, Point2 minor) const noexcept;
    int width(int texture) const noexcept { return int(base(texture).width); }
    int height(int texture) const noexcept { return int(base(texture).height); }
    bool filtered() const noexcept { return filtered_; } // is there a pyramid at all?
    std::size_t bytes() const noexcept;
    std::span<const TexelStore> images() const noexcept { return images_; }
    std::span<const TextureDesc> textures() const noexcept { return textures_; }

private:
    const MipLevel& base(int texture) const noexcept { return images_[textures_[texture].image].levels(Transfer::linear)[0]; }
    std::vector<TexelStore> images_;
    std::vector<TextureDesc> textures_;
    bool filtered_ = false;
};

// What the materials of a scene read filtered.
std::vector<Pyramids> wantedPyramids(std::span<const MaterialDesc>, std::span<const TextureDesc>, std::size_t images);

// IEC 61966-2-1:1999, both ways.
float srgbToLinear(float encoded) noexcept;
float linearToSrgb(float linear) noexcept;

Point2 apply(const float (&transform)[2][3], Point2 uv) noexcept;

} // namespace chiaro
