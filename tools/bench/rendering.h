// An integrator under measure: passes of samples over the whole view, again and again, as the driver would make them once it has warmed up.
#pragma once
#include "tools/bench/bench.h"
#include "tools/bench/measure.h"

namespace chiaro::bench {

std::string nameOf(const IntegratorChoice&); // "path:wide=off"

class Rendering {
public:
    // Prepares it; job lives as long.
    Rendering(const Job&, const IntegratorChoice&);
    double prepareSeconds() const noexcept { return prepared_; }
    // The next pass. The first takes one sample a pixel; from then on a pass takes as many, a power of two and at most sixteen, as are done
    // in about `passSeconds`. Gives how many samples it took.
    double pass(double passSeconds = 0.25);
    // One more pass, whose calls to Embree are counted.
    double raysPerSample();

private:
    const Job& job_;
    std::unique_ptr<Integrator> integrator_;
    std::unique_ptr<Film> film_;
    uint32_t next_ = 0, samples_ = 1;
    double prepared_ = 0;
};

} // namespace chiaro::bench
