// The sheet: pictures in whole factors or averaged in linear light, labels that stay in their cells, one exposure for all, and reports that
// nobody expects.
#include "tools/cli/sheet.h"
#include "io/picture.h"
#include "tests/cli/program.h"
#include "tools/cli/sheet_picture.h"
#include "tools/judge/false_color.h"
#include <cmath>
#include <limits>

using namespace chiaro;
using namespace chiaro::cli;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN();

report::Entry entry(std::string name, uint32_t width, uint32_t height, std::vector<float> rgb) {
    report::Entry e;
    e.name = std::move(name);
    e.picture = {e.name, width, height, std::move(rgb)};
    return e;
}
report::Entry grey(std::string name, uint32_t width, uint32_t height, float value) {
    return entry(std::move(name), width, height, std::vector<float>(std::size_t(width) * height * 3, value));
}
report::Report reportOf(std::vector<report::Entry> entries) {
    report::Report r;
    r.title = "@cornell";
    r.entries = std::move(entries);
    return r;
}
std::size_t pixelsOf(const judge::Canvas& c, judge::Rgb8 color) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < c.rgb.size(); i += 3) n += c.rgb[i] == color[0] && c.rgb[i + 1] == color[1] && c.rgb[i + 2] == color[2];
    return n;
}

} // namespace

