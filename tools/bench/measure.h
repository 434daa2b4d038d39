// The stopwatch of a suite: it shares the suite's time among its figures and gives the median of several runs of each.
#pragma once
#include "core/render/executor.h"
#include <optional>
#include <vector>

namespace chiaro::bench {

using Clock = std::chrono::steady_clock;
inline double secondsSince(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

struct Rate {
    double perSecond = 0; // median of the runs
    double spread = 0;    // (largest - smallest) / median
    uint32_t runs = 0;
};

class Stopwatch {
public:
    // figures: that are going to be measured, all together.
    Stopwatch(double seconds, std::size_t figures, uint32_t runs, const StopToken& stop);
    // batch: does some work and says how much. It is done once to warm up and then again and again, `runs` times over, until the share of
    // this figure is spent; at least one batch is timed. Empty: stopped.
    std::optional<Rate> rate(FunctionRef<double()> batch);
    // How long something takes that is done once a run.
    std::optional<double> seconds(FunctionRef<void()> work);
    double left() const noexcept { return total_ - secondsSince(begin_); }

private:
    double total_;
    std::size_t figures_;
    uint32_t runs_;
    const StopToken& stop_;
    Clock::time_point begin_ = Clock::now();
};

double median(std::vector<double>);

} // namespace chiaro::bench
