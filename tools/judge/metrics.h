// Error metrics between a picture and its reference, in double with pairwise sums. One table says what exists: its formula texts feed
// --help, its functions the reports. Metrics describe; they never decide on a bias (that is agreement.h).
//
// Defined answers: a pixel with a NaN or infinite value in either picture is left out of everything, and counted; 0/0 is 0 and x/0 is
// infinite, so that black references give an answer; identical pictures have a PSNR of +inf; a metric over no pixels is NaN; pictures of
// unequal size throw Exit::unsupported. Channels that are no RGB are ignored and named (Picture::ignored).
#pragma once
#include "tools/judge/flip.h"
#include "tools/judge/picture.h"
#include <array>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace chiaro::judge {

enum class Channel { all, luminance, red, green, blue };
inline constexpr std::array<Channel, 5> channels{Channel::all, Channel::luminance, Channel::red, Channel::green, Channel::blue};
const char* channelName(Channel) noexcept; // "rgb", "Y", "R", "G", "B"

// The matched values of one channel (`all`: R, G, B of each pixel in turn) and the settings the formulas need.
struct Samples {
    std::vector<double> test, reference;
    std::vector<double> testError, referenceError; // empty where no error is known
    double peak = 0;                               // of PSNR
    double relativeFloor = 0;                      // eps of relMSE: relativeScale (mean ref)^2
    double absoluteFloor = 0;                      // eps of relMSE-abs and MRSE
    double percentFloor = 0;                       // added to |ref| in MAPE: percentScale mean |ref|
    std::size_t count() const noexcept { return reference.size(); }
};

struct Metric {
    const char* name;
    const char* formula; // t test, r reference, d = t - r; mean over the compared values
    const char* unit;
    double (*value)(const Samples&);          // null for FLIP, which looks at whole pictures
    bool signedValue = false, better = false; // better: larger is better
};
std::span<const Metric> metricTable() noexcept;
const Metric* findMetric(std::string_view name) noexcept;

struct MetricSettings {
    Region region;
    std::optional<double> peak;  // of PSNR; absent: the largest |reference|
    double relativeScale = 0.01; // relMSE: eps = relativeScale (mean ref)^2
    double absoluteFloor = 0.01; // relMSE-abs, MRSE: eps
    double percentScale = 0.01;  // MAPE: eps = percentScale mean |ref|
    double trim = 0.001;         // share of the largest |d| left out of the second number
    bool flip = true;
    FlipSettings flipSettings;
};

struct MetricValue {
    double value = 0;
    double trimmed = 0; // the same without the largest |d|: shows what fireflies do, never a verdict
};
struct Worst {
    uint32_t x = 0, y = 0;
    double difference = 0, test = 0, reference = 0; // signed t - r at the largest |d|
};
struct ChannelReport {
    Channel channel = Channel::all;
    std::size_t count = 0;
    std::vector<MetricValue> values; // in the order of metricTable(); FLIP in Channel::all, else NaN
    double meanTest = 0, meanReference = 0;
    // Standard error of mean(d), where errors are known: pixels independent, channels of one pixel fully correlated (a safe bound).
    std::optional<double> meanDifferenceError;
    double maxOverMedian = 0; // of the test: large where fireflies are
    double peak = 0, relativeFloor = 0, absoluteFloor = 0, percentFloor = 0;
    Worst worst;
};
struct Report {
    std::size_t selected = 0, compared = 0;                // pixels in crop and mask; of them finite in both
    std::size_t nonFiniteTest = 0, nonFiniteReference = 0; // pixels left out
    std::vector<ChannelReport> channels;                   // in the order of judge::channels
    std::optional<FlipResult> flipLdr, flipHdr;
    std::vector<std::string> ignoredTest, ignoredReference;                       // channels not compared
    double value(std::string_view metric, Channel = Channel::all) const noexcept; // NaN for an unknown name
};

Report compare(const Picture& test, const Picture& reference, const MetricSettings& = {});

} // namespace chiaro::judge
