// The false alarms of the judge on real pictures: the path tracer against itself, 200 times, every time with other seeds.
#include "tests/converged/comparison.h"
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace chiaro;
using namespace chiaro::test;

TEST_SUITE("false-alarms") {
    TEST_CASE("path against path, 200 times at alpha .05: 3 to 19 alarms, p-values uniform") {
        const Stage stage("@cornell");
        const Entrant path(chooseIntegrator("path"));
        judge::AgreementSettings settings;
        settings.alpha = 0.05;
        int alarms = 0, strict = 0;
        std::vector<double> luminance, red, tiles;
        const Design d{16, 4, 16, 0, 1};
        for (uint64_t k = 0; k < 200; ++k) {
            const auto side = [&](uint64_t which) {
                Design own = d;
                own.firstSeed = (2 * k + which) * 1000;
                return replicatesOf(stage, path.choice, path.paths, own);
            };
            const judge::Replicates a = side(0), b = side(1);
            const auto alarm = [](judge::Verdict v) { return v == judge::Verdict::biased || v == judge::Verdict::differs; };
            const judge::Agreement loose = judge::agree(a, b, settings);
            alarms += alarm(loose.verdict);
            strict += alarm(judge::agree(a, b).verdict);
            luminance.push_back(loose.bias[0].test.p);
            red.push_back(loose.bias[1].test.p);
            tiles.push_back(loose.tiles.p);
        }
        const double p[] = {judge::uniformity(luminance).p, judge::uniformity(red).p, judge::uniformity(tiles).p};
        fmt::print("{} alarms of 200 at alpha .05, {} at the default .001; uniformity of p: luminance {:.3f}, red {:.3f}, tiles {:.3f}\n",
                   alarms, strict, p[0], p[1], p[2]);
        CHECK(alarms >= 3);
        CHECK(alarms <= 19);
        CHECK(strict <= 2); // P(3 or more) = 1.1e-3 at .001
        for (const double each : p) CHECK(each > 0.01);
    }
} // TEST_SUITE
