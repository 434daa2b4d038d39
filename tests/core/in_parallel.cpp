#include "core/render/in_parallel.h"
#include "core/render/error.h"
#include <doctest/doctest.h>
#include <vector>

using namespace chiaro;

TEST_SUITE("in-parallel") {

    TEST_CASE("every piece once, with and without threads") {
        const Executor two(2), five(5);
        for (const Executor* run : {static_cast<const Executor*>(nullptr), &two, &five}) {
            std::vector<std::atomic<int>> done(1000);
            inParallel(run, done.size(), [&](uint64_t i) { ++done[i]; });
            for (const auto& d : done) CHECK(d == 1);
            inParallel(run, 0, [](uint64_t) { FAIL("nothing to do"); });
        }
    }

    TEST_CASE("of several failures the one of the lowest number is told") {
        const Executor four(4);
        for (const Executor* run : {static_cast<const Executor*>(nullptr), &four})
            for (int repeat = 0; repeat < 50; ++repeat) {
                std::string told;
                try {
                    inParallel(run, 200, [](uint64_t i) {
                        if (i % 7 == 5) throw Error(Exit::file, std::to_string(i));
                    });
                } catch (const Error& e) { told = e.what(); }
                CHECK(told == "5");
            }
    }

} // TEST_SUITE
