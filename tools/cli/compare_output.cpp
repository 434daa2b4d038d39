#include "tools/cli/compare_output.h"
#include "io/replace_file.h"
#include "tools/cli/recipe.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

namespace fs = std::filesystem;
constexpr uint32_t block = 8; // pixels over which an error is pooled, as Film::standardError has it

// Standard error of the merged picture by the spread of its seeds, a channel a plane; empty where the seeds' pictures are not there.
std::vector<std::vector<float>> spreadOf(const Contestant& c) {
    std::vector<const judge::Picture*> seeds;
    for (const SeedRun& r : c.runs)
        if (r.whole && !r.picture.rgb.empty()) seeds.push_back(&r.picture);
    if (seeds.size() < 2 || seeds.size() != c.wholeSeeds()) return {};
    const uint32_t width = seeds[0]->width, height = seeds[0]->height, columns = (width + block - 1) / block;
    const double n = double(seeds.size());
    std::vector<std::vector<float>> planes(3, std::vector<float>(seeds[0]->pixels()));
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<double> sums(std::size_t(columns) * ((height + block - 1) / block)), counts(sums.size());
        const auto blockOf = [&](std::size_t i) { return i / width / block * columns + i % width / block; };
        for (std::size_t i = 0; i < planes[channel].size(); ++i) {
            double mean = 0, squares = 0;
            for (const judge::Picture* p : seeds) mean += p->rgb[3 * i + channel] / n;
            for (const judge::Picture* p : seeds) squares += std::pow(p->rgb[3 * i + channel] - mean, 2);
            sums[blockOf(i)] += squares / (n * (n - 1));
            ++counts[blockOf(i)];
        }
        for (std::size_t i = 0; i < planes[channel].size(); ++i)
            planes[channel][i] = float(std::sqrt(sums[blockOf(i)] / counts[blockOf(i)]));
    }
    return planes;
}

std::string seedsText(const Contestant& c) {
    std::string text;
    for (const SeedRun& r : c.runs) text += fmt::format("{}{} ({:g} spp)", text.empty() ? "" : ", ", r.seed, r.spp);
    return text;
}

Metadata recipeOf(const CompareSettings& s, const Contestant& c, const SceneContext& context, const DisplayTransform& display,
                  double exposure, bool automatic) {
    RenderSettings one = s.base;
    one.integrator = c.choice;
    if (!c.prepass) one.prepass.choice.reset();
    one.classes = c.classes;
    one.seed = c.runs.front().seed;
    const Rendered rendered{.result = {Ended::spp, uint32_t(std::lround(c.spp())), c.seconds()},
                            .noise = 0,
                            .mean = {},
                            .exposure = exposure,
                            .automaticExposure = automatic,
                            .camera = context.camera,
                            .prepassSeconds = c.prepassSeconds(),
                            .facts = c.facts};
    Metadata m = recipe(one, context.loaded, context.view, display, *c.film, rendered);
    m.emplace_back("chiaro:seeds", seedsText(c));
    return m;
}

void writeReference(const fs::path& file, const CompareSettings& s, const ReferenceSums& sums, const SceneContext& context) {
    const judge::Picture p = sums.picture();
    ::chiaro::Picture out{
        .width = context.view.width, .height = context.view.height, .window = context.view.crop, .names = {}, .planes = {}, .metadata = {}};
    const char* const names[] = {"R", "G", "B", "error.R", "error.G", "error.B"};
    for (std::size_t c = 0; c < 6; ++c) {
        std::vector<float>& plane = out.add(names[c]);
        const std::vector<float>& from = c < 3 ? p.rgb : p.error;
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = from[3 * i + c % 3];
    }
    out.metadata = {{"chiaro:command", s.base.arguments->line},
                    {"chiaro:scene", s.base.scene.operand},
                    {"chiaro:sceneHash", fmt::format("{:016x}", context.loaded.scene->hash())},
                    {"chiaro:reference", fmt::format("{} replicas of {} samples a pixel by path", sums.replicas(), sums.spp())},
                    {"chiaro:error", std::string("error.*: standard error of each value, by the spread of the replicas")},
                    {"chiaro:unit", std::string("1.0 = 1 cd/m2")},
                    {"chiaro:seconds", sums.seconds()}};
    writeExr(file, out);
}

} // namespace

void prepareFolder(const CompareSettings& s, const std::vector<Contestant>& contestants) {
    std::error_code failed;
    if (fs::exists(s.folder, failed) && !fs::is_directory(s.folder, failed))
        throw Error(Exit::file, fmt::format("-o {}: there is a file of that name; compare needs a folder", s.folder.string()));
    fs::create_directories(s.folder, failed);
    if (failed) throw Error(Exit::file, fmt::format("cannot make the folder {} ({})", s.folder.string(), failed.message()));
    std::vector<fs::path> files;
    for (const char* name : {"report.html", "sheet.png", "results.csv", "results.json", "reference.exr"}) files.push_back(s.folder / name);
    for (const Contestant& c : contestants) files.push_back(s.folder / c.file);
    std::vector<std::string> read = s.images;
    read.push_back(s.referenceFile);
    for (const fs::path& file : files) {
        for (const std::string& input : read) {
            std::error_code absent;
            if (!input.empty() && fs::equivalent(file, input, absent))
                throw Error(Exit::usage, fmt::format("{} is read and would be written over; give another folder with -o", input));
        }
        checkWritable(file);
    }
}

std::vector<fs::path> writePictures(const CompareSettings& s, const Comparison& c, const SceneContext& context,
                                    const DisplayTransform& display, double exposure, bool automaticExposure) {
    std::vector<fs::path> files;
    for (const Contestant& one : c.contestants) {
        if (!one.film) continue;
        ::chiaro::Picture picture = pictureOf(*one.film, context.depth);
        const std::vector<std::vector<float>> spread = spreadOf(one);
        for (std::size_t k = 0; k < spread.size(); ++k) {
            const auto at = std::find(picture.names.begin(), picture.names.end(), std::string("error.") + "RGB"[k]);
            picture.planes[std::size_t(at - picture.names.begin())] = spread[k];
        }
        picture.metadata = recipeOf(s, one, context, display, exposure, automaticExposure);
        files.push_back(s.folder / one.file);
        writeExr(files.back(), picture);
    }
    if (c.reference && c.reference->sums()) {
        files.push_back(s.folder / "reference.exr");
        writeReference(files.back(), s, *c.reference->sums(), context);
    }
    return files;
}

} // namespace chiaro::cli
