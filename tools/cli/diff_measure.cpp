#include "io/color.h"
#include "tools/cli/diff.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

using judge::Channel;

FlipKind resolvedFlip(const DiffInputs& in, const DiffSettings& s) {
    if (s.flip != FlipKind::automatic) return s.flip;
    return !in.color ? FlipKind::none : in.linear() ? FlipKind::hdr : FlipKind::ldr;
}

const judge::Metric* metricOf(const std::string& name, FlipKind flip) {
    if (name != "flip") return judge::findMetric(name);
    return flip == FlipKind::none ? nullptr : judge::findMetric(flip == FlipKind::ldr ? "flip-ldr" : "flip-hdr");
}

bool isFlip(const judge::Metric& m) { return m.value == nullptr; }

// What is told: the list asked for, else all but the kind of FLIP that was not picked and what needs an error layer that is not there.
std::vector<const judge::Metric*> toldMetrics(const DiffInputs& in, const DiffSettings& s, FlipKind flip) {
    std::vector<const judge::Metric*> told;
    for (const std::string& name : s.metrics) {
        const judge::Metric* m = metricOf(name, flip);
        if (!m)
            throw Error(Exit::usage, s.flip == FlipKind::none
                                         ? std::string("--metrics flip: --flip none says that there is none")
                                         : fmt::format("--metrics flip: the layer \"{}\" holds no colour; add --flip ldr or hdr", s.layer));
        told.push_back(m);
    }
    if (!s.metrics.empty()) return told;
    for (const judge::Metric& m : judge::metricTable()) {
        if (isFlip(m) && &m != metricOf("flip", flip)) continue;
        if (std::string_view(m.name) == "relmse-net" && in.b.picture.error.empty()) continue;
        told.push_back(&m);
    }
    return told;
}

bool finite(const float* rgb) { return std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]); }

// |d| with what is not finite taken as idiff does: equal infinities, and two that are no numbers, do not differ.
double distance(float a, float b) {
    if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
    const double d = std::abs(double(a) - double(b));
    return std::isfinite(d) ? d : std::numeric_limits<double>::infinity();
}

void lookAtPixels(const DiffInputs& in, const DiffSettings& s, Difference& out) {
    out.keep = judge::selected(in.area.width(), in.area.height(), in.region);
    out.map.resize(out.keep.size());
    out.identical = true;
    for (std::size_t i = 0; i < out.keep.size(); ++i) {
        const float *a = &in.a.picture.rgb[3 * i], *b = &in.b.picture.rgb[3 * i];
        double most = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double d = distance(a[c], b[c]);
            if (d > most) out.map[i] = float(double(a[c]) - double(b[c]));
            most = std::max(most, d);
        }
        const bool whole = finite(a) && finite(b);
        if (!whole) out.map[i] = std::numeric_limits<float>::quiet_NaN();
        if (!out.keep[i]) continue;
        out.notFinite += !whole;
        out.identical &= most == 0;
        out.largest = std::max(out.largest, most);
        out.failing.pixels += most > s.fail.pixels.each;
        out.warning.pixels += most > s.warn.pixels.each;
    }
}

// FLIP LDR sees what a screen shows: the linear pictures times 2^EV.
judge::Picture shownOnScreen(const PictureSide& side, double exposure) {
    judge::Picture p = side.picture;
    if (side.encoded) return p;
    const float gain = float(std::exp2(exposure));
    for (float& v : p.rgb) v *= gain;
    return p;
}

double ldrExposure(const DiffInputs& in, const DiffSettings& s) {
    if (s.exposure) return *s.exposure;
    if (!in.linear() || !in.color) return 0;
    std::vector<float> rgb = in.b.picture.rgb;
    for (float& v : rgb)
        if (!std::isfinite(v)) v = 0;
    return autoExposure(rgb);
}

void measureFlip(const DiffInputs& in, const DiffSettings& s, const judge::Metric& metric, Difference& out) {
    const bool ldr = std::string_view(metric.name) == "flip-ldr";
    if (ldr) out.exposure = ldrExposure(in, s);
    double mean = out.report.compared ? 0 : std::numeric_limits<double>::quiet_NaN();
    if (!out.identical && out.report.compared) {
        std::vector<uint8_t> keep = out.keep;
        for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = keep[i] && std::isfinite(out.map[i]);
        auto& result = ldr ? out.report.flipLdr : out.report.flipHdr;
        result = ldr ? judge::flipLdr(shownOnScreen(in.a, out.exposure), shownOnScreen(in.b, out.exposure), keep)
                     : judge::flipHdr(in.a.picture, in.b.picture, keep);
        mean = result->mean;
    }
    const std::size_t row = std::size_t(&metric - judge::metricTable().data());
    out.report.channels.front().values[row] = {mean, std::numeric_limits<double>::quiet_NaN()};
}

