// Pictures from texels written in a test.
#pragma once
#include "core/scene/desc.h"
#include <cstring>

namespace chiaro::test {

template <class T> ImageDesc imageOf(int width, int height, int channels, const std::vector<T>& texels) {
    ImageDesc i;
    i.width = width;
    i.height = height;
    i.channels = channels;
    i.type = sizeof(T) == 1 ? PixelType::u8 : sizeof(T) == 2 ? PixelType::u16 : PixelType::f32;
    i.pixels.resize(texels.size() * sizeof(T));
    std::memcpy(i.pixels.data(), texels.data(), i.pixels.size());
    return i;
}

} // namespace chiaro::test
