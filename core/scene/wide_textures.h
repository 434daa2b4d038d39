// WideTextures: what lanes read of the textures of a scene: by material the base colour's, as a record of levels that fits into registers;
// by triangle the texture coordinates of its corners; and how much the triangles of mirrors are curved. Made once before a render, read by
// all threads. Look-ups: core/scene/wide_texture_lookup.h.
#pragma once
#include "core/scene/texel_store.h"
#include <cstdint>
#include <vector>

namespace chiaro {

class Executor;
class Scene;
class WideSurfaces;

struct alignas(64) WideTexture {
    uint32_t width[16], height[16], across[16], first[16]; // of each level, as in MipLevel
    const std::byte* data;
    const float* decoded; // values by code; null: codes are whole shares, or floats
    float transform[2][3];
    uint32_t last; // the coarsest level
    uint32_t tileX, tileY, texelBytes;
    int channels;
    PixelType type;
    Wrap wrapS, wrapT;
    bool nearest;
    bool alone; // too large to be addressed in lanes
};

class WideTextures {
public:
    static constexpr uint32_t none = ~0u;
    WideTextures(const Scene&, const WideSurfaces&, const Executor* run = nullptr);
    bool filtered() const noexcept { return filtered_; } // do paths need a footprint?
    // Of a material with a base colour texture.
    const WideTexture& of(uint32_t material) const noexcept { return textures_[ofMaterial_[material]]; }
    const uint32_t* firsts() const noexcept { return firsts_.data(); }      // by geometry: its first triangle below; none: without UVs
    const float* corners() const noexcept { return uvs_.data(); }           // eight a triangle: uv of its corners, two unused
    const float* curvatures() const noexcept { return curvatures_.data(); } // by record of WideSurfaces
    std::size_t bytes() const noexcept;

private:
    void addTexture(const Scene&, uint32_t material);
    std::vector<WideTexture> textures_;
    std::vector<uint32_t> ofMaterial_, firsts_;
    std::vector<float> uvs_, curvatures_;
    bool filtered_ = false;
};

} // namespace chiaro
