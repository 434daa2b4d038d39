// Pages made on request, not tests: browser.py asks for "page for the browser", and `chiaro_tests_report --no-skip --test-case="page from
// pictures"` with CHIARO_REPORT_PICTURES="FILE..." (the last one is the reference) and CHIARO_REPORT_PAGE=FILE shows real pictures, for
// looking at the page.
#include "io/picture.h"
#include "tests/report/example.h"
#include "tools/judge/metrics.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <doctest/doctest.h>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

using namespace chiaro;
namespace fs = std::filesystem;

namespace {

report::Image imageOf(const Picture& p, const std::string& prefix, const std::string& name) {
    report::Image out{name, p.window.x1 - p.window.x0, p.window.y1 - p.window.y0, {}};
    const std::vector<float>*r = p.find(prefix + "R"), *g = p.find(prefix + "G"), *b = p.find(prefix + "B");
    for (std::size_t i = 0; i < r->size(); ++i) out.rgb.insert(out.rgb.end(), {(*r)[i], (*g)[i], (*b)[i]});
    return out;
}

report::Entry entryOf(const fs::path& file) {
    const Picture p = readPicture(file);
    report::Entry e;
    e.name = file.stem().string();
    e.source = "file";
    e.file = file.filename().string();
    e.command = "chiaro render @cornell-spheres -i " + e.name + " --size 1280x720 --spp 16 -o " + e.file;
    e.covers = "L (D|G|S)* E; cannot find Ld S+ (D|G) .* E";
    e.picture = imageOf(p, "", e.name);
    for (const std::string& name : p.names)
        if (name.ends_with(".R") && !name.starts_with("error") && !name.starts_with("albedo"))
            e.layers.push_back(imageOf(p, name.substr(0, name.size() - 1), name.substr(0, name.size() - 2)));
    std::sort(e.layers.begin(), e.layers.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return e;
}

Picture pictureFrom(const report::Image& image) {
    Picture p{.width = image.width,
              .height = image.height,
              .window = {0, 0, image.width, image.height},
              .names = {},
              .planes = {},
              .metadata = {}};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = p.add(std::string(1, "RGB"[c]));
        for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = image.rgb[3 * i + c];
    }
    return p;
}

const char* const hostile = "\"><script>window.injected=1</script></script><img src=x onerror=\"window.injected=1\"> & 'x' <b>";

judge::Picture judged(const report::Image& i) { return {i.width, i.height, i.rgb, {}, i.name, {}}; }

} // namespace

TEST_SUITE("report") {

    // page.html in the folder CHIARO_REPORT_PAGE, and what it must show in expected.json: pixels through an EXR, as `chiaro compare` has
    // them.
    TEST_CASE("page for the browser" * doctest::skip()) {
        const char* folder = std::getenv("CHIARO_REPORT_PAGE");
        REQUIRE(folder);
        report::Report r = test::exampleReport(96, 64);
        r.title = hostile;
        r.entries[1].name = r.entries[1].covers = r.entries[1].verdict = hostile;
        r.notes.push_back(hostile);
        r.entries[0].picture.rgb[3 * (10 * 96 + 20)] = std::numeric_limits<float>::quiet_NaN();
        r.entries[0].picture.rgb[3 * (11 * 96 + 20)] = std::numeric_limits<float>::infinity();
        nlohmann::json expected{{"hostile", hostile}, {"pictures", nlohmann::json::array()}};
        for (report::Entry& e : r.entries) {
            const fs::path file = fs::path(folder) / ("picture" + std::to_string(expected["pictures"].size()) + ".exr");
            writeExr(file, pictureFrom(e.picture));
            e.picture = imageOf(readPicture(file), "", e.name);
            nlohmann::json values = nlohmann::json::array();
            for (const float v : e.picture.rgb) values.push_back(std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr));
            expected["pictures"].push_back(std::move(values));
        }
        std::uintmax_t limit = report::writeReport(r, fs::path(folder) / "page.html").bytes;
        expected["maps"] = nlohmann::json::array();
        for (const report::Map& m : r.entries[0].maps) expected["maps"].push_back({{"values", m.values}, {"low", m.low}, {"high", m.high}});
        // The same with little room: fewer bits, smaller maps, pictures of full size.
        const auto shortened = [&] {
            const std::vector<std::string> reductions = report::writeReport(r, fs::path(folder) / "reduced.html", limit).reductions;
            return std::any_of(reductions.begin(), reductions.end(), [](const std::string& s) { return s.find("mantissa") != s.npos; });
        };
        while (!shortened()) limit -= 4000;
        std::ofstream(fs::path(folder) / "expected.json") << expected;
        const report::Image pixel{"pixel", 1, 1, {0.5f, 0.25f, 0.125f}}, black{"black", 64, 64, std::vector<float>(64 * 64 * 3)};
        for (const report::Image& only : {pixel, black}) {
            report::Report small = test::exampleTexts();
            for (int i = 0; i < 2; ++i) {
                report::Entry e;
                e.name = only.name;
                e.picture = only;
                small.entries.push_back(std::move(e));
            }
            report::writeReport(small, fs::path(folder) / (only.name + ".html"));
        }
        report::writeReport({}, fs::path(folder) / "empty.html");
    }

    TEST_CASE("page from pictures" * doctest::skip()) {
        const char* list = std::getenv("CHIARO_REPORT_PICTURES");
        const char* page = std::getenv("CHIARO_REPORT_PAGE");
        REQUIRE(list);
        REQUIRE(page);
        report::Report r = test::exampleTexts();
        std::istringstream names(list);
        for (std::string name; names >> name;) r.entries.push_back(entryOf(name));
        r.reference = uint32_t(r.entries.size() - 1);
        const report::Image target = r.entries.back().picture;
        using enum report::Standing;
        const report::Standing standings[] = {agrees, cannotTell, biased, missesPaths, debug, differs};
        for (std::size_t i = 0; i < r.entries.size(); ++i) test::describe(r.entries[i], standings[i % 6], i);
        r.entries.back().standing = report::Standing::reference;
        r.entries.back().verdict = "the mean of 16 independent renders by path";
        for (std::size_t i = 0; i + 1 < r.entries.size(); ++i) {
            report::Entry& e = r.entries[i];
            const judge::Report m = judge::compare(judged(e.picture), judged(target));
            e.metrics = {{"relMSE", m.value("relmse"), 0.02 * m.value("relmse"), true},
                         {"FLIP", m.flipHdr->mean, 0.001, true},
                         {"mean", m.channels[0].meanTest, 0.002, true, false}};
            e.maps.push_back({"FLIP", "The difference that a person sees, 0 to 1", m.flipHdr->map, 0, 1, false});
            std::vector<float> z;
            for (std::size_t k = 0; k < e.picture.rgb.size(); k += 3)
                z.push_back(8 * (e.picture.rgb[k + 1] - target.rgb[k + 1]) / (0.3f * target.rgb[k + 1] + 0.1f));
            e.maps.push_back({"z-score", "Difference in standard errors; beyond 4 it is no noise", z, -6, 6, true});
        }
        test::addCurves(r, std::min<std::size_t>(4, r.entries.size() - 1));
        const auto start = std::chrono::steady_clock::now();
        const report::WrittenReport w = report::writeReport(r, page);
        MESSAGE(w.bytes, " bytes in ", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), " s");
        for (const std::string& reduction : w.reductions) MESSAGE(reduction);
        CHECK(w.bytes <= 10'000'000);
    }
}
