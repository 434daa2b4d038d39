// The comparison report: everything that the page shows, as plain values, and the one function that turns them into one offline file.
// `chiaro compare` fills it; nothing in it is markup: names may hold quotes and angle brackets, values may be NaN.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chiaro::report {

// Linear Rec.709 radiance, row 0 at the top, three floats a pixel; NaN and infinities are shown as what they are.
struct Image {
    std::string name;
    uint32_t width = 0, height = 0;
    std::vector<float> rgb;
};
// A number a pixel against the reference, with the scale that gives it colour: FLIP 0 to 1, z-scores -6 to 6.
struct Map {
    std::string name, caption; // "FLIP", "z-score"; what it means in one sentence
    std::vector<float> values; // width x height of its picture
    float low = 0, high = 1;
    bool diverging = false; // 0 is in the middle and neutral
};
// What `agree` calls it, for colour and order; the sentence stands beside it.
enum class Standing : uint8_t { reference, agrees, cannotTell, missesPaths, biased, differs, debug, unjudged };
struct Metric {
    std::string name; // "relMSE", "FLIP", "mean"
    double value = 0; // NaN: does not apply
    double error = 0; // half width of its 95 % interval over the seeds; 0: not known
    bool smallerIsBetter = true;
    bool ranked = true; // false: no value is better than another (a mean, a count)
};
// One column of the comparison: an integrator, or a picture from anywhere.
struct Entry {
    std::string name;   // as the user sees it: "path", "photon:count=2M", "b.exr"
    std::string source; // "integrator", "file" or "reference"
    std::string covers; // which light paths it makes, one line
    Standing standing = Standing::unjudged;
    std::string verdict; // one sentence
    Image picture;
    std::vector<Image> layers; // per bounce and path class; same size
    std::vector<Map> maps;
    std::vector<Metric> metrics;
    double seconds = 0; // of all seeds together, what comes before the first sample included; 0 where there was no render
    // Before the first sample: a field that was solved for it (--prepass), and its own photon maps, solution or tables.
    double prepassSeconds = 0, prepareSeconds = 0;
    double spp = 0;
    uint32_t seeds = 1;
    uint64_t dropped = 0; // non-finite samples, or non-finite pixels of a file
    std::string file;     // the EXR beside the page
    std::string command;  // that makes this picture alone
};
// Error of one seed of an entry as it renders on: the mean over the seeds, with their spread.
struct CurvePoint {
    double seconds = 0, spp = 0, error = 0; // relative root mean square error to the reference
    double low = 0, high = 0;               // band over the seeds: smallest and largest
};
struct Curve {
    uint32_t entry = 0;
    std::vector<CurvePoint> points;
    std::optional<double> slope, slopeError; // of log error over log spp; an unbiased estimator has -0.5
};
// Seconds until an error is reached, measured or by the fitted slope.
struct TimeToError {
    double error = 0;
    struct Cell {
        double seconds = 0; // NaN: never, as far as can be told
        bool extrapolated = false;
    };
    std::vector<Cell> cells; // one an entry that has a curve, in the order of curves
};
struct Report {
    std::string title, version, command, machine;
    std::vector<std::pair<std::string, std::string>> settings; // name and value, in order
    std::vector<std::string> notes;                            // warnings and what was decided by itself
    double exposure = 0;                                       // EV that every picture is opened with
    std::vector<Entry> entries;                                // the first is the one opened; the reference among them
    std::optional<uint32_t> reference;
    std::vector<Curve> curves;
    std::vector<TimeToError> timeToError;
};
struct WrittenReport {
    std::uintmax_t bytes = 0;
    std::vector<std::string> reductions; // what had to be made smaller for the size limit, as the page says it too
};
// Writes the page beside and renames it. Throws Error: the file cannot be written.
WrittenReport writeReport(const Report&, const std::filesystem::path& file, std::uintmax_t limit = 10'000'000);

} // namespace chiaro::report
