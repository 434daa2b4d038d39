// `chiaro diff`: what it writes. CSV and JSON are parsed, pictures are read back pixel by pixel, and no input is ever overwritten.
#include "diff_pictures.h"

using namespace program;

namespace {
std::vector<std::vector<std::string>> csvLines(const std::string& text) {
    std::vector<std::vector<std::string>> lines(1, std::vector<std::string>(1));
    bool quoted = false;
    for (const char c : text) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            lines.back().emplace_back();
        else if (c == '\n' && !quoted)
            lines.emplace_back(1);
        else
            lines.back().back() += c;
    }
    lines.pop_back();
    return lines;
}
std::array<int, 3> pixel(const chiaro::Picture& p, uint32_t x, uint32_t y) {
    std::array<int, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = int(std::lround(255 * p.planes[c][std::size_t(y) * p.width + x]));
    return rgb;
}
} // namespace

TEST_SUITE("diff output") {
    TEST_CASE("CSV") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1.1f, 1.8f, 4.4f});
        writeRow(folder / "b,c.exr", {1, 2, 4});
        const Outcome o = run(folder, {"diff", "a.exr", "b,c.exr", "--csv", "-"});
        CHECK(o.code == 2);
        CHECK(contains(o.err, "FAIL")); // the verdict is not among the data
        const auto lines = csvLines(o.out);
        CHECK(lines.size() == 1 + 12 * 5 + 1); // FLIP has no channels
        CHECK(lines[0] == std::vector<std::string>{"a", "b", "metric", "channel", "value", "without_largest_0.1_percent", "unit"});
        for (const auto& line : lines) CHECK(line.size() == 7);
        CHECK(lines[1][1] == "b,c.exr");
        CHECK(lines[1][2] == "mse");
        CHECK(near(std::stod(lines[1][4]), 0.07));
        const Outcome file = run(folder, {"diff", "a.exr", "b,c.exr", "--csv", "d.csv", "--json", "d.json"});
        CHECK(readAll(folder / "d.csv") == o.out);
        CHECK(contains(file.out, "FAIL"));
        CHECK(contains(file.err, "wrote    d.csv"));
        CHECK(Json::parse(readAll(folder / "d.json"))["exitCode"] == 2);
    }

    TEST_CASE("false-colour PNG") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1, 3, 1, notANumber, 5});
        writeRow(folder / "b.exr", {1, 1, 3, 1, 1});
        writeBytes(folder / "m.png", 5, 1, {255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0});
        const Outcome o = run(folder, {"diff", "a.exr", "b.exr", "--mask", "m.png", "-o", "d.png"});
        CHECK(contains(o.err, "wrote    d.png  red A brighter, blue B brighter, full colour at 2 (auto), 0 % of the pixels beyond"));
        const chiaro::Picture p = chiaro::readPicture(folder / "d.png");
        CHECK(p.width > 100); // room for the legend
        CHECK(p.height > 20);
        CHECK(pixel(p, 0, 0) == std::array{238, 238, 238}); // equal
        CHECK(pixel(p, 1, 0) == std::array{190, 10, 30});   // A brighter
        CHECK(pixel(p, 2, 0) == std::array{25, 60, 200});   // B brighter
        CHECK(pixel(p, 3, 0) == std::array{0, 170, 60});    // not a number
        CHECK(pixel(p, 4, 0) == std::array{70, 70, 70});    // left out
        CHECK(std::get<std::string>(*p.attribute("chiaro:scale")) == "2");
        // The bar runs from one end to the other, with ink under it.
        bool low = false, high = false;
        std::size_t ink = 0;
        for (uint32_t y = 1; y < p.height; ++y)
            for (uint32_t x = 0; x < p.width; ++x) {
                low |= x < 20 && pixel(p, x, y) == std::array{25, 60, 200};
                high |= x > p.width - 20 && pixel(p, x, y) == std::array{190, 10, 30};
                ink += pixel(p, x, y) == std::array{20, 20, 20};
            }
        CHECK(low);
        CHECK(high);
        CHECK(ink > 100);
        run(folder, {"diff", "a.exr", "b.exr", "-o", "half.png", "--scale", "4"});
        const auto red = pixel(chiaro::readPicture(folder / "half.png"), 1, 0);
        CHECK(red[0] > 190);
        CHECK(red[1] > 60);
    }

    TEST_CASE("false-colour EXR carries the numbers, pixel upon pixel") {
        if (absent()) return;
        const Folder folder;
        writePlanes(folder / "a.exr", 2, 1, {{"R", {1, 2}}, {"G", {1, 2}}, {"B", {1, 2}}});
        writePlanes(folder / "b.exr", 2, 1, {{"R", {1, 1}}, {"G", {1, 2}}, {"B", {1, 5}}});
        run(folder, {"diff", "a.exr", "b.exr", "-o", "d.exr"});
        const chiaro::Picture p = chiaro::readPicture(folder / "d.exr");
        CHECK(p.width == 2);
        CHECK(p.height == 1);
        REQUIRE(p.find("difference.R"));
        CHECK(*p.find("difference.R") == std::vector<float>{0, 1});
        CHECK(*p.find("difference.G") == std::vector<float>{0, 0});
        CHECK(*p.find("difference.B") == std::vector<float>{0, -3});
        REQUIRE(p.find("B"));
        CHECK((*p.find("B"))[1] > (*p.find("R"))[1]); // the largest difference decides: B brighter
    }

    TEST_CASE("outputs are checked before anything is read, and never go over an input") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1, 2});
        writeRow(folder / "b.exr", {1, 3});
        const std::string before = readAll(folder / "a.exr");
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "-o", "a.exr"}).code == 64);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "-o", "./a.exr"}).code == 64);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--csv", "b.exr"}).code == 64);
        CHECK(readAll(folder / "a.exr") == before);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "-o", "d.jpg"}).code == 64);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "-o", "no/such/d.png"}).code == 4);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--csv", "-", "--json", "-"}).code == 64);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--csv", "x", "--json", "x"}).code == 64);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--scale", "0"}).code == 64);
        const Outcome missing = run(folder, {"diff", "a.exr", "c.exr"});
        CHECK(missing.code == 4);
        CHECK(contains(missing.err, "error: c.exr: no such file; similar here: "));
        folder.write("t.exr", before.substr(0, before.size() / 2));
        CHECK(run(folder, {"diff", "a.exr", "t.exr"}).code == 4);
        folder.write("x.png", "no picture at all");
        CHECK(run(folder, {"diff", "a.exr", "x.png"}).code == 4);
    }

    TEST_CASE("help is made from the tables") {
        if (absent()) return;
        const Folder folder;
        const Outcome help = run(folder, {"help", "diff"}), option = run(folder, {"diff", "--help"});
        CHECK(help.code == 0);
        CHECK(help.out == option.out);
        for (const char* part :
             {"mean d^2/(r^2 + e), e = 0.01 (mean r)^2", "sqrt(mean d^2)", "mean 2|d|/(|t| + |r|)", "Andersson et al. 2020",
              "Andersson et al. 2021", "--hardfail", "--warnpercent", "Exit code 0 PASS, 1 WARN, 2 FAIL"})
            CHECK(contains(help.out, part));
        CHECK(contains(run(folder, {"diff", "a", "b", "--channel"}).err,
                       "unknown option --channel; did you mean --channels? (chiaro help diff)"));
    }
}
