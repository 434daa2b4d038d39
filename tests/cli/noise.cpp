// --noise, and whether the interval of the mean keeps its promise: at 95 % it covers the converged value in 90 to 99 of 100 renders.
#include "scenes/builtin.h"
#include "tests/cli/program.h"
#include "tests/scene_kit.h"
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

double meanOf(const Scene& scene, const std::string& integrator, uint32_t spp) {
    test::Settings s = smallPicture(1'000'000, spp);
    s.threads = 2;
    return test::rendered(scene, scene.cameras()[0], s, integrator).film->meanLuminance().value;
}

// Of 100 seeds, how many intervals hold the converged value.
int covered(const std::string& name, const std::string& integrator, uint32_t spp) {
    const auto scene = test::compiled(findBuiltin(name)->make());
    const double truth = meanOf(*scene, integrator, 4096);
    int hits = 0;
    double noise = 0, relative = 0;
    for (uint64_t seed = 0; seed < 100; ++seed) {
        const test::Rendering r = test::rendered(*scene, scene->cameras()[0], smallPicture(seed, spp), integrator);
        const Film::Mean m = r.film->meanLuminance();
        const double width = cli::relativeInterval(m);
        hits += std::fabs(m.value - truth) <= width * m.value;
        noise += r.film->noise() / 100;
        relative += width / 100;
    }
    MESSAGE(name << " " << integrator << " " << spp << " spp: " << hits << " of 100 intervals cover, mean +-" << 100 * relative
                 << " %, noise " << 100 * noise << " %");
    return hits;
}

} // namespace

TEST_SUITE("noise-interval") {

    TEST_CASE("the 95 % interval of the mean covers the converged value in 90 to 99 of 100 seeds") {
        struct Case {
            const char *scene, *integrator;
            uint32_t spp;
        };
        for (const Case& c :
             {Case{"@cornell", "path", 16}, {"@cornell", "path", 50}, {"@furnace", "path", 16}, {"@cornell", "light", 16}}) {
            const int hits = covered(c.scene, c.integrator, c.spp);
            CAPTURE(c.scene);
            CAPTURE(c.integrator);
            CHECK(hits >= 90);
            CHECK(hits <= 99);
        }
    }

    TEST_CASE("the noise that is told is that of the pixels") {
        const auto scene = test::compiled(findBuiltin("@cornell")->make());
        constexpr int seeds = 64;
        constexpr uint32_t pixels = 48 * 27;
        std::vector<double> sums(pixels), squares(pixels);
        double told = 0;
        for (uint64_t seed = 0; seed < seeds; ++seed) {
            const test::Rendering r = test::rendered(*scene, scene->cameras()[0], smallPicture(seed, 32));
            told += r.film->noise() / seeds;
            for (uint32_t i = 0; i < pixels; ++i) {
                const double v = double(luminance(r.film->mean({i % 48, i / 48})));
                sums[i] += v;
                squares[i] += v * v;
            }
        }
        double deviation = 0, light = 0;
        for (uint32_t i = 0; i < pixels; ++i) {
            const double mean = sums[i] / seeds;
            deviation += std::sqrt(std::max(0.0, squares[i] / seeds - mean * mean) * seeds / (seeds - 1));
            light += mean;
        }
        const double truth = deviation / light;
        CAPTURE(truth);
        CHECK(told > 0.8 * truth);
        CHECK(told < 1.3 * truth);
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
        CHECK(contains(o.err, "noise 5.0 %, depth"));
        CHECK(contains(o.err, "(below 5.0 % with 95 % confidence)"));
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
        CHECK(contains(help.out, "95 % confidence"));
        CHECK(contains(help.out, "Student's t"));
    }

} // TEST_SUITE
