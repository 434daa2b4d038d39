#include "tools/judge/metrics.h"
#include "core/math/vec.h"
#include "tools/judge/pairwise.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

namespace chiaro::judge {

namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool finitePixel(const Picture& p, std::size_t i) noexcept {
    return std::isfinite(p.rgb[3 * i]) && std::isfinite(p.rgb[3 * i + 1]) && std::isfinite(p.rgb[3 * i + 2]);
}
double luminanceOf(const float* rgb) noexcept { return luminance(Rgb<double>(rgb[0], rgb[1], rgb[2])); }

void append(std::vector<double>& out, const std::vector<float>& plane, std::size_t pixel, Channel c) {
    const float* v = plane.data() + 3 * pixel;
    switch (c) {
    case Channel::all: out.insert(out.end(), {double(v[0]), double(v[1]), double(v[2])}); break;
    case Channel::luminance: out.push_back(luminanceOf(v)); break; // of errors: the bound for fully correlated channels
    case Channel::red: out.push_back(v[0]); break;
    case Channel::green: out.push_back(v[1]); break;
    case Channel::blue: out.push_back(v[2]); break;
    }
}

Samples gather(const Picture& test, const Picture& reference, const std::vector<std::size_t>& pixels, Channel c,
               const MetricSettings& settings) {
    Samples s;
    for (const std::size_t i : pixels) {
        append(s.test, test.rgb, i, c);
        append(s.reference, reference.rgb, i, c);
        if (!test.error.empty()) append(s.testError, test.error, i, c);
        if (!reference.error.empty()) append(s.referenceError, reference.error, i, c);
    }
    if (s.count() == 0) return s;
    double peak = 0;
    for (const double r : s.reference) peak = std::max(peak, std::abs(r));
    s.peak = settings.peak.value_or(peak);
    const double mean = pairwiseMean(s.count(), [&](std::size_t i) { return s.reference[i]; });
    s.relativeFloor = settings.relativeScale * mean * mean;
    s.absoluteFloor = settings.absoluteFloor;
    s.percentFloor = settings.percentScale * pairwiseMean(s.count(), [&](std::size_t i) { return std::abs(s.reference[i]); });
    return s;
}

// The samples without the share of largest |d| (of equal ones the first); the floors stay those of the whole.
Samples trimmed(const Samples& s, double share) {
    const std::size_t drop = std::min(s.count(), std::size_t(std::ceil(share * double(s.count()))));
    if (drop == 0) return s;
    const auto size = [&](std::size_t i) { return std::abs(s.test[i] - s.reference[i]); };
    std::vector<double> sizes(s.count());
    for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = size(i);
    const auto last = sizes.begin() + std::ptrdiff_t(drop - 1);
    std::nth_element(sizes.begin(), last, sizes.end(), std::greater<>());
    const double limit = *last;
    std::size_t equal = drop - std::size_t(std::count_if(sizes.begin(), last, [&](double v) { return v > limit; })); // to drop at the limit
    Samples kept{{}, {}, {}, {}, s.peak, s.relativeFloor, s.absoluteFloor, s.percentFloor};
    for (std::size_t i = 0; i < s.count(); ++i) {
        const double v = size(i);
        if (v > limit) continue;
        if (v == limit && equal > 0) {
            --equal;
            continue;
        }
        kept.test.push_back(s.test[i]);
        kept.reference.push_back(s.reference[i]);
        if (!s.testError.empty()) kept.testError.push_back(s.testError[i]);
        if (!s.referenceError.empty()) kept.referenceError.push_back(s.referenceError[i]);
    }
    return kept;
}

std::optional<double> meanDifferenceError(const Samples& s, Channel c) {
    if ((s.testError.empty() && s.referenceError.empty()) || s.count() == 0) return {};
    // The channels of a pixel share its paths: their errors add up, those of different pixels add as squares.
    const std::size_t group = c == Channel::all ? 3 : 1;
    const auto variance = [&](const std::vector<double>& errors, std::size_t pixel) {
        double sum = 0;
        for (std::size_t k = 0; k < group && !errors.empty(); ++k) sum += errors[pixel * group + k];
        return sum * sum;
    };
    const double sum =
        pairwiseSum(0, s.count() / group, [&](std::size_t i) { return variance(s.testError, i) + variance(s.referenceError, i); });
    return std::sqrt(sum) / double(s.count());
}

double maxOverMedian(std::vector<double> values) {
    if (values.empty()) return nan;
    const double most = *std::max_element(values.begin(), values.end());
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return most == 0 ? 0 : most / *middle;
}

Worst worstOf(const Samples& s, const std::vector<std::size_t>& pixels, Channel c, uint32_t width) {
    Worst w;
    const std::size_t group = c == Channel::all ? 3 : 1;
    for (std::size_t i = 0; i < s.count(); ++i) {
        const double d = s.test[i] - s.reference[i];
        if (i > 0 && !(std::abs(d) > std::abs(w.difference))) continue;
        const std::size_t pixel = pixels[i / group];
        w = {uint32_t(pixel % width), uint32_t(pixel / width), d, s.test[i], s.reference[i]};
    }
    return w;
}

ChannelReport reportOn(const Samples& s, const std::vector<std::size_t>& pixels, Channel c, uint32_t width, double trim) {
    ChannelReport r;
    r.channel = c;
    r.count = s.count();
    const Samples few = trimmed(s, trim);
    for (const Metric& m : metricTable()) {
        const bool known = m.value && s.count() > 0;
        r.values.push_back({known ? m.value(s) : nan, known && few.count() > 0 ? m.value(few) : nan});
    }
    r.meanTest = pairwiseMean(s.count(), [&](std::size_t i) { return s.test[i]; });
    r.meanReference = pairwiseMean(s.count(), [&](std::size_t i) { return s.reference[i]; });
    r.meanDifferenceError = meanDifferenceError(s, c);
    r.maxOverMedian = maxOverMedian(s.test);
    r.peak = s.peak;
    r.relativeFloor = s.relativeFloor;
    r.absoluteFloor = s.absoluteFloor;
    r.percentFloor = s.percentFloor;
    r.worst = worstOf(s, pixels, c, width);
    return r;
}

void setFlip(Report& report, const char* name, const FlipResult& flip) {
    const std::size_t i = std::size_t(findMetric(name) - metricTable().data());
    report.channels.front().values[i] = {flip.mean, nan};
}
} // namespace

