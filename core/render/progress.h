// Progress: how the work tells the user interface where it stands. The driver announces passes, the tile loop advances them; render() is
// called a few times a second, by whatever thread comes by, never by two at once.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string_view>

namespace chiaro {

struct RenderStatus {
    uint32_t spp = 0, sppTarget = 0; // complete samples; target 0: none, time ends it
    double samples = 0;              // complete and begun samples a pixel, with the part of the pass that is done
    double seconds = 0;              // since rendering began
    double secondsLeft = -1;         // negative: not known yet
    double noise = 0;                // Film::noise, NaN before there is one
};

class Progress {
public:
    virtual ~Progress() = default;
    virtual void phase(std::string_view) {}
    virtual void render(const RenderStatus&) noexcept {}

    using Clock = std::chrono::steady_clock;
    struct Plan {
        Clock::time_point start;
        double secondsBudget = 0; // infinity: none
        uint32_t sppBegin = 0, sppTarget = 0;
        uint32_t passBegin = 0, passEnd = 0;
        double noise = 0;
    };
    void beginPass(const Plan&) noexcept;     // between passes
    void advance(double partOfPass) noexcept; // by any thread

private:
    RenderStatus status() const noexcept;
    Plan plan_;
    std::atomic<double> part_{0};
    std::mutex mutex_;
    Clock::time_point shown_{};
};

} // namespace chiaro
