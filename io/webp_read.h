// WebP by its own library: OpenImageIO multiplies by alpha, and where alpha is 0 the colour is gone; data that is kept beside an alpha of
// its own (a glossiness) would be lost. 8 bits, three channels or four with alpha.
#pragma once
#include "io/image_read.h"

namespace chiaro {

PictureSize webpSize(std::span<const std::byte> bytes, const std::string& name);
ImageDesc decodeWebp(std::span<const std::byte> bytes, const std::string& name);

} // namespace chiaro
