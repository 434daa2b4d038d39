#include "tools/cli/progress_bar.h"
#include "tools/cli/console.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace chiaro::cli {
namespace {

using namespace std::chrono_literals;

std::string wholePercent(double fraction) { return fmt::format("{:>3.0f} %", std::floor(fraction * 100)); }

std::string noiseText(double noise) { return std::isfinite(noise) && noise > 0 ? "  noise " + percent(noise) : ""; }

std::chrono::milliseconds interval(ProgressMode mode) {
    return mode == ProgressMode::bar ? 200ms : mode == ProgressMode::json ? 1000ms : 10000ms;
}

} // namespace

ProgressBar::ProgressBar(ProgressMode mode, bool quiet, double seconds) : mode_(mode), seconds_(seconds) {
    if (mode_ == ProgressMode::automatic) mode_ = quiet ? ProgressMode::none : stderrIsTerminal() ? ProgressMode::bar : ProgressMode::lines;
    next_ = Clock::now() + interval(mode_);
    if (mode_ == ProgressMode::bar) next_ = Clock::now() + 100ms; // what is done at once needs no bar
}

void ProgressBar::phase(std::string_view what) {
    const std::lock_guard lock(mutex_);
    if (mode_ != ProgressMode::none && mode_ != ProgressMode::json) {
        if (drawn_) fmt::print(stderr, "\r\x1b[K");
        drawn_ = false;
        fmt::print(stderr, "{:<8} {}\n", "prepare", what);
    }
}

// Of the work, 0..1: of whichever budget is nearer to its end.
double ProgressBar::fraction(const RenderStatus& s) const {
    const double bySamples = s.sppTarget > 0 ? s.samples / s.sppTarget : 0;
    const double byTime = std::isfinite(seconds_) ? s.seconds / seconds_ : 0;
    return std::clamp(std::max(bySamples, byTime), 0.0, 1.0);
}

std::string ProgressBar::text(const RenderStatus& s) const {
    constexpr int cells = 30;
    const double done = fraction(s);
    const int full = int(done * cells);
    const bool open = s.sppTarget == 0 || s.sppTarget >= 1u << 31; // no number of samples ends it
    const std::string target = open ? "" : fmt::format("/{}", s.sppTarget);
    const std::string left = s.secondsLeft >= 0 ? fmt::format(", {} left", duration(s.secondsLeft)) : "";
    return fmt::format("render   [{:#<{}}{:-<{}}] {}  {}{} spp  {}{}{}  {}", "", full, "", cells - full, wholePercent(done),
                       uint64_t(s.samples), target, duration(s.seconds), left, noiseText(lastNoise_), memorySize(double(residentBytes())));
}

std::string ProgressBar::json(const RenderStatus& s) const {
    nlohmann::ordered_json line{{"progress", fraction(s)}, {"spp", uint64_t(s.samples)}, {"seconds", s.seconds}};
    if (s.secondsLeft >= 0) line["secondsLeft"] = s.secondsLeft;
    if (std::isfinite(lastNoise_) && lastNoise_ > 0) line["noise"] = lastNoise_;
    line["memory"] = residentBytes();
    return line.dump();
}

void ProgressBar::draw(const RenderStatus& s) {
    if (mode_ == ProgressMode::json)
        fmt::print(stderr, "{}\n", json(s));
    else if (mode_ == ProgressMode::lines)
        fmt::print(stderr, "{}\n", text(s));
    else {
        fmt::print(stderr, "\r{}\x1b[K", text(s));
        std::fflush(stderr);
        drawn_ = true;
    }
}

void ProgressBar::render(const RenderStatus& s) noexcept {
    if (mode_ == ProgressMode::none) return;
    try {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        const auto now = Clock::now();
        if (!lock.owns_lock() || now < next_) return;
        next_ = now + interval(mode_);
        if (std::isfinite(s.noise)) lastNoise_ = s.noise;
        draw(s);
    } catch (...) { mode_ = ProgressMode::none; } // progress that cannot be shown is no reason to lose a render
}

void ProgressBar::clear() noexcept {
    const std::lock_guard lock(mutex_);
    if (drawn_) std::fputs("\r\x1b[K", stderr);
    drawn_ = false;
}

} // namespace chiaro::cli
