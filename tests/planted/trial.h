// A check that can fail without failing its test: the same function must pass on the sound program and fail on the one with a planted
// fault. Measurements are means of independent replicates against exact numbers (tests/render/measure.h); a trial counts the samples they
// took.
#pragma once
#include "core/render/fault.h"
#include "tests/render/measure.h"
#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace chiaro::test {

// A fault from here to the end of the block. Scenes must be compiled and pictures rendered inside it.
class Planted {
public:
    explicit Planted(Fault f) { plantedFault = f; }
    ~Planted() { plantedFault = Fault::none; }
    Planted(const Planted&) = delete;
    Planted& operator=(const Planted&) = delete;
};

class Trial {
public:
    explicit Trial(uint32_t spp) : spp_(spp) {}
    // Mean luminance of the picture is `expected`, at p = 5e-6; floor: of the arithmetic and the tessellation, relative.
    void equal(const Scene& scene, const CameraDesc& camera, Settings how, double expected, const std::string& integrator = "path",
               double floor = 2e-5) {
        how.spp = spp_;
        const Measured m = measure(scene, camera, how, integrator);
        samples_ += uint64_t(std::max(1u, spp_ / replicates)) * replicates * how.width * how.height;
        const double scale = std::max(std::fabs(expected), 1e-3), allowed = criticalT * m.error + floor * scale;
        judge(m.value, expected, allowed);
        resolution_ = std::max(resolution_, allowed / scale);
    }
    // A number without noise.
    void exact(double value, double expected, double tolerance) {
        ++samples_;
        judge(value, expected, tolerance);
    }
    // A probability that the sound program gives less than once in 200,000 runs.
    void likely(double p, uint64_t samples) {
        samples_ += samples;
        if (p < 5e-6) fail(p, 1);
    }
    bool passed() const { return passed_; }
    uint32_t spp() const { return spp_; }
    uint64_t samples() const { return samples_; }
    double resolution() const { return resolution_; } // the coarsest relative difference that was let pass
    double value() const { return value_; }           // of the first measurement that failed
    double expected() const { return expected_; }

private:
    void judge(double value, double expected, double allowed) {
        if (!(std::fabs(value - expected) <= allowed)) fail(value, expected);
    }
    void fail(double value, double expected) {
        if (!passed_) return;
        passed_ = false;
        value_ = value;
        expected_ = expected;
    }
    uint32_t spp_;
    bool passed_ = true;
    uint64_t samples_ = 0;
    double resolution_ = 0, value_ = 0, expected_ = 0;
};

struct Check {
    const char* name;
    void (*run)(Trial&);
    uint32_t spp; // that resolve what it must find
};
// One planted bug and the check that must find it. number: of the catalogue of failures, 0: none there.
struct PlantedRow {
    Fault fault;
    int number;
    const char* broken;
    const Check& check;
};
std::span<const PlantedRow> plantedLights();
std::span<const PlantedRow> plantedTransport();
std::span<const PlantedRow> plantedMaterials();
std::span<const PlantedRow> plantedSurfaces();
std::span<const PlantedRow> plantedFilm();
std::span<const PlantedRow> plantedLens();
std::span<const PlantedRow> plantedMotion();
std::span<const PlantedRow> plantedWhitted();
std::span<const PlantedRow> plantedDistributed();
std::span<const PlantedRow> plantedPhotons();
std::span<const PlantedRow> plantedRadiosity();

// Every check passes without a fault; every fault is found by its check, with more samples until it is, and the table is printed.
void catchAll(std::span<const PlantedRow>);

} // namespace chiaro::test
