#include "io/color.h"
#include <cmath>
#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <limits>
#include <unistd.h>

using namespace chiaro;

namespace {

double through(const DisplayTransform& t, float value, double exposure = 0) {
    float rgb[3] = {value, value, value};
    t.apply(rgb, exposure);
    CHECK(rgb[0] == doctest::Approx(rgb[1]).epsilon(1e-4));
    CHECK(rgb[0] == doctest::Approx(rgb[2]).epsilon(1e-4));
    return rgb[1];
}

template <class F> Error errorOf(F&& f) {
    try {
        f();
    } catch (const Error& e) { return e; }
    FAIL("nothing was thrown");
    return Error(Exit::internal, "");
}

std::vector<float> grey(std::initializer_list<float> values) {
    std::vector<float> rgb;
    for (float v : values) rgb.insert(rgb.end(), 3, v);
    return rgb;
}

} // namespace

TEST_SUITE("color") {

    TEST_CASE("the default view is sRGB without tone mapping (verification K1)") {
        unsetenv("OCIO");
        const DisplayTransform t;
        CHECK(t.display() == "sRGB");
        CHECK(t.view() == "Standard");
        CHECK(t.source() == "built in");
        CHECK(t.srgb());
        const double table[][2] = {{.001, .01292}, {.0031308, .04045}, {.01, .0998527}, {.18, .4613561}, {.5, .7353570}, {1, 1}};
        for (const auto& [linear, encoded] : table) CHECK(through(t, float(linear)) == doctest::Approx(encoded).epsilon(2e-4));
        const std::vector<uint8_t> bytes = t.bytes(grey({.18f, .5f, 1, 0, 7, -1, std::nanf("")}), 0);
        CHECK(bytes[0] == 118);
        CHECK(bytes[3] == 188);
        CHECK(bytes[6] == 255);
        CHECK(bytes[9] == 0);
        CHECK(bytes[12] == 255);
        CHECK(bytes[15] == 0);
        CHECK(bytes[18] == 0);
        CHECK(t.bytes(grey({.09f}), 1)[0] == 118); // one stop up
    }

    TEST_CASE("colours keep their channels") {
        unsetenv("OCIO");
        const DisplayTransform t;
        const std::vector<float> red = {1, 0, 0};
        const std::vector<uint8_t> bytes = t.bytes(red, 0);
        CHECK(bytes[0] == 255);
        CHECK(bytes[1] <= 1);
        CHECK(bytes[2] <= 1);
    }

    TEST_CASE("ACES views") {
        unsetenv("OCIO");
        const DisplayTransform t({}, "ACES 1.0 SDR");
        CHECK(t.display() == "sRGB");
        CHECK(std::abs(through(t, 0.18f) - 0.3560) < 1e-3);
        CHECK(std::abs(through(t, 1) - 0.8120) < 1e-3);
        CHECK(std::abs(through(t, 16) - 0.9997) < 1e-3);
        CHECK(DisplayTransform({}, "aces 1.0 sdr").view() == "ACES 1.0 SDR"); // case does not matter
        CHECK(DisplayTransform({}, "Rec.1886 Rec.709/ACES 1.0 SDR").display() == "Rec.1886 Rec.709");
        CHECK(!DisplayTransform({}, "ACES 1.1 HDR 1000 nit").srgb());
        const std::vector<float> red = {1, 0, 0}; // the transform leaves negative values, the bytes do not
        const std::vector<uint8_t> bytes = t.bytes(red, 0);
        CHECK(bytes[0] > 150);
        CHECK(bytes[1] < 100);
    }

    TEST_CASE("every view of the configuration works") {
        unsetenv("OCIO");
        const std::vector<std::string> views = DisplayTransform::views();
        CHECK(views.size() == 7);
        for (const std::string& v : views) {
            const std::size_t open = v.rfind(" (");
            const std::string name = v.substr(0, open), display = v.substr(open + 2, v.size() - open - 3);
            const DisplayTransform t({}, display + "/" + name);
            CHECK(std::isfinite(through(t, 0.18f)));
            CHECK(through(t, 0.5f) > through(t, 0.18f));
        }
    }

    TEST_CASE("a view that does not exist") {
        unsetenv("OCIO");
        const Error e = errorOf([] { DisplayTransform t({}, "Standart"); });
        CHECK(e.code == Exit::usage);
        CHECK(std::string(e.what()).find("did you mean \"Standard\"?") != std::string::npos);
        CHECK(std::string(e.what()).find("ACES 1.0 SDR") != std::string::npos);
    }

    TEST_CASE("another configuration, by option and by environment") {
        const std::filesystem::path file = std::filesystem::temp_directory_path() / ("chiaro-test-" + std::to_string(getpid()) + ".ocio");
        std::ofstream(file) << "ocio_profile_version: 2\nstrictparsing: true\nroles: {scene_linear: lin, default: lin}\n"
                               "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
                               "displays:\n  Lamp:\n    - !<View> {name: Plain, colorspace: half}\nactive_displays: []\nactive_views: []\n"
                               "colorspaces:\n  - !<ColorSpace> {name: lin}\n"
                               "  - !<ColorSpace> {name: half, from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, "
                               "0, 0, 0, 0.5, 0, 0, 0, 0, 1]}}\n";
        const auto checkPlain = [](const DisplayTransform& t) {
            CHECK(t.view() == "Plain");
            CHECK(through(t, 0.5f) == doctest::Approx(0.25));
            CHECK(!t.note().empty()); // nothing says what Rec.709 is
        };
        checkPlain(DisplayTransform(file.string()));
        setenv("OCIO", file.c_str(), 1);
        checkPlain(DisplayTransform());
        setenv("OCIO", "/no/such.ocio", 1);
        CHECK(std::string(errorOf([] { DisplayTransform t; }).what()).find("$OCIO") != std::string::npos);
        unsetenv("OCIO");
        CHECK(errorOf([] { DisplayTransform t("/no/such.ocio"); }).code == Exit::file);
        std::filesystem::remove(file);
    }

    TEST_CASE("automatic exposure") {
        CHECK(autoExposure({}) == 0);
        CHECK(autoExposure(grey({0, 0, 0})) == 0);
        CHECK(autoExposure(grey({.18f, .18f})) == 0);
        CHECK(autoExposure(grey({.09f, 0, .36f})) == 0); // the geometric mean of what is lit
        CHECK(autoExposure(grey({.045f})) == doctest::Approx(2));
        CHECK(autoExposure(grey({.18f * 3})) == doctest::Approx(-1.6)); // log2(3) = 1.585, down to tenths
        CHECK(autoExposure(grey({.18f, std::nanf(""), std::numeric_limits<float>::infinity(), -1})) == 0);
        CHECK(!std::signbit(autoExposure(grey({.18f}))));
    }

    TEST_CASE("the 99.5 % quantile is kept below clipping") {
        std::vector<float> rgb;
        for (int i = 0; i < 1000; ++i) rgb.insert(rgb.end(), 3, i < 990 ? 0.01f : 4.0f); // one per cent is bright
        const double ev = autoExposure(rgb);
        CHECK(ev == doctest::Approx(-2)); // 4 x 2^-2 = 1
        std::vector<float> few;
        for (int i = 0; i < 1000; ++i) few.insert(few.end(), 3, i < 997 ? 0.01f : 4.0f); // three of a thousand may clip
        CHECK(autoExposure(few) > 3.9);
    }

    TEST_CASE("lamps in the picture do not count, unless there is little else") {
        const std::vector<float> rgb = grey({.18f, .18f, .18f, 100});
        const std::vector<uint8_t> lamps = {0, 0, 0, 1}, all = {1, 1, 1, 1};
        CHECK(autoExposure(rgb) == doctest::Approx(-2.3)); // log2(100 / 0.18) / 4 = 2.28, down to tenths
        CHECK(autoExposure(rgb, lamps) == 0);
        CHECK(autoExposure(rgb, all) == doctest::Approx(-2.3));
    }

} // TEST_SUITE
