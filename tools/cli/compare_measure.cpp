#include "tools/cli/compare_measure.h"
#include "core/math/vec.h"
#include "tools/judge/flip.h"
#include "tools/judge/special.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace chiaro::cli {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double relativeScale = 0.01;      // of judge::MetricSettings
constexpr std::size_t flipPixels = 4 << 20; // beyond, FLIP looks at smaller pictures
constexpr std::size_t jackknifePixels = 300'000, jackknifeGroups = 8;

double ratio(double a, double b) noexcept { return a == 0 ? 0 : a / b; }
bool finite(const float* rgb) noexcept { return std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]); }
double luminanceOf(const float* rgb) noexcept { return luminance(Rgb<double>(rgb[0], rgb[1], rgb[2])); }

struct MeanError {
    double value = nan, error = 0; // standard error; 0: not known
};
// Of the luminance over the finite pixels; errors of a pixel's channels add up, pixels are independent.
MeanError meanOf(const judge::Picture& p) {
    double sum = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < p.rgb.size(); i += 3) {
        if (!finite(&p.rgb[i])) continue;
        sum += luminanceOf(&p.rgb[i]);
        if (!p.error.empty() && finite(&p.error[i])) squares += sqr(luminanceOf(&p.error[i]));
        ++count;
    }
    return count > 0 ? MeanError{sum / count, std::sqrt(squares) / count} : MeanError{};
}

double halfWidth(double standardError, double dof) { return standardError > 0 ? judge::tQuantile(0.025, dof) * standardError : 0; }

// Averages over squares of n x n pixels; what is not finite is left out of them.
judge::Picture smaller(const judge::Picture& p, uint32_t n) {
    judge::Picture out{(p.width + n - 1) / n, (p.height + n - 1) / n, {}, {}, p.name, {}};
    out.rgb.resize(out.pixels() * 3);
    std::vector<uint32_t> counts(out.pixels());
    for (uint32_t y = 0; y < p.height; ++y)
        for (uint32_t x = 0; x < p.width; ++x) {
            const float* rgb = &p.rgb[3 * (std::size_t(y) * p.width + x)];
            const std::size_t at = std::size_t(y / n) * out.width + x / n;
            if (!finite(rgb)) continue;
            for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * at + c] += rgb[c];
            ++counts[at];
        }
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * i + c] /= float(std::max(1u, counts[i]));
    return out;
}

// The merged picture without the seeds of one group; the seeds weigh by their samples.
std::vector<float> without(const Contestant& c, std::size_t group, std::size_t groups) {
    std::vector<double> sum;
    double weight = 0;
    std::size_t k = 0;
    for (const SeedRun& r : c.runs) {
        if (!r.whole) continue;
        if (k++ % groups == group) continue;
        sum.resize(r.picture.rgb.size());
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += r.spp * double(r.picture.rgb[i]);
        weight += r.spp;
    }
    std::vector<float> rgb(sum.size());
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = float(sum[i] / weight);
    return rgb;
}

double jackknifeError(const std::vector<double>& v) {
    const double n = double(v.size());
    double mean = 0, squares = 0;
    for (const double x : v) mean += x / n;
    for (const double x : v) squares += sqr(x - mean);
    return std::sqrt((n - 1) / n * squares);
}

struct Jackknife {
    std::size_t groups = 0; // 0: not done
    double relMse = 0, rmse = 0, flip = 0, efficiency = 0;
};
Jackknife jackknife(const Contestant& c, const ErrorMeter& meter, bool flip, const Executor& run) {
    const std::size_t n = std::min<std::size_t>(c.wholeSeeds(), jackknifeGroups);
    for (const SeedRun& r : c.runs)
        if (r.whole && r.picture.rgb.empty()) return {};
    if (n < 3) return {};
    std::vector<double> relative(n), root(n), flips(n), efficiency(n);
    const judge::Picture& reference = meter.reference();
    flip = flip && reference.pixels() <= jackknifePixels;
    run.chunks(
        n,
        [&](uint64_t k) {
            judge::Picture p{reference.width, reference.height, without(c, k, n), {}, c.name, {}};
            const Squared s = meter.squared(p.rgb);
            relative[k] = s.relative;
            root[k] = std::sqrt(std::max(0.0, s.absolute));
            efficiency[k] = std::log(std::max(s.relative, 1e-300));
            if (flip) flips[k] = flipOf(p, reference).mean;
        },
        nullptr);
    return {n, jackknifeError(relative), jackknifeError(root), flip ? jackknifeError(flips) : 0, jackknifeError(efficiency)};
}

