// TexelStore: one picture as it is read: its texels in the depth of the source and, below them, a pyramid of ever smaller means of it. All
// levels lie in tiles of 64 bytes, so that the four texels of a look-up share a cache line more often than not, along columns as well as
// along rows. Three channels are stored as four: a texel is one load.
//
// Every level is the mean of the picture: texels are decoded, averaged in linear light and encoded again; alpha is averaged apart from
// colour, normals as they are, without giving them length one again. Where a side is odd, each of its n/2 texels takes its share of three
// (the polyphase box of Guthe and Heckbert, Non-Power-of-Two Mipmapping, NVIDIA 2005): nothing is lost or counted twice. The pyramid
// depends on the transfer function, the first level does not: what is read under both has two pyramids.
#pragma once
#include "core/scene/desc.h"
#include <array>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

namespace chiaro {

struct MipLevel {
    uint32_t width = 0, height = 0;
    uint32_t across = 0; // tiles in a row
    uint32_t first = 0;  // texels before it in the store
};
struct Pyramids { // that are wanted
    bool linear = true, srgb = true;
};

class TexelStore {
public:
    static constexpr uint32_t mostLevels = 16;
    TexelStore(const ImageDesc&, Pyramids);

    PixelType type() const noexcept { return type_; }
    int channels() const noexcept { return channels_; }
    uint32_t texelBytes() const noexcept { return texelBytes_; }
    uint32_t tileX() const noexcept { return tileX_; } // sides of a tile, as powers of two
    uint32_t tileY() const noexcept { return tileY_; }
    std::span<const MipLevel> levels(Transfer t) const noexcept { return levels_[std::size_t(t)]; } // the first is the picture itself
    const std::byte* data() const noexcept { return data_.get(); }                                  // 16 more bytes can be read
    std::size_t bytes() const noexcept { return bytes_; }

    // Missing channels read as grey (1), alpha as 1.
    Vec4 texel(const MipLevel&, uint32_t x, uint32_t y, Transfer) const noexcept;
    // A row of the picture as it came.
    void row(uint32_t y, std::vector<std::byte>& to) const;

private:
    void add(Transfer, std::size_t& texels, uint32_t width, uint32_t height);
    void reduce(Transfer);
    std::byte* at(const MipLevel&, uint32_t x, uint32_t y) const noexcept;
    struct Free {
        void operator()(std::byte* p) const noexcept { std::free(p); }
    };
    PixelType type_;
    int channels_;
    uint32_t texelBytes_, channelBytes_, tileX_ = 0, tileY_ = 0;
    std::array<std::vector<MipLevel>, 2> levels_; // by Transfer
    std::unique_ptr<std::byte[], Free> data_;
    std::size_t bytes_ = 0;
    const float* decoded_[2] = {}; // values of the codes, by Transfer
};

// Tables of decoded values by code.
const float* decoding8(Transfer) noexcept;
const float* decoding16(Transfer) noexcept;
const float* decodingHalf() noexcept; // linear by nature

} // namespace chiaro
