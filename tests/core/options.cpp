// Option tables: parsing, every error message, counts with suffixes, the recipe; and the nearest word to a typo.
#include "core/render/options.h"
#include <doctest/doctest.h>

using namespace chiaro;

namespace {

constexpr OptionSpec specs[] = {
    {"count", OptionType::integer, "100", 1, 1e9, "", "photons"},
    {"radius", OptionType::real, "0.5", 0, 10, "", "metres"},
    {"mis", OptionType::boolean, "on", 0, 0, "", "weigh"},
    {"mode", OptionType::choice, "fast", 0, 0, "fast|slow|exact", "how"},
};
std::string errorOf(std::string_view text) {
    try {
        Options::parse(specs, text, "photon");
        return "accepted";
    } catch (const Error& e) {
        CHECK(e.code == Exit::usage);
        return e.what();
    }
}

} // namespace

TEST_SUITE("options") {

    TEST_CASE("defaults, values, recipe") {
        const Options standard(specs);
        CHECK(standard.integer("count") == 100);
        CHECK(standard.real("radius") == 0.5);
        CHECK(standard.boolean("mis"));
        CHECK(standard.text("mode") == "fast");
        CHECK(standard.recipe().empty());
        const Options o = Options::parse(specs, "count=2M,mis=off,mode=exact,radius=1e-2", "photon");
        CHECK(o.integer("count") == 2'000'000);
        CHECK(o.real("radius") == 0.01);
        CHECK(!o.boolean("mis"));
        CHECK(o.text("mode") == "exact");
        CHECK(o.recipe() == "count=2M,radius=1e-2,mis=off,mode=exact");
        CHECK(Options::parse(specs, o.recipe(), "photon").recipe() == o.recipe());
        CHECK(Options::parse(specs, "", "photon").recipe().empty());
        CHECK(Options::parse(specs, "radius=2,radius=3", "photon").real("radius") == 3); // the last one counts
        for (const char* yes : {"on", "true", "1", "yes"}) CHECK(Options::parse(specs, std::string("mis=") + yes, "p").boolean("mis"));
        for (const char* no : {"off", "false", "0", "no"}) CHECK(!Options::parse(specs, std::string("mis=") + no, "p").boolean("mis"));
        CHECK_THROWS_AS(standard.real("nothing"), Error);
    }

    TEST_CASE("every error names owner, key, value and the way out") {
        const std::pair<const char*, const char*> cases[] = {
            {"cuont=3", "photon has no option \"cuont\"; have count, radius, mis, mode; did you mean count?"},
            {"zzzzzzzz=3", "photon has no option \"zzzzzzzz\"; have count, radius, mis, mode"},
            {"count", "photon: \"count\" is not key=value"},
            {"count=1,,mis=on", "photon: \"\" is not key=value"},
            {"count=many", "photon: count=many is not a number"},
            {"count=", "photon: count= is not a number"},
            {"radius=nan", "photon: radius=nan is not a number"},
            {"radius=inf", "photon: radius=inf is not a number"},
            {"radius=1e999", "photon: radius=1e999 is not a number"},
            {"radius=2x", "photon: radius=2x is not a number"},
            {"count=1.5", "photon: count=1.5 must be a whole number"},
            {"count=0", "photon: count=0 is out of range; give 1 to 1000000000"},
            {"count=2G", "photon: count=2G is out of range; give 1 to 1000000000"},
            {"radius=-1", "photon: radius=-1 is out of range; give 0 to 10"},
            {"mis=maybe", "photon: mis=maybe must be on or off"},
            {"mode=warp", "photon: mode=warp is none of fast, slow, exact"},
        };
        for (const auto& [text, message] : cases) CHECK(errorOf(text) == message);
        try {
            Options::parse({}, "a=1", "normals");
            FAIL("accepted");
        } catch (const Error& e) { CHECK(std::string(e.what()) == "normals has no option \"a\"; have none"); }
    }

    TEST_CASE("counts") {
        const std::pair<const char*, double> good[] = {{"0", 0},        {"64k", 64e3}, {"64K", 64e3}, {"2M", 2e6},
                                                       {"1.5G", 1.5e9}, {"-3", -3},    {"1e3", 1e3},  {".5", .5}};
        for (const auto& [text, value] : good) CHECK(parseCount(text) == value);
        for (const char* bad : {"", "k", "M2", "2 M", " 2", "2MM", "2m", "0x10", "nan", "inf", "-inf", "1,5", "1e999", "--1"}) {
            CAPTURE(std::string(bad));
            CHECK_THROWS_AS(parseCount(bad), std::invalid_argument);
        }
    }
}

TEST_SUITE("nearest") {

    TEST_CASE("typical typos find their word, strangers find none") {
        const std::vector<std::string> options = {"--spp",        "--seed",      "--size",   "--sampler",
                                                  "--integrator", "--max-depth", "--output", "--exposure"};
        const std::pair<const char*, const char*> typos[] = {{"--ssp", "--spp"},
                                                             {"--sed", "--seed"},
                                                             {"--sise", "--size"},
                                                             {"--smapler", "--sampler"},
                                                             {"--integrater", "--integrator"},
                                                             {"--max_depth", "--max-depth"},
                                                             {"--ouput", "--output"},
                                                             {"--exposur", "--exposure"},
                                                             {"--integ", "--integrator"}};
        for (const auto& [typo, word] : typos) CHECK(nearest(typo, options) == word);
        const std::vector<std::string> integrators = {"whitted", "distributed", "path", "photon", "radiosity"};
        CHECK(nearest("pathtracer", integrators) == "path");
        CHECK(nearest("phtoon", integrators) == "photon");
        CHECK(nearest("pth", integrators) == "path");
        CHECK(nearest("radiosty", integrators) == "radiosity");
        for (const char* stranger : {"metropolis", "x", "bidirectional", "qqqqqq"}) CHECK(nearest(stranger, integrators).empty());
        CHECK(nearest("path", {}).empty());
        CHECK(nearest("", integrators).empty());
    }

    TEST_CASE("diagnostics keep each warning once, in order") {
        Diagnostics notes;
        for (const char* w : {"b", "a", "b", "c", "a"}) notes.warn(w);
        CHECK(notes.warnings() == std::vector<std::string>{"b", "a", "c"});
    }
}
