#include "io/webp_read.h"
#include <webp/decode.h>

namespace chiaro {

namespace {

const uint8_t* dataOf(std::span<const std::byte> bytes) { return reinterpret_cast<const uint8_t*>(bytes.data()); }

} // namespace

PictureSize webpSize(std::span<const std::byte> bytes, const std::string& name) {
    WebPBitstreamFeatures found;
    if (WebPGetFeatures(dataOf(bytes), bytes.size(), &found) != VP8_STATUS_OK) undecodable(name, "the WebP is damaged");
    if (found.has_animation) undecodable(name, "the WebP is an animation");
    PictureSize size{found.width, found.height, found.has_alpha ? 4 : 3}; // each side is below 16,384: the format has no more
    size.bytes = uint64_t(size.width) * uint64_t(size.height) * uint64_t(size.channels);
    return size;
}

ImageDesc decodeWebp(std::span<const std::byte> bytes, const std::string& name) {
    const PictureSize size = webpSize(bytes, name);
    ImageDesc image{name, size.width, size.height, size.channels, PixelType::u8, std::vector<std::byte>(size.bytes)};
    const auto decode = size.channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (!decode(dataOf(bytes), bytes.size(), reinterpret_cast<uint8_t*>(image.pixels.data()), image.pixels.size(),
                size.width * size.channels))
        undecodable(name, "the WebP is damaged or truncated");
    return image;
}

} // namespace chiaro
