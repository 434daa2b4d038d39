#include "core/render/progress.h"
#include <algorithm>
#include <cmath>

namespace chiaro {

void Progress::beginPass(const Plan& plan) noexcept {
    plan_ = plan;
    part_.store(0);
    const std::lock_guard lock(mutex_);
    render(status());
    shown_ = Clock::now();
}

void Progress::advance(double partOfPass) noexcept {
    part_.fetch_add(partOfPass);
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const auto now = Clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    render(status());
}

RenderStatus Progress::status() const noexcept {
    RenderStatus s;
    s.spp = plan_.passBegin;
    s.sppTarget = plan_.sppTarget;
    s.samples = plan_.passBegin + std::min(1.0, part_.load()) * (plan_.passEnd - plan_.passBegin);
    s.seconds = std::chrono::duration<double>(Clock::now() - plan_.start).count();
    s.noise = plan_.noise;
    const double taken = s.samples - plan_.sppBegin;
    if (plan_.sppTarget && taken > 0.02) s.secondsLeft = s.seconds * (plan_.sppTarget - s.samples) / taken;
    if (std::isfinite(plan_.secondsBudget)) {
        const double left = std::max(0.0, plan_.secondsBudget - s.seconds);
        s.secondsLeft = s.secondsLeft < 0 ? left : std::min(left, s.secondsLeft);
    }
    return s;
}

} // namespace chiaro
