// Reads pictures through OpenImageIO, as they are stored: no colour conversion (who reads a texture knows what it means), alpha not
// premultiplied, 8 and 16 bits an integer channel and half kept, wider and mixed depths as f32. At most four channels; CMYK and more come
// as RGB. Throws Error(Exit::file) that names the picture.
#pragma once
#include "core/render/error.h"
#include "core/scene/desc.h"
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace chiaro {

ImageDesc readImage(const std::filesystem::path& file);
// From memory; the format is found by content (PNG, JPEG, WebP, OpenEXR, HDR, TIFF, BMP; TGA by its name). `name` is for messages and
// ImageDesc::name.
ImageDesc decodeImage(std::span<const std::byte> bytes, const std::string& name);

// What a picture will be once decoded, by its header alone.
struct PictureSize {
    int width = 0, height = 0, channels = 0;
    uint64_t bytes = 0; // of its pixels
};
PictureSize pictureSize(std::span<const std::byte> bytes, const std::string& name);
PictureSize pictureSize(const std::filesystem::path& file);
std::string pictureFormat(std::span<const std::byte> bytes);             // "PNG", "OpenEXR", ..., for people; empty: unknown
[[noreturn]] void undecodable(const std::string& name, std::string why); // the error of all of these

// A latitude-longitude picture as linear f32 RGB radiance: EXR and HDR as they are, 8 and 16 bit pictures decoded from sRGB.
// Texels that are not finite or negative (no radiance is) become 0; one warning says how many.
EnvironmentDesc readEnvironment(const std::filesystem::path& file, Diagnostics& notes);

} // namespace chiaro
