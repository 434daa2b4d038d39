#include "tools/bake/bake.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace chiaro::bake {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t block = 64; // sites

// The average |even - odd| / 2 of a site over the average: as Film::noise.
double noiseOf(std::span<const SiteSum> sums) {
    double error = 0, mean = 0;
    for (const SiteSum& s : sums) {
        if (s.counted[0] == 0 || s.counted[1] == 0) return std::numeric_limits<double>::quiet_NaN();
        const double even = s.half[0] / s.counted[0], odd = s.half[1] / s.counted[1];
        error += std::fabs(even - odd) / 2;
        mean += (even + odd) / 2;
    }
    constexpr double fromMeanDeviation = 1.2533141373155003; // sqrt(pi / 2): of a normal distribution
    return mean > 0 ? fromMeanDeviation * error / mean : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

bool leaks(const SiteSum& s) noexcept { return s.rays > 0 && 2 * s.backs > s.rays; }

MapTexel valueOf(const SiteSum& s) noexcept {
    MapTexel t;
    const double n = s.kept();
    if (!(n > 0)) return t;
    for (std::size_t c = 0; c < 3; ++c) {
        t.irradiance[c] = float(s.irradiance[c] / n);
        t.outgoing[c] = float(s.outgoing[c] / n);
    }
    t.opacity = float(s.opacity / n);
    t.known = !leaks(s);
    return t;
}

BakeResult bake(const Job& job, const Gather& gather, const Sites& sites, std::span<SiteSum> sums, const Budget& budget, StopToken& stop) {
    const Clock::time_point start = Clock::now();
    const std::size_t blocks = (sums.size() + block - 1) / block;
    BakeResult r;
    r.noise = std::numeric_limits<double>::quiet_NaN();
    for (uint32_t begin = 0; begin < budget.spp;) {
        const uint32_t end = uint32_t(std::min<uint64_t>(budget.spp, begin == 0 ? 1 : 2 * uint64_t(begin)));
        job.progress.beginPass({start, budget.seconds, 0, budget.spp, begin, end, r.noise});
        if (begin > 0 && std::isfinite(budget.seconds))
            stop.setDeadline(start +
                             std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(budget.seconds, 1e9))));
        const auto one = [&](uint64_t b) {
            const std::size_t first = b * block;
            gather.samples(sites, first, sums.subspan(first, std::min(block, sums.size() - first)), end);
            job.progress.advance(1.0 / double(blocks));
        };
        const bool whole = job.run.chunks(blocks, one, &stop);
        if (whole) r.spp = begin = end;
        r.noise = noiseOf(sums);
        if (!whole || stop.requested()) {
            r.ended = stop.cancelled() ? Ended::stopped : begin < budget.spp ? Ended::time : Ended::spp;
            break;
        }
    }
    r.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    Rgb<double> mean(0.0);
    double known = 0;
    for (const SiteSum& s : sums) {
        r.dropped += s.dropped;
        r.leaks += leaks(s);
        if (!(s.kept() > 0)) continue;
        mean += s.irradiance * (1 / s.kept());
        ++known;
    }
    for (std::size_t c = 0; c < 3; ++c) r.mean[c] = known > 0 ? float(mean[c] / known) : 0;
    return r;
}

} // namespace chiaro::bake
