// `chiaro diff`: every metric against values computed by hand (rows K1, K7 and K8 of the verification notes), through real files.
#include "diff_pictures.h"

using namespace program;

TEST_SUITE("diff metrics") {
    TEST_CASE("row K7") {
        if (absent()) return;
        const Folder folder;
        writeRow(folder / "a.exr", {1.1f, 1.8f, 4.4f});
        writeRow(folder / "b.exr", {1, 2, 4});
        const Outcome o = run(folder, diffWords({"--flip", "none"}));
        CHECK(o.code == 2);
        const Json j = json(o);
        const double e = 0.01 * 49 / 9, p = 0.07 / 3;
        for (const char* channel : {"rgb", "Y", "R", "G", "B"}) {
            CAPTURE(channel);
            CHECK(near(metric(j, "mse", channel), 0.07));
            CHECK(near(metric(j, "rmse", channel), 0.2645751));
            CHECK(near(metric(j, "mae", channel), 0.2333333));
            CHECK(near(metric(j, "bias", channel), 0.1));
            CHECK(near(metric(j, "relbias", channel), 0.3 / 7));
            CHECK(near(metric(j, "relmse", channel), (0.01 / (1 + e) + 0.04 / (4 + e) + 0.16 / (16 + e)) / 3));
            CHECK(near(metric(j, "relmse-abs", channel), 0.0099566021));
            CHECK(near(metric(j, "mrse", channel), 0.0098846308));
            CHECK(near(metric(j, "mape", channel), (0.1 / (1 + p) + 0.2 / (2 + p) + 0.4 / (4 + p)) / 3));
            CHECK(near(metric(j, "smape", channel), 0.0985797828));
            CHECK(near(metric(j, "psnr", channel), 10 * std::log10(16 / 0.07)));
            CHECK(near(metric(j, "maxabs", channel), 0.4));
            // the largest |d| of three values left out: the mean of 0.01 and 0.04
            if (std::string(channel) != "rgb") CHECK(near(j["metrics"]["mse"][channel]["trimmed"].get<double>(), 0.025));
        }
        CHECK(j["metrics"].size() == 12); // no FLIP, and no relmse-net without errors
        CHECK(near(j["means"]["rgb"]["a"].get<double>(), 7.3 / 3));
        CHECK(near(j["means"]["R"]["difference"].get<double>(), 0.1));
        CHECK(j["means"]["R"]["standardError"].is_null());
        CHECK(j["largest"]["x"] == 2);
        CHECK(j["largest"]["y"] == 0);
        CHECK(near(j["largest"]["difference"].get<double>(), 0.4));
        CHECK(near(metric(json(run(folder, diffWords({"--metrics", "psnr", "--peak", "1"}))), "psnr"), 10 * std::log10(1 / 0.07)));
    }

    TEST_CASE("channels apart") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "a.exr", 4, 3, 1.5f, 1, 0);
        writeConstant(folder / "b.exr", 4, 3, 1, 1, 1);
        const Json j = json(run(folder, diffWords({"--metrics", "mse,bias,psnr"})));
        CHECK(near(metric(j, "mse", "R"), 0.25));
        CHECK(metric(j, "mse", "G") == 0);
        CHECK(near(metric(j, "mse", "B"), 1));
        CHECK(near(metric(j, "mse"), 1.25 / 3));
        CHECK(near(metric(j, "bias", "Y"), 0.5 * 0.2126 - 0.0722));
        CHECK(j["metrics"]["psnr"]["G"]["value"] == "inf");
        CHECK(j["largest"]["channel"] == "B");
        CHECK(j["largest"]["difference"] == -1);
        CHECK(j["metrics"].size() == 3);
        const Outcome text = run(folder, {"diff", "a.exr", "b.exr", "--channels", "--metrics", "mse,psnr"});
        CHECK(contains(text.out, "mse              0.416667   0.00116281         0.25            0            1   (cd/m2)^2\n"));
        CHECK(contains(text.out, "largest d              -1"));
    }

    TEST_CASE("row K8: FLIP of constant pictures") {
        if (absent()) return;
        const Folder folder;
        const auto flip = [&](std::array<float, 3> a, std::array<float, 3> b) {
            writeConstant(folder / "a.exr", 24, 16, a[0], a[1], a[2]);
            writeConstant(folder / "b.exr", 24, 16, b[0], b[1], b[2]);
            return metric(json(run(folder, diffWords({"--metrics", "flip", "--flip", "ldr", "--exposure", "0"}))), "flip-ldr");
        };
        const float half = 0.2140411f, more = std::pow((0.55f + 0.055f) / 1.055f, 2.4f); // sRGB 0.5 and 0.55
        CHECK(std::abs(flip({0, 0, 0}, {1, 1, 1}) - 0.9673798) < 1e-4);
        CHECK(std::abs(flip({1, 0, 0}, {0, 1, 0}) - 0.9866623) < 1e-4);
        CHECK(std::abs(flip({0, 0, 0}, {half, half, half}) - 0.9314961) < 1e-4);
        CHECK(std::abs(flip({half, half, half}, {more, more, more}) - 0.1764611) < 1e-4);
        CHECK(std::abs(flip({0, 1, 0}, {0, 0, 1}) - 1) < 1e-4);
        CHECK(flip({0.3f, 0.3f, 0.3f}, {0.3f, 0.3f, 0.3f}) == 0);
    }

    TEST_CASE("which FLIP, and at which exposure") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "a.exr", 8, 8, 0.25f, 0.25f, 0.25f);
        writeConstant(folder / "b.exr", 8, 8, 0.5f, 0.5f, 0.5f);
        const auto names = [](const Json& j) {
            std::string all;
            for (const auto& [name, value] : j["metrics"].items()) all += name + " ";
            return all;
        };
        CHECK(names(json(run(folder, diffWords({"--metrics", "flip"})))) == "flip-hdr ");
        CHECK(contains(names(json(run(folder, diffWords()))), "flip-hdr"));
        CHECK_FALSE(contains(names(json(run(folder, diffWords()))), "flip-ldr"));
        CHECK(run(folder, diffWords({"--metrics", "flip", "--flip", "none"})).code == 64);
        // Half as bright at one stop more is the same on the screen as the other pair at no exposure.
        const double plain = metric(json(run(folder, diffWords({"--metrics", "flip-ldr", "--exposure", "0"}))), "flip-ldr");
        writeConstant(folder / "a.exr", 8, 8, 0.125f, 0.125f, 0.125f);
        writeConstant(folder / "b.exr", 8, 8, 0.25f, 0.25f, 0.25f);
        const Json j = json(run(folder, diffWords({"--metrics", "flip-ldr", "--exposure", "1"})));
        CHECK(metric(j, "flip-ldr") == plain);
        CHECK(j["flip"]["ldr"]["exposure"] == 1);
        // auto: that of B; its log-average of 0.25 comes to 0.18: log2(0.18/0.25) = -0.47, in tenths and down
        CHECK(json(run(folder, diffWords({"--metrics", "flip-ldr"})))["flip"]["ldr"]["exposure"] == -0.5);
        const Outcome useless = run(folder, diffWords({"--exposure", "1", "--metrics", "mse"}));
        CHECK(contains(useless.err, "warning: --exposure changes FLIP LDR alone"));
    }

    TEST_CASE("8-bit pictures are decoded by the sRGB curve") {
        if (absent()) return;
        const Folder folder;
        writeBytes(folder / "a.png", 2, 1, {10, 11, 64, 128, 188, 192});
        writeBytes(folder / "b.png", 2, 1, {0, 0, 0, 0, 0, 0});
        const Outcome o = run(folder, {"diff", "a.png", "b.png", "--json", "-"});
        const Json j = json(o);
        CHECK(j["a"]["decoded"] == "sRGB");
        CHECK(near(j["means"]["R"]["a"].get<double>(), (0.0030352698 + 0.2158605001) / 2, 1e-5));
        CHECK(near(j["means"]["G"]["a"].get<double>(), (0.0033465358 + 0.5028864580) / 2, 1e-5));
        CHECK(near(j["means"]["B"]["a"].get<double>(), (0.0512694584 + 0.5271151257) / 2, 1e-5));
        CHECK(j["metrics"].contains("flip-ldr"));
        CHECK(j["metrics"]["mse"]["unit"] == "1");
        CHECK(j["constants"]["peak"] == 1);
        CHECK(contains(run(folder, {"diff", "a.png", "b.png"}).out, "decoded by the sRGB curve"));
    }

    TEST_CASE("a linear picture beside its own PNG") {
        if (absent()) return;
        const Folder folder;
        writeConstant(folder / "a.exr", 16, 8, 0.25f, 0.25f, 0.25f);
        writeBytes(folder / "b.png", 16, 8, std::vector<uint8_t>(16 * 8 * 3, 188)); // twice as bright, encoded
        const Outcome o = run(folder, {"diff", "a.exr", "b.png", "--metrics", "flip", "--exposure", "1", "--fail-metric", "flip=0.02"});
        CHECK(o.code == 0);
        CHECK(contains(o.out, "flip-ldr"));
        CHECK(contains(o.err, "warning: b.png holds encoded colours for a screen, a.exr linear radiance"));
        CHECK(run(folder, {"diff", "a.exr", "b.png", "--fail-metric", "flip=0.02"}).code == 2); // a stop apart
    }

    TEST_CASE("mean difference with its standard error") {
        if (absent()) return;
        const Folder folder;
        const std::vector<float> ones{1, 1}, twos{2, 2}, small{0.1f, 0.1f}, large{0.2f, 0.2f};
        writePlanes(folder / "a.exr", 2, 1,
                    {{"R", twos}, {"G", twos}, {"B", twos}, {"error.R", small}, {"error.G", small}, {"error.B", small}});
        writePlanes(folder / "b.exr", 2, 1,
                    {{"R", ones}, {"G", ones}, {"B", ones}, {"error.R", large}, {"error.G", large}, {"error.B", large}});
        // The channels of a pixel add up, pixels add as squares: sqrt(2 (0.3^2 + 0.6^2))/6; of one channel sqrt(2 (0.1^2 + 0.2^2))/2.
        const Json j = json(run(folder, diffWords()));
        CHECK(near(j["means"]["rgb"]["standardError"].get<double>(), std::sqrt(0.9) / 6));
        CHECK(near(j["means"]["R"]["standardError"].get<double>(), std::sqrt(0.1) / 2));
        // relmse - mean s^2/(r^2 + e), e = 0.01
        CHECK(near(metric(j, "relmse-net"), (1 - 0.04) / 1.01));
        CHECK(contains(run(folder, {"diff", "a.exr", "b.exr"}).out, "A - B +1 +- 0.158114 (1 standard error, of both), 6.3 of them"));
        writePlanes(folder / "b.exr", 2, 1, {{"R", ones}, {"G", ones}, {"B", ones}});
        CHECK(contains(run(folder, {"diff", "a.exr", "b.exr"}).out, "A - B +1 +- 0.0707107 (1 standard error, of A alone), 14.1 of them"));
        CHECK(run(folder, {"diff", "a.exr", "b.exr", "--fail-metric", "relmse-net=0.1"}).code == 3);
    }
}
