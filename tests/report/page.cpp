#include "core/render/error.h"
#include "tests/report/example.h"
#include "tests/report/unpack.h"
#include "tools/report/pack.h"
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <unistd.h>

using namespace chiaro;
namespace fs = std::filesystem;

namespace {

constexpr float notANumber = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

struct Folder {
    Folder() {
        std::string name = (fs::temp_directory_path() / "chiaro-report-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

struct Made {
    report::WrittenReport written;
    test::Page page;
};
Made make(const report::Report& r, std::uintmax_t limit = 10'000'000) {
    const Folder folder;
    const report::WrittenReport written = report::writeReport(r, folder.path / "a.html", limit);
    std::ifstream in(folder.path / "a.html", std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    CHECK(written.bytes == text.size());
    return {written, test::pageFrom(std::move(text))};
}

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
}

// What a float becomes in the page: a half, and that cut to the mantissa.
float kept(float v, int exponent, int mantissa) {
    const uint16_t half = report::toHalf(std::ldexp(v, -exponent));
    return std::ldexp(report::fromHalf(report::lengthened(report::shortened(half, mantissa), mantissa)), exponent);
}

bool same(float a, float b) { return std::isnan(a) ? std::isnan(b) : a == b; }

report::Report onePicture(uint32_t width, uint32_t height, std::vector<float> rgb) {
    report::Report r = test::exampleTexts();
    report::Entry e;
    e.name = e.picture.name = "one";
    e.picture.width = width;
    e.picture.height = height;
    e.picture.rgb = std::move(rgb);
    r.entries.push_back(std::move(e));
    return r;
}

} // namespace

TEST_SUITE("report") {

    TEST_CASE("the page holds every picture, layer, map and number") {
        const report::Report r = test::exampleReport(60, 40);
        const Made made = make(r);
        const nlohmann::json& data = made.page.data;
        CHECK(made.written.reductions.empty());
        CHECK(data["title"] == r.title);
        CHECK(data["reference"] == 3);
        REQUIRE(data["entries"].size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            const report::Entry& e = r.entries[i];
            const nlohmann::json& found = data["entries"][i];
            CHECK(found["name"] == e.name);
            CHECK(found["metrics"].size() == e.metrics.size());
            const std::vector<float> rgb = made.page.picture(found["picture"]), layer = made.page.picture(found["layers"][0]);
            int wrong = 0;
            for (std::size_t k = 0; k < e.picture.rgb.size(); ++k)
                wrong +=
                    rgb[k] != kept(e.picture.rgb[k], data["exponent"], 10) || layer[k] != kept(e.layers[0].rgb[k], data["exponent"], 10);
            CHECK(wrong == 0);
            for (std::size_t m = 0; m < e.maps.size(); ++m) {
                const std::vector<double> map = made.page.map(found["maps"][m]);
                const double step = (e.maps[m].high - e.maps[m].low) / 254;
                for (std::size_t k = 0; k < map.size(); ++k)
                    wrong += std::abs(map[k] - std::clamp<double>(e.maps[m].values[k], e.maps[m].low, e.maps[m].high)) > 0.51 * step;
            }
            CHECK(wrong == 0);
        }
        CHECK(data["curves"][0]["points"].size() == r.curves[0].points.size());
        CHECK(data["timeToError"][3]["cells"][2]["seconds"].is_null());
    }

    TEST_CASE("the same report is the same page, and it loads nothing") {
        const report::Report r = test::exampleReport(30, 20);
        const Made made = make(r);
        CHECK(made.page.text == make(r).page.text);
        const std::string page = made.page.withoutBlocks(); // in which any word may occur by chance
        CHECK(page.find("default-src 'none'") != std::string::npos);
        for (const std::string& word : std::vector<std::string>{"{{", "unsafe-inline", "unsafe-eval", "innerHTML", "\nimport ", "\nexport ",
                                                                "fetch(", "https://", "@import", "url("})
            CHECK_MESSAGE(count(page, word) == 0, word);
        CHECK(count(page, "http://") == 1); // the name of SVG's namespace
    }

    TEST_CASE("names with quotes, brackets and broken letters are text") {
        const std::string evil = "\"><script>alert(1)</script><!-- <img src=x onerror=alert(1)> & ' {{script}} \xe2\x80\xa8 \xff \x01";
        report::Report plain = test::exampleReport(8, 8), r = plain;
        r.title = r.command = r.machine = r.version = evil;
        r.settings = {{evil, evil}};
        r.notes = {evil};
        for (report::Entry& e : r.entries) {
            e.name = e.source = e.covers = e.verdict = e.file = e.command = e.picture.name = e.layers[0].name = evil;
            for (report::Map& m : e.maps) m.name = m.caption = evil;
            for (report::Metric& m : e.metrics) m.name = evil;
        }
        const Made made = make(r);
        const std::string before = make(plain).page.text;
        for (const std::string& word : std::vector<std::string>{"<script", "</script", "<!--", "<img", "alert(1)<", "\xff"})
            CHECK_MESSAGE(count(made.page.text, word) == count(before, word), word);
        const std::string name = made.page.data["entries"][0]["name"];
        CHECK(name.starts_with("\"><script>alert(1)</script><!-- <img"));
        CHECK(name.find("\xef\xbf\xbd") != std::string::npos); // what was no UTF-8
    }

    TEST_CASE("NaN, infinities, negative values and a black picture") {
        const std::vector<float> rgb{notANumber, 1, 2, infinity, 0, 0, -1.5f, -infinity, 0.25f, 0, 0, 0};
        const Made made = make(onePicture(2, 2, rgb));
        const nlohmann::json& picture = made.page.data["entries"][0]["picture"];
        CHECK(picture["nan"] == 1);
        CHECK(picture["infinite"] == 2);
        const std::vector<float> back = made.page.picture(picture);
        for (std::size_t i = 0; i < rgb.size(); ++i) CHECK(same(back[i], rgb[i]));
        const Made black = make(onePicture(64, 64, std::vector<float>(64 * 64 * 3, 0.0f)));
        for (const float v : black.page.picture(black.page.data["entries"][0]["picture"])) CHECK(v == 0);
    }

    TEST_CASE("numbers that JSON has no word for") {
        report::Report r = test::exampleReport(4, 4);
        r.entries[0].metrics[0].value = notANumber;
        r.entries[1].metrics[0].value = infinity;
        r.entries[0].picture = {};
        r.entries[0].layers = {};
        r.entries[0].maps = {};
        const Made made = make(r);
        CHECK(made.page.data["entries"][0]["metrics"][0]["value"].is_null());
        CHECK(made.page.data["entries"][1]["metrics"][0]["value"] == "Infinity");
        CHECK(!made.page.data["entries"][0]["picture"].contains("block"));
        CHECK(make(report::Report{}).page.data["entries"].empty());
    }

    TEST_CASE("lamps above the largest half and very dark scenes keep their digits") {
        for (const float gain : {1e7f, 1.0f, 1e-7f}) {
            std::vector<float> rgb;
            for (int i = 0; i < 64 * 64; ++i)
                for (const float v : {1.0f, 0.37f, 0.1f + 1e-3f * float(i % 100)}) rgb.push_back(gain * v);
            const Made made = make(onePicture(64, 64, rgb));
            CHECK(made.written.reductions.empty());
            const std::vector<float> back = made.page.picture(made.page.data["entries"][0]["picture"]);
            int wrong = 0;
            for (std::size_t i = 0; i < rgb.size(); ++i) wrong += std::abs(back[i] - rgb[i]) > 0x1p-11f * rgb[i];
            CHECK_MESSAGE(wrong == 0, gain);
        }
        std::vector<float> firefly(64 * 64 * 3, 0.01f);
        firefly[5] = 1e9f;
        const Made made = make(onePicture(64, 64, firefly));
        REQUIRE(made.written.reductions.size() == 1);
        CHECK(made.written.reductions[0].starts_with("1 values above"));
        const std::vector<float> back = made.page.picture(made.page.data["entries"][0]["picture"]);
        CHECK(back[4] == doctest::Approx(0.01).epsilon(1e-3));
        CHECK(std::isfinite(back[5]));
    }

    TEST_CASE("1 x 1 and 4096 x 4096") {
        const Made one = make(onePicture(1, 1, {0.5f, 0.25f, 2}));
        CHECK(one.page.picture(one.page.data["entries"][0]["picture"]) == std::vector<float>{0.5f, 0.25f, 2});
        std::vector<float> rgb(std::size_t(4096) * 4096 * 3);
        for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = float((i * 2654435761u >> 9) % 4096) / 1024;
        rgb[3 * (4096 * 100 + 200)] = notANumber;
        const Made large = make(onePicture(4096, 4096, std::move(rgb)));
        CHECK(large.written.bytes <= 10'000'000);
        CHECK(large.written.reductions.size() >= 1);
        const nlohmann::json& data = large.page.data;
        const uint32_t factor = data["factor"], width = data["entries"][0]["picture"]["width"];
        CHECK(factor >= 2);
        CHECK(width == 4096 / factor);
        CHECK(data["entries"][0]["picture"]["fullWidth"] == 4096);
        CHECK(data["entries"][0]["picture"]["nan"] == 1);
        const std::vector<float> back = large.page.picture(data["entries"][0]["picture"]);
        CHECK(std::isnan(back[3 * (100 / factor * width + 200 / factor)])); // it stays visible
    }

    TEST_CASE("the limit is kept, the order of what is given up too, and it is said") {
        const report::Report r = test::exampleReport(128, 128);
        const Made all = make(r);
        CHECK(all.written.reductions.empty());
        std::uintmax_t limit = all.written.bytes;
        int factor = 1, mantissa = 10;
        std::size_t layers = 1;
        bool leftLayers = false, mapsFirst = false, shortenedFirst = false;
        for (; limit > 115'000; limit = limit * 9 / 10) {
            const Made made = make(r, limit);
            CHECK(made.written.bytes <= limit);
            const nlohmann::json& data = made.page.data;
            CHECK(made.written.reductions == data["reductions"].get<std::vector<std::string>>());
            const int f = data["factor"], m = data["mantissa"];
            const std::size_t l = data["entries"][0]["layers"][0].contains("block");
            const int maps = data["mapFactor"];
            CHECK(data["entries"][0]["maps"][0]["width"] == 128 / maps);
            CHECK(data["entries"][0]["picture"]["width"] == 128 / f);
            CHECK(m >= 5);
            if (m < 10) CHECK(maps > f);
            CHECK(made.written.reductions.empty() == (f == 1 && maps == 1 && m == 10 && l == 1));
            CHECK(f >= factor);
            if (f == factor) CHECK(m <= mantissa);
            leftLayers = leftLayers || (f == 1 && maps == 1 && m == 10 && l == 0);
            mapsFirst = mapsFirst || (f == 1 && maps == 2 && m == 10);
            shortenedFirst = shortenedFirst || (f == 1 && m < 10);
            factor = f, mantissa = m, layers = l;
        }
        CHECK(leftLayers);
        CHECK(mapsFirst);
        CHECK(shortenedFirst);
        CHECK(factor > 1);
        CHECK(layers <= 1);
        const Made tiny = make(r, 10);
        CHECK(tiny.page.data["entries"][0]["picture"]["width"] == 1);
        CHECK(tiny.written.reductions.back().find("larger than 10 bytes") != std::string::npos);
    }

    TEST_CASE("wrong sizes and places are errors") {
        const auto code = [](const report::Report& r, const fs::path& file) {
            try {
                report::writeReport(r, file);
            } catch (const Error& e) { return e.code; }
            return Exit::done;
        };
        const Folder folder;
        CHECK(code(onePicture(2, 2, {1, 2, 3}), folder.path / "a.html") == Exit::internal);
        CHECK(code(onePicture(1, 1, {1, 2, 3}), folder.path / "absent" / "a.html") == Exit::file);
        CHECK(fs::is_empty(folder.path));
    }
}