void measureFlips(const DiffInputs& in, const DiffSettings& s, Difference& out) {
    std::vector<const judge::Metric*> wanted = out.metrics;
    for (const Limits* limits : {&s.fail, &s.warn})
        for (const MetricLimit& l : limits->metrics) {
            const judge::Metric* m = metricOf(l.metric, out.flip);
            if (!m) throw Error(Exit::usage, fmt::format("a limit on {} needs --flip ldr or --flip hdr", l.metric));
            wanted.push_back(m);
        }
    for (const judge::Metric& m : judge::metricTable())
        if (isFlip(m) && std::find(wanted.begin(), wanted.end(), &m) != wanted.end()) measureFlip(in, s, m, out);
}

// "3 pixels of a.exr" ...
void tellNotFinite(const DiffInputs& in, const Difference& d, Diagnostics& notes) {
    const auto side = [&](std::size_t n, const std::string& file) {
        if (n > 0) notes.warn(fmt::format("{}: {} of {} pixels are not finite; left out of the metrics", file, n, d.report.selected));
    };
    side(d.report.nonFiniteTest, in.a.file);
    side(d.report.nonFiniteReference, in.b.file);
}

// The reason why a metric is beyond its limit; empty: it is not.
std::string beyond(const DiffInputs& in, const Difference& d, const MetricLimit& limit, const char* option) {
    const judge::Metric& m = *metricOf(limit.metric, d.flip);
    const double value = d.report.value(m.name);
    if (std::isnan(value)) {
        if (d.report.compared > 0)
            throw Error(Exit::unsupported, fmt::format("--{} {}: not known here, {} has no error layer", option, m.name, in.b.file));
        return fmt::format("{} is not known, no pixel is finite (--{})", m.name, option);
    }
    const double seen = m.signedValue ? std::abs(value) : value;
    if (m.better ? seen >= limit.value : seen <= limit.value) return {};
    return fmt::format("{} {:.6g} {} {:.6g} (--{})", m.name, value, m.better ? "is below" : "is above", limit.value, option);
}

std::string pixelReason(const Difference& d, const PixelLimits& limits, const Over& over, const std::string& name) {
    if (over.pixels > 0 && over.percent > limits.percent)
        return fmt::format("{} of {} pixels ({:.3g} %) differ by more than {:.6g} (--{}{})", over.pixels, d.report.selected, over.percent,
                           limits.each, name, limits.percent > 0 ? fmt::format(", {:.6g} % allowed", limits.percent) : "");
    if (d.largest > limits.hard) return fmt::format("a pixel differs by {:.6g}, more than {:.6g} (--hard{})", d.largest, limits.hard, name);
    return {};
}

std::string reasonOf(const DiffInputs& in, const Difference& d, const DiffSettings& s, const Limits& limits, const Over& over,
                     const std::string& name) {
    std::string reasons = s.pixelLimits ? pixelReason(d, limits.pixels, over, name) : std::string();
    for (const MetricLimit& l : limits.metrics) {
        const std::string reason = beyond(in, d, l, (name + "-metric").c_str());
        if (!reason.empty()) reasons += (reasons.empty() ? "" : "; ") + reason;
    }
    return reasons;
}

} // namespace

Difference measureDifference(const DiffInputs& in, const DiffSettings& s, Diagnostics& notes) {
    Difference d;
    d.flip = resolvedFlip(in, s);
    d.metrics = toldMetrics(in, s, d.flip);
    lookAtPixels(in, s, d);
    judge::MetricSettings settings;
    settings.region = in.region;
    settings.peak = s.peak;
    if (!s.peak && !in.linear()) settings.peak = 1;
    settings.flip = false;
    d.report = judge::compare(in.a.picture, in.b.picture, settings);
    for (Over* over : {&d.failing, &d.warning}) over->percent = 100 * double(over->pixels) / double(d.report.selected);
    measureFlips(in, s, d);
    for (const Channel c : {Channel::green, Channel::blue})
        if (std::abs(d.of(c).worst.difference) > std::abs(d.of(d.worstChannel).worst.difference)) d.worstChannel = c;
    if (s.exposure &&
        !std::any_of(d.metrics.begin(), d.metrics.end(), [](const auto* m) { return std::string_view(m->name) == "flip-ldr"; }))
        notes.warn("--exposure changes FLIP LDR alone, which is not measured here; add --flip ldr");
    tellNotFinite(in, d, notes);
    return d;
}

DiffVerdict verdictOf(const DiffInputs& in, const Difference& d, const DiffSettings& s) {
    const std::string failed = reasonOf(in, d, s, s.fail, d.failing, "fail");
    const std::string warned = reasonOf(in, d, s, s.warn, d.warning, "warn");
    if (!failed.empty()) return {Exit::failed, "FAIL", failed};
    if (!warned.empty()) return {Exit::warning, "WARN", warned};
    if (d.identical) return {Exit::done, "PASS", fmt::format("identical in all {} pixels", d.report.selected)};
    return {Exit::done, "PASS", d.largest > 0 ? fmt::format("within the limits, largest difference {:.6g}", d.largest) : "no difference"};
}

} // namespace chiaro::cli
