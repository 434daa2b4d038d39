#include "tools/cli/diff.h"
#include "io/replace_file.h"
#include "tools/cli/console.h"
#include "tools/cli/deliver.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

void checkOutputs(const DiffSettings& s) {
    for (const std::filesystem::path& file : s.pictures) checkWritable(file);
    checkTextOutputs(std::array{s.csv, s.json});
}

void deliverPictures(const DiffInputs& in, const Difference& d, const DiffSettings& s, const Console& console) {
    if (s.pictures.empty()) return;
    const double scale = writeDifferencePictures(in, d, s);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < d.map.size(); ++i)
        beyond += d.keep[i] && std::isfinite(d.map[i]) && std::abs(double(d.map[i])) > scale * (1 + 1e-6);
    for (const std::filesystem::path& file : s.pictures)
        console.phase("wrote", fmt::format("{}  red A brighter, blue B brighter, full colour at {:.3g}{}, {:.2g} % of the pixels beyond{}",
                                           file.string(), scale, s.scale ? "" : " (auto)", 100 * double(beyond) / double(d.report.selected),
                                           s.scale ? "" : fmt::format("      keep it with: --scale {:.3g}", scale)));
}

} // namespace

int runDiff(const Arguments& arguments) {
    const DiffSettings settings = readDiffSettings(arguments);
    checkOutputs(settings);
    Diagnostics notes;
    Console console(settings.quiet);
    const DiffInputs in = loadDiffInputs(settings, notes);
    const Difference difference = measureDifference(in, settings, notes);
    const DiffVerdict verdict = verdictOf(in, difference, settings);
    console.warnings(notes);
    const std::string line = fmt::format("{}  {}\n", verdict.word, verdict.reason);
    const bool forPrograms = settings.csv == "-" || settings.json == "-";
    if (!settings.quiet && !forPrograms) fmt::print("{}{}", diffText(in, difference, settings), line);
    if (!settings.quiet && forPrograms) fmt::print(stderr, "{}", line);
    deliver(settings.csv, diffCsv(in, difference), console);
    deliver(settings.json, diffJson(in, difference, settings, verdict), console);
    deliverPictures(in, difference, settings, console);
    return int(verdict.code);
}

} // namespace chiaro::cli