TEST_SUITE("sheet") {
    TEST_CASE("small pictures are enlarged by whole factors, large ones fitted, every side at least a pixel") {
        const auto size = [](SheetSize picture, SheetSize frame) {
            const SheetSize s = sheetSize(picture, frame, 512);
            return std::pair{s.width, s.height};
        };
        CHECK(size({32, 32}, {700, 700}) == std::pair{512u, 512u});
        CHECK(size({100, 75}, {700, 700}) == std::pair{500u, 375u});
        CHECK(size({100, 75}, {250, 700}) == std::pair{200u, 150u});
        CHECK(size({600, 400}, {700, 700}) == std::pair{600u, 400u});
        CHECK(size({1280, 720}, {640, 700}) == std::pair{640u, 360u});
        CHECK(size({1, 1}, {700, 700}) == std::pair{512u, 512u});
        CHECK(size({10000, 1}, {500, 500}) == std::pair{500u, 1u});
        CHECK(size({1, 10000}, {500, 500}) == std::pair{1u, 500u});
    }

    TEST_CASE("reduction averages radiance over areas: the mean stays, to rounding, at any ratio") {
        std::vector<float> rgb;
        for (int i = 0; i < 7 * 5; ++i)
            for (int c = 0; c < 3; ++c) rgb.push_back(float((i * 37 + c * 11) % 19) * 100);
        double whole = 0;
        for (const float v : rgb) whole += v;
        for (const SheetSize to : {SheetSize{7, 5}, SheetSize{3, 2}, SheetSize{1, 1}, SheetSize{14, 10}, SheetSize{5, 4}}) {
            CAPTURE(to.width);
            const SheetPixels p = sheetPixels(rgb, {7, 5}, to);
            double sum = 0;
            for (const float v : p.rgb) sum += v;
            CHECK(sum / (to.width * to.height) == doctest::Approx(whole / 35).epsilon(1e-6));
        }
        const SheetPixels half = sheetPixels(std::vector<float>{0, 0, 0, 1, 2, 4}, {2, 1}, {1, 1});
        CHECK(half.rgb == std::vector<float>{0.5f, 1, 2});
        const SheetPixels twice = sheetPixels(std::vector<float>{0, 0, 0, 1, 2, 4}, {2, 1}, {4, 2});
        CHECK(twice.rgb == std::vector<float>{0, 0, 0, 0, 0, 0, 1, 2, 4, 1, 2, 4, 0, 0, 0, 0, 0, 0, 1, 2, 4, 1, 2, 4});
    }

    TEST_CASE("what is not finite marks exactly the pixels it lies in") {
        std::vector<float> rgb(9 * 3, 1.f);
        rgb[4 * 3 + 1] = notANumber;
        const SheetPixels same = sheetPixels(rgb, {3, 3}, {3, 3});
        CHECK(same.unusable == std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0});
        rgb[4 * 3 + 1] = std::numeric_limits<float>::infinity();
        const SheetPixels twice = sheetPixels(rgb, {3, 3}, {6, 6});
        CHECK(std::count(twice.unusable.begin(), twice.unusable.end(), 1) == 4);
        const SheetPixels small = sheetPixels(rgb, {3, 3}, {2, 2}); // the middle reaches into all four
        CHECK(std::count(small.unusable.begin(), small.unusable.end(), 1) == 4);
        for (const float v : small.rgb) CHECK(std::isfinite(v));
    }

    TEST_CASE("one exposure and one view for all: the pixels are those of the display transform") {
        const DisplayTransform display;
        report::Report r = reportOf({grey("a", 64, 64, 0.25f), grey("b", 64, 64, 0.5f)});
        r.exposure = -1;
        const judge::Canvas c = drawSheet(r, display);
        for (const float v : {0.25f, 0.5f}) {
            const std::vector<uint8_t> b = display.bytes(std::vector<float>{v, v, v}, -1);
            CHECK(pixelsOf(c, {b[0], b[1], b[2]}) >= 512 * 512); // each enlarged eight times
        }
    }

    TEST_CASE("the sheet is wide rather than high, and never wider than 2400 pixels") {
        const DisplayTransform display;
        for (const uint32_t n : {1u, 2u, 3u, 4u, 5u, 7u, 12u})
            for (const SheetSize s : {SheetSize{64, 64}, SheetSize{1280, 720}, SheetSize{200, 900}, SheetSize{3000, 40}}) {
                CAPTURE(n);
                CAPTURE(s.width);
                std::vector<report::Entry> entries;
                for (uint32_t i = 0; i < n; ++i) entries.push_back(grey("picture", s.width, s.height, 0.2f));
                const judge::Canvas c = drawSheet(reportOf(std::move(entries)), display);
                CHECK(c.width <= 2400);
                CHECK(c.rgb.size() == std::size_t(c.width) * c.height * 3);
            }
        const judge::Canvas four = drawSheet(reportOf(std::vector<report::Entry>(4, grey("square", 512, 512, 0.2f))), display);
        CHECK(four.width > 3 * four.height); // four squares stand in a row
    }

    TEST_CASE("pixels that are not finite have a colour of their own, and the label says how many") {
        const DisplayTransform display;
        std::vector<float> rgb(64 * 64 * 3, 0.2f);
        rgb[300] = notANumber;
        const judge::Canvas c = drawSheet(reportOf({entry("path", 64, 64, std::move(rgb))}), display);
        const std::size_t marked = pixelsOf(c, judge::notFiniteColor);
        CHECK(marked > 64); // the pixel, eight times as wide and high, and the letters
        CHECK(marked < 64 + 3000);
    }

    TEST_CASE("labels stay under their pictures") {
        const DisplayTransform display;
        report::Report r = reportOf(std::vector<report::Entry>(3, grey("x", 32, 32, 0.f)));
        for (report::Entry& e : r.entries) {
            e.name = "distributed:light-samples=16,a-very-long-option-that-goes-on=and-on-and-on,more=still";
            e.seconds = 123.456;
            e.prepassSeconds = 100;
            e.spp = 1048576;
            e.metrics = {{"relMSE", 1.2345e-5}, {"FLIP", 0.0456}, {"PSNR", 33}};
            e.standing = report::Standing::missesPaths;
        }
        const judge::Canvas c = drawSheet(r, display);
        // Three cells of 512 with 20 between them: from one to the next, only the surround.
        REQUIRE(c.width == 2 * 24 + 3 * 512 + 2 * 20);
        for (const uint32_t left : {24u + 512u, 24u + 2 * 512 + 20})
            for (uint32_t y = 80; y < c.height; ++y)
                for (uint32_t x = left; x < left + 20; ++x) REQUIRE(c.rgb[3 * (std::size_t(y) * c.width + x)] == c.rgb[0]);
    }

    TEST_CASE("names that differ look it, however much they have in common") {
        const DisplayTransform display;
        const auto sheet = [&](const std::string& steps) {
            std::vector<report::Entry> entries(4, grey("radiosity:show=patch,solver=shoot,factors=hemisphere,steps=1", 64, 64, 0.2f));
            entries[1].name = "radiosity:show=patch,solver=shoot,factors=hemisphere,steps=" + steps;
            return drawSheet(reportOf(std::move(entries)), display);
        };
        const judge::Canvas same = sheet("1"), other = sheet("2");
        REQUIRE(same.rgb.size() == other.rgb.size());
        CHECK(same.rgb != other.rgb);
    }

    TEST_CASE("reports that nobody expects still give a sheet") {
        const DisplayTransform display;
        CHECK(drawSheet(report::Report{}, display).width > 0);
        report::Report r = reportOf({grey("", 1, 1, 0.f),
                                     grey("\xff\xfe K\xc3\xbc"
                                          "che \xe4\xb8\xad <b>\"q\"</b>\n",
                                          1, 4096, 1e30f),
                                     report::Entry{}});
        r.title = std::string(4000, 'W');
        r.entries[2].metrics = {{"relMSE", notANumber}, {"FLIP", std::numeric_limits<double>::infinity()}};
        r.entries[2].picture = {"broken", 100, 100, {1, 2, 3}}; // too few values
        r.exposure = -300;
        const judge::Canvas c = drawSheet(r, display);
        CHECK(c.width <= 2400);
    }

    TEST_CASE("a file: the picture that was drawn, and an error where it cannot be written") {
        const program::Folder folder;
        const DisplayTransform display;
        const report::Report r = reportOf({grey("a", 16, 16, 0.25f), grey("b", 16, 16, 0.5f)});
        writeSheet(r, folder / "sheet.png", display);
        const judge::Canvas c = drawSheet(r, display);
        const Picture p = readPicture(folder / "sheet.png");
        REQUIRE(p.width == c.width);
        REQUIRE(p.height == c.height);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < p.planes[0].size(); ++i) wrong += std::lround(p.planes[0][i] * 255) != c.rgb[3 * i];
        CHECK(wrong == 0);
        CHECK_THROWS_AS(writeSheet(r, folder / "no" / "such" / "sheet.png", display), Error);
    }
} // TEST_SUITE
