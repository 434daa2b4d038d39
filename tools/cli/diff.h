// chiaro diff A B: what was asked for, what the two pictures are, how they differ, and the verdict. A is the test, B the reference, d = A -
// B in linear values. Metrics describe; the verdict comes from the limits alone, with the words and exit codes of OpenImageIO's idiff.
#pragma once
#include "core/math/ray.h"
#include "tools/cli/command.h"
#include "tools/cli/picture_side.h"
#include "tools/judge/metrics.h"
#include <filesystem>
#include <limits>
#include <optional>

namespace chiaro::cli {

enum class FlipKind { automatic, ldr, hdr, none };

struct PixelLimits {
    double each = 1e-6, percent = 0, hard = std::numeric_limits<double>::infinity();
};
struct MetricLimit {
    std::string metric; // a name of the judge's table, or "flip"
    double value = 0;
};
struct Limits {
    PixelLimits pixels;
    std::vector<MetricLimit> metrics;
};

struct DiffSettings {
    std::string fileA, fileB, layer, mask, crop; // crop as typed: the size is not known yet
    bool fit = false, perChannel = false, quiet = false;
    FlipKind flip = FlipKind::automatic;
    std::optional<double> exposure; // none: auto
    std::optional<double> peak;
    std::vector<std::string> metrics; // empty: all
    Limits fail, warn;
    bool pixelLimits = true;                     // off where there are limits on metrics alone
    std::vector<std::filesystem::path> pictures; // -o
    std::optional<double> scale;                 // none: auto
    std::string csv, json;                       // empty: none; "-": stdout
};
DiffSettings readDiffSettings(const Arguments&);

struct DiffInputs {
    PictureSide a, b;
    Rect area;                          // of the whole pictures: what both have
    judge::Region region;               // in the area
    std::vector<judge::Channel> told;   // all five, or without luminance, or one for two grey pictures
    std::array<std::string, 5> columns; // their names, by Channel
    bool color = true;                  // else a layer of numbers: normals, depths
    bool linear() const { return !a.encoded && !b.encoded; }
    // The unit of light where the values have one.
    std::string unit(const std::string& ofTable) const;
};
// Throws Exit::unsupported where the two cannot be compared.
DiffInputs loadDiffInputs(const DiffSettings&, Diagnostics&);

struct Over {
    std::size_t pixels = 0;
    double percent = 0;
};
struct Difference {
    judge::Report report;
    std::vector<const judge::Metric*> metrics; // those to be told
    FlipKind flip = FlipKind::none;            // what `flip` means here
    double exposure = 0;                       // of FLIP LDR
    std::vector<float> map;                    // a pixel of the area: d of the channel that differs most; NaN: not finite
    std::vector<uint8_t> keep;                 // crop and mask
    bool identical = false;                    // same values everywhere, not a number equal to itself
    double largest = 0;                        // |d|; infinite where one is not finite and the other differs
    std::size_t notFinite = 0;                 // pixels that are not finite in A or B
    Over failing, warning;
    judge::Channel worstChannel = judge::Channel::red; // the one of the largest |d|
    const judge::ChannelReport& of(judge::Channel c) const { return report.channels[std::size_t(c)]; }
};
Difference measureDifference(const DiffInputs&, const DiffSettings&, Diagnostics&);

struct DiffVerdict {
    Exit code = Exit::done;
    std::string word, reason; // PASS, WARN, FAIL
};
DiffVerdict verdictOf(const DiffInputs&, const Difference&, const DiffSettings&);

std::string diffText(const DiffInputs&, const Difference&, const DiffSettings&);
std::string diffCsv(const DiffInputs&, const Difference&);
std::string diffJson(const DiffInputs&, const Difference&, const DiffSettings&, const DiffVerdict&);
// Returns the scale used.
double writeDifferencePictures(const DiffInputs&, const Difference&, const DiffSettings&);

} // namespace chiaro::cli
