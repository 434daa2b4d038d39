// The numbers that the pages of the built-in scenes promise, measured by path tracing. Where noise decides, 16 independent replicas give
// the mean and its standard error; five of them are allowed (Student's t with 15 degrees of freedom: 2e-4).
#include "scenes/builtin.h"
#include "tests/scene_kit.h"
#include <cmath>
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

namespace {

struct Stage {
    const BuiltinScene& builtin;
    std::unique_ptr<const Scene> scene = compiled(builtin.make());
    Settings settings;

    explicit Stage(std::string_view name) : builtin(*findBuiltin(name)) {
        settings.width = builtin.width;
        settings.height = builtin.height;
    }
    Spectrum mean(std::size_t camera = 0) const { return rendered(*scene, scene->cameras()[camera], settings).mean; }
    void onePixel(uint32_t x, uint32_t y) { settings.crop = {x, y, x + 1, y + 1}; }
    // Mean of the first channel over independent replicas, and its standard error.
    struct Estimate {
        double value = 0, error = 0;
    };
    Estimate replicas(int n, std::size_t camera = 0) {
        double sum = 0, squares = 0;
        for (int i = 0; i < n; ++i) {
            settings.seed = uint64_t(i) + 1;
            const double v = mean(camera)[0];
            sum += v;
            squares += v * v;
        }
        const double m = sum / n;
        return {m, std::sqrt(std::max(0.0, squares / n - m * m) / (n - 1))};
    }
};

} // namespace

TEST_SUITE("builtin numbers") {

    TEST_CASE("@furnace: the geometric series, exactly 2 in the end") {
        Stage s("@furnace");
        s.settings.width = s.settings.height = 32;
        double expected = 0;
        for (uint32_t depth = 0; depth <= 3; ++depth) {
            expected += std::pow(0.5, depth);
            s.settings.maxDepth = depth;
            const auto got = s.replicas(16);
            CAPTURE(depth);
            CHECK(std::abs(got.value - expected) < 5 * got.error + 1e-6);
            CHECK(got.error < 2e-3);
        }
        s.settings.maxDepth = unlimitedDepth;
        const auto got = s.replicas(8);
        CHECK(std::abs(got.value - 2) < 5 * got.error);
        CHECK(got.error < 2e-3);
    }

    TEST_CASE("@cornell: direct light on the short block by Lambert's polygon formula") {
        Stage s("@cornell");
        s.onePixel(324, 335);
        s.settings.spp = 16384;
        s.settings.maxDepth = 1;
        const Spectrum got = s.mean();
        CHECK(got[0] == doctest::Approx(0.300235).epsilon(0.002));
        CHECK(got[1] == doctest::Approx(0.249281).epsilon(0.002));
        CHECK(got[2] == doctest::Approx(0.122435).epsilon(0.002));
    }

    TEST_CASE("@cornell: the mean of the picture agrees with another renderer's within 1 %") {
        Stage s("@cornell");
        s.settings.width = s.settings.height = 128;
        s.settings.spp = 64;
        const Spectrum got = s.mean();
        CHECK(got[0] == doctest::Approx(0.214164).epsilon(0.01));
        CHECK(got[1] == doctest::Approx(0.166773).epsilon(0.01));
        CHECK(got[2] == doctest::Approx(0.073202).epsilon(0.01));
    }

    TEST_CASE("@cornell-spheres: the lamp in the mirror ball and on the glass ball") {
        Stage s("@cornell-spheres");
        s.settings.spp = 64;
        s.settings.maxDepth = 1;
        s.onePixel(201, 322);
        CHECK(s.mean()[0] == doctest::Approx(18.4 * 0.95004).epsilon(1e-4));
        s.onePixel(318, 324);
        s.settings.spp = 4096;
        CHECK(s.mean()[0] == doctest::Approx(18.4 * 0.059364).epsilon(0.02));
    }

    TEST_CASE("@veach-mis: a lamp seen directly shows its radiance") {
        Stage s("@veach-mis");
        s.settings.maxDepth = 0;
        s.onePixel(547, 97);
        const Spectrum got = s.mean();
        CHECK(got[0] == doctest::Approx(4.4921).epsilon(1e-4));
        CHECK(got[1] == doctest::Approx(2.6953).epsilon(1e-4));
        CHECK(got[2] == doctest::Approx(3.5937).epsilon(1e-4));
    }

    TEST_CASE("@caustic: light through the ball on the square of half side 0.1 around the focus") {
        Stage s("@caustic");
        s.settings.width = s.settings.height = 64;
        s.settings.spp = 128;
        s.settings.maxDepth = 3;
        const auto got = s.replicas(16, 1);
        CHECK(std::abs(got.value - 14.2115) < 5 * got.error);
        CHECK(got.error < 0.02 * 14.2115);
    }

} // TEST_SUITE
