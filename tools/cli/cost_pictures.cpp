#include "tools/cli/cost_pictures.h"
#include "tools/judge/false_color.h"
#include "tools/judge/ramp.h"

namespace chiaro::cli {
namespace {

struct Quantity {
    const char *layer, *unit;
};
constexpr std::array<Quantity, 3> quantities = {
    {{"cost.time", "microseconds a sample"}, {"cost.rays", "rays a sample"}, {"cost.depth", "depth"}}};

} // namespace

std::array<std::filesystem::path, 3> costFiles(const std::filesystem::path& png) {
    std::array<std::filesystem::path, 3> files;
    for (std::size_t i = 0; i < files.size(); ++i)
        files[i] = png.parent_path() / (png.stem().string() + "." + quantities[i].layer + ".png");
    return files;
}

void writeCostPictures(const std::filesystem::path& png, const Picture& picture) {
    const std::array<std::filesystem::path, 3> files = costFiles(png);
    for (std::size_t i = 0; i < files.size(); ++i) {
        const std::vector<float>* values = picture.find(quantities[i].layer);
        if (!values) continue;
        const judge::Canvas canvas =
            judge::ramp(*values, picture.window.width(), picture.window.height(), judge::niceScale(*values, 0.95), quantities[i].unit);
        writePng(files[i], canvas.width, canvas.height, canvas.rgb, picture.metadata, true);
    }
}

} // namespace chiaro::cli
