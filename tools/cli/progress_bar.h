// Progress on stderr: a bar on a terminal (at most five redraws a second), a line every ten seconds elsewhere, or JSON, a line a second.
#pragma once
#include "core/render/progress.h"
#include <chrono>
#include <mutex>
#include <string>

namespace chiaro::cli {

enum class ProgressMode { automatic, bar, lines, json, none };

class ProgressBar : public Progress {
public:
    // seconds: the time budget, infinity without one.
    ProgressBar(ProgressMode, bool quiet, double seconds);
    void phase(std::string_view) override;
    void render(const RenderStatus&) noexcept override;
    void budget(double seconds) noexcept { seconds_ = seconds; } // what is left of it; before rendering begins
    void clear() noexcept;                                       // the bar gives its line back

private:
    using Clock = std::chrono::steady_clock;
    double fraction(const RenderStatus&) const;
    std::string text(const RenderStatus&) const;
    std::string json(const RenderStatus&) const;
    void draw(const RenderStatus&);

    ProgressMode mode_;
    double seconds_;
    std::mutex mutex_;
    Clock::time_point next_; // no earlier redraw
    bool drawn_ = false;
    double lastNoise_ = 0;
};

} // namespace chiaro::cli
