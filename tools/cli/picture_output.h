// From a film to files: .exr with all that was computed, .png through the display transform, and what each pixel cost beside it.
#pragma once
#include "io/color.h"
#include "io/picture.h"
#include "tools/cli/settings.h"

namespace chiaro::cli {

// What a picture needs beside its film.
struct PictureRequest {
    std::vector<std::filesystem::path> files; // .exr and .png
    LayerChoice layers;
    const DisplayTransform& display;
    std::optional<double> exposure; // none: chosen
    std::span<const float> depth;   // what lies under the pixel centres (core/render/depth.h)
    std::span<const uint8_t> lamp;
};
// The exposure that was chosen, or asked for.
double exposureOf(const PictureRequest&, const Film&);
void writePictures(const PictureRequest&, const Film&, double exposure, Metadata);
// Beside the PNGs among the files, where the cost was asked for.
std::vector<std::filesystem::path> costFilesOf(const LayerChoice&, std::span<const std::filesystem::path> files);

} // namespace chiaro::cli
