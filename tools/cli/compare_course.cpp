#include "tools/cli/compare_course.h"
#include <algorithm>
#include <cmath>

namespace chiaro::cli {

void Course::begin(const Part& part) noexcept {
    part_ = part;
    units_ = bySamples_ ? part.samples : part.seconds;
    begun_ = Clock::now();
}

void Course::render(const RenderStatus& one) noexcept {
    const auto since = [](Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); };
    const double bySpp = one.samples / part_.spp, byTime = since(begun_) / part_.mostSeconds;
    const double done = done_ + units_ * std::clamp(std::max(bySpp, byTime), 0.0, 1.0), elapsed = since(start_);
    RenderStatus all;
    all.noise = std::nan("");
    if (bySamples_) {
        all.samples = done;
        all.spp = uint32_t(std::min(done, 4e9));
        all.sppTarget = uint32_t(std::min(planned_, 2e9));
        all.seconds = elapsed;
        if (done > 0) all.secondsLeft = elapsed * std::max(0.0, planned_ / done - 1);
    } else {
        all.samples = one.samples;
        all.spp = one.spp;
        all.seconds = done; // the bar divides it by the plan
        all.secondsLeft = std::max(0.0, planned_ - done) * (done > 1 ? std::clamp(elapsed / done, 1.0, 4.0) : 1);
    }
    whole_.render(all);
}

} // namespace chiaro::cli
