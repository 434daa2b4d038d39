#include "tools/cli/diff.h"
#include "tools/cli/values.h"
#include <algorithm>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

std::vector<std::string> splitList(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        parts.push_back(text.substr(at, comma - at));
        at = comma + 1;
    }
    return parts;
}

void requireMetric(std::string_view option, const std::string& name) {
    if (name == "flip" || judge::findMetric(name)) return;
    std::vector<std::string> names;
    std::string list;
    for (const judge::Metric& m : judge::metricTable()) {
        names.emplace_back(m.name);
        list += names.back() + ", ";
    }
    names.emplace_back("flip");
    const std::string near = nearest(name, names);
    throw Error(Exit::usage, fmt::format("--{}: no metric \"{}\"; have {}flip{}", option, name, list,
                                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

PixelLimits pixelLimits(const Arguments& a, const std::string& name) {
    PixelLimits limits;
    limits.each = parseReal(name, a.text(name), 0, 1e30);
    limits.percent = parseReal(name + "percent", a.text(name + "percent"), 0, 100);
    const std::string hard = "hard" + name;
    if (a.given(hard)) limits.hard = parseReal(hard, a.text(hard), 0, 1e30);
    return limits;
}

std::vector<MetricLimit> metricLimits(const Arguments& a, const std::string& option) {
    std::vector<MetricLimit> limits;
    for (const std::string& text : a.all(option)) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Exit::usage, fmt::format("--{}: \"{}\" is not like flip=0.02", option, text));
        limits.push_back({text.substr(0, equals), parseReal(option, text.substr(equals + 1), -1e30, 1e30)});
        requireMetric(option, limits.back().metric);
    }
    return limits;
}

void readOutputs(DiffSettings& s, const Arguments& a) {
    for (const std::string& o : a.all("output")) {
        const std::string extension = std::filesystem::path(o).extension().string();
        if (extension != ".exr" && extension != ".png")
            throw Error(Exit::usage, fmt::format("-o {}: chiaro writes .exr and .png; give one of these endings", o));
        s.pictures.emplace_back(o);
    }
    if (a.text("scale") != "auto") s.scale = parseReal("scale", a.text("scale"), 1e-30, 1e30);
    s.csv = a.text("csv");
    s.json = a.text("json");
    if (s.csv == "-" && s.json == "-") throw Error(Exit::usage, "--csv - and --json -: only one of them can have stdout");
}

// No file is written twice, and none over what is read.
void requireApart(const DiffSettings& s) {
    std::vector<std::filesystem::path> written = s.pictures;
    for (const std::string& file : {s.csv, s.json})
        if (!file.empty() && file != "-") written.emplace_back(file);
    for (std::size_t i = 0; i < written.size(); ++i) {
        if (std::find(written.begin(), written.begin() + std::ptrdiff_t(i), written[i]) != written.begin() + std::ptrdiff_t(i))
            throw Error(Exit::usage, fmt::format("{} would be written twice", written[i].string()));
        for (const std::string& read : {s.fileA, s.fileB, s.mask}) {
            std::error_code absent;
            if (!read.empty() && std::filesystem::equivalent(written[i], read, absent))
                throw Error(Exit::usage, fmt::format("{} is read; give the output another name", written[i].string()));
        }
    }
}

} // namespace

DiffSettings readDiffSettings(const Arguments& a) {
    DiffSettings s;
    s.fileA = a.operands[0];
    s.fileB = a.operands[1];
    s.layer = a.text("layer");
    s.mask = a.text("mask");
    s.crop = a.text("crop");
    s.fit = a.on("fit");
    s.perChannel = a.on("channels");
    s.quiet = a.on("quiet");
    s.flip = FlipKind(parseChoice("flip", a.text("flip"), {"auto", "ldr", "hdr", "none"}));
    if (a.text("exposure") != "auto") s.exposure = parseReal("exposure", a.text("exposure"), -100, 100);
    if (a.given("peak")) s.peak = parseReal("peak", a.text("peak"), 1e-30, 1e30);
    if (a.given("metrics"))
        for (std::string& name : splitList(a.text("metrics"))) {
            requireMetric("metrics", name);
            s.metrics.push_back(std::move(name));
        }
    s.fail = {pixelLimits(a, "fail"), metricLimits(a, "fail-metric")};
    s.warn = {pixelLimits(a, "warn"), metricLimits(a, "warn-metric")};
    const bool given = a.given("fail") || a.given("failpercent") || a.given("hardfail") || a.given("warn") || a.given("warnpercent") ||
                       a.given("hardwarn");
    s.pixelLimits = given || (s.fail.metrics.empty() && s.warn.metrics.empty());
    readOutputs(s, a);
    requireApart(s);
    return s;
}

std::string diffNotes() {
    std::string text = "\nMetrics   t a value of A, r of B, d = t - r, linear; mean over pixels and channels; 0/0 = 0\n";
    for (const judge::Metric& m : judge::metricTable()) text += fmt::format("  {:<12} {}\n", m.name, m.formula);
    return text +
           "  Each is told a second time without the 0.1 % of largest |d|: what fireflies do.\n"
           "  8 and 16 bit pictures are decoded by the sRGB curve first. Pixels that are not finite are left out and counted.\n"
           "\nVerdict   FAIL when more than --failpercent of the pixels, or one by more than --hardfail, or a metric is beyond its limit;\n"
           "  else WARN by the same rule with the warn limits; else PASS\n"
           "Exit code 0 PASS, 1 WARN, 2 FAIL, 3 not comparable (sizes, channels), 4 a file, 64 usage\n";
}

} // namespace chiaro::cli
