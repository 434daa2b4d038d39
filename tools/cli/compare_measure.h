// How far pictures are from the reference, and how sure that is. Means, biases and their 95 % intervals come from the spread over the
// seeds; those of the merged picture's relMSE, RMSE and FLIP from the jackknife: all seeds but one, each in turn (Efron and Stein, The
// Jackknife Estimate of Variance, Annals of Statistics 9(3), 1981). Where the reference knows its own standard error s, the mean square it
// adds to every difference is taken out again: relMSE - mean s^2/(r^2 + e), which can be below zero by chance.
#pragma once
#include "tools/cli/compare_contest.h"
#include "tools/report/report.h"
#include <optional>
#include <span>
#include <vector>

namespace chiaro::cli {

struct Squared {
    double relative = 0, absolute = 0; // relMSE and MSE, both net of the reference's own error
};
// The error of pictures against one reference, quick enough to be asked between passes. The formulas are those of `chiaro diff`.
class ErrorMeter {
public:
    explicit ErrorMeter(const judge::Picture& reference);
    Squared squared(const std::vector<float>& rgb) const;   // NaN: no pixel is finite in both
    double relative(const judge::Picture&) const;           // sqrt(relMSE); 0 where chance makes it negative
    double referenceMean() const noexcept { return mean_; } // luminance
    double referenceMeanError() const noexcept { return meanError_; }
    const judge::Picture& reference() const noexcept { return reference_; }

private:
    double floor_ = 0, mean_ = 0, meanError_ = 0;
    const judge::Picture& reference_;
};

struct Flip {
    double mean = 0;
    std::vector<float> map; // a pixel
    uint32_t reduced = 1;   // pictures were averaged over squares of so many pixels a side before
};
Flip flipOf(const judge::Picture& test, const judge::Picture& reference);

// Of an integrator: all metrics with intervals; flip: that of the merged picture.
std::vector<report::Metric> metricsOf(const Contestant&, const judge::Picture& merged, const ErrorMeter*, const Flip*, const Executor&);
// Of a picture from a file: the same without intervals, but for the mean's where it has an error layer.
std::vector<report::Metric> metricsOf(const judge::Picture&, const ErrorMeter*, const Flip*);

// Error against samples and time, over the whole seeds; none without a snapshot.
std::optional<report::Curve> curveOf(const Contestant&, uint32_t entry);
// endless: of each curve, whether its error falls on with more samples: not where paths are missing or a bias stays.
std::vector<report::TimeToError> timesToError(const std::vector<report::Curve>&, const std::vector<bool>& endless);

} // namespace chiaro::cli
