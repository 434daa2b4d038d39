// Whatever the bytes are: decoding them as a picture gives pixels, or an Error; and the header alone promises no less than there is.
#include "io/image_read.h"
#include <cstdlib>

using namespace chiaro;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    try {
        const PictureSize promised = pictureSize(bytes, "picture");
        if (promised.bytes > (uint64_t(1) << 26)) return 0; // large ones are slow, and no different
        const ImageDesc image = decodeImage(bytes, "picture");
        if (image.pixels.size() != promised.bytes || image.width != promised.width || image.channels != promised.channels) std::abort();
    } catch (const Error&) {}
    return 0;
}
