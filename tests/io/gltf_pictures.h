// Pictures made from code, as the bytes of a file.
#pragma once
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

namespace chiaro::test {

// A file of that format and depth; `values` are floats, channels interleaved (a ramp where none are given).
inline std::string picture(const std::string& format, int width, int height, int channels, OIIO::TypeDesc depth,
                           std::vector<float> values = {}, OIIO::ImageSpec spec = {}) {
    if (values.empty())
        for (int i = 0; i < width * height * channels; ++i) values.push_back(float(i) / float(width * height * channels));
    const auto file = std::filesystem::temp_directory_path() / ("chiaro-picture-" + std::to_string(getpid()) + "." + format);
    spec.width = spec.full_width = width;
    spec.height = spec.full_height = height;
    spec.nchannels = channels;
    spec.format = depth;
    spec.default_channel_names();
    const auto out = OIIO::ImageOutput::create(file.string());
    if (!out || !out->open(file.string(), spec) || !out->write_image(OIIO::TypeDesc::FLOAT, values.data()) || !out->close())
        throw std::runtime_error("cannot write a test picture: " + (out ? out->geterror() : OIIO::geterror()));
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(file);
    return bytes;
}
inline std::string png(int width, int height, int channels) { return picture("png", width, height, channels, OIIO::TypeDesc::UINT8); }

} // namespace chiaro::test
