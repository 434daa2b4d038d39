#include "tools/cli/picture_output.h"
#include "tools/cli/cost_pictures.h"

namespace chiaro::cli {
namespace {

std::vector<float> interleaved(const Film& film) {
    const Rect& r = film.layout().crop;
    std::vector<float> rgb;
    rgb.reserve(r.area() * 3);
    for (uint32_t y = r.y0; y < r.y1; ++y)
        for (uint32_t x = r.x0; x < r.x1; ++x) {
            const Spectrum v = film.mean({x, y});
            for (std::size_t c = 0; c < 3; ++c) rgb.push_back(v[c]);
        }
    return rgb;
}

} // namespace

double exposureOf(const PictureRequest& r, const Film& film) { return r.exposure ? *r.exposure : autoExposure(interleaved(film), r.lamp); }

void writePictures(const PictureRequest& r, const Film& film, double exposure, Metadata metadata) {
    if (r.files.empty()) return;
    Picture picture = pictureOf(film, r.layers.depth ? r.depth : std::span<const float>(), {r.layers.albedo, r.layers.normal});
    picture.metadata = std::move(metadata);
    for (const std::filesystem::path& file : r.files) {
        if (isExr(file)) {
            writeExr(file, picture);
            continue;
        }
        if (r.layers.cost) writeCostPictures(file, picture);
        if (r.layers.photons) writePhotonPictures(file, picture);
        writePng(file, picture.window.width(), picture.window.height(), r.display.bytes(interleaved(film), exposure), picture.metadata,
                 r.display.srgb());
    }
}

std::vector<std::filesystem::path> costFilesOf(const LayerChoice& layers, std::span<const std::filesystem::path> files) {
    std::vector<std::filesystem::path> all;
    for (const std::filesystem::path& file : files)
        if (!isExr(file)) {
            if (layers.cost)
                for (const std::filesystem::path& cost : costFiles(file)) all.push_back(cost);
            if (layers.photons)
                for (const std::filesystem::path& photons : photonFiles(file)) all.push_back(photons);
        }
    return all;
}

} // namespace chiaro::cli
