// The progress of many renders as one: a bar, and the time that is left for all of them together.
#pragma once
#include "core/math/ray.h"
#include "core/render/progress.h"
#include <chrono>

namespace chiaro::cli {

class Course : public Progress {
public:
    // Units of work: seconds, or samples a pixel (bySamples), of all renders together.
    Course(Progress& whole, double planned, bool bySamples) : whole_(whole), planned_(planned), bySamples_(bySamples) {}
    struct Part {
        double samples = 0, seconds = 0;               // what it is worth, as far as is known
        double spp = infinity, mostSeconds = infinity; // where it ends, whichever comes first
    };
    void begin(const Part&) noexcept;
    void end() noexcept { done_ += units_, units_ = 0; }
    void phase(std::string_view) override {} // pre-passes of every seed would flood the terminal
    void render(const RenderStatus&) noexcept override;

private:
    using Clock = std::chrono::steady_clock;
    Progress& whole_;
    Part part_;
    double planned_, done_ = 0, units_ = 0;
    bool bySamples_;
    Clock::time_point start_ = Clock::now(), begun_ = start_;
};

} // namespace chiaro::cli
