#include "tools/cli/agree_map.h"
#include "core/render/error.h"
#include "io/picture.h"
#include "io/replace_file.h"
#include "tools/judge/false_color.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

bool isFile(const std::string& output) { return output.ends_with(".png") || output.ends_with(".exr"); }

// Tiles have the edge of the judge's: the first tile begins at the corner of the window.
float tileValue(const AgreeMap& m, uint32_t x, uint32_t y) {
    const judge::Agreement& a = *m.agreement;
    const uint32_t edge = m.test ? m.test->tile() : 8;
    return a.tileZ[std::size_t(y / edge) * a.tilesX + x / edge];
}

// Both panels side by side, pixels enlarged by a whole number.
void writeMapPng(const std::filesystem::path& file, const AgreeMap& m) {
    const uint32_t w = m.window.width(), h = m.window.height(), gap = 8;
    const uint32_t zoom = std::clamp(384u / std::max(w, 1u), 1u, 8u);
    const uint32_t width = 2 * w * zoom + gap, height = h * zoom;
    std::vector<float> values(std::size_t(width) * height, 0);
    std::vector<uint8_t> keep(values.size(), 0);
    const auto put = [&](uint32_t left, uint32_t x, uint32_t y, float z) {
        for (uint32_t j = 0; j < zoom; ++j)
            for (uint32_t i = 0; i < zoom; ++i) {
                const std::size_t at = std::size_t(y * zoom + j) * width + left + x * zoom + i;
                values[at] = z;
                keep[at] = z == z; // not NaN
            }
    };
    for (uint32_t y = 0; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            put(0, x, y, tileValue(m, x, y));
            put(w * zoom + gap, x, y, m.agreement->pixelZ[std::size_t(y) * w + x]);
        }
    const judge::Canvas canvas = judge::falseColor(
        values, keep, width, height, mapScale, {m.name + " darker", m.name + " brighter", "standard errors: 8x8 tiles left, pixels right"});
    const Metadata metadata{{"chiaro:agree", fmt::format("{} - {} in standard errors", m.name, m.reference)}, {"chiaro:scale", mapScale}};
    writePng(file, canvas.width, canvas.height, canvas.rgb, metadata, true);
}

void addMeans(::chiaro::Picture& out, const char* name, const judge::Replicates* side) {
    if (!side) return;
    const judge::Evidence e = side->evidence(std::vector<uint8_t>(side->badTiles().size(), 0));
    std::vector<float>& plane = out.add(name);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = float(e.pixels[i].mean);
}

void writeMapExr(const std::filesystem::path& file, const AgreeMap& m) {
    ::chiaro::Picture out{.width = m.width, .height = m.height, .window = m.window, .names = {}, .planes = {}, .metadata = {}};
    out.metadata = {{"chiaro:agree", fmt::format("{} - {} in standard errors", m.name, m.reference)}};
    const uint32_t w = m.window.width();
    std::vector<float>& tiles = out.add("z.tile");
    for (std::size_t i = 0; i < tiles.size(); ++i) tiles[i] = tileValue(m, uint32_t(i % w), uint32_t(i / w));
    out.add("z.pixel") = m.agreement->pixelZ;
    addMeans(out, "test.Y", m.test);
    addMeans(out, "reference.Y", m.of);
    writeExr(file, out);
}

} // namespace

std::vector<std::filesystem::path> mapFiles(const std::vector<std::string>& outputs, const std::string& fileName) {
    std::vector<std::filesystem::path> files;
    for (std::string o : outputs) {
        if (!isFile(o)) {
            files.push_back(std::filesystem::path(o) / (fileName + ".png"));
            files.push_back(std::filesystem::path(o) / (fileName + ".exr"));
            continue;
        }
        constexpr std::string_view field = "{integrator}";
        for (std::size_t at = o.find(field); at != std::string::npos; at = o.find(field)) o.replace(at, field.size(), fileName);
        files.emplace_back(o);
    }
    return files;
}

void prepareMaps(const std::vector<std::string>& outputs, const std::vector<std::string>& fileNames) {
    for (const std::string& o : outputs) {
        std::error_code failed;
        if (!isFile(o)) std::filesystem::create_directories(o, failed);
        if (failed) throw Error(Exit::file, fmt::format("cannot make the folder {} ({})", o, failed.message()));
    }
    for (const std::string& name : fileNames)
        for (const std::filesystem::path& file : mapFiles(outputs, name)) checkWritable(file);
}

void writeMap(const std::filesystem::path& file, const AgreeMap& m) {
    if (m.agreement->pixelZ.empty()) return; // no pixel was compared
    if (file.extension() == ".exr")
        writeMapExr(file, m);
    else
        writeMapPng(file, m);
}

} // namespace chiaro::cli
