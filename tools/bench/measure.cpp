#include "tools/bench/measure.h"
#include <algorithm>

namespace chiaro::bench {

double median(std::vector<double> v) {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    return v.size() % 2 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}

Stopwatch::Stopwatch(double seconds, std::size_t figures, uint32_t runs, const StopToken& stop)
    : total_(seconds), figures_(std::max<std::size_t>(1, figures)), runs_(std::max(1u, runs)), stop_(stop) {}

std::optional<Rate> Stopwatch::rate(FunctionRef<double()> batch) {
    const double share = std::max(0.0, left()) / double(figures_);
    if (figures_ > 1) --figures_;
    const auto begin = Clock::now();
    const double warm = batch();
    if (stop_.requested()) return {};
    std::vector<double> rates;
    if (const double taken = secondsSince(begin); taken > share && warm > 0) rates.push_back(warm / taken); // one is all there is time for
    for (uint32_t r = 0; r < runs_ && rates.size() < runs_ && (rates.empty() || secondsSince(begin) < share); ++r) {
        const auto start = Clock::now();
        const double until = (share - std::chrono::duration<double>(start - begin).count()) / (runs_ - r);
        double done = 0;
        do {
            done += batch();
            if (stop_.requested()) return {};
        } while (secondsSince(start) < until);
        rates.push_back(done / secondsSince(start));
    }
    const auto [least, most] = std::minmax_element(rates.begin(), rates.end());
    const double middle = median(rates);
    return Rate{middle, middle > 0 ? (*most - *least) / middle : 0, uint32_t(rates.size())};
}

std::optional<double> Stopwatch::seconds(FunctionRef<void()> work) {
    std::vector<double> all;
    const double share = std::max(0.0, left()) / double(figures_);
    if (figures_ > 1) --figures_;
    const auto begin = Clock::now();
    do {
        const auto start = Clock::now();
        work();
        if (stop_.requested()) return {};
        all.push_back(secondsSince(start));
    } while (all.size() < runs_ && secondsSince(begin) + all.back() < share);
    return median(all);
}

} // namespace chiaro::bench