double Report::value(std::string_view metric, Channel c) const noexcept {
    const Metric* m = findMetric(metric);
    if (!m || channels.empty()) return nan;
    return channels[std::size_t(c)].values[std::size_t(m - metricTable().data())].value;
}

Report compare(const Picture& test, const Picture& reference, const MetricSettings& settings) {
    requireComparable(test, reference, settings.region);
    Report report;
    report.ignoredTest = test.ignored;
    report.ignoredReference = reference.ignored;
    std::vector<uint8_t> keep = selected(test.width, test.height, settings.region);
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (!keep[i]) continue;
        ++report.selected;
        const bool t = finitePixel(test, i), r = finitePixel(reference, i);
        report.nonFiniteTest += !t;
        report.nonFiniteReference += !r;
        keep[i] = t && r;
        if (keep[i]) pixels.push_back(i);
    }
    report.compared = pixels.size();
    for (const Channel c : channels)
        report.channels.push_back(reportOn(gather(test, reference, pixels, c, settings), pixels, c, test.width, settings.trim));
    if (settings.flip) {
        report.flipLdr = flipLdr(test, reference, keep, settings.flipSettings);
        report.flipHdr = flipHdr(test, reference, keep, settings.flipSettings);
        setFlip(report, "flip-ldr", *report.flipLdr);
        setFlip(report, "flip-hdr", *report.flipHdr);
    }
    return report;
}

} // namespace chiaro::judge
