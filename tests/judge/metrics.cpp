// Every metric against values computed by hand (row K7 of the verification notes) and its defined answers.
#include "tools/judge/metrics.h"
#include "core/render/error.h"
#include "tests/judge/pictures.h"
#include "tools/judge/pairwise.h"
#include <cmath>
#include <doctest/doctest.h>
#include <set>
#include <string>

using namespace chiaro::judge;
using chiaro::Rect, chiaro::judge::tests::constant, chiaro::judge::tests::make;

namespace {
constexpr float notANumber = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
bool near(double value, double expected, double relative = 1e-6) { return std::abs(value - expected) <= relative * std::abs(expected); }

Picture row(std::vector<float> values, std::string name = "row") { // grey
    return make(
        uint32_t(values.size()), 1, [&](uint32_t x, uint32_t, uint32_t) { return values[x]; }, std::move(name));
}
MetricSettings plain() {
    MetricSettings s;
    s.flip = false;
    return s;
}
} // namespace

TEST_SUITE("metrics") {
    TEST_CASE("row K7, every channel alike") {
        MetricSettings s = plain();
        s.percentScale = 0;
        const Report r = compare(row({1.1f, 1.8f, 4.4f}), row({1, 2, 4}), s);
        for (const Channel c : channels) {
            CAPTURE(channelName(c));
            CHECK(near(r.value("mse", c), 0.07));
            CHECK(near(r.value("rmse", c), 0.2645751));
            CHECK(near(r.value("mae", c), 0.2333333));
            CHECK(near(r.value("bias", c), 0.1));
            CHECK(near(r.value("relbias", c), 0.1 / (7.0 / 3)));
            CHECK(near(r.value("relmse-abs", c), 0.0099566021));
            CHECK(near(r.value("mrse", c), 0.0098846308));
            CHECK(near(r.value("mape", c), 0.1));
            CHECK(near(r.value("smape", c), 0.0985797828));
            CHECK(near(r.value("psnr", c), 10 * std::log10(16 / 0.07)));
            CHECK(near(r.value("maxabs", c), 0.4));
            // e = 0.01 (7/3)^2 = 0.0544444
            CHECK(near(r.value("relmse", c), (0.01 / 1.0544444444 + 0.04 / 4.0544444444 + 0.16 / 16.0544444444) / 3));
            CHECK(std::isnan(r.value("relmse-net", c)));
        }
        const ChannelReport& rgb = r.channels[0];
        CHECK(rgb.count == 9);
        CHECK(rgb.worst.x == 2);
        CHECK(near(rgb.worst.difference, 0.4));
        CHECK(rgb.peak == 4);
        CHECK(near(rgb.relativeFloor, 0.054444444));
        CHECK(near(rgb.meanTest, 7.3 / 3));
        CHECK(near(rgb.maxOverMedian, 4.4 / 1.8));
        s.percentScale = 0.01; // with the floor: e = 0.07/3
        const double e = 0.07 / 3;
        CHECK(near(compare(row({1.1f, 1.8f, 4.4f}), row({1, 2, 4}), s).value("mape"), (0.1 / (1 + e) + 0.2 / (2 + e) + 0.4 / (4 + e)) / 3));
        s.peak = 1;
        CHECK(near(compare(row({1.1f, 1.8f, 4.4f}), row({1, 2, 4}), s).value("psnr"), 10 * std::log10(1 / 0.07)));
    }

    TEST_CASE("channels apart, and luminance") {
        const Report r = compare(constant(4, 3, 1.5, 1, 0), constant(4, 3, 1, 1, 1), plain());
        CHECK(near(r.value("mse", Channel::red), 0.25));
        CHECK(r.value("mse", Channel::green) == 0);
        CHECK(near(r.value("mse", Channel::blue), 1));
        CHECK(near(r.value("mse", Channel::all), 1.25 / 3));
        CHECK(near(r.value("bias", Channel::luminance), 0.5 * 0.2126 - 0.0722));
        CHECK(std::isinf(r.value("psnr", Channel::green)));
        CHECK(std::isnan(r.value("no-such-metric")));
    }

    TEST_CASE("the table names each metric once, with formula and unit") {
        std::set<std::string> names;
        for (const Metric& m : metricTable()) {
            CHECK(names.insert(m.name).second);
            CHECK(std::string(m.formula).size() > 4);
            CHECK(std::string(m.unit).size() > 0);
            CHECK(findMetric(m.name) == &m);
            CHECK((m.value != nullptr) == (std::string(m.name).substr(0, 4) != "flip"));
        }
        CHECK(findMetric("nothing") == nullptr);
        const Report r = compare(constant(8, 8, 1, 1, 1), constant(8, 8, 0, 0, 0));
        CHECK(r.value("flip-ldr") == r.flipLdr->mean);
        CHECK(r.value("flip-hdr") == r.flipHdr->mean);
        CHECK(r.value("flip-ldr") > 0.96);
        CHECK(std::isnan(r.value("flip-ldr", Channel::red)));
    }

    TEST_CASE("NaN and infinite pixels are left out and counted") {
        const Report r = compare(row({1, notANumber, 3, 5, 7}), row({1, 2, infinity, 4, notANumber}), plain());
        CHECK(r.selected == 5);
        CHECK(r.compared == 2);
        CHECK(r.nonFiniteTest == 1);
        CHECK(r.nonFiniteReference == 2);
        CHECK(r.value("mse") == 0.5);
        CHECK(r.channels[0].worst.x == 3);
        Picture test = row({1, 2}), reference = row({1, 3});
        test.rgb[4] = notANumber; // one channel spoils the pixel
        CHECK(compare(test, reference, plain()).value("mse", Channel::red) == 0);
    }

    TEST_CASE("black pictures, equal pictures, no pixels") {
        const Picture black = constant(4, 4, 0, 0, 0), grey = constant(4, 4, 0.5, 0.5, 0.5);
        const Report same = compare(black, black, plain());
        for (const char* name : {"mse", "rmse", "mae", "bias", "relbias", "relmse", "relmse-abs", "mrse", "mape", "smape", "maxabs"}) {
            CAPTURE(name);
            CHECK(same.value(name) == 0);
        }
        CHECK(same.value("psnr") == std::numeric_limits<double>::infinity());
        const Report lit = compare(grey, black, plain());
        CHECK(std::isinf(lit.value("relmse")));
        CHECK(std::isinf(lit.value("mape")));
        CHECK(std::isinf(lit.value("relbias")));
        CHECK(lit.value("smape") == 2);
        CHECK(near(lit.value("relmse-abs"), 25));
        CHECK(lit.value("psnr") == -std::numeric_limits<double>::infinity());
        CHECK(compare(grey, grey, plain()).value("psnr") == std::numeric_limits<double>::infinity());
        const Report nothing = compare(constant(0, 0, 0, 0, 0), constant(0, 0, 0, 0, 0));
        CHECK(nothing.compared == 0);
        for (const Metric& m : metricTable()) CHECK(std::isnan(nothing.value(m.name)));
        const Report spoiled = compare(constant(2, 2, notANumber, 0, 0), constant(2, 2, 0, 0, 0));
        CHECK(spoiled.compared == 0);
        CHECK(spoiled.nonFiniteTest == 4);
        CHECK(std::isnan(spoiled.value("mse")));
    }

    TEST_CASE("crop and mask") {
        const auto values = [](uint32_t x, uint32_t y, uint32_t) { return x == 2 && y == 1 ? 9.0 : 1.0; };
        const Picture test = make(4, 3, values), reference = constant(4, 3, 1, 1, 1);
        MetricSettings s = plain();
        s.region.crop = Rect{2, 1, 4, 3};
        CHECK(compare(test, reference, s).value("mse") == 16);
        CHECK(compare(test, reference, s).channels[0].worst.x == 2);
        CHECK(compare(test, reference, s).channels[0].worst.y == 1);
        s.region.mask.assign(12, 1);
        s.region.mask[1 * 4 + 2] = 0;
        CHECK(compare(test, reference, s).value("mse") == 0);
        CHECK(compare(test, reference, s).selected == 3);
        s.region.crop = Rect{1, 1, 1, 3};
        CHECK(compare(test, reference, s).compared == 0);
        s.region.crop = Rect{2, 1, 5, 3};
        CHECK_THROWS_AS(compare(test, reference, s), chiaro::Error);
        s.region.crop.reset();
        s.region.mask.resize(5);
        CHECK_THROWS_AS(compare(test, reference, s), chiaro::Error);
    }

    TEST_CASE("unequal sizes say so as the command line promises") {
        Picture a = constant(1280, 720, 0, 0, 0), b = constant(1024, 1024, 0, 0, 0);
        a.name = "a.exr";
        b.name = "b.exr";
        try {
            compare(a, b);
            FAIL("no error");
        } catch (const chiaro::Error& e) {
            CHECK(e.code == chiaro::Exit::unsupported);
            CHECK(std::string(e.what()) == "a.exr is 1280x720, b.exr is 1024x1024; use --crop or --fit to compare.");
        }
        Picture cut = constant(4, 4, 0, 0, 0);
        cut.rgb.pop_back();
        CHECK_THROWS_AS(compare(cut, constant(4, 4, 0, 0, 0)), chiaro::Error);
        Picture wrong = constant(4, 4, 0, 0, 0);
        wrong.error.resize(3);
        CHECK_THROWS_AS(compare(wrong, constant(4, 4, 0, 0, 0)), chiaro::Error);
    }

    TEST_CASE("error layers: standard error of the mean difference, relMSE net of the reference's noise") {
        Picture test = row({1, 2, 3, 4}), reference = row({1, 2, 3, 4});
        reference.error.assign(12, 0.3f);
        test.error.assign(12, 0.4f);
        const Report r = compare(test, reference, plain());
        for (const Channel c : channels) CHECK(near(r.channels[std::size_t(c)].meanDifferenceError.value(), 0.5 / 2, 1e-6)); // 0.5/sqrt(4)
        const double e = 0.01 * 2.5 * 2.5;
        CHECK(near(r.value("relmse-net"), -0.09 * (1 / (1 + e) + 1 / (4 + e) + 1 / (9 + e) + 1 / (16 + e)) / 4));
        CHECK_FALSE(compare(row({1}), row({1}), plain()).channels[0].meanDifferenceError);
    }

    TEST_CASE("fireflies: the second number leaves them out") {
        const Picture reference = constant(50, 40, 1, 1, 1);
        const Picture test = make(50, 40, [](uint32_t x, uint32_t y, uint32_t) { return x == 7 && y == 9 ? 1001.0 : 1.1; });
        const Report r = compare(test, reference, plain());
        const MetricValue mse = r.channels[1].values[0];
        CHECK(near(mse.value, (1e6 + 1999 * 0.01) / 2000, 1e-5));
        CHECK(near(mse.trimmed, 0.01, 1e-5));
        CHECK(r.channels[1].maxOverMedian > 900);
        MetricSettings half = plain(); // ties: of four equal differences two stay
        half.trim = 0.5;
        CHECK(near(compare(row({2, 2, 2, 2}), row({1, 1, 1, 1}), half).channels[1].values[0].trimmed, 1));
        CHECK(near(compare(row({1, 2, 3, 4}), row({1, 1, 1, 1}), half).channels[1].values[0].trimmed, 0.5));
        half.trim = 1;
        CHECK(std::isnan(compare(row({2}), row({1}), half).channels[1].values[0].trimmed));
        half.trim = 0;
        CHECK(compare(row({2}), row({1}), half).channels[1].values[0].trimmed == 1);
    }

    TEST_CASE("channels are found by name, the others are named") {
        const ChannelChoice rgba = chooseChannels({"A", "B", "G", "R", "Z"});
        CHECK(rgba.red == 3u);
        CHECK(rgba.green == 2u);
        CHECK(rgba.blue == 1u);
        CHECK(rgba.ignored == std::vector<std::string>{"A", "Z"});
        const ChannelChoice layer = chooseChannels({"R", "G", "B", "error.R", "error.G", "error.B"}, "error");
        CHECK(layer.red == 3u);
        CHECK(layer.ignored.size() == 3);
        CHECK(chooseChannels({"Y"}).green == 0u);
        CHECK(chooseChannels({"depth"}).blue == 0u);
        CHECK_FALSE(chooseChannels({"Z", "id"}).red);
        Picture p = constant(2, 2, 1, 1, 1);
        p.ignored = {"A"};
        CHECK(compare(p, constant(2, 2, 1, 1, 1), plain()).ignoredTest == std::vector<std::string>{"A"});
    }

    TEST_CASE("pairwise sums keep what plain sums lose") {
        const std::size_t n = 10'000'000;
        const double sum = pairwiseSum(0, n, [](std::size_t) { return 0.1; });
        CHECK(std::abs(sum - 1e6) < 1e-8); // a plain sum is off by 1.6e-4
        CHECK(std::isnan(pairwiseMean(0, [](std::size_t) { return 1.0; })));
    }
}
