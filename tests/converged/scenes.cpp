// Each integrator of the registry on each built-in scene, against its reference. One suite a scene; the rows are in comparison.cpp.
#include "tests/converged/comparison.h"
#include <doctest/doctest.h>

using namespace chiaro;
using namespace chiaro::test;

TEST_SUITE("cornell") {
    TEST_CASE("@cornell") { compareAll("@cornell"); }
} // TEST_SUITE
TEST_SUITE("cornell-spheres") {
    TEST_CASE("@cornell-spheres") { compareAll("@cornell-spheres"); }
} // TEST_SUITE
TEST_SUITE("veach-mis") {
    TEST_CASE("@veach-mis") { compareAll("@veach-mis"); }
} // TEST_SUITE
TEST_SUITE("caustic") {
    TEST_CASE("@caustic") { compareAll("@caustic"); }
} // TEST_SUITE
TEST_SUITE("playground") {
    TEST_CASE("@playground") { compareAll("@playground"); }
} // TEST_SUITE
TEST_SUITE("gallery") {
    TEST_CASE("@gallery") { compareAll("@gallery"); }
} // TEST_SUITE
TEST_SUITE("furnace") {
    TEST_CASE("@furnace") { compareAll("@furnace"); }
} // TEST_SUITE
