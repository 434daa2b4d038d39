// Pictures as Chiaro writes them: multi-layer float32 OpenEXR (linear Rec.709, 1.0 = 1 cd/m2, zip) that carries the recipe of the render as
// attributes "chiaro:...", and 8-bit PNG for the screen. Layers are named as tev groups them: R G B; albedo.R ...; normal.X ...; Z; error.R
// ...; samples; cost.time (microseconds of one thread a sample), cost.rays, cost.depth, photons.density (1/m2), photons.radius (m),
// photons.count where the film kept them. A crop is the data window
// inside the display window. Equal renders give equal bytes but for chiaro:seconds: no file holds a date. Files are replaced whole
// (io/replace_file.h). Errors: Error(Exit::file) or Error(Exit::resources) for a full disk, with the path and the system's reason.
#pragma once
#include "core/render/film.h"
#include "core/scene/desc.h"
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace chiaro {

// Attributes in the order in which they were added; 64-bit numbers travel as text.
using MetadataValue = std::variant<std::string, int, double>;
using Metadata = std::vector<std::pair<std::string, MetadataValue>>;

struct Picture {
    uint32_t width = 0, height = 0;         // of the whole picture
    Rect window;                            // the part that has pixels
    std::vector<std::string> names;         // of the channels
    std::vector<std::vector<float>> planes; // window.area() values each, rows from the top
    Metadata metadata;
    bool integer = false; // the file stores whole numbers: values encoded for a display, most likely

    std::vector<float>& add(std::string name); // a new plane of zeros
    const std::vector<float>* find(std::string_view name) const;
    const MetadataValue* attribute(std::string_view name) const;
};

// Which of the first hit's layers a picture carries; Z by its values.
struct FirstHitLayers {
    bool albedo = true, normal = true;
};
// The beauty and all layers of a film. depth: planar, one value a pixel of the crop (+inf on a miss), or empty for no Z.
Picture pictureOf(const Film& film, std::span<const float> depth, FirstHitLayers = {});

void writeExr(const std::filesystem::path& file, const Picture& picture);
// rgb: three bytes a pixel of the crop, already encoded for the display. srgb: whether that display is sRGB (the file then says so).
void writePng(const std::filesystem::path& file, uint32_t width, uint32_t height, std::span<const uint8_t> rgb, const Metadata& metadata,
              bool srgb);

// A PNG in memory, for a file that holds pictures: values as they are, 16 bits a channel for u16 and f32 (clamped to [0, 1]).
std::vector<std::byte> pngBytes(uint32_t width, uint32_t height, int channels, PixelType, const void* pixels, const std::string& name);

// Any picture that OpenImageIO reads, channels found by name; integer depths become [0, 1]. Nothing is decoded or converted.
Picture readPicture(const std::filesystem::path& file);

} // namespace chiaro
