// --noise, and whether the interval of the mean keeps its promise: at 95 % it covers the converged value in 90 to 99 of 100 renders.
#include "scenes/builtin.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"
#include "tests/statistics.h"
#include "tools/cli/report.h"
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace program;

namespace {

test::Settings smallPicture(uint64_t seed, uint32_t spp) {
    test::Settings s{.width = 48, .height = 27, .spp = spp};
    s.seed = seed;
    s.filter = FilterKind::blackmanHarris;
    return s;
}

struct Promise {
    int covered = 0;              // of 100 intervals
    double noise = 0, spread = 0; // as told, and as it is
};
// 100 seeds. Their mean, of 100 times the samples, is the converged value: its own error is a tenth of the one that is judged.
Promise judged(const std::string& name, const std::string& integrator, uint32_t spp) {
    const auto scene = test::compiled(findBuiltin(name)->make());
    constexpr int seeds = 100;
    constexpr uint32_t pixels = 48 * 27;
    std::vector<stats::Moments> ofPixels(pixels);
    std::vector<Film::Mean> means;
    stats::Moments picture, width;
    Promise p;
    for (uint64_t seed = 0; seed < seeds; ++seed) {
        const test::Rendering r = test::rendered(*scene, scene->cameras()[0], smallPicture(seed, spp), integrator);
        means.push_back(r.film->meanLuminance());
        picture.add(means.back().value);
        width.add(cli::relativeInterval(means.back()));
        p.noise += r.film->noise() / seeds;
        for (uint32_t i = 0; i < pixels; ++i) ofPixels[i].add(double(luminance(r.film->mean({i % 48, i / 48}))));
    }
    for (const Film::Mean& m : means) p.covered += std::fabs(m.value - picture.mean) <= cli::relativeInterval(m) * m.value;
    for (const stats::Moments& m : ofPixels) p.spread += std::sqrt(m.variance()) / pixels / picture.mean;
    MESSAGE(name << " " << integrator << " " << spp << " spp: " << p.covered << " of 100 intervals cover, mean +-" << 100 * width.mean
                 << " %, noise " << 100 * p.noise << " %, in truth " << 100 * p.spread << " %");
    return p;
}

} // namespace

TEST_SUITE("noise-interval") {

    TEST_CASE("the 95 % interval of the mean covers the converged value in 90 to 99 of 100 seeds; the noise is that of the pixels") {
        struct Case {
            const char *scene, *integrator;
            uint32_t spp;
        };
        constexpr Case cases[] = {{"@cornell", "path", 16}, {"@cornell", "path", 24}, {"@furnace", "path", 16}, {"@cornell", "light", 16}};
        for (const Case& c : cases) {
            const Promise p = judged(c.scene, c.integrator, c.spp);
            CAPTURE(c.scene);
            CAPTURE(c.integrator);
            CHECK(p.covered >= 90);
            CHECK(p.covered <= 99);
            CHECK(p.noise > 0.75 * p.spread);
            CHECK(p.noise < 1.4 * p.spread);
        }
    }

} // TEST_SUITE

TEST_SUITE("noise") {

    TEST_CASE("--noise ends the render, says so, and means it") {
        if (absent()) return;
        const Folder folder;
        const Outcome o = run(folder, {"render", "@cornell", "--size", "64x64", "--noise", "5%", "--json"});
        CAPTURE(o.err);
        CHECK(o.code == 0);
        const auto summary = nlohmann::json::parse(o.out);
        CHECK(summary["ended"] == "noise");
        CHECK(summary["noiseBound"].get<double>() <= 0.0501);
        CHECK(summary["noise"].get<double>() < summary["noiseBound"].get<double>());
        CHECK(summary["noiseBound"].get<double>() > 0.03); // no more samples than it takes
        CHECK(contains(o.err, "or noise 5 %, depth"));
        CHECK(contains(o.err, "(below 5 % with 95 % confidence)"));
        const int spp = summary["spp"];
        CHECK(spp >= 16);
        // The same samples as those of a render of so many, whatever ended it.
        const Outcome again = run(folder, {"render", "@cornell", "--size", "64x64", "--spp", std::to_string(spp), "--json", "-o", "b.exr"});
        CHECK(nlohmann::json::parse(again.out)["mean"] == summary["mean"]);
    }

    TEST_CASE("other limits come first where they are tighter; nothing ends before 16 samples by noise") {
        if (absent()) return;
        const Folder folder;
        const auto ended = [&](std::vector<std::string> more) {
            std::vector<std::string> words = {"render", "@cornell", "--size", "16x16", "--json", "-q"};
            words.insert(words.end(), more.begin(), more.end());
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            REQUIRE(o.code == 0);
            const auto summary = nlohmann::json::parse(o.out);
            return summary["ended"].get<std::string>() + " " + std::to_string(summary["spp"].get<int>());
        };
        CHECK(ended({"--noise", "1", "--spp", "20"}) == "spp 20");
        CHECK(ended({"--noise", "100", "--spp", "20"}) == "noise 16");
        CHECK(ended({"--noise", "0.001", "--time", "200ms"}).starts_with("time "));
        CHECK(ended({"--noise", "2", "-i", "depth:"}).starts_with("noise "));
    }

    TEST_CASE("what is no percentage is refused; the help says how it is found") {
        if (absent()) return;
        const Folder folder;
        for (const char* wrong : {"x", "0", "-1", "101", "2%%x", ""}) {
            const Outcome o = run(folder, {"render", "@cornell", "--noise", wrong});
            CHECK(o.code == 64);
            CHECK(contains(o.err, "a percentage from 0.001 to 100, like 2%"));
        }
        const Outcome help = run(folder, {"help", "noise"});
        CHECK(help.code == 0);
        CHECK(contains(help.out, "confidence"));
        CHECK(contains(help.out, "Student's t"));
    }

} // TEST_SUITE
