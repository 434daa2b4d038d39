// The table of planted faults: how each is tried, and that none is forgotten.
#include "tests/planted/trial.h"
#include <fmt/format.h>
#include <set>

namespace chiaro::test {

namespace {

// With the fault on, from few samples to those of the check.
Trial hunt(const PlantedRow& row) {
    const Planted planted(row.fault);
    for (uint32_t spp = std::min(16u, row.check.spp);; spp = std::min(4 * spp, row.check.spp)) {
        Trial trial(spp);
        row.check.run(trial);
        if (!trial.passed() || spp == row.check.spp) return trial;
    }
}

} // namespace

void catchAll(std::span<const PlantedRow> rows) {
    std::set<const Check*> sound;
    for (const PlantedRow& row : rows) {
        const std::string name = row.check.name, broken = row.broken;
        CAPTURE(name);
        CAPTURE(broken);
        if (sound.insert(&row.check).second) {
            Trial trial(row.check.spp);
            row.check.run(trial);
            INFO("without a fault: " << trial.value() << " for " << trial.expected());
            CHECK(trial.passed());
            fmt::print("     sound: {:<42} {:>9} samples, resolves {:.2g} %\n", name, trial.samples(), 100 * trial.resolution());
        }
        const Trial found = hunt(row);
        CHECK_FALSE(found.passed());
        fmt::print("{:>2} {}: {:<58} by {:<34} {:>9} samples, {:.6g} for {:.6g}\n", row.number ? std::to_string(row.number) : "-",
                   found.passed() ? "MISSED" : "caught", broken, name, found.samples(), found.value(), found.expected());
    }
}

} // namespace chiaro::test

using namespace chiaro;
using namespace chiaro::test;

TEST_SUITE("planted-table") {
    TEST_CASE("every fault is planted in one row, and no fault is on by itself") {
        CHECK(plantedFault == Fault::none);
        std::multiset<Fault> all;
        for (const auto rows : {plantedLights(), plantedTransport(), plantedMaterials(), plantedSurfaces(), plantedFilm(), plantedLens(),
                                plantedMotion(), plantedWhitted(), plantedDistributed(), plantedPhotons(), plantedRadiosity()})
            for (const PlantedRow& row : rows) all.insert(row.fault);
        for (int f = 1; f < int(Fault::count); ++f) {
            CAPTURE(f);
            CHECK(all.count(Fault(f)) == 1);
        }
    }
} // TEST_SUITE
