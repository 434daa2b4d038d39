#include "tools/judge/metrics.h"
#include "tools/judge/pairwise.h"
#include <cmath>
#include <string_view>

namespace chiaro::judge {

namespace {

double ratio(double numerator, double denominator) noexcept { return numerator == 0 ? 0 : numerator / denominator; }

template <class Term> double meanOver(const Samples& s, const Term& term) noexcept {
    return pairwiseMean(s.count(), [&](std::size_t i) { return term(s.test[i], s.reference[i]); });
}

double mse(const Samples& s) {
    return meanOver(s, [](double t, double r) { return (t - r) * (t - r); });
}
double rmse(const Samples& s) { return std::sqrt(mse(s)); }
double mae(const Samples& s) {
    return meanOver(s, [](double t, double r) { return std::abs(t - r); });
}
double bias(const Samples& s) {
    return meanOver(s, [](double t, double r) { return t - r; });
}
double relativeBias(const Samples& s) {
    return ratio(bias(s), meanOver(s, [](double, double r) { return r; }));
}

double relativeMse(const Samples& s, double floor) {
    return meanOver(s, [floor](double t, double r) { return ratio((t - r) * (t - r), r * r + floor); });
}
double relMse(const Samples& s) { return relativeMse(s, s.relativeFloor); }
double relMseAbsolute(const Samples& s) { return relativeMse(s, s.absoluteFloor); }
double relMseNet(const Samples& s) {
    if (s.referenceError.empty()) return std::numeric_limits<double>::quiet_NaN();
    return relMse(s) - pairwiseMean(s.count(), [&](std::size_t i) {
               const double r = s.reference[i], e = s.referenceError[i];
               return ratio(e * e, r * r + s.relativeFloor);
           });
}
double mrse(const Samples& s) {
    return meanOver(s, [&](double t, double r) { return ratio((t - r) * (t - r), (r + s.absoluteFloor) * (r + s.absoluteFloor)); });
}
double mape(const Samples& s) {
    return meanOver(s, [&](double t, double r) { return ratio(std::abs(t - r), std::abs(r) + s.percentFloor); });
}
double smape(const Samples& s) {
    return meanOver(s, [](double t, double r) { return ratio(2 * std::abs(t - r), std::abs(t) + std::abs(r)); });
}
double psnr(const Samples& s) {
    const double error = mse(s);
    return error == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(s.peak * s.peak / error);
}
double maxAbs(const Samples& s) {
    double most = s.count() == 0 ? std::numeric_limits<double>::quiet_NaN() : 0;
    for (std::size_t i = 0; i < s.count(); ++i) most = std::max(most, std::abs(s.test[i] - s.reference[i]));
    return most;
}

constexpr Metric table[] = {
    {"mse", "mean d^2", "(cd/m2)^2", mse},
    {"rmse", "sqrt(mean d^2)", "cd/m2", rmse},
    {"mae", "mean |d|", "cd/m2", mae},
    {"bias", "mean d", "cd/m2", bias, true},
    {"relbias", "mean d / mean r", "1", relativeBias, true},
    {"relmse", "mean d^2/(r^2 + e), e = 0.01 (mean r)^2", "1", relMse},
    {"relmse-abs", "mean d^2/(r^2 + e), e = 0.01 (cd/m2)^2", "1", relMseAbsolute},
    {"relmse-net", "relmse - mean s^2/(r^2 + e), s the reference's standard error", "1", relMseNet, true},
    {"mrse", "mean d^2/(r + e)^2, e = 0.01 cd/m2", "1", mrse},
    {"mape", "mean |d|/(|r| + e), e = 0.01 mean |r|", "1", mape},
    {"smape", "mean 2|d|/(|t| + |r|), from 0 to 2", "1", smape},
    {"psnr", "10 log10(peak^2/mean d^2), peak = max |r| unless given", "dB", psnr, false, true},
    {"maxabs", "max |d|", "cd/m2", maxAbs},
    {"flip-ldr", "mean FLIP of both clamped to 0..1 (Andersson et al. 2020)", "1", nullptr},
    {"flip-hdr", "mean over pixels of the largest FLIP over exposures (Andersson et al. 2021)", "1", nullptr},
};
} // namespace

std::span<const Metric> metricTable() noexcept { return table; }

const Metric* findMetric(std::string_view name) noexcept {
    for (const Metric& m : table)
        if (name == m.name) return &m;
    return nullptr;
}

const char* channelName(Channel c) noexcept {
    switch (c) {
    case Channel::all: return "rgb";
    case Channel::luminance: return "Y";
    case Channel::red: return "R";
    case Channel::green: return "G";
    case Channel::blue: return "B";
    }
    return "";
}

} // namespace chiaro::judge
