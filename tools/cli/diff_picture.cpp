#include "core/scene/texture.h"
#include "io/picture.h"
#include "tools/cli/diff.h"
#include "tools/judge/false_color.h"
#include <cmath>

namespace chiaro::cli {
namespace {

Metadata metadataOf(const DiffInputs& in, double scale) {
    return {{"chiaro:diff", "A - B of the channel that differs most: red where A is brighter, blue where B is"},
            {"chiaro:a", in.a.file},
            {"chiaro:b", in.b.file},
            {"chiaro:scale", scale}};
}

void writeLegendPng(const std::filesystem::path& file, const DiffInputs& in, const Difference& d, double scale) {
    const std::string unit = in.unit("cd/m2"); // a pure number has no name
    const judge::Canvas canvas = judge::falseColor(d.map, d.keep, in.area.width(), in.area.height(), scale,
                                                   {"B brighter", "A brighter", unit == "1" ? "A - B" : "A - B, " + unit});
    writePng(file, canvas.width, canvas.height, canvas.rgb, metadataOf(in, scale), true);
}

// R G B: the same colours, linear, without a legend, so that pixels lie where they are in A and B; difference.*: the signed numbers.
void writeNumbersExr(const std::filesystem::path& file, const DiffInputs& in, const Difference& d, double scale) {
    ::chiaro::Picture out{.width = in.a.width, .height = in.a.height, .window = in.area, .names = {}, .planes = {}, .metadata = {}};
    out.metadata = metadataOf(in, scale);
    const char* const colors[3] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = out.add(colors[c]);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            const judge::Rgb8 color = d.keep[i] ? judge::signedColor(d.map[i] / scale) : judge::leftOutColor;
            plane[i] = srgbToLinear(float(color[c]) / 255);
        }
    }
    for (std::size_t c = 0; c < (in.told.size() == 1 ? 1 : 3); ++c) {
        std::vector<float>& plane = out.add("difference." + in.columns[c + 2]);
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = in.a.picture.rgb[3 * i + c] - in.b.picture.rgb[3 * i + c];
    }
    writeExr(file, out);
}

} // namespace

double writeDifferencePictures(const DiffInputs& in, const Difference& d, const DiffSettings& s) {
    std::vector<float> kept;
    for (std::size_t i = 0; i < d.map.size(); ++i)
        if (d.keep[i]) kept.push_back(d.map[i]);
    const double scale = s.scale ? *s.scale : judge::niceScale(kept);
    for (const std::filesystem::path& file : s.pictures) {
        if (file.extension() == ".exr")
            writeNumbersExr(file, in, d, scale);
        else
            writeLegendPng(file, in, d, scale);
    }
    return scale;
}

} // namespace chiaro::cli