std::vector<report::Metric> metrics(const judge::Picture& p, MeanError mean, double dof, const ErrorMeter* meter, const Flip* flip,
                                    const Jackknife& j, double seconds) {
    std::vector<report::Metric> all;
    all.push_back({"mean", mean.value, halfWidth(mean.error, dof), false, false});
    if (!meter) return all;
    const double reference = meter->referenceMean();
    all.push_back({"relative bias", ratio(mean.value - reference, std::abs(reference)),
                   halfWidth(std::hypot(mean.error, meter->referenceMeanError()) / std::abs(reference), dof), true});
    const Squared s = meter->squared(p.rgb);
    const double jackDof = double(j.groups) - 1;
    all.push_back({"relMSE", s.relative, halfWidth(j.relMse, jackDof), true});
    all.push_back({"RMSE", std::sqrt(std::max(0.0, s.absolute)), halfWidth(j.rmse, jackDof), true});
    if (flip) all.push_back({"FLIP", flip->mean, halfWidth(j.flip, jackDof), true});
    if (seconds > 0 && s.relative > 0) {
        const double value = 1 / (s.relative * seconds);
        all.push_back({"efficiency", value, value * halfWidth(j.efficiency, jackDof), false});
    }
    return all;
}

} // namespace

ErrorMeter::ErrorMeter(const judge::Picture& reference) : reference_(reference) {
    const MeanError mean = meanOf(reference);
    mean_ = mean.value;
    meanError_ = mean.error;
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < reference.rgb.size(); i += 3)
        if (finite(&reference.rgb[i])) {
            sum += double(reference.rgb[i]) + reference.rgb[i + 1] + reference.rgb[i + 2];
            count += 3;
        }
    floor_ = count > 0 ? relativeScale * sqr(sum / count) : 0;
}

Squared ErrorMeter::squared(const std::vector<float>& rgb) const {
    double relative = 0, absolute = 0, count = 0;
    const std::vector<float>& errors = reference_.error;
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        if (!finite(&rgb[i]) || !finite(&reference_.rgb[i])) continue;
        const bool known = !errors.empty() && finite(&errors[i]);
        for (std::size_t k = i; k < i + 3; ++k) {
            const double r = reference_.rgb[k], d = double(rgb[k]) - r, s = known ? double(errors[k]) : 0;
            relative += ratio(d * d - s * s, r * r + floor_);
            absolute += d * d - s * s;
        }
        count += 3;
    }
    return count > 0 ? Squared{relative / count, absolute / count} : Squared{nan, nan};
}

double ErrorMeter::relative(const judge::Picture& p) const {
    const double s = squared(p.rgb).relative;
    return std::isnan(s) ? s : std::sqrt(std::max(0.0, s));
}

Flip flipOf(const judge::Picture& test, const judge::Picture& reference) {
    Flip flip;
    while (reference.pixels() / (std::size_t(flip.reduced) * flip.reduced) > flipPixels) ++flip.reduced;
    std::vector<uint8_t> keep(reference.pixels());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = finite(&test.rgb[3 * i]) && finite(&reference.rgb[3 * i]);
    if (std::find(keep.begin(), keep.end(), 1) == keep.end()) {
        flip.mean = nan;
        flip.map.assign(keep.size(), std::numeric_limits<float>::quiet_NaN());
        return flip;
    }
    if (flip.reduced == 1) {
        judge::FlipResult result = judge::flipHdr(test, reference, keep);
        flip.mean = result.mean;
        flip.map = std::move(result.map);
    } else {
        const judge::FlipResult result = judge::flipHdr(smaller(test, flip.reduced), smaller(reference, flip.reduced));
        const uint32_t width = (test.width + flip.reduced - 1) / flip.reduced;
        flip.mean = result.mean;
        flip.map.resize(keep.size());
        for (uint32_t y = 0; y < test.height; ++y)
            for (uint32_t x = 0; x < test.width; ++x)
                flip.map[std::size_t(y) * test.width + x] = result.map[std::size_t(y / flip.reduced) * width + x / flip.reduced];
    }
    for (std::size_t i = 0; i < keep.size(); ++i)
        if (!keep[i]) flip.map[i] = std::numeric_limits<float>::quiet_NaN();
    return flip;
}

std::vector<report::Metric> metricsOf(const Contestant& c, const judge::Picture& merged, const ErrorMeter* meter, const Flip* flip,
                                      const Executor& run) {
    judge::Moments means;
    for (const SeedRun& r : c.runs)
        if (r.whole) means.add(r.mean);
    const MeanError mean{meanOf(merged).value, means.count() > 1 ? means.standardError() : 0};
    const Jackknife j = meter ? jackknife(c, *meter, flip != nullptr, run) : Jackknife{};
    return metrics(merged, mean, double(means.count()) - 1, meter, flip, j, c.seconds());
}

std::vector<report::Metric> metricsOf(const judge::Picture& p, const ErrorMeter* meter, const Flip* flip) {
    return metrics(p, meanOf(p), std::numeric_limits<double>::infinity(), meter, flip, {}, 0);
}

} // namespace chiaro::cli
