// chiaro ff: lists, pairs, rows, checks, and wrong words.
#include "program.h"
#include <nlohmann/json.hpp>

using namespace program;

namespace {

nlohmann::json jsonOf(const Outcome& o) {
    const auto j = nlohmann::json::parse(o.out, nullptr, false);
    CAPTURE(o.out);
    CAPTURE(o.err);
    REQUIRE(j.is_object());
    return j;
}

} // namespace

TEST_SUITE("ff") {
    TEST_CASE("objects and their patches, as text and JSON") {
        if (absent()) return;
        const Folder folder;
        const Outcome text = run(folder, {"ff", "@cornell", "--patches", "300"});
        CHECK(text.code == 0);
        CHECK(contains(text.out, "object"));
        CHECK(contains(text.err, "patches"));
        const auto j = jsonOf(run(folder, {"ff", "@cornell", "--patches", "300", "--json"}));
        std::size_t sum = 0;
        for (const auto& o : j["objects"]) sum += o["patches"].get<std::size_t>();
        CHECK(sum == j["patches"].get<std::size_t>());
        CHECK(sum > 200);
        CHECK(sum < 400);
    }
    TEST_CASE("a pair of patches is reciprocal within its errors, a row sums to its parts") {
        if (absent()) return;
        const Folder folder;
        for (const char* method : {"analytic", "hemisphere", "hemicube"}) {
            const auto j = jsonOf(run(
                folder, {"ff", "@cornell", "floor", "ceiling", "--patches", "100", "--method", method, "--resolution", "32", "--json"}));
            const double there = j["there"]["factor"].get<double>() * j["from"]["area"].get<double>(),
                         back = j["back"]["factor"].get<double>() * j["to"]["area"].get<double>();
            const double error = j["there"]["error"].get<double>() * j["from"]["area"].get<double>() +
                                 j["back"]["error"].get<double>() * j["to"]["area"].get<double>();
            CAPTURE(method);
            CHECK(std::abs(there - back) <= 5 * error + 1e-9);
        }
        const auto row = jsonOf(run(folder, {"ff", "@cornell", "0", "--patches", "100", "--json"}));
        double sum = 0;
        for (const auto& o : row["row"]) sum += o["factor"].get<double>();
        CHECK(sum == doctest::Approx(row["sum"].get<double>()));
        CHECK(sum <= 1.0001);
    }
    TEST_CASE("checks pass for every method, on an open and on a closed scene") {
        if (absent()) return;
        const Folder folder;
        for (const char* method : {"analytic", "hemisphere", "hemicube"}) {
            const Outcome o =
                run(folder, {"ff", "@cornell", "--patches", "100", "--check", "--method", method, "--resolution", "32", "--json"});
            CHECK(o.code == 0);
            const auto j = jsonOf(o);
            CHECK(j["check"]["passed"] == true);
            CHECK(j["check"]["asymmetry"]["worst_in_matrix_m2"] == 0);
        }
        const auto closed = jsonOf(run(folder, {"ff", "@furnace", "--patches", "200", "--check", "--json"}));
        CHECK(closed["check"]["passed"] == true);
        CHECK(closed["check"]["closed"] == true);
    }
    TEST_CASE("what cannot be is said in one line") {
        if (absent()) return;
        const Folder folder;
        const auto fails = [&](const std::vector<std::string>& words, int code, const std::string& part) {
            const Outcome o = run(folder, words);
            CAPTURE(o.err);
            CHECK(o.code == code);
            CHECK(contains(o.err, part));
            CHECK(o.out.empty());
        };
        fails({"ff"}, 64, "SCENE");
        fails({"ff", "@cornell", "nothing", "0"}, 64, "no object \"nothing\"");
        fails({"ff", "@cornell", "99999999", "0"}, 64, "no patch 99999999");
        fails({"ff", "@cornell", "--method", "guess"}, 64, "analytic");
        fails({"ff", "@cornell", "--size", "1", "--patches", "9"}, 64, "one of them");
        fails({"ff", "@cornell", "0", "--check"}, 64, "--check");
        fails({"ff", "@cornell", "--size", "1e-6"}, 6, "patches");
        fails({"ff", "@cornell", "--check", "--patches", "3000", "--max-memory", "1M"}, 6, "memory");
        fails({"ff", "absent.glb"}, 4, "absent.glb");
    }
} // TEST_SUITE
