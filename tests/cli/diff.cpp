// `chiaro diff`: limits and exit codes, what is compared, and the defined answers for odd pictures.
#include "diff_pictures.h"

using namespace program;

namespace {
int codeOf(const Folder& folder, const std::vector<std::string>& more) {
    std::vector<std::string> words{"diff", "a.exr", "b.exr", "--flip", "none"};
    words.insert(words.end(), more.begin(), more.end());
    std::string typed;
    for (const std::string& w : words) typed += w + " ";
    CAPTURE(typed);
    const Outcome o = run(folder, words);
    CAPTURE(o.err);
    CHECK(o.code < 6);
    return o.code;
}
} // namespace

TEST_SUITE("diff") {
    TEST_CASE("limits are those of idiff") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "b.exr", {1, 1, 1, 1});
        writeRow(folder / "a.exr", {1, 1, 1.25f, 2}); // |d| = 0 0 0.25 1
        CHECK(codeOf(folder, {}) == 2);
        CHECK(codeOf(folder, {"--fail", "1"}) == 1); // no more than 1, but more than --warn
        CHECK(codeOf(folder, {"--fail", "1", "--warn", "1"}) == 0);
        CHECK(codeOf(folder, {"--fail", "0.5", "--warn", "1"}) == 2);
        CHECK(codeOf(folder, {"--fail", "0.5", "--failpercent", "25", "--warn", "1"}) == 0); // one of four
        CHECK(codeOf(folder, {"--fail", "0.5", "--failpercent", "24", "--warn", "1"}) == 2);
        CHECK(codeOf(folder, {"--failpercent", "50"}) == 1);
        CHECK(codeOf(folder, {"--failpercent", "50", "--warnpercent", "50"}) == 0);
        CHECK(codeOf(folder, {"--failpercent", "50", "--warnpercent", "50", "--hardfail", "0.9"}) == 2);
        CHECK(codeOf(folder, {"--failpercent", "50", "--warnpercent", "50", "--hardwarn", "0.9"}) == 1);
        CHECK(codeOf(folder, {"--failpercent", "50", "--warnpercent", "50", "--hardfail", "1"}) == 0);
        const Outcome o = run(folder, {"diff", "a.exr", "b.exr", "--fail", "0.5"});
        CHECK(contains(o.out, "FAIL  1 of 4 pixels (25 %) differ by more than 0.5 (--fail)\n"));
        CHECK(contains(o.out, "|d| 1 at pixel 3,0 channel R: A 2, B 1"));
        const Outcome quiet = run(folder, {"diff", "a.exr", "b.exr", "-q"});
        CHECK(quiet.code == 2);
        CHECK(quiet.out.empty());
        CHECK(quiet.err.empty());
    }

    TEST_CASE("limits on metrics") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "b.exr", {1, 1, 1, 1});
        writeRow(folder / "a.exr", {1, 1, 1, 0.5f}); // mse 0.0625, psnr 12.04, bias -0.125
        CHECK(codeOf(folder, {"--fail-metric", "mse=0.06"}) == 2);
        CHECK(codeOf(folder, {"--fail-metric", "mse=0.0625"}) == 0);
        CHECK(codeOf(folder, {"--fail-metric", "mse=0.07", "--warn-metric", "mae=0.1"}) == 1);
        CHECK(codeOf(folder, {"--fail-metric", "psnr=12"}) == 0); // more is better
        CHECK(codeOf(folder, {"--fail-metric", "psnr=13"}) == 2);
        CHECK(codeOf(folder, {"--fail-metric", "bias=0.1"}) == 2); // of either sign
        CHECK(codeOf(folder, {"--fail-metric", "mse=1", "--fail-metric", "mae=0.1"}) == 2);
        CHECK(codeOf(folder, {"--fail-metric", "mse=1", "--fail", "0.1"}) == 2); // both kinds, when both are asked for
        CHECK(contains(run(folder, {"diff", "a.exr", "b.exr", "--fail-metric", "mse=0.06"}).out,
                       "FAIL  mse 0.0625 is above 0.06 (--fail-metric)"));
        for (const char* wrong : {"mse", "=3", "mse=", "msee=1", "mse=x"})
            CHECK(run(folder, {"diff", "a.exr", "b.exr", "--fail-metric", wrong}).code == 64);
        CHECK(contains(run(folder, {"diff", "a.exr", "b.exr", "--metrics", "relmes"}).err, "did you mean relmse?"));
        CHECK(contains(run(folder, {"diff", "a.exr"}).err, "diff needs A B"));
    }

    TEST_CASE("a file and itself") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1, 0, 3});
        const Outcome o = run(folder, {"diff", "a.exr", "a.exr"});
        CHECK(o.code == 0);
        CHECK(o.err.empty());
        CHECK(contains(o.out, "\nPASS  identical in all 3 pixels\n"));
        writeRow(folder / "n.exr", {1, notANumber, infinity});
        const Outcome odd = run(folder, {"diff", "n.exr", "n.exr"});
        CHECK(odd.code == 0);
        CHECK(contains(odd.err, "warning: n.exr: 2 of 3 pixels are not finite"));
    }

    TEST_CASE("pixels that are not finite fail, and are left out of the metrics") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1, notANumber, 3, 5, 7});
        writeRow(folder / "b.exr", {1, 2, infinity, 4, notANumber});
        const Outcome o = run(folder, diffWords({"--fail", "10"}));
        CHECK(o.code == 2);
        const Json j = json(o);
        CHECK(j["pixels"]["selected"] == 5);
        CHECK(j["pixels"]["compared"] == 2);
        CHECK(j["pixels"]["notFiniteA"] == 1);
        CHECK(j["pixels"]["notFiniteB"] == 2);
        CHECK(j["fail"]["pixels"] == 3);
        CHECK(metric(j, "mse") == 0.5);
        CHECK(contains(o.err, "warning: a.exr: 1 of 5 pixels are not finite; left out of the metrics"));
        CHECK(contains(o.err, "warning: b.exr: 2 of 5"));
        CHECK(codeOf(folder, {"--fail", "10", "--failpercent", "60", "--warn", "10", "--warnpercent", "60"}) == 0);
        CHECK(codeOf(folder, {"--failpercent", "100", "--hardfail", "1000"}) == 2);
        writeRow(folder / "a.exr", {notANumber});
        writeRow(folder / "b.exr", {1});
        const Outcome none = run(folder, diffWords());
        CHECK(none.code == 2);
        CHECK(json(none)["metrics"]["mse"]["rgb"]["value"].is_null());
        CHECK(json(none)["largest"].is_null());
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--fail-metric", "mse=1"}).code == 2);
    }

    TEST_CASE("black pictures") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "b.exr", 8, 8, 0, 0, 0);
        writeConstant(folder / "a.exr", 8, 8, 0, 0, 0);
        const Outcome same = run(folder, diffWords());
        CHECK(same.code == 0);
        for (const char* name : {"mse", "relbias", "relmse", "mape", "smape", "flip-hdr"}) CHECK(metric(json(same), name) == 0);
        writeConstant(folder / "a.exr", 8, 8, 0.5f, 0.5f, 0.5f);
        const Json lit = json(run(folder, diffWords()));
        CHECK(lit["metrics"]["relmse"]["rgb"]["value"] == "inf");
        CHECK(lit["metrics"]["psnr"]["rgb"]["value"] == "-inf");
        CHECK(metric(lit, "smape") == 2);
        CHECK(near(metric(lit, "relmse-abs"), 25));
        CHECK(metric(lit, "flip-hdr") > 0.5);
    }

    TEST_CASE("unequal sizes, --fit and --crop") {
        if (absent()) return;
        const Folder folder;
        writePlanes(folder / "a.exr", 3, 2, {{"Y", {1, 2, 3, 4, 5, 6}}});
        writePlanes(folder / "b.exr", 2, 3, {{"Y", {1, 2, 4, 4, 9, 9}}});
        const Outcome o = run(folder, {"diff", "a.exr", "b.exr"});
        CHECK(o.code == 3);
        CHECK(o.out.empty());
        CHECK(o.err == "error: a.exr is 3x2, b.exr is 2x3; use --crop or --fit to compare.\n");
        const Json fit = json(run(folder, diffWords({"--fit"})));
        CHECK(fit["area"] == Json({0, 0, 2, 2}));
        CHECK(metric(fit, "mse", "Y") == 0.25); // of 1-1 2-2 4-4 5-4
        CHECK(fit["largest"]["x"] == 1);
        CHECK(fit["largest"]["y"] == 1);
        CHECK(codeOf(folder, {"--crop", "2x1+0+0"}) == 0);
        CHECK(codeOf(folder, {"--crop", "1x1+1+1"}) == 2);
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--crop", "3x1+0+0"}).code == 64); // not inside b
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--crop", "2x1"}).code == 64);
    }

    TEST_CASE("crop windows are places in the whole picture") {
        if (absent()) return;
        const Folder folder;
        writePlanes(folder / "a.exr", 4, 1, {{"Y", {1, 2, 3, 4}}});
        chiaro::Picture part{.width = 4, .height = 1, .window = {2, 0, 4, 1}, .names = {}, .planes = {}, .metadata = {}};
        part.add("Y") = {3, 5};
        chiaro::writeExr(folder / "b.exr", part);
        const Outcome o = run(folder, {"diff", "a.exr", "b.exr"});
        CHECK(o.code == 3);
        CHECK(contains(o.err, "a.exr has the window 4x1+0+0, b.exr has 2x1+2+0; use --crop or --fit"));
        const Json j = json(run(folder, diffWords({"--fit"})));
        CHECK(metric(j, "mse", "Y") == 0.5);
        CHECK(j["largest"]["x"] == 3);
        CHECK(codeOf(folder, {"--crop", "1x1+2+0"}) == 0);
        CHECK(codeOf(folder, {"--crop", "2x1+1+0"}) == 3);
        CHECK(codeOf(folder, {"--crop", "1x1+3+0"}) == 2);
    }

    TEST_CASE("mask") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1, 2, 9});
        writeRow(folder / "b.exr", {1, 1, 1});
        writeBytes(folder / "m.png", 3, 1, {255, 255, 255, 200, 200, 200, 0, 0, 0});
        const Json j = json(run(folder, diffWords({"--mask", "m.png"})));
        CHECK(j["pixels"]["selected"] == 2);
        CHECK(metric(j, "mse") == 0.5);
        CHECK(j["largest"]["x"] == 1);
        CHECK(codeOf(folder, {"--mask", "m.png", "--crop", "1x1+0+0"}) == 0);
        CHECK(codeOf(folder, {"--mask", "m.png", "--crop", "1x1+2+0"}) == 3); // nothing left
        writeBytes(folder / "s.png", 2, 1, {255, 255, 255, 0, 0, 0});
        const Outcome o = run(folder, {"diff", "a.exr", "b.exr", "--mask", "s.png"});
        CHECK(o.code == 3);
        CHECK(contains(o.err, "--mask s.png is 2x1, a.exr is 3x1; make the mask of that size."));
        CHECK(codeOf(folder, {"--mask", "none.png"}) == 4);
    }

    TEST_CASE("layers, extra and missing channels, grey") {
        if (absent()) return;
        const Folder folder;
        const std::vector<float> one{1}, two{2}, three{3};
        writePlanes(folder / "a.exr", 1, 1,
                    {{"R", one},
                     {"G", one},
                     {"B", one},
                     {"albedo.R", two},
                     {"albedo.G", two},
                     {"albedo.B", two},
                     {"normal.X", one},
                     {"normal.Y", one},
                     {"normal.Z", one},
                     {"Z", {infinity}},
                     {"extra", one}});
        writePlanes(folder / "b.exr", 1, 1,
                    {{"R", one},
                     {"G", one},
                     {"B", one},
                     {"albedo.R", two},
                     {"albedo.G", two},
                     {"albedo.B", three},
                     {"normal.X", one},
                     {"normal.Y", one},
                     {"normal.Z", two},
                     {"Z", {infinity}}});
        const Json j = json(run(folder, diffWords()));
        CHECK(j["verdict"] == "PASS"); // what is not compared does not count, but is named
        const auto left = j["a"]["notCompared"].get<std::vector<std::string>>();
        for (const char* name : {"albedo", "normal", "Z", "extra"}) CHECK(std::find(left.begin(), left.end(), name) != left.end());
        CHECK(left.size() == 4);
        CHECK(near(metric(json(run(folder, diffWords({"--layer", "albedo"}))), "mse"), 1.0 / 3));
        const Json normal = json(run(folder, diffWords({"--layer", "normal"})));
        CHECK(metric(normal, "mse", "Z") == 1);
        CHECK(metric(normal, "mse", "X") == 0);
        CHECK_FALSE(normal["metrics"].contains("flip-hdr"));
        CHECK(codeOf(folder, {"--layer", "Z"}) == 0); // both miss there
        const Outcome absentLayer = run(folder, {"diff", "a.exr", "b.exr", "--layer", "extra"});
        CHECK(absentLayer.code == 3);
        CHECK(contains(absentLayer.err, "b.exr has no layer \"extra\"; have "));
        writePlanes(folder / "b.exr", 1, 1, {{"Y", two}});
        const Json grey = json(run(folder, diffWords()));
        CHECK(metric(grey, "mse") == 1);
        CHECK(grey["b"]["channels"] == Json({"Y"}));
        CHECK(contains(run(folder, {"diff", "a.exr", "b.exr"}).out, "Y   linear, grey"));
        writePlanes(folder / "b.exr", 1, 1, {{"R", two}, {"G", two}});
        const Outcome missing = run(folder, {"diff", "a.exr", "b.exr"});
        CHECK(missing.code == 3);
        CHECK(contains(missing.err, "b.exr has no R, G, B and no Y but R, G; compare one of them with --layer NAME."));
    }
}
