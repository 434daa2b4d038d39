#include "tools/cli/cost_pictures.h"
#include "tools/judge/false_color.h"
#include "tools/judge/ramp.h"

namespace chiaro::cli {
namespace {

struct Quantity {
    const char *layer, *unit;
};
using Quantities = std::array<Quantity, 3>;
constexpr Quantities costs = {{{"cost.time", "microseconds a sample"}, {"cost.rays", "rays a sample"}, {"cost.depth", "depth"}}};
constexpr Quantities photons = {
    {{"photons.density", "photons a square metre"}, {"photons.radius", "metres gathered in"}, {"photons.count", "photons found"}}};

std::array<std::filesystem::path, 3> filesOf(const std::filesystem::path& png, const Quantities& quantities) {
    std::array<std::filesystem::path, 3> files;
    for (std::size_t i = 0; i < files.size(); ++i)
        files[i] = png.parent_path() / (png.stem().string() + "." + quantities[i].layer + ".png");
    return files;
}
void write(const std::filesystem::path& png, const Picture& picture, const Quantities& quantities) {
    const std::array<std::filesystem::path, 3> files = filesOf(png, quantities);
    for (std::size_t i = 0; i < files.size(); ++i) {
        const std::vector<float>* values = picture.find(quantities[i].layer);
        if (!values) continue;
        const judge::Canvas canvas =
            judge::ramp(*values, picture.window.width(), picture.window.height(), judge::niceScale(*values, 0.95), quantities[i].unit);
        writePng(files[i], canvas.width, canvas.height, canvas.rgb, picture.metadata, true);
    }
}

} // namespace

std::array<std::filesystem::path, 3> costFiles(const std::filesystem::path& png) { return filesOf(png, costs); }
void writeCostPictures(const std::filesystem::path& png, const Picture& picture) { write(png, picture, costs); }
std::array<std::filesystem::path, 3> photonFiles(const std::filesystem::path& png) { return filesOf(png, photons); }
void writePhotonPictures(const std::filesystem::path& png, const Picture& picture) { write(png, picture, photons); }

} // namespace chiaro::cli
