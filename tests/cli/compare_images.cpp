// chiaro compare on pictures from anywhere, and what it refuses.
#include "diff_pictures.h"
#include <algorithm>

using namespace program;

namespace {

using Words = std::vector<std::string>;
Outcome compare(const Folder& folder, Words words) {
    words.insert(words.begin(), "compare");
    return run(folder, words);
}
Json results(const Folder& folder) {
    const Json parsed = Json::parse(readAll(folder / "out" / "results.json"), nullptr, false);
    REQUIRE(parsed.is_object());
    return parsed;
}
void refused(const Folder& folder, const Words& words, int code, const std::string& message) {
    std::string typed;
    for (const std::string& w : words) typed += " " + w;
    CAPTURE(typed);
    const Outcome o = compare(folder, words);
    CAPTURE(o.err);
    CHECK(o.code == code);
    CHECK(o.out.empty());
    CHECK(contains(o.err, message));
}

} // namespace

TEST_SUITE("compare pictures") {

    TEST_CASE("two pictures: the last is the reference, --ref names another") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "a.exr", 8, 4, 1.1f, 1.1f, 1.1f);
        writeConstant(folder / "b.exr", 8, 4, 1, 1, 1);
        const Outcome o = compare(folder, {"a.exr", "b.exr", "-o", "out"});
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        Json j = results(folder);
        REQUIRE(j["entries"].size() == 2);
        CHECK(j["entries"][0]["name"] == "a.exr");
        CHECK(j["entries"][0]["standing"] == "not judged");
        CHECK(j["entries"][1]["standing"] == "reference");
        CHECK(near(j["entries"][0]["metrics"]["relative bias"]["value"].get<double>(), 0.1, 1e-5));
        CHECK(near(j["entries"][0]["metrics"]["relMSE"]["value"].get<double>(), 0.01 / 1.01, 1e-4));
        for (const char* file : {"report.html", "sheet.png", "results.csv"}) CHECK(fs::exists(folder / "out" / file));
        REQUIRE(compare(folder, {"a.exr", "b.exr", "--ref", "a.exr", "-o", "out", "--json", "j.json"}).code == 0);
        j = results(folder);
        REQUIRE(j["entries"].size() == 3);
        CHECK(j["reference"]["file"] == "a.exr");
        CHECK(readAll(folder / "j.json") == readAll(folder / "out" / "results.json"));
        REQUIRE(compare(folder, {"a.exr", "b.exr", "--ref", "none", "-o", "out"}).code == 0);
        CHECK(results(folder)["reference"].is_null());
        const Outcome text = compare(folder, {"a.exr", "b.exr", "-q", "-o", "out", "--csv", "-"});
        CHECK(text.out == readAll(folder / "out" / "results.csv"));
    }

    TEST_CASE("names that would break a table or a page") {
        if (absent()) return;
        const Folder folder;
        const std::string strange = "a \"b\", <i>c\n.exr";
        writeConstant(folder / strange, 4, 4, 1, 1, 1);
        writeConstant(folder / "b.exr", 4, 4, 1, 1, 1);
        const Outcome o = compare(folder, {strange, "b.exr", "-o", "out"});
        CAPTURE(o.err);
        REQUIRE(o.code == 0);
        CHECK(results(folder)["entries"][0]["name"] == strange);
        CHECK(contains(readAll(folder / "out" / "results.csv"), "\"a \"\"b\"\", <i>c\n.exr\",file,"));
        CHECK(!contains(o.out, "<i>c\n"));
        CHECK(!contains(readAll(folder / "out" / "report.html"), "<i>c"));
    }

    TEST_CASE("not a number, black, one pixel") {
        if (absent()) return;
        const Folder folder;
        const std::vector<float> nothing(16, notANumber), black(16, 0.f),
            some{1, notANumber, infinity, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
        for (const auto& [name, values] : {std::pair{"nan.exr", nothing}, {"black.exr", black}, {"some.exr", some}})
            writePlanes(folder / name, 4, 4, {{"R", values}, {"G", values}, {"B", values}});
        writeConstant(folder / "one.exr", 1, 1, 1, 2, 3);
        writeConstant(folder / "two.exr", 1, 1, 2, 2, 3);
        for (const Words& pair : {Words{"nan.exr", "black.exr"},
                                  {"black.exr", "nan.exr"},
                                  {"some.exr", "black.exr"},
                                  {"black.exr", "some.exr"},
                                  {"nan.exr", "nan.exr"},
                                  {"black.exr", "black.exr"},
                                  {"one.exr", "two.exr"}}) {
            CAPTURE(pair[0]);
            CAPTURE(pair[1]);
            const Outcome o = compare(folder, {pair[0], pair[1], "-o", "out"});
            CAPTURE(o.err);
            CHECK(o.code == 0);
            results(folder);
        }
        const Outcome o = compare(folder, {"some.exr", "black.exr", "-o", "out"});
        CHECK(contains(o.err, "some.exr: 2 of 16 pixels are not finite"));
        CHECK(results(folder)["entries"][0]["dropped"] == 2);
        const Outcome scene = compare(folder, {"@furnace", "-i", "path", "--size", "1x1", "--spp", "8", "--cache", "none", "-o", "out"});
        CAPTURE(scene.err);
        CHECK(scene.code == 0);
    }

    TEST_CASE("scene and pictures together, cut to what all have") {
        if (absent()) return;
        const Folder folder;
        REQUIRE(run(folder, {"render", "@cornell", "--size", "16x16", "--spp", "4", "-o", "mine.exr", "-q"}).code == 0);
        writeConstant(folder / "wide.exr", 24, 16, 1, 1, 1);
        const Words scene{"@cornell", "-i", "normals", "--size", "16x16", "--spp", "4", "--seeds", "2", "--cache", "none", "-o", "out"};
        Words words = scene;
        words.insert(words.begin(), "mine.exr");
        REQUIRE(compare(folder, words).code == 0);
        const Json j = results(folder);
        REQUIRE(j["entries"].size() == 3);
        CHECK(j["entries"][1]["source"] == "file");
        CHECK(j["entries"][1]["standing"] != "not judged"); // render wrote an error layer
        words[0] = "wide.exr";
        refused(folder, words, 3, "@cornell is 16x16, wide.exr is 24x16; use --size 24x16, --crop or --fit to compare.");
        words.emplace_back("--fit");
        CHECK(compare(folder, words).code == 0);
        words.back() = "--crop";
        words.emplace_back("8x8+4+4");
        CHECK(compare(folder, words).code == 0);
        CHECK(results(folder)["settings"]["crop"] == "8x8+4+4");
        Words file = scene;
        file[2] = "path";
        file.insert(file.end(), {"--ref", "mine.exr"});
        REQUIRE(compare(folder, file).code == 0);
        CHECK(results(folder)["reference"]["errors"] == true);
        CHECK(!results(folder)["entries"][0]["judged"].is_null());
    }

    TEST_CASE("what it refuses, with advice") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "a.exr", 8, 4, 1, 1, 1);
        writeConstant(folder / "b.exr", 4, 4, 1, 1, 1);
        refused(folder, {"a.exr"}, 64, "a.exr alone: there is nothing to compare it with. Add another picture, --ref FILE, or a SCENE");
        refused(folder, {"a.exr", "b.exr"}, 3, "a.exr is 8x4, b.exr is 4x4; use --crop or --fit to compare.");
        CHECK(compare(folder, {"a.exr", "b.exr", "--fit"}).code == 0);
        CHECK(fs::exists(folder / "a-compare" / "report.html"));
        refused(folder, {"a.exr", "c.exr"}, 4, "c.exr: no such file");
        refused(folder, {"a.exr", "a.exr", "-i", "path"}, 64, "--integrator is about rendering, but there are pictures alone");
        refused(folder, {"@cornell", "@furnace"}, 64, "@cornell and @furnace are two scenes");
        refused(folder, {"@cornell", "--time", "1s", "--spp", "4"}, 64, "say with --equal which of them is held equal");
        refused(folder, {"@cornell", "--equal", "time", "--spp", "4"}, 64, "--spp says nothing with --equal time");
        refused(folder, {"@cornell", "--spp", "4", "--seeds", "8"}, 64, "--seeds 8 share --spp 4");
        refused(folder, {"@cornell", "-i", "path,pth"}, 64, "did you mean path?");
        refused(folder, {"@cornell", "--ref", "none", "--ref-time", "1s"}, 64, "--ref-time is about --ref auto");
        refused(folder, {"@cornell", "--equal", "tme"}, 64, "--equal");
        refused(folder, {"a.exr", "a.exr", "-o", "a.exr"}, 4, "there is a file of that name; compare needs a folder");
        fs::create_directory(folder / "out");
        fs::copy_file(folder / "a.exr", folder / "out" / "path.exr");
        refused(folder, {"@cornell", "-i", "path", "--size", "8x4", "--spp", "1", "out/path.exr", "-o", "out"}, 64,
                "is read and would be written over");
    }
}
